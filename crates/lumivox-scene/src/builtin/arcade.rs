//! An arcade, 18 m long, beside a court that is open to the sky. The sun shines through its round
//! arches onto its floor; everything else in it is lit by that patch of sunlight, the court, and
//! the sky between the columns.
//!
//! Hidden faces are omitted; the building is closed, so light enters only over the court.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::build::{WHITE, checker, diffuse, place, tile};
use super::shapes::{Faces, cuboid, cylinder, merge, quad, sphere};
use crate::{Camera, Environment, Light, LightKind, Mesh, Scene};

/// Half the length of arcade and court, along x.
const HALF_LENGTH_M: f32 = 9.0;
/// Depth of the arcade along +z, and of the court along -z; the arches are at z = 0.
const ARCADE_M: f32 = 3.4;
const COURT_M: f32 = 8.0;
const CEILING_M: f32 = 4.0;
const ROOF_M: f32 = 6.0;
const WALL_M: f32 = 0.3;

const ARCHES: usize = 8;
/// Distance between the middles of two arches.
const BAY_M: f32 = 2.0 * HALF_LENGTH_M / ARCHES as f32;
const ARCH_RADIUS_M: f32 = 0.9;
/// Height at which an arch begins.
const SPRING_M: f32 = 2.2;
/// Thickness of the wall above the arches.
const SPANDREL_M: f32 = 0.4;
const ARCH_SEGMENTS: usize = 16;
const COLUMN_RADIUS_M: f32 = 0.2;

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let stone = diffuse(&mut scene, "stone", Vec3::new(0.62, 0.55, 0.45));
    let plaster = diffuse(&mut scene, "plaster", WHITE);
    let tiles = checker(&mut scene, "tiles", [[200, 184, 160], [140, 104, 84]]);
    shell(&mut scene, plaster, tiles);
    place(&mut scene, "arches", merge((0..ARCHES).map(arch).chain([piers()])), stone);
    let axis = |i: usize| Vec3::new(-HALF_LENGTH_M + BAY_M * i as f32, 0.0, 0.5 * SPANDREL_M);
    let columns = (1..ARCHES).map(|i| cylinder(axis(i), COLUMN_RADIUS_M, SPRING_M, 24));
    place(&mut scene, "columns", merge(columns), stone);
    furniture(&mut scene, stone);

    scene.lights.push(Light {
        name: "sun".to_owned(),
        intensity: 80_000.0,
        color: Vec3::new(1.0, 0.96, 0.90),
        direction: Vec3::new(0.35, -1.0, 0.62).normalize(),
        ..Light::typical(LightKind::Directional)
    });
    scene.environment =
        Environment { radiance: Vec3::new(2000.0, 2800.0, 4000.0), ..Environment::default() };
    scene.cameras.push(Camera {
        name: "along the arcade".to_owned(),
        ..Camera::look_at(Vec3::new(-8.2, 1.65, 2.3), Vec3::new(0.0, 1.75, 1.1), 1.05)
    });
    scene.cameras.push(Camera {
        name: "from the court".to_owned(),
        ..Camera::look_at(Vec3::new(-5.5, 1.65, -6.8), Vec3::new(1.0, 2.0, 0.5), 1.05)
    });
    scene
}

/// Floor, walls, ceiling and roof.
fn shell(scene: &mut Scene, plaster: usize, tiles: usize) {
    let min = Vec2::new(-HALF_LENGTH_M, -COURT_M);
    let max = Vec2::new(HALF_LENGTH_M, ARCADE_M);
    let half = (max - min) * 0.5;
    let at = |y: f32| Vec3::new(0.0, y, (min.y + max.y) * 0.5);
    let (x, z) = (Vec3::X * half.x, Vec3::Z * half.y);
    // Half-metre tiles: one repetition of the image is two by two tiles.
    place(scene, "floor", tile(quad(at(0.0), x, -z), 2.0 * half.x, 2.0 * half.y), tiles);

    let box_of = |low: [f32; 3], high: [f32; 3], faces| cuboid(low.into(), high.into(), faces);
    let (outer_min, outer_max) = (min - WALL_M, max + WALL_M);
    let along = Faces { x: [true; 2], y: [false, true], z: [true; 2] };
    let across = Faces { z: [false; 2], ..along };
    let below = Faces { x: [true; 2], y: [true, false], z: [true; 2] };
    let whole = HALF_LENGTH_M + WALL_M;
    let walls = [
        box_of([-whole, 0.0, max.y], [whole, ROOF_M, outer_max.y], along),
        box_of([-whole, 0.0, outer_min.y], [whole, ROOF_M, min.y], along),
        box_of([-whole, 0.0, min.y], [min.x, ROOF_M, max.y], across),
        box_of([max.x, 0.0, min.y], [whole, ROOF_M, max.y], across),
        box_of([-whole, -WALL_M, outer_min.y], [whole, 0.0, outer_max.y], below),
    ];
    let middle = |from_z: f32, y: f32| Vec3::new(0.0, y, (from_z + max.y) * 0.5);
    let depth = |from_z: f32| Vec3::Z * ((max.y - from_z) * 0.5);
    let ceiling = quad(middle(SPANDREL_M, CEILING_M), x, depth(SPANDREL_M));
    let roof = quad(middle(0.0, ROOF_M), x, -depth(0.0));
    let above = Vec3::Y * ((ROOF_M - CEILING_M) * 0.5);
    let facade = quad(Vec3::Y * ((ROOF_M + CEILING_M) * 0.5), -x, above);
    place(scene, "walls", merge(walls.into_iter().chain([ceiling, roof, facade])), plaster);
}

/// One arch: its underside, and both sides of the wall above it up to the ceiling.
fn arch(index: usize) -> Mesh {
    let middle = -HALF_LENGTH_M + BAY_M * (index as f32 + 0.5);
    let rim = |i: usize| {
        let angle = PI * (1.0 - i as f32 / ARCH_SEGMENTS as f32);
        Vec2::new(middle + ARCH_RADIUS_M * angle.cos(), SPRING_M + ARCH_RADIUS_M * angle.sin())
    };
    let edge = |x: f32| Vec2::new(x, SPRING_M);
    // From the middle of a pier over the arch to the middle of the next pier.
    let mut outline = vec![edge(middle - 0.5 * BAY_M)];
    outline.extend((0..=ARCH_SEGMENTS).map(rim));
    outline.push(edge(middle + 0.5 * BAY_M));
    let mut parts = Vec::new();
    for pair in outline.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let point = |at: Vec2, z: f32| at.extend(z);
        let top = |at: Vec2, z: f32| Vec3::new(at.x, CEILING_M, z);
        let back = SPANDREL_M;
        parts.push(panel([point(b, 0.0), point(a, 0.0), top(a, 0.0), top(b, 0.0)]));
        parts.push(panel([point(a, back), point(b, back), top(b, back), top(a, back)]));
        // The half piers are below both ends.
        if a.x > -HALF_LENGTH_M && b.x < HALF_LENGTH_M {
            parts.push(panel([point(a, 0.0), point(b, 0.0), point(b, back), point(a, back)]));
        }
    }
    merge(parts)
}

/// The half piers at both ends.
fn piers() -> Mesh {
    let width = 0.5 * BAY_M - ARCH_RADIUS_M;
    let pier = |from: f32, inner: usize| {
        let mut faces = Faces { x: [false; 2], y: [false; 2], z: [true; 2] };
        faces.x[inner] = true;
        let high = Vec3::new(from + width, SPRING_M, SPANDREL_M);
        cuboid(Vec3::new(from, 0.0, 0.0), high, faces)
    };
    merge([pier(-HALF_LENGTH_M, 1), pier(HALF_LENGTH_M - width, 0)])
}

/// A plane quadrangle, counter-clockwise seen from its front, with u along its first edge.
fn panel(corners: [Vec3; 4]) -> Mesh {
    let u = (corners[1] - corners[0]).normalize();
    let normal = u.cross(corners[2] - corners[0]).normalize();
    let v = normal.cross(u);
    let uv = |at: Vec3| Vec2::new((at - corners[0]).dot(u), 1.0 - (at - corners[0]).dot(v));
    Mesh {
        positions: corners.to_vec(),
        normals: vec![normal; 4],
        uvs: corners.map(uv).to_vec(),
        tangents: vec![u.extend(1.0); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}

/// Benches along the back wall, a cloth over one, and a ball on a plinth in the court.
fn furniture(scene: &mut Scene, stone: usize) {
    let bench = |x: f32| {
        let low = Vec3::new(x - 0.9, 0.0, ARCADE_M - 0.5);
        cuboid(
            low,
            Vec3::new(x + 0.9, 0.45, ARCADE_M),
            Faces { z: [true, false], ..Faces::NO_BOTTOM },
        )
    };
    let plinth = Vec3::new(1.0, 1.0, -4.0);
    let half = Vec3::new(0.4, 0.0, 0.4);
    let stand = cuboid((plinth - half).with_y(0.0), plinth + half, Faces::NO_BOTTOM);
    place(scene, "benches and plinth", merge([bench(-4.5), bench(0.0), bench(4.5), stand]), stone);
    let mut ball = sphere(0.45, 32);
    for position in &mut ball.positions {
        *position += plinth + Vec3::Y * 0.45;
    }
    place(scene, "ball", ball, stone);
    for (x, name, albedo) in [
        (-6.6, "red cloth", Vec3::new(0.62, 0.06, 0.05)),
        (2.3, "blue cloth", Vec3::new(0.07, 0.16, 0.58)),
    ] {
        let cloth = diffuse(scene, name, albedo);
        let low = Vec3::new(x - 0.6, 0.9, ARCADE_M - 0.02);
        let faces = Faces { z: [true, false], ..Faces::ALL };
        place(scene, name, cuboid(low, Vec3::new(x + 0.6, 3.3, ARCADE_M), faces), cloth);
    }
}
