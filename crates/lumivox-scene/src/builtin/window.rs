//! A room of 4 x 5 m with one window: a low sun shines through it onto the floor, and the sky
//! lights the rest.
//!
//! The walls are 30 cm thick and have no hidden faces, so that light enters only through the
//! window.

use glam::Vec3;

use super::build::{WHITE, diffuse, lacquer, place};
use super::shapes::{Faces, cuboid, interior, merge, quad};
use crate::{Camera, Environment, Light, LightKind, Mesh, Scene};

/// The room's corners: the window is in the wall at its +x side.
const MIN_M: Vec3 = Vec3::new(-2.0, 0.0, -2.5);
const MAX_M: Vec3 = Vec3::new(2.0, 2.7, 2.5);
const WALL_M: f32 = 0.3;
/// The window along z and y.
const WINDOW_Z_M: [f32; 2] = [-1.2, 0.6];
const WINDOW_Y_M: [f32; 2] = [0.9, 2.3];

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let plaster = diffuse(&mut scene, "plaster", WHITE);
    let oak = lacquer(&mut scene, "oak", Vec3::new(0.45, 0.30, 0.17), 0.4);
    let blue = diffuse(&mut scene, "blue", Vec3::new(0.10, 0.16, 0.40));

    // The floor has a material of its own; the wall of the window is assembled separately.
    let mut walls = interior(MIN_M, MAX_M);
    keep_walls(&mut walls);
    place(&mut scene, "walls and ceiling", merge([walls, window_wall()]), plaster);
    let (center, half) = ((MIN_M + MAX_M) * 0.5, (MAX_M - MIN_M) * 0.5);
    let floor = quad(center.with_y(0.0), Vec3::X * half.x, Vec3::NEG_Z * half.z);
    place(&mut scene, "floor", floor, oak);
    let [low, high] = [MIN_M - WALL_M, MAX_M + WALL_M];
    let outer = Faces { x: [true, false], ..Faces::ALL };
    place(&mut scene, "outside", cuboid(low, high, outer), plaster);

    let table = cuboid(Vec3::new(-0.6, 0.66, -1.0), Vec3::new(0.5, 0.7, 0.2), Faces::ALL);
    let leg = |x: f32, z: f32| {
        cuboid(Vec3::new(x, 0.0, z), Vec3::new(x + 0.06, 0.66, z + 0.06), Faces::SIDES)
    };
    let legs = [leg(-0.58, -0.98), leg(0.42, -0.98), leg(-0.58, 0.12), leg(0.42, 0.12)];
    place(&mut scene, "table", merge([table].into_iter().chain(legs)), oak);
    let chest = cuboid(Vec3::new(-2.0, 0.0, -2.2), Vec3::new(-1.5, 1.0, -0.9), Faces::NO_BOTTOM);
    place(&mut scene, "chest", chest, blue);

    scene.lights.push(Light {
        name: "sun".to_owned(),
        intensity: 60_000.0,
        color: Vec3::new(1.0, 0.93, 0.82),
        direction: Vec3::new(-1.0, -0.62, 0.35).normalize(),
        ..Light::typical(LightKind::Directional)
    });
    scene.environment =
        Environment { radiance: Vec3::new(2500.0, 3300.0, 4500.0), ..Environment::default() };
    scene.cameras.push(Camera {
        name: "from the door".to_owned(),
        ..Camera::look_at(Vec3::new(0.9, 1.6, 2.3), Vec3::new(-0.5, 1.0, -1.2), 1.0)
    });
    scene
}

/// Removes the floor, and the wall of the window.
fn keep_walls(room: &mut Mesh) {
    let corners = |triangle: [usize; 3]| triangle.map(|i| room.positions[i]);
    let is_kept = |triangle: &[usize; 3]| {
        let at = corners(*triangle);
        !at.iter().all(|p| p.y == MIN_M.y) && !at.iter().all(|p| p.x == MAX_M.x)
    };
    room.indices = room.triangles().filter(is_kept).flatten().map(|i| i as u32).collect();
}

/// The inner and outer side of the wall around the window, and the window's reveal.
fn window_wall() -> Mesh {
    let [z0, z1] = WINDOW_Z_M;
    let [y0, y1] = WINDOW_Y_M;
    let side = |x: f32, margin: f32, facing: f32| {
        let (low, high) = (MIN_M - margin, MAX_M + margin);
        let panel = |z: [f32; 2], y: [f32; 2]| {
            let center = Vec3::new(x, (y[0] + y[1]) * 0.5, (z[0] + z[1]) * 0.5);
            let along = Vec3::NEG_Z * (facing * (z[1] - z[0]) * 0.5);
            quad(center, along, Vec3::Y * ((y[1] - y[0]) * 0.5))
        };
        merge([
            panel([low.z, z0], [low.y, high.y]),
            panel([z1, high.z], [low.y, high.y]),
            panel([z0, z1], [low.y, y0]),
            panel([z0, z1], [y1, high.y]),
        ])
    };
    let reveal = Faces { x: [false; 2], ..Faces::ALL };
    let mut reveal =
        cuboid(Vec3::new(MAX_M.x, y0, z0), Vec3::new(MAX_M.x + WALL_M, y1, z1), reveal);
    reveal.flip_winding();
    for normal in &mut reveal.normals {
        *normal = -*normal;
    }
    merge([side(MAX_M.x, 0.0, -1.0), side(MAX_M.x + WALL_M, WALL_M, 1.0), reveal])
}
