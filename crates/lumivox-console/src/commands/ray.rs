//! The command `ray`: it marks the point that a ray hits.

use glam::{Vec2, Vec3};
use lumivox_render::OverlayLine;
use lumivox_scene::Picker;

use crate::arguments::{FARTHEST_M, PLACE, commas, number, vector};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::{Console, Failure, Reply, nothing_to_show};

pub const TABLE: &[Command] = &[Command {
    name: "ray",
    group: Group::View,
    usage: "[X Y|X,Y,Z DX,DY,DZ|mark X,Y,Z X,Y,Z NX,NY,NZ LENGTH|off]",
    count: (0, 5),
    takes: &[Takes::Word(&["off", "mark"]), Takes::Anything],
    summary: "Send a ray into the scene, print what it hits, and mark the place and the surface's normal",
    details: "From the camera through the centre of the picture, or through a pixel (from the upper left corner), or from a \
              point in a direction. The ray and a cross are red, the normal is green; `off` removes them. They \
              stay in place when objects move. `mark` draws them without casting a ray: from a point to a point, with a normal of a length \
              in metres; `script` prints it.",
    example: "ray 320 180",
    run: Now(run),
    ..PLAIN
}];

const RED: [f32; 4] = [1.0, 0.15, 0.1, 1.0];
const GREEN: [f32; 4] = [0.1, 0.9, 0.2, 1.0];

/// Length of the normal as a share of the scene's radius; each arm of the cross is a third of it.
const NORMAL: f32 = 0.15;

/// A ray, drawn with the point that it hits and the normal there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayMarker {
    /// The ray's origin, m.
    origin: Vec3,
    /// The point that it hits, m.
    at: Vec3,
    normal: Vec3,
    /// The drawn length of the normal, m.
    length_m: f32,
}

fn show(console: &mut Console, mark: RayMarker) -> anyhow::Result<()> {
    console.change(|settings| settings.overlay.lines = mark.lines())?;
    console.ray = Some(mark);
    Ok(())
}

fn run(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let explorer = &console.explorer;
    let scene = explorer.scene().ok_or_else(nothing_to_show)?;
    let size = explorer.settings().size;
    let through = |pixel: Vec2| explorer.camera().ray(pixel, size);
    let (origin, direction) = match arguments {
        [] => through(0.5 * size.as_vec2()),
        ["off"] => {
            console.ray = None;
            console.change(|settings| settings.overlay.lines.clear())?;
            return Ok(Reply::default());
        }
        ["mark", from, at, normal, length] => {
            let mark = RayMarker {
                origin: vector(&[from], "the ray's place in metres", PLACE)?,
                at: vector(&[at], "the marked place in metres", PLACE)?,
                normal: vector(&[normal], "the normal", -2.0..=2.0)?,
                length_m: number(length, "the normal's length in metres", 0.0..=FARTHEST_M)?,
            };
            show(console, mark)?;
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
        _ => {
            return Err(Failure::input(
                "ray takes a pixel X Y, or X,Y,Z DX,DY,DZ, or mark and four values, or off",
            )
            .into());
        }
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
    let length_m = NORMAL * explorer.bounds().radius_m();
    show(console, RayMarker { origin, at: pick.position, normal: pick.shading_normal, length_m })?;
    Ok(Reply::say(format!(
        "\"{name}\" (material \"{}\") at {} m, {} m away, normal {}",
        material.unwrap_or_default(),
        commas(pick.position),
        pick.distance_m,
        commas(pick.shading_normal)
    )))
}

impl RayMarker {
    /// The lines of the marker. They are visible through surfaces, because most of them lie on one.
    fn lines(&self) -> Vec<OverlayLine> {
        let Self { origin, at, normal, length_m } = *self;
        let line = |from, to, color| OverlayLine { from, to, color, is_hidden_by_surfaces: false };
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
}

/// The command that draws this marker again, even if objects have moved since.
pub fn line(console: &Console) -> Option<String> {
    let mark = console.ray.filter(|_| !console.explorer.settings().overlay.lines.is_empty())?;
    let (origin, at, normal) = (commas(mark.origin), commas(mark.at), commas(mark.normal));
    Some(format!("ray mark {origin} {at} {normal} {}", mark.length_m))
}
