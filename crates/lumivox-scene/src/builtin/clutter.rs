//! Three hundred small things on a floor between three walls, in the light of a lamp and of an even
//! sky.

use glam::{Mat4, Quat, Vec3};

use super::build::{WHITE, diffuse, lacquer, place, place_at, point_light};
use super::shapes::{Faces, cuboid, merge, quad, sphere};
use crate::{Camera, Environment, Instance, Scene};

const COUNT: u32 = 300;

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let white = diffuse(&mut scene, "white", WHITE);
    let paints = [
        lacquer(&mut scene, "ivory", Vec3::new(0.75, 0.70, 0.58), 0.4),
        lacquer(&mut scene, "brick", Vec3::new(0.48, 0.15, 0.10), 0.6),
        lacquer(&mut scene, "teal", Vec3::new(0.06, 0.30, 0.32), 0.3),
        diffuse(&mut scene, "straw", Vec3::new(0.62, 0.50, 0.22)),
    ];
    let (x, y, z) = (Vec3::X * 1.5, Vec3::Y, Vec3::Z * 1.5);
    let walls = [quad(Vec3::ZERO, x, -z), quad(y - z, x, y), quad(y - x, -z, y), quad(y + x, z, y)];
    place(&mut scene, "floor and walls", merge(walls), white);

    let half = Vec3::splat(0.5);
    place_at(&mut scene, "block 0", cuboid(-half, half, Faces::ALL), paints[0], thing(0));
    place_at(&mut scene, "ball 1", sphere(0.5, 16), paints[1], thing(1));
    for number in 2..COUNT {
        let mesh = scene.instances[(number % 2) as usize + 1].mesh;
        let kind = if number % 2 == 0 { "block" } else { "ball" };
        scene.instances.push(Instance {
            name: format!("{kind} {number}"),
            mesh,
            material: paints[number as usize % paints.len()],
            world_from_local: thing(number),
            ..Instance::default()
        });
    }
    point_light(&mut scene, "lamp", Vec3::new(-0.5, 2.2, 0.6), 60.0);
    scene.environment = Environment { radiance: Vec3::splat(8.0), ..Environment::default() };
    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.3, 1.7, 3.0), Vec3::new(0.0, 0.35, -0.2), 0.8)
    });
    scene
}

/// Position and rotation of a thing of 6 to 18 cm. The things are spread by the golden ratio and
/// its analogues in two and three dimensions (Roberts 2018, "The unreasonable effectiveness of
/// quasirandom sequences") and piled up to 60 cm.
fn thing(number: u32) -> Mat4 {
    let spread = |step: f32| (0.5 + number as f32 * step).fract();
    let size_m = 0.06 + 0.12 * spread(0.618_034) * spread(0.618_034);
    let (u, v, height) = (spread(0.819_172_5), spread(0.671_043_6), spread(0.549_700_5));
    let reach_m = 1.5 - size_m;
    let at = Vec3::new(
        reach_m * (2.0 * u - 1.0),
        0.9 * size_m + 0.6 * height * height * height,
        reach_m * (2.0 * v - 1.0),
    );
    let turn = Quat::from_euler(
        glam::EulerRot::XYZ,
        6.0 * spread(0.37),
        6.0 * spread(0.29),
        6.0 * spread(0.83),
    );
    Mat4::from_scale_rotation_translation(Vec3::splat(size_m), turn, at)
}
