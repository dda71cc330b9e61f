//! The white furnace: every surface emits e = 1 cd/m² and reflects the fraction a = 0.5, so that
//! the radiance is L = e + a L = e / (1 - a) = 2 cd/m² everywhere, in every direction.

use glam::Vec3;

use super::build::{material, place};
use super::shapes::interior;
use crate::{Camera, Material, Scene};

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let mut wall = Material::diffuse("glowing wall", Vec3::splat(0.5));
    wall.emissive = Vec3::ONE;
    let wall = material(&mut scene, wall);
    place(&mut scene, "cube", interior(Vec3::splat(-1.0), Vec3::ONE), wall);
    scene.cameras.push(Camera {
        name: "inside".to_owned(),
        ..Camera::look_at(Vec3::new(0.5, 0.3, 0.7), Vec3::new(-0.4, -0.2, -1.0), 1.05)
    });
    scene
}
