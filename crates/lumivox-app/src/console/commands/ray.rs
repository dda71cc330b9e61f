//! A ray that marks what it hits.

use glam::{Vec2, Vec3};
use lumivox_render::OverlayLine;
use lumivox_scene::{Pick, Picker};

use crate::console::arguments::{PLACE, commas, number, vector};
use crate::console::command::{Command, Group, PLAIN, Takes};
use crate::console::{Console, Reply, nothing_to_show};
use crate::exit::Failure;

pub const TABLE: &[Command] = &[Command {
    name: "ray",
    group: Group::View,
    usage: "[X Y|X,Y,Z DX,DY,DZ|off]",
    count: (0, 2),
    takes: &[Takes::Word(&["off"]), Takes::Anything],
    summary: "Send a ray into the scene, print what it hits, and mark the place and the surface's normal",
    details: "From the camera through the middle of the picture, or through a pixel (from the upper left corner), or from a \
              place in a direction. The ray and a cross are red, the normal is green; `off` removes them.",
    example: "ray 320 180",
    vxct: Some("prints the object, the place and the normal, too"),
    run,
    ..PLAIN
}];

const RED: [f32; 4] = [1.0, 0.15, 0.1, 1.0];
const GREEN: [f32; 4] = [0.1, 0.9, 0.2, 1.0];

/// Length of the normal as a share of the scene's radius; the cross has a third of it.
const NORMAL: f32 = 0.15;

fn run(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let explorer = &console.explorer;
    let scene = explorer.scene().ok_or_else(nothing_to_show)?;
    let size = explorer.size();
    let through = |pixel: Vec2| explorer.camera().ray(pixel, size);
    let (origin, direction) = match arguments {
        [] => through(0.5 * size.as_vec2()),
        ["off"] => {
            console.ray = None;
            console.change(|settings| settings.overlay.lines.clear())?;
            return Ok(Reply::default());
        }
        [from, along] if from.contains(',') => {
            let origin = vector(&[from], "the ray's place in metres", PLACE)?;
            let direction = vector(&[along], "the ray's direction", PLACE)?;
            if direction == Vec3::ZERO {
                return Err(Failure::input("the ray's direction must not be 0,0,0").into());
            }
            (origin, direction)
        }
        [x, y] => {
            let x = number(x, "the pixel's column", 0.0..=size.x as f32)?;
            through(Vec2::new(x, number(y, "the pixel's row", 0.0..=size.y as f32)?))
        }
        _ => return Err(Failure::input("ray takes a pixel X Y, or X,Y,Z DX,DY,DZ, or off").into()),
    };
    let Some(pick) = Picker::new(scene).pick(origin, direction) else {
        console.ray = None;
        console.change(|settings| settings.overlay.lines.clear())?;
        return Ok(Reply::say("the ray hits nothing"));
    };
    let name = explorer.object_names().into_iter().nth(pick.instance).unwrap_or_default();
    let instance = scene.instances.get(pick.instance);
    let material =
        instance.and_then(|instance| explorer.material_names().into_iter().nth(instance.material));
    let lines = mark(origin, &pick, NORMAL * explorer.bounds().radius_m());
    console.change(|settings| settings.overlay.lines = lines)?;
    console.ray = Some((origin, direction));
    Ok(Reply::say(format!(
        "\"{name}\" (material \"{}\") at {} m, {} m away, normal {}",
        material.unwrap_or_default(),
        commas(pick.position),
        pick.distance_m,
        commas(pick.shading_normal)
    )))
}

/// The lines of a hit. Seen through surfaces, for most of them lies within one.
fn mark(origin: Vec3, pick: &Pick, length_m: f32) -> Vec<OverlayLine> {
    let line = |from, to, color| OverlayLine { from, to, color, is_hidden_by_surfaces: false };
    let (at, normal) = (pick.position, pick.shading_normal);
    let along = normal.any_orthonormal_vector();
    let across = normal.cross(along);
    let arm = length_m / 3.0;
    vec![
        line(origin, at, RED),
        line(at - arm * along, at + arm * along, RED),
        line(at - arm * across, at + arm * across, RED),
        line(at, at + length_m * normal, GREEN),
    ]
}

/// The command that sends the ray which is shown.
pub fn line(console: &Console) -> Option<String> {
    let (origin, direction) =
        console.ray.filter(|_| !console.explorer.settings().overlay.lines.is_empty())?;
    Some(format!("ray {} {}", commas(origin), commas(direction)))
}
