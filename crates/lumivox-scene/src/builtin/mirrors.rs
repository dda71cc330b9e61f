//! Rooms with mirrors, and with brushed metals. They are closed: all that a reflection shows is in
//! the scene.

use glam::{Mat4, Vec3};

use super::build::{
    GREEN, Lamp, RED, WHITE, checker, diffuse, lacquer, material, place, place_at, tile,
};
use super::shapes::{Faces, cuboid, merge, quad, sphere};
use crate::{Camera, Material, MetallicRoughness, Scene, Shading};

const CHROME: Vec3 = Vec3::new(0.55, 0.56, 0.55);
const SILVER: Vec3 = Vec3::new(0.97, 0.96, 0.91);
const COPPER: Vec3 = Vec3::new(0.95, 0.64, 0.54);
const GOLD: Vec3 = Vec3::new(1.0, 0.78, 0.34);
const STEEL: Vec3 = Vec3::new(0.56, 0.57, 0.58);

fn metal(scene: &mut Scene, name: &str, color: Vec3, roughness: f32) -> usize {
    let shading = MetallicRoughness {
        base_color: color.extend(1.0),
        metallic: 1.0,
        roughness,
        ..MetallicRoughness::default()
    };
    let shading = Shading::MetallicRoughness(shading);
    material(scene, Material { name: name.to_owned(), shading, ..Material::default() })
}

/// A lamp's radiance times a quarter of its area, in candela.
const QUARTER_CD: f32 = 10.0;

/// A room with a checkered floor, [-2, 2] x [0, 2.6] x [-2, 2], and a lamp, given half its edges.
/// Returns a white paint.
fn room(scene: &mut Scene, [half_x_m, half_z_m]: [f32; 2]) -> usize {
    let white = diffuse(scene, "white", WHITE);
    let red = diffuse(scene, "red", RED);
    let green = diffuse(scene, "green", GREEN);
    let tiles = checker(scene, "tiles", [[214, 205, 188], [70, 84, 108]]);
    let center = Vec3::new(0.0, 1.3, 0.0);
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 1.3, Vec3::Z * 2.0);
    // Squares of a third of a metre.
    place(scene, "floor", tile(quad(center - y, x, -z), 6.0, 6.0), tiles);
    let walls = [quad(center + y, x, z), quad(center - z, x, y), quad(center + z, -x, y)];
    place(scene, "ceiling, back and front wall", merge(walls), white);
    place(scene, "left wall", quad(center - x, -z, y), red);
    place(scene, "right wall", quad(center + x, z, y), green);
    let top = Vec3::Y * 2.6;
    let face_radiance = QUARTER_CD / (half_x_m * half_z_m);
    Lamp { top, half_x_m, half_z_m, drop_m: 0.05, face_radiance, intensity_cd: 0.0 }.install(scene);
    white
}

/// A mirror on the back wall, a chrome ball near the right one, polished stone, a basin of water.
pub(super) fn mirrors() -> Scene {
    let mut scene = Scene::default();
    // Paths that reach a small lamp by a mirror are too rare for a reference.
    let white = room(&mut scene, [1.4, 1.2]);
    let mirror = metal(&mut scene, "mirror", SILVER, 0.0);
    let chrome = metal(&mut scene, "chrome", CHROME, 0.05);
    let stone = lacquer(&mut scene, "polished stone", Vec3::new(0.05, 0.06, 0.05), 0.1);
    let water = lacquer(&mut scene, "water", Vec3::new(0.02, 0.05, 0.06), 0.0);
    if let Shading::MetallicRoughness(shading) = &mut scene.materials[water].shading {
        shading.ior = 1.33;
    }
    let ochre = diffuse(&mut scene, "ochre", Vec3::new(0.62, 0.42, 0.10));
    let blue = diffuse(&mut scene, "blue", Vec3::new(0.08, 0.16, 0.55));

    let pane = quad(Vec3::new(-0.4, 1.4, -1.97), Vec3::X * 1.2, Vec3::Y * 0.8);
    place(&mut scene, "mirror", pane, mirror);
    let ball = Mat4::from_translation(Vec3::new(1.45, 0.45, -0.9));
    place_at(&mut scene, "chrome ball", sphere(0.45, 64), chrome, ball);
    let slab = cuboid(Vec3::new(-1.8, 0.0, -1.7), Vec3::new(-0.9, 0.5, -0.9), Faces::NO_BOTTOM);
    place(&mut scene, "slab", slab, stone);
    let rim = [
        cuboid(Vec3::new(-0.7, 0.0, 0.3), Vec3::new(-0.6, 0.15, 1.1), Faces::NO_BOTTOM),
        cuboid(Vec3::new(0.5, 0.0, 0.3), Vec3::new(0.6, 0.15, 1.1), Faces::NO_BOTTOM),
        cuboid(Vec3::new(-0.6, 0.0, 0.3), Vec3::new(0.5, 0.15, 0.4), Faces::NO_BOTTOM),
        cuboid(Vec3::new(-0.6, 0.0, 1.0), Vec3::new(0.5, 0.15, 1.1), Faces::NO_BOTTOM),
    ];
    place(&mut scene, "rim", merge(rim), white);
    let surface = quad(Vec3::new(-0.05, 0.1, 0.7), Vec3::X * 0.55, Vec3::NEG_Z * 0.3);
    place(&mut scene, "water", surface, water);
    let block = cuboid(Vec3::new(-0.25, 0.0, -0.25), Vec3::new(0.25, 0.7, 0.25), Faces::NO_BOTTOM);
    let turned = Mat4::from_translation(Vec3::new(0.3, 0.0, -0.6)) * Mat4::from_rotation_y(0.5);
    place_at(&mut scene, "ochre block", block, ochre, turned);
    let behind = cuboid(Vec3::new(-1.7, 0.0, 1.2), Vec3::new(-1.2, 1.1, 1.7), Faces::NO_BOTTOM);
    place(&mut scene, "blue block", behind, blue);

    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.5, 1.5, 1.9), Vec3::new(-0.1, 0.8, -1.0), 1.0)
    });
    scene
}

/// Balls, a panel and a block of metals with a roughness from 0.2 to 0.7.
pub(super) fn metals() -> Scene {
    let mut scene = Scene::default();
    room(&mut scene, [0.6, 0.4]);
    let balls = [
        ("silver, roughness 0.2", SILVER, 0.2, -1.2),
        ("gold, roughness 0.3", GOLD, 0.3, -0.4),
        ("copper, roughness 0.45", COPPER, 0.45, 0.4),
        ("steel, roughness 0.6", STEEL, 0.6, 1.2),
    ];
    for (name, color, roughness, x) in balls {
        let surface = metal(&mut scene, name, color, roughness);
        let at = Mat4::from_translation(Vec3::new(x, 0.35, -0.3));
        place_at(&mut scene, name, sphere(0.35, 48), surface, at);
    }
    let brushed = metal(&mut scene, "brushed panel, roughness 0.35", STEEL, 0.35);
    let panel = quad(Vec3::new(0.0, 1.4, -1.97), Vec3::X * 1.2, Vec3::Y * 0.7);
    place(&mut scene, "panel", panel, brushed);
    let dull = metal(&mut scene, "dull block, roughness 0.7", GOLD, 0.7);
    let block = cuboid(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, 0.6, 0.3), Faces::NO_BOTTOM);
    let turned = Mat4::from_translation(Vec3::new(-1.2, 0.0, -1.3)) * Mat4::from_rotation_y(0.6);
    place_at(&mut scene, "block", block, dull, turned);

    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.3, 1.5, 1.9), Vec3::new(0.0, 0.75, -1.0), 1.0)
    });
    scene
}
