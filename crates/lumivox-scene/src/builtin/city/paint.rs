//! Meshes with one colour per part, so that a house is one mesh with one material.

use glam::Vec3;

pub(super) use super::super::build::{chance, pick};
use super::super::shapes::{Faces, append, cuboid, quad};
use crate::Mesh;

/// A mesh that is built part by part.
#[derive(Default)]
pub(super) struct Paint {
    pub(super) mesh: Mesh,
}

/// A rectangular hole in a wall, m: along the wall, and above its foot.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    pub(super) along: [f32; 2],
    pub(super) height: [f32; 2],
}

/// An upright wall with two faces; the front faces `along` cross +y.
#[derive(Clone, Copy)]
pub(super) struct Wall {
    /// The wall's foot at one end, in the middle of its thickness.
    pub(super) foot: Vec3,
    /// Unit vector along the wall.
    pub(super) along: Vec3,
    pub(super) length_m: f32,
    pub(super) height_m: f32,
    pub(super) thickness_m: f32,
    pub(super) front: Vec3,
    pub(super) back: Vec3,
}

impl Paint {
    pub(super) fn add(&mut self, part: Mesh, color: Vec3) {
        let vertices = self.mesh.positions.len() + part.positions.len();
        append(&mut self.mesh, part);
        self.mesh.colors.resize(vertices, color.extend(1.0));
    }

    pub(super) fn block(&mut self, min: Vec3, max: Vec3, faces: Faces, color: Vec3) {
        self.add(cuboid(min, max, faces), color);
    }

    /// Adds a block by the centre of its base and its edge lengths.
    pub(super) fn stand(&mut self, foot: Vec3, size_m: Vec3, color: Vec3) {
        let half = Vec3::new(0.5 * size_m.x, 0.0, 0.5 * size_m.z);
        let max = foot + half + Vec3::Y * size_m.y;
        self.block(foot - half, max, Faces::NO_BOTTOM, color);
    }

    /// Adds a horizontal rectangle that faces up or down, by its centre and half its edges.
    pub(super) fn level(
        &mut self,
        center: Vec3,
        half_x_m: f32,
        half_z_m: f32,
        up: bool,
        color: Vec3,
    ) {
        let z = if up { Vec3::NEG_Z } else { Vec3::Z };
        self.add(quad(center, Vec3::X * half_x_m, z * half_z_m), color);
    }

    /// Adds a wall with openings, which must be sorted along it and must not touch.
    pub(super) fn wall(&mut self, wall: &Wall, openings: &[Opening]) {
        let mut from = 0.0;
        for opening in openings {
            self.panel(wall, [from, opening.along[0]], [0.0, wall.height_m]);
            self.panel(wall, opening.along, [0.0, opening.height[0]]);
            self.panel(wall, opening.along, [opening.height[1], wall.height_m]);
            self.reveal(wall, opening);
            from = opening.along[1];
        }
        self.panel(wall, [from, wall.length_m], [0.0, wall.height_m]);
    }

    /// Adds both faces of a part of a wall.
    fn panel(&mut self, wall: &Wall, along: [f32; 2], height: [f32; 2]) {
        let half_along = wall.along * (0.5 * (along[1] - along[0]));
        let half_up = Vec3::Y * (0.5 * (height[1] - height[0]));
        if half_along.length() < 1e-4 || half_up.length() < 1e-4 {
            return;
        }
        let center = wall.at(0.5 * (along[0] + along[1]), 0.5 * (height[0] + height[1]));
        let side = wall.half_thickness();
        self.add(quad(center + side, half_along, half_up), wall.front);
        self.add(quad(center - side, -half_along, half_up), wall.back);
    }

    /// Adds the four sides of a hole.
    fn reveal(&mut self, wall: &Wall, opening: &Opening) {
        let [from, to] = opening.along;
        let [low, high] = opening.height;
        let (middle, level) = (0.5 * (from + to), 0.5 * (low + high));
        let half_along = wall.along * (0.5 * (to - from));
        let half_up = Vec3::Y * (0.5 * (high - low));
        let side = wall.half_thickness();
        self.add(quad(wall.at(from, level), half_up, side), wall.front);
        self.add(quad(wall.at(to, level), side, half_up), wall.front);
        self.add(quad(wall.at(middle, high), half_along, side), wall.front);
        // A door needs no bottom face: the house's floor is there.
        if low > 0.0 {
            self.add(quad(wall.at(middle, low), side, half_along), wall.front);
        }
    }
}

impl Wall {
    fn at(&self, along_m: f32, height_m: f32) -> Vec3 {
        self.foot + self.along * along_m + Vec3::Y * height_m
    }

    fn half_thickness(&self) -> Vec3 {
        self.along.cross(Vec3::Y) * (0.5 * self.thickness_m)
    }
}
