//! A square emitter of 4 x 4 m and 1 cd/m² that faces a floor of 6 x 6 m from 1 m above it. The
//! emitter reflects nothing, so the floor's irradiance is the emitter's radiance times pi times its
//! form factor, in closed form (Howell, Menguc & Siegel, "Thermal radiation heat transfer",
//! configuration factors of a differential element to a parallel rectangle).

use glam::Vec3;

use super::build::{diffuse, material, place};
use super::shapes::quad;
use crate::{Camera, Material, Scene};

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let floor = diffuse(&mut scene, "floor", Vec3::splat(0.5));
    place(&mut scene, "floor", quad(Vec3::ZERO, Vec3::X * 3.0, Vec3::NEG_Z * 3.0), floor);

    let mut panel = Material::diffuse("panel", Vec3::ZERO);
    panel.emissive = Vec3::ONE;
    let panel = material(&mut scene, panel);
    place(&mut scene, "panel", quad(Vec3::Y, Vec3::X * 2.0, Vec3::Z * 2.0), panel);

    scene.cameras.push(Camera {
        name: "between".to_owned(),
        ..Camera::look_at(Vec3::new(0.0, 0.7, 4.2), Vec3::new(0.0, 0.2, 0.0), 0.8)
    });
    scene
}
