//! Two rooms, [-2, 2] x [0, 2] x [-1, 1] m, divided at x = 0 by a wall of 5 mm: thinner than a
//! voxel at any usual resolution. Only the room at x < 0 has a light. Any light in the other room
//! came through the doorway or leaked.

use glam::Vec3;

use super::build::{RED, WHITE, diffuse, place};
use super::shapes::{merge, quad};
use crate::{Camera, Light, Mesh, Scene};

const WALL_HALF_M: f32 = 0.0025;
/// The doorway, 0.8 m wide and 1.6 m high, nearer to the wall at +z.
const DOOR_Z_M: [f32; 2] = [0.15, 0.95];
const DOOR_HEIGHT_M: f32 = 1.6;

pub(super) fn scene(doorway: bool) -> Scene {
    let mut scene = Scene::default();
    let white = diffuse(&mut scene, "white", WHITE);
    let red = diffuse(&mut scene, "red", RED);
    let blue = diffuse(&mut scene, "blue", Vec3::new(0.10, 0.20, 0.62));
    let yellow = diffuse(&mut scene, "yellow", Vec3::new(0.70, 0.55, 0.12));

    // The shells of both rooms, open at x = 0.
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let shell = |at: f32| {
        let middle = x * at;
        merge([
            quad(middle, x, -z),
            quad(middle + 2.0 * y, x, z),
            quad(middle + y - z, x, y),
            quad(middle + y + z, -x, y),
        ])
    };
    place(&mut scene, "lit room", shell(-1.0), white);
    place(&mut scene, "dark room", shell(1.0), white);
    place(&mut scene, "end of the lit room", quad(y - 2.0 * x, -z, y), red);
    place(&mut scene, "end of the dark room", quad(y + 2.0 * x, z, y), blue);
    place(&mut scene, "dividing wall", dividing_wall(doorway), yellow);

    scene.lights.push(Light {
        name: "lamp in the lit room".to_owned(),
        intensity: 30.0,
        position: Vec3::new(-1.0, 1.6, 0.0),
        radius_m: 0.05,
        ..Light::default()
    });

    let fov = 1.05;
    scene.cameras.push(Camera {
        name: "dark room".to_owned(),
        ..Camera::look_at(Vec3::new(1.85, 1.3, -0.8), Vec3::new(0.0, 0.85, 0.3), fov)
    });
    scene.cameras.push(Camera {
        name: "lit room".to_owned(),
        ..Camera::look_at(Vec3::new(-1.85, 1.3, -0.8), Vec3::new(0.0, 0.85, 0.3), fov)
    });
    scene
}

fn dividing_wall(doorway: bool) -> Mesh {
    // The rectangles of each face of the wall, in y and z.
    let [near, far] = DOOR_Z_M;
    let pieces: &[[[f32; 2]; 2]] = if doorway {
        &[[[0.0, 2.0], [-1.0, near]], [[DOOR_HEIGHT_M, 2.0], DOOR_Z_M], [[0.0, 2.0], [far, 1.0]]]
    } else {
        &[[[0.0, 2.0], [-1.0, 1.0]]]
    };
    let mut parts = Vec::new();
    for [y, z] in pieces {
        let center = Vec3::new(0.0, (y[0] + y[1]) * 0.5, (z[0] + z[1]) * 0.5);
        let up = Vec3::Y * ((y[1] - y[0]) * 0.5);
        let along = Vec3::Z * ((z[1] - z[0]) * 0.5);
        parts.push(quad(center + Vec3::X * WALL_HALF_M, -along, up));
        parts.push(quad(center - Vec3::X * WALL_HALF_M, along, up));
    }
    if doorway {
        // The reveal: both jambs and the lintel's underside.
        let thick = Vec3::X * WALL_HALF_M;
        let up = Vec3::Y * (DOOR_HEIGHT_M * 0.5);
        let along = Vec3::Z * ((far - near) * 0.5);
        parts.push(quad(up + Vec3::Z * near, thick, up));
        parts.push(quad(up + Vec3::Z * far, -thick, up));
        let lintel = Vec3::new(0.0, DOOR_HEIGHT_M, (near + far) * 0.5);
        parts.push(quad(lintel, thick, along));
    }
    merge(parts)
}
