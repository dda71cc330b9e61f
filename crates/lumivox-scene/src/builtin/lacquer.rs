//! A hall lacquered in deep colours, with checkered floor and ceiling: its surfaces mirror most of
//! the light that they reflect. It is open towards +z, where the camera is.

use glam::{Mat4, Vec3};

use super::build::{checker, glaze, lacquer, place, place_at, point_light, tile};
use super::shapes::{Faces, cuboid, quad, sphere};
use crate::{Camera, Scene};

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let [red, green, blue] = [
        ("red lacquer", Vec3::new(0.7, 0.0, 0.0)),
        ("green lacquer", Vec3::new(0.0, 0.5, 0.02)),
        ("blue lacquer", Vec3::new(0.0, 0.01, 0.7)),
    ]
    .map(|(name, color)| lacquer(&mut scene, name, color, 0.5));
    let black = lacquer(&mut scene, "black lacquer", Vec3::splat(0.02), 0.3);
    let tiles = checker(&mut scene, "tiles", [[230, 230, 230], [0, 0, 0]]);
    glaze(&mut scene, tiles, 0.5);

    // The hall: [-2, 2] x [0, 3] x [-2, 2], with tiles of half a metre.
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 1.5, Vec3::Z * 2.0);
    place(&mut scene, "floor", tile(quad(Vec3::ZERO, x, -z), 4.0, 4.0), tiles);
    place(&mut scene, "ceiling", tile(quad(2.0 * y, x, z), 4.0, 4.0), tiles);
    place(&mut scene, "back wall", quad(y - z, x, y), blue);
    place(&mut scene, "left wall", quad(y - x, -z, y), red);
    place(&mut scene, "right wall", quad(y + x, z, y), green);
    let block = cuboid(Vec3::new(-0.4, 0.0, -0.4), Vec3::new(0.4, 0.9, 0.4), Faces::NO_BOTTOM);
    let turn = Mat4::from_translation(Vec3::new(-0.8, 0.0, -0.5)) * Mat4::from_rotation_y(0.4);
    place_at(&mut scene, "block", block, black, turn);
    let ball = Mat4::from_translation(Vec3::new(0.9, 0.5, -0.2));
    place_at(&mut scene, "ball", sphere(0.5, 32), green, ball);

    point_light(&mut scene, "left lamp", Vec3::new(-1.2, 2.6, 0.8), 60.0);
    point_light(&mut scene, "right lamp", Vec3::new(1.2, 2.6, 0.8), 60.0);
    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.0, 1.5, 5.4), Vec3::new(0.0, 1.45, 0.0), 0.86)
    });
    scene
}
