//! The Cornell box (Goral, Torrance, Greenberg & Battaile 1984, "Modeling the interaction of light
//! between diffuse surfaces"), with the proportions of Cornell's measured data (552.8 units a side)
//! scaled to two metres. It is open towards +z, where the camera is.

use glam::{Mat4, Vec3};

use super::build::{GREEN, Lamp, RED, WHITE, diffuse, place, place_at};
use super::shapes::{Faces, cuboid, merge, quad};
use crate::{Camera, Scene};

/// Rotation of both blocks about y, in opposite directions (the data's edges (160, 49) and (158,
/// 49)).
const BLOCK_TURN_RAD: f32 = 0.297;

/// The source of the lamp's light.
#[derive(Clone, Copy)]
pub(super) enum LightSource {
    /// A small light below the lamp's face, which itself emits a fiftieth of the flux.
    Point,
    /// The face, evenly.
    Area,
}

/// The light's luminous intensity, in candela: 126 lumens downwards.
const INTENSITY_CD: f32 = 20.0;

/// Half the lamp's edges in metres: the data's lamp is 130 x 105 units.
const HALF_LAMP_M: [f32; 2] = [0.235, 0.19];

pub(super) fn scene(source: LightSource) -> Scene {
    let mut scene = Scene::default();
    let white = diffuse(&mut scene, "white", WHITE);
    let red = diffuse(&mut scene, "red", RED);
    let green = diffuse(&mut scene, "green", GREEN);

    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let white_walls = [quad(Vec3::ZERO, x, -z), quad(2.0 * y, x, z), quad(y - z, x, y)];
    place(&mut scene, "floor, ceiling, back wall", merge(white_walls), white);
    place(&mut scene, "left wall", quad(y - x, -z, y), red);
    place(&mut scene, "right wall", quad(y + x, z, y), green);

    let block = |height_m: f32| {
        cuboid(Vec3::new(-0.3, 0.0, -0.3), Vec3::new(0.3, height_m, 0.3), Faces::NO_BOTTOM)
    };
    let short =
        Mat4::from_translation(Vec3::new(0.33, 0.0, 0.40)) * Mat4::from_rotation_y(-BLOCK_TURN_RAD);
    let tall = Mat4::from_translation(Vec3::new(-0.33, 0.0, -0.25))
        * Mat4::from_rotation_y(BLOCK_TURN_RAD);
    place_at(&mut scene, "short block", block(0.6), white, short);
    place_at(&mut scene, "tall block", block(1.2), white, tall);

    let [half_x_m, half_z_m] = HALF_LAMP_M;
    let (face_radiance, intensity_cd) = match source {
        LightSource::Point => (10.0, INTENSITY_CD),
        // Half a sphere of the point's intensity, through an area that emits by the cosine.
        LightSource::Area => (2.0 * INTENSITY_CD / (4.0 * half_x_m * half_z_m), 0.0),
    };
    Lamp { top: 2.0 * y, half_x_m, half_z_m, drop_m: 0.02, face_radiance, intensity_cd }
        .install(&mut scene);

    // The front opening, 2.8 m away, fills the height except for two per cent on each side.
    let fov = 2.0 * (1.02_f32 / 2.8).atan();
    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.0, 1.0, 3.8), Vec3::Y, fov)
    });
    scene
}
