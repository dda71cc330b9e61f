//! Two rows of seven spheres, of metal behind and of a dielectric in front, with roughness from
//! 0.05 (left) to 1 (right), in a closed room with a checkered floor.

use glam::{Mat4, Vec3};

use super::build::{GREEN, Lamp, RED, WHITE, checker, diffuse, material, place, place_at, tile};
use super::shapes::{merge, quad, sphere};
use crate::{Camera, Instance, Material, MetallicRoughness, Scene, Shading};

const COUNT: usize = 7;
const SPACING_M: f32 = 0.6;
const RADIUS_M: f32 = 0.25;
const SMOOTHEST: f32 = 0.05;

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let white = diffuse(&mut scene, "white", WHITE);
    let red = diffuse(&mut scene, "red", RED);
    let green = diffuse(&mut scene, "green", GREEN);
    let floor = checker(&mut scene, "checkered floor", [[222, 218, 208], [52, 60, 82]]);

    // The room: [-2.5, 2.5] x [0, 2.5] x [-1.5, 3.5].
    let center = Vec3::new(0.0, 1.25, 1.0);
    let (x, y, z) = (Vec3::X * 2.5, Vec3::Y * 1.25, Vec3::Z * 2.5);
    // Squares of a quarter of a metre: 20 along each edge, two per repetition.
    place(&mut scene, "floor", tile(quad(center - y, x, -z), 10.0, 10.0), floor);
    let white_walls = [quad(center + y, x, z), quad(center - z, x, y), quad(center + z, -x, y)];
    place(&mut scene, "ceiling, back and front wall", merge(white_walls), white);
    place(&mut scene, "left wall", quad(center - x, -z, y), red);
    place(&mut scene, "right wall", quad(center + x, z, y), green);

    for (row, z) in [("metal", -0.55), ("dielectric", 0.25)] {
        for i in 0..COUNT {
            let t = i as f32 / (COUNT - 1) as f32;
            let roughness = SMOOTHEST + (1.0 - SMOOTHEST) * t;
            let name = format!("{row}, roughness {roughness:.2}");
            let metal = row == "metal";
            let base =
                if metal { Vec3::new(0.95, 0.76, 0.45) } else { Vec3::new(0.16, 0.30, 0.55) };
            let shading = MetallicRoughness {
                base_color: base.extend(1.0),
                metallic: if metal { 1.0 } else { 0.0 },
                roughness,
                ..MetallicRoughness::default()
            };
            let surface = material(
                &mut scene,
                Material {
                    name: name.clone(),
                    shading: Shading::MetallicRoughness(shading),
                    ..Material::default()
                },
            );
            let at = Vec3::new((i as f32 - (COUNT - 1) as f32 * 0.5) * SPACING_M, RADIUS_M, z);
            let world_from_local = Mat4::from_translation(at);
            match scene.meshes.iter().position(|mesh| mesh.name == "sphere") {
                Some(mesh) => scene.instances.push(Instance {
                    name,
                    mesh,
                    material: surface,
                    world_from_local,
                    ..Instance::default()
                }),
                None => {
                    place_at(&mut scene, "sphere", sphere(RADIUS_M, 48), surface, world_from_local);
                }
            }
        }
    }

    Lamp {
        top: Vec3::new(0.0, 2.5, 0.5),
        half_x_m: 0.8,
        half_z_m: 0.3,
        drop_m: 0.05,
        face_radiance: 20.0,
        intensity_cd: 40.0,
    }
    .install(&mut scene);

    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.0, 1.35, 3.3), Vec3::new(0.0, 0.45, -0.2), 0.85)
    });
    scene
}
