//! A furnished room: things of all sizes, many of them thinner than a voxel, under one hanging
//! lamp.

use glam::{Mat4, Vec3};

use super::build::{WHITE, diffuse, lacquer, place, place_at, point_light};
use super::shapes::{Faces, cuboid, interior, merge, quad};
use crate::{Camera, Mesh, Scene};

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let plaster = diffuse(&mut scene, "plaster", WHITE);
    let parquet = lacquer(&mut scene, "parquet", Vec3::new(0.40, 0.25, 0.13), 0.35);
    let beech = lacquer(&mut scene, "beech", Vec3::new(0.62, 0.44, 0.27), 0.5);
    let cloth = diffuse(&mut scene, "cloth", Vec3::new(0.12, 0.20, 0.22));
    let wool = diffuse(&mut scene, "wool", Vec3::new(0.50, 0.13, 0.10));
    let paper = diffuse(&mut scene, "paper", Vec3::new(0.72, 0.62, 0.30));

    // The room: [-2.5, 2.5] x [0, 2.6] x [-2, 2].
    place(
        &mut scene,
        "room",
        interior(Vec3::new(-2.5, 0.0, -2.0), Vec3::new(2.5, 2.6, 2.0)),
        plaster,
    );
    let boards = quad(Vec3::Y * 0.012, Vec3::X * 2.5, Vec3::NEG_Z * 2.0);
    place(&mut scene, "parquet", boards, parquet);
    let sheet = |min: Vec3, max: Vec3| cuboid(min, max, Faces::ALL);
    let carpet = cuboid(Vec3::new(-1.3, 0.012, -0.9), Vec3::new(1.3, 0.022, 0.9), Faces::NO_BOTTOM);
    place(&mut scene, "carpet", carpet, wool);
    let picture = sheet(Vec3::new(-0.6, 1.3, -1.99), Vec3::new(0.5, 2.0, -1.97));
    place(&mut scene, "picture", picture, paper);

    place(&mut scene, "table", table(Vec3::new(1.5, 0.74, 0.85), 0.022), beech);
    for (number, (x, z, turn)) in
        [(-0.4, 0.75, 0.1_f32), (0.4, 0.8, -0.15), (-0.4, -0.75, 3.3), (0.45, -0.8, 3.0)]
            .into_iter()
            .enumerate()
    {
        let at = Mat4::from_translation(Vec3::new(x, 0.022, z)) * Mat4::from_rotation_y(turn);
        place_at(&mut scene, &format!("chair {}", number + 1), chair(), beech, at);
    }
    place(&mut scene, "shelf", shelf(), beech);
    let books = (0..18).map(|i| {
        let (board, place) = (i / 6, i % 6);
        let (x, y) = (-2.44, 0.055 + 0.55 * board as f32);
        let z = -1.35 + 0.155 * place as f32;
        let height_m = 0.22 + 0.05 * ((i * 7) % 5) as f32;
        cuboid(
            Vec3::new(x, y, z),
            Vec3::new(x + 0.2, y + height_m, z + 0.05 + 0.02 * ((i * 3) % 4) as f32),
            Faces::NO_BOTTOM,
        )
    });
    place(&mut scene, "books", merge(books), paper);
    let sofa = [
        cuboid(Vec3::new(1.6, 0.012, -1.2), Vec3::new(2.4, 0.42, 1.2), Faces::NO_BOTTOM),
        cuboid(Vec3::new(2.2, 0.42, -1.2), Vec3::new(2.4, 0.85, 1.2), Faces::NO_BOTTOM),
    ];
    place(&mut scene, "sofa", merge(sofa), cloth);

    point_light(&mut scene, "lamp", Vec3::new(0.0, 1.75, 0.0), 120.0);
    scene.cameras.push(Camera {
        name: "from the corner".to_owned(),
        ..Camera::look_at(Vec3::new(2.3, 1.7, 1.8), Vec3::new(-0.8, 0.75, -0.6), 1.0)
    });
    scene
}

/// A table in the middle of the floor, by its edges and the height of the carpet below it.
fn table(size_m: Vec3, floor_m: f32) -> Mesh {
    let half = size_m * 0.5;
    let top = floor_m + size_m.y;
    let board =
        cuboid(Vec3::new(-half.x, top - 0.03, -half.z), Vec3::new(half.x, top, half.z), Faces::ALL);
    let leg = |x: f32, z: f32| {
        let at = Vec3::new(x * (half.x - 0.05), 0.0, z * (half.z - 0.05));
        cuboid(
            at + Vec3::new(-0.025, floor_m, -0.025),
            at + Vec3::new(0.025, top - 0.03, 0.025),
            Faces::SIDES,
        )
    };
    merge([board, leg(-1.0, -1.0), leg(1.0, -1.0), leg(-1.0, 1.0), leg(1.0, 1.0)])
}

/// A chair that faces -z.
fn chair() -> Mesh {
    let leg = |x: f32, z: f32, top_m: f32| {
        cuboid(Vec3::new(x, 0.0, z), Vec3::new(x + 0.035, top_m, z + 0.035), Faces::NO_BOTTOM)
    };
    merge([
        cuboid(Vec3::new(-0.21, 0.43, -0.21), Vec3::new(0.21, 0.45, 0.21), Faces::ALL),
        cuboid(Vec3::new(-0.17, 0.62, 0.182), Vec3::new(0.17, 0.85, 0.198), Faces::ALL),
        leg(-0.205, -0.205, 0.43),
        leg(0.17, -0.205, 0.43),
        leg(-0.205, 0.17, 0.87),
        leg(0.17, 0.17, 0.87),
    ])
}

/// Boards of 2 cm against the wall on the left.
fn shelf() -> Mesh {
    let board = |y: f32| {
        cuboid(
            Vec3::new(-2.5, y, -1.42),
            Vec3::new(-2.2, y + 0.02, -0.38),
            Faces { x: [false, true], ..Faces::ALL },
        )
    };
    let side = |z: f32| {
        let faces = Faces { x: [false, true], y: [false, true], z: [true; 2] };
        cuboid(Vec3::new(-2.5, 0.012, z), Vec3::new(-2.2, 1.75, z + 0.02), faces)
    };
    merge([board(0.035), board(0.585), board(1.135), board(1.685), side(-1.44), side(-0.38)])
}
