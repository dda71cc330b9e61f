//! A closed room without lamps: a panel, a tube, a ball and a screen light it, in four colours and
//! sizes.

use glam::{Mat4, Vec3};

use super::build::{WHITE, diffuse, glowing, place, place_at};
use super::shapes::{Faces, cuboid, cylinder, interior, quad, sphere};
use crate::{Camera, Scene};

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let white = diffuse(&mut scene, "white", WHITE);
    let grey = diffuse(&mut scene, "grey", Vec3::splat(0.25));
    let panel = glowing(&mut scene, "panel", Vec3::new(600.0, 560.0, 500.0));
    let tube = glowing(&mut scene, "tube", Vec3::new(2500.0, 400.0, 900.0));
    let ball = glowing(&mut scene, "ball", Vec3::new(1200.0, 800.0, 200.0));
    let screen = glowing(&mut scene, "screen", Vec3::new(60.0, 140.0, 300.0));

    let room = interior(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 2.5, 2.0));
    place(&mut scene, "room", room, white);
    // Eight centimetres below the ceiling, with a back that blocks the light upwards.
    let plate = cuboid(
        Vec3::new(-0.9, 2.42, -1.2),
        Vec3::new(0.3, 2.44, -0.6),
        Faces { y: [false, true], ..Faces::ALL },
    );
    place(&mut scene, "back of the panel", plate, grey);
    let face = quad(Vec3::new(-0.3, 2.42, -0.9), Vec3::X * 0.6, Vec3::Z * 0.3);
    place(&mut scene, "panel", face, panel);
    let upright = cylinder(Vec3::new(1.6, 0.0, -1.6), 0.025, 2.5, 16);
    place(&mut scene, "tube", upright, tube);
    let at = Mat4::from_translation(Vec3::new(-1.4, 0.85, -1.3));
    place_at(&mut scene, "ball", sphere(0.12, 32), ball, at);
    let stand = cuboid(Vec3::new(-1.7, 0.0, -1.6), Vec3::new(-1.1, 0.7, -1.0), Faces::NO_BOTTOM);
    place(&mut scene, "stand", stand, white);
    let lit = quad(Vec3::new(0.5, 1.2, -1.94), Vec3::X * 0.45, Vec3::Y * 0.27);
    place(&mut scene, "screen", lit, screen);
    let set = Faces { z: [true, false], ..Faces::ALL };
    let set = cuboid(Vec3::new(0.03, 0.91, -1.99), Vec3::new(0.97, 1.49, -1.941), set);
    place(&mut scene, "back of the screen", set, grey);
    let block = cuboid(Vec3::new(0.1, 0.0, -0.9), Vec3::new(0.8, 0.45, -0.2), Faces::NO_BOTTOM);
    place(&mut scene, "block", block, white);

    scene.cameras.push(Camera {
        name: "front".to_owned(),
        ..Camera::look_at(Vec3::new(0.3, 1.4, 1.9), Vec3::new(-0.05, 1.1, -1.0), 1.0)
    });
    scene
}
