//! A furnished living room of 7.5 x 5.5 m, whose wide window looks down on the street.

use std::f32::consts::TAU;

use glam::Vec3;

use super::super::build::WHITE;
use super::super::shapes::{Faces, sphere};
use super::house::{FOOT_M, Kind, Roof, STOREY_M, WALL_M};
use super::paint::{Paint, chance, pick};
use crate::Mesh;

/// The storey of the room.
const STOREY: u32 = 1;

/// The house that contains the room: its first room at the front.
pub(super) const KIND: Kind = Kind {
    width_m: 16.0,
    depth_m: 12.0,
    storeys: 4,
    rooms: 2,
    glazing: 0.4,
    roof: Roof::Flat,
    facade: Vec3::new(0.62, 0.50, 0.36),
    has_balconies: false,
    seed: 4711,
    empty_room: Some(STOREY),
};

/// The middle of the room's floor, in the house's coordinates.
pub(super) fn middle() -> Vec3 {
    let width_m = 0.5 * KIND.width_m - WALL_M;
    Vec3::new(-0.5 * width_m, FOOT_M + STOREY as f32 * STOREY_M, -3.1)
}

/// The furniture around [`middle`]: the window is towards +z, the door towards -z. The lamp's ball
/// is the second mesh.
pub(super) fn furniture() -> (Paint, Mesh) {
    let mut paint = Paint::default();
    let oak = Vec3::new(0.45, 0.30, 0.17);
    let walnut = Vec3::new(0.22, 0.13, 0.08);
    let cloth = Vec3::new(0.12, 0.26, 0.30);
    let carpet = Vec3::new(0.50, 0.13, 0.10);
    let block = |paint: &mut Paint, low: [f32; 3], high: [f32; 3], color: Vec3| {
        paint.block(Vec3::from(low), Vec3::from(high), Faces::ALL, color);
    };

    block(&mut paint, [-2.6, 0.005, -1.1], [0.6, 0.02, 1.3], carpet);
    // A sofa with its back to the wall on the left, and a low table before it.
    block(&mut paint, [-3.5, 0.08, -1.0], [-2.6, 0.42, 1.2], cloth);
    block(&mut paint, [-3.55, 0.42, -1.0], [-3.3, 0.85, 1.2], cloth);
    block(&mut paint, [-3.3, 0.42, -1.0], [-2.6, 0.62, -0.82], cloth);
    block(&mut paint, [-3.3, 0.42, 1.02], [-2.6, 0.62, 1.2], cloth);
    block(&mut paint, [-3.25, 0.42, 0.45], [-3.0, 0.78, 0.95], Vec3::new(0.70, 0.52, 0.14));
    table(&mut paint, Vec3::new(-1.4, 0.02, 0.1), [0.6, 0.38, 1.1], oak);

    // A table with chairs by the window on the right.
    let dining = Vec3::new(2.1, 0.0, 0.9);
    table(&mut paint, dining, [1.7, 0.74, 0.9], oak);
    for (x, z, turn) in
        [(-0.45, 0.75, 0.0), (0.45, 0.75, 0.0), (-0.45, -0.75, 0.5), (0.45, -0.75, 0.5)]
    {
        chair(&mut paint, dining + Vec3::new(x, 0.0, z), turn, walnut);
    }
    block(&mut paint, [2.0, 0.74, 0.8], [2.2, 0.96, 1.0], Vec3::new(0.12, 0.30, 0.50));

    // Shelves with books at the wall on the right, a picture above the sofa, and a chest by the
    // door.
    let (low, high) = ([3.25, 0.0, -2.5], [3.6, 2.1, -0.6]);
    for board in 0..6 {
        let y = 0.05 + 0.4 * board as f32;
        block(&mut paint, [low[0], y, low[2]], [high[0], y + 0.03, high[2]], walnut);
        let mut z = low[2] + 0.08;
        for book in 0..40 {
            let thick = 0.025 + 0.03 * chance(board, book, 1);
            if board == 5 || z + thick > high[2] - 0.08 || chance(board, book, 2) < 0.02 {
                break;
            }
            let tall = 0.2 + 0.13 * chance(board, book, 3);
            let colors = [carpet, cloth, oak, WHITE * 0.8, Vec3::new(0.16, 0.30, 0.14)];
            let color = pick(&colors, chance(board, book, 4));
            let foot = y + 0.03;
            block(&mut paint, [3.35, foot, z], [3.57, foot + tall, z + thick], color);
            z += thick + 0.003;
        }
    }
    for z in [low[2] - 0.03, high[2]] {
        block(&mut paint, [low[0], 0.0, z], [high[0], 2.1, z + 0.03], walnut);
    }
    block(&mut paint, [-3.58, 1.25, -0.6], [-3.55, 2.0, 0.7], Vec3::new(0.66, 0.42, 0.12));
    block(&mut paint, [-3.56, 1.32, -0.5], [-3.54, 1.93, 0.1], Vec3::new(0.10, 0.30, 0.42));
    block(&mut paint, [-2.4, 0.0, -2.65], [-0.9, 0.75, -2.2], WHITE);
    // Curtains beside the window.
    for x in [-3.45, 3.1] {
        block(&mut paint, [x, 0.05, 2.5], [x + 0.35, 2.6, 2.58], Vec3::new(0.62, 0.58, 0.48));
    }
    // A plant, and a lamp with a ball on a pole.
    paint.stand(Vec3::new(0.6, 0.0, 2.2), Vec3::new(0.35, 0.4, 0.35), Vec3::new(0.45, 0.20, 0.12));
    for leaf in 0..9 {
        let (angle, lift) = (TAU * leaf as f32 / 9.0, 0.55 + 0.07 * (leaf % 4) as f32);
        let mut ball = sphere(0.13, 8);
        let center = Vec3::new(0.6 + 0.17 * angle.cos(), lift, 2.2 + 0.17 * angle.sin());
        ball.positions.iter_mut().for_each(|position| *position += center);
        paint.add(ball, Vec3::new(0.06, 0.20, 0.05));
    }
    paint.stand(Vec3::new(-3.2, 0.0, -1.6), Vec3::new(0.3, 0.03, 0.3), walnut);
    paint.stand(Vec3::new(-3.2, 0.03, -1.6), Vec3::new(0.03, 1.35, 0.03), walnut);
    let mut lamp = sphere(0.16, 12);
    lamp.positions.iter_mut().for_each(|position| *position += Vec3::new(-3.2, 1.55, -1.6));
    (paint, lamp)
}

fn table(paint: &mut Paint, foot: Vec3, size_m: [f32; 3], color: Vec3) {
    let half = Vec3::new(0.5 * size_m[0], 0.0, 0.5 * size_m[2]);
    let top = foot + Vec3::Y * size_m[1];
    paint.block(top - half - Vec3::Y * 0.04, top + half, Faces::ALL, color);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let at = foot + Vec3::new(x * (half.x - 0.06), 0.0, z * (half.z - 0.06));
        paint.block(
            at - Vec3::new(0.03, 0.0, 0.03),
            at + Vec3::new(0.03, size_m[1] - 0.04, 0.03),
            Faces::SIDES,
            color,
        );
    }
}

/// A chair; without `turns`, its back is towards +z.
fn chair(paint: &mut Paint, foot: Vec3, turns: f32, color: Vec3) {
    let side = if turns == 0.0 { 1.0 } else { -1.0 };
    table(paint, foot, [0.42, 0.45, 0.42], color);
    let back = foot + Vec3::new(0.0, 0.45, 0.19 * side);
    paint.block(
        back - Vec3::new(0.2, 0.0, 0.02),
        back + Vec3::new(0.2, 0.45, 0.02),
        Faces::NO_BOTTOM,
        color,
    );
}
