//! The ground, and the lamps, trees and cars on it.

use glam::Vec3;

use super::super::build::WHITE;
use super::super::shapes::{Faces, cylinder, quad, sphere};
use super::paint::{Paint, chance, pick};
use super::{BLOCK_M, PAVEMENT_M};
use crate::Mesh;

/// Half the edge of the square of a block's houses, of its pavement, and of the block including
/// half of the streets around it, m.
const HOUSES_M: f32 = 40.0;
const KERB_M: f32 = 44.0;

/// The ground of a block: streets with their marks, pavement, and a green court; or the stones of a
/// square.
pub(super) fn ground(seed: u32, is_square: bool) -> Paint {
    let mut paint = Paint::default();
    let half = 0.5 * BLOCK_M;
    let mut edges = vec![-half, 0.1 - half];
    edges.extend((-11..=11).map(|step| step as f32 * 4.0));
    edges.extend([half - 0.1, half]);
    let cells = || edges.windows(2).enumerate();
    for ((i, x), (j, z)) in cells().flat_map(|x| cells().map(move |z| (x, z))) {
        let middle = Vec3::new(0.5 * (x[0] + x[1]), 0.0, 0.5 * (z[0] + z[1]));
        let from_middle = middle.x.abs().max(middle.z.abs());
        let across = middle.x.abs().min(middle.z.abs());
        let shade = 0.85 + 0.3 * chance(i as u32, j as u32, seed);
        let is_street = from_middle > KERB_M && !is_square;
        let is_mark = is_street && from_middle > half - 0.1 && across < 40.0 && (i + j) % 2 == 0;
        let color = if is_mark {
            WHITE
        } else if is_street {
            Vec3::new(0.075, 0.075, 0.08)
        } else if is_square || from_middle > 28.0 {
            Vec3::new(0.34, 0.33, 0.31)
        } else if across < 2.0 {
            Vec3::new(0.42, 0.36, 0.27)
        } else {
            Vec3::new(0.10, 0.19, 0.05)
        };
        let y = if is_street || is_square { 0.0 } else { PAVEMENT_M };
        let half_x = 0.5 * (x[1] - x[0]);
        let half_z = 0.5 * (z[1] - z[0]);
        paint.level(middle + Vec3::Y * y, half_x, half_z, true, color * shade);
    }
    if !is_square {
        let kerb = Vec3::new(KERB_M, 0.0, KERB_M);
        paint.block(-kerb, kerb + Vec3::Y * PAVEMENT_M, Faces::SIDES, Vec3::splat(0.4));
    }
    paint
}

/// A lamp of 6 m whose arm points towards +z: its body, and its emissive face, 40 x 70 cm.
pub(super) fn lamp() -> (Paint, Mesh) {
    let mut paint = Paint::default();
    let steel = Vec3::splat(0.18);
    paint.add(cylinder(Vec3::ZERO, 0.07, 6.0, 8), steel);
    paint.block(Vec3::new(-0.05, 6.0, -0.07), Vec3::new(0.05, 6.1, 1.2), Faces::ALL, steel);
    let head = Faces { y: [false, true], ..Faces::ALL };
    paint.block(Vec3::new(-0.2, 5.9, 1.2), Vec3::new(0.2, 6.1, 1.9), head, steel);
    let face = quad(Vec3::new(0.0, 5.9, 1.55), Vec3::X * 0.2, Vec3::Z * 0.35);
    (paint, face)
}

/// A mast with lamps that point down and towards +z: its body, and its emissive face, 8 x 4 m.
pub(super) fn mast() -> (Paint, Mesh) {
    let mut paint = Paint::default();
    let steel = Vec3::splat(0.3);
    paint.add(cylinder(Vec3::ZERO, 0.8, 44.0, 12), steel);
    let (x, y) = (Vec3::X * 4.0, Vec3::new(0.0, 1.6, 1.2));
    let middle = Vec3::new(0.0, 45.0, 1.4);
    let back = Vec3::new(0.0, 0.03, -0.04);
    paint.add(quad(middle + back, -x, y), steel);
    (paint, quad(middle, x, y))
}

/// A tree of about 7 m.
pub(super) fn tree(seed: u32) -> Paint {
    let mut paint = Paint::default();
    paint.add(cylinder(Vec3::ZERO, 0.16, 3.2, 7), Vec3::new(0.16, 0.11, 0.07));
    for ball in 0..4 {
        let at = |axis: u32| chance(seed, ball, axis) - 0.5;
        let center = Vec3::new(2.2 * at(0), 4.6 + 2.4 * at(1), 2.2 * at(2));
        let green = Vec3::new(0.06, 0.17, 0.04).lerp(Vec3::new(0.15, 0.22, 0.05), at(3) + 0.5);
        let mut crown = sphere(1.2 + 0.5 * at(4), 8);
        for position in &mut crown.positions {
            *position += center;
        }
        paint.add(crown, green);
    }
    paint
}

/// A car of 4.3 m that faces +x.
pub(super) fn car(seed: u32) -> Paint {
    let colors = [
        Vec3::new(0.50, 0.05, 0.04),
        Vec3::splat(0.55),
        Vec3::splat(0.04),
        Vec3::new(0.06, 0.12, 0.35),
        Vec3::splat(0.25),
    ];
    let color = pick(&colors, chance(seed, 7, 7));
    let dark = Vec3::splat(0.03);
    let mut paint = Paint::default();
    let mut block = |low: [f32; 3], high: [f32; 3], color| {
        paint.block(Vec3::from(low), Vec3::from(high), Faces::ALL, color);
    };
    block([-2.15, 0.28, -0.88], [2.15, 0.85, 0.88], color);
    block([-1.5, 0.85, -0.78], [0.9, 1.32, 0.78], dark);
    block([-1.4, 1.32, -0.74], [0.75, 1.42, 0.74], color);
    for (x, z) in [(-1.35, -0.9), (1.35, -0.9), (-1.35, 0.68), (1.35, 0.68)] {
        block([x - 0.31, 0.0, z], [x + 0.31, 0.6, z + 0.22], dark);
    }
    paint
}

/// One of the [`SECTIONS`] sections of a stadium's stands, with its roof, on a circle of 100 m. The
/// stadium is an ellipse of 1 to 0.72.
pub(super) fn stands() -> Paint {
    let mut paint = Paint::default();
    let half = (std::f32::consts::PI / SECTIONS as f32).tan();
    let concrete = Vec3::splat(0.45);
    // A strip along the circle from one radius and height to another.
    let mut strip = |from: [f32; 2], to: [f32; 2], color: Vec3| {
        let corner = |[r, y]: [f32; 2], side: f32| Vec3::new(side * r * half, y, r);
        let mut part = quad(Vec3::ZERO, Vec3::X, Vec3::NEG_Z);
        part.positions =
            vec![corner(from, -1.0), corner(to, -1.0), corner(to, 1.0), corner(from, 1.0)];
        let [a, b, c] = [part.positions[0], part.positions[1], part.positions[2]];
        let normal = (b - a).cross(c - a).normalize();
        part.normals = vec![normal; 4];
        part.tangents = vec![Vec3::X.extend(1.0); 4];
        paint.add(part, color);
    };
    let row = |row: u32| [56.0 + 1.3 * row as f32, 1.2 + 0.62 * row as f32];
    // A strip from the middle outwards faces up; a strip from low to high faces the middle.
    strip([56.0, 0.0], [56.0, 1.2], concrete);
    for number in 0..ROWS {
        let ([r, y], [next, above]) = (row(number), row(number + 1));
        strip([r, y], [next, y], concrete);
        strip([next, y], [next, above], concrete);
    }
    let [outer, top] = row(ROWS);
    let wall = [outer + 2.0, top + 4.5];
    strip([outer, top], [outer, top + 4.5], concrete);
    strip([outer, top + 4.5], wall, concrete);
    strip(wall, [wall[0], 0.0], Vec3::new(0.55, 0.52, 0.47));
    // The roof is a sheet of 20 cm over the upper half.
    let [inner, end] = [outer - 20.0, outer + 3.0];
    strip([inner, top + 8.0], [end, top + 6.0], Vec3::splat(0.62));
    strip([end, top + 5.8], [inner, top + 7.8], Vec3::splat(0.62));
    strip([inner, top + 7.8], [inner, top + 8.0], concrete);
    strip([end, top + 6.0], [end, top + 5.8], concrete);
    for number in 0..ROWS {
        let [r, y] = row(number);
        let seats = (r * half / 0.65) as u32;
        for seat in 0..seats {
            let x = (2.0 * (seat as f32 + 0.5) / seats as f32 - 1.0) * r * half;
            let color =
                if chance(number, seat, 5) < 0.12 { WHITE } else { Vec3::new(0.08, 0.16, 0.42) };
            paint.stand(Vec3::new(x, y, r + 0.8), Vec3::new(0.45, 0.45, 0.4), color);
        }
    }
    paint
}

/// Rows of seats.
const ROWS: u32 = 28;
/// Sections of the stands.
pub(super) const SECTIONS: u32 = 60;

/// The lawn within the stands, in stripes.
pub(super) fn lawn() -> Paint {
    let mut paint = Paint::default();
    for stripe in 0..20 {
        let x = (stripe as f32 - 9.5) * 5.0;
        let green = if stripe % 2 == 0 { 1.0 } else { 0.75 };
        let color = Vec3::new(0.09, 0.24, 0.05) * green;
        paint.level(Vec3::new(x, 0.02, 0.0), 2.5, 32.0, true, color);
    }
    paint
}

/// Distance of the house fronts from the centre of a block.
pub(super) const FRONT_M: f32 = HOUSES_M;
