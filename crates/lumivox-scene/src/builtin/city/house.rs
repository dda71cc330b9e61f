//! Houses with rooms: outer walls of 30 cm with open windows, walls of 15 cm between rooms, doors,
//! and simple furniture.
//!
//! A house stands on y = 0 with its front at z = 0 and its back towards -z. A storey has a row of
//! rooms along the front and one along the back, with a wall between the rows; about a third of the
//! rooms have a lamp under the ceiling.

use glam::{Vec2, Vec3};

use super::super::build::WHITE;
use super::super::shapes::{Faces, FrameFaces, append, cuboid, frame, quad};
use super::paint::{Opening, Paint, Wall, chance, pick};
use crate::Mesh;

/// The height of a storey, m.
pub(super) const STOREY_M: f32 = 3.0;
/// The height of a room, m, below a slab of 30 cm.
const ROOM_M: f32 = 2.7;
/// The height of the lowest floor above the ground.
pub(super) const FOOT_M: f32 = 0.12;
pub(super) const WALL_M: f32 = 0.3;
const PARTITION_M: f32 = 0.15;
const LIT_ROOMS: f32 = 0.35;

/// Paints of rooms and furniture.
const ROOM_COLORS: [Vec3; 6] = [
    WHITE,
    Vec3::new(0.70, 0.66, 0.55),
    Vec3::new(0.62, 0.30, 0.22),
    Vec3::new(0.30, 0.45, 0.60),
    Vec3::new(0.40, 0.55, 0.33),
    Vec3::new(0.72, 0.60, 0.25),
];
const WOOD: [Vec3; 3] =
    [Vec3::new(0.42, 0.27, 0.15), Vec3::new(0.58, 0.42, 0.26), Vec3::new(0.25, 0.15, 0.09)];
const CLOTH: [Vec3; 4] = [
    Vec3::new(0.55, 0.10, 0.08),
    Vec3::new(0.10, 0.22, 0.40),
    Vec3::new(0.60, 0.58, 0.52),
    Vec3::new(0.16, 0.34, 0.18),
];

/// The top of a house.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Roof {
    Flat,
    Gable,
}

/// The parameters of a kind of house.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    pub(super) width_m: f32,
    pub(super) depth_m: f32,
    pub(super) storeys: u32,
    /// Rooms along the front, and as many along the back.
    pub(super) rooms: u32,
    /// Share of a room's width that its window covers.
    pub(super) glazing: f32,
    pub(super) roof: Roof,
    pub(super) facade: Vec3,
    pub(super) has_balconies: bool,
    /// Seed of the differences between houses.
    pub(super) seed: u32,
    /// The storey whose first room at the front is empty and has one wide window.
    pub(super) empty_room: Option<u32>,
}

/// Builds a house; the second mesh holds the faces of the lamps in its rooms.
pub(super) fn house(kind: &Kind) -> (Paint, Mesh) {
    let mut house = House { kind, paint: Paint::default(), lamps: Mesh::default() };
    for storey in 0..kind.storeys {
        house.shell(storey);
        house.rooms(storey);
    }
    house.roof();
    (house.paint, house.lamps)
}

struct House<'a> {
    kind: &'a Kind,
    paint: Paint,
    lamps: Mesh,
}

/// The middle of a room's floor, and its edges, m.
#[derive(Clone, Copy)]
struct Room {
    middle: Vec3,
    width_m: f32,
    depth_m: f32,
    /// The direction of the window along z: 1 at the front, -1 at the back.
    outward: f32,
    seed: [u32; 3],
}

impl Room {
    fn chance(&self, what: u32) -> f32 {
        let [x, y, z] = self.seed;
        chance(x, y, z.wrapping_mul(64).wrapping_add(what))
    }
}

impl House<'_> {
    fn room_width_m(&self) -> f32 {
        (self.kind.width_m - 2.0 * WALL_M) / self.kind.rooms as f32
    }

    fn floor_m(storey: u32) -> f32 {
        FOOT_M + storey as f32 * STOREY_M
    }

    fn top_m(&self) -> f32 {
        Self::floor_m(self.kind.storeys)
    }

    /// The four outer walls.
    fn shell(&mut self, storey: u32) {
        let Kind { width_m, depth_m, facade, .. } = *self.kind;
        let below = if storey == 0 { FOOT_M } else { 0.0 };
        let foot_y = Self::floor_m(storey) - below;
        let half = 0.5 * width_m;
        let inset = 0.5 * WALL_M;
        let outside = if storey == 0 { facade * 0.6 } else { facade };
        let wall = Wall {
            foot: Vec3::new(-half, foot_y, -inset),
            along: Vec3::X,
            length_m: width_m,
            height_m: STOREY_M + below,
            thickness_m: WALL_M,
            front: outside,
            back: WHITE,
        };
        let back = Vec3::new(half, foot_y, inset - depth_m);
        let back = Wall { foot: back, along: Vec3::NEG_X, ..wall };
        let openings = self.windows(storey, true, below);
        self.paint.wall(&wall, &openings);
        self.frames(&wall, &openings);
        let openings = self.windows(storey, false, below);
        self.paint.wall(&back, &openings);
        self.frames(&back, &openings);
        let right = Vec3::new(half - inset, foot_y, 0.0);
        let left = Vec3::new(inset - half, foot_y, -depth_m);
        let side = Wall { length_m: depth_m, ..wall };
        self.paint.wall(&Wall { foot: right, along: Vec3::NEG_Z, ..side }, &[]);
        self.paint.wall(&Wall { foot: left, along: Vec3::Z, ..side }, &[]);
    }

    fn windows(&self, storey: u32, is_front: bool, below: f32) -> Vec<Opening> {
        let room_m = self.room_width_m();
        let opening = |room: u32| {
            let middle = WALL_M + (room as f32 + 0.5) * room_m;
            let is_shop = storey == 0 && is_front;
            let is_door = storey == 0 && room == self.kind.rooms / 2 && !is_front;
            let is_wide = is_front && self.kind.empty_room == Some(storey) && room == 0;
            let (half, height) = if is_door {
                (0.55, [below, 2.15])
            } else if is_wide {
                (0.42 * room_m, [0.45, 2.45])
            } else if is_shop {
                (0.36 * room_m, [0.7, 2.5])
            } else {
                (0.5 * self.kind.glazing * room_m, [0.9, 2.35])
            };
            let lift = if is_door { 0.0 } else { below };
            Opening {
                along: [middle - half, middle + half],
                height: [height[0] + lift, height[1] + lift],
            }
        };
        (0..self.kind.rooms).map(opening).collect()
    }

    /// Sills, a post in the middle of each window, and balconies.
    fn frames(&mut self, wall: &Wall, openings: &[Opening]) {
        let outward = wall.along.cross(Vec3::Y);
        let at = |along: f32, out: f32, y: f32| {
            wall.foot + wall.along * along + outward * out + Vec3::Y * y
        };
        for opening in openings.iter().filter(|opening| opening.height[0] > 0.5) {
            let [from, to] = opening.along;
            let [low, high] = opening.height;
            let middle = 0.5 * (from + to);
            let ends = [at(middle - 0.04, -0.03, low), at(middle + 0.04, 0.05, high)];
            self.paint.block(ends[0].min(ends[1]), ends[0].max(ends[1]), Faces::SIDES, WHITE);
            let edge = 0.5 * WALL_M;
            let ends = [at(from - 0.1, edge, low - 0.1), at(to + 0.1, edge + 0.12, low)];
            self.paint.block(ends[0].min(ends[1]), ends[0].max(ends[1]), Faces::ALL, WHITE * 0.8);
            if self.kind.has_balconies && low < 1.0 && outward.z > 0.0 && wall.foot.y > 1.0 {
                let color = self.kind.facade * 0.8;
                let out = edge + 1.2;
                let ends = [at(from - 0.3, edge, -0.15), at(to + 0.3, out, -0.02)];
                self.paint.block(ends[0].min(ends[1]), ends[0].max(ends[1]), Faces::ALL, color);
                let ends = [at(from - 0.3, out, -0.15), at(to + 0.3, out + 0.08, 0.85)];
                self.paint.block(ends[0].min(ends[1]), ends[0].max(ends[1]), Faces::ALL, color);
            }
        }
    }

    /// Floor and ceiling of a storey, the walls between its rooms, and their furniture.
    fn rooms(&mut self, storey: u32) {
        let Kind { width_m, depth_m, rooms, seed, .. } = *self.kind;
        let y = Self::floor_m(storey);
        let half = 0.5 * width_m - WALL_M;
        let middle = Vec3::new(0.0, y, -0.5 * depth_m);
        let half_depth = 0.5 * depth_m - WALL_M;
        let wood = pick(&WOOD, chance(seed, storey, 1));
        self.paint.level(middle, half, half_depth, true, wood);
        self.paint.level(middle + Vec3::Y * ROOM_M, half, half_depth, false, WHITE);

        let color = |what: u32| pick(&ROOM_COLORS, chance(seed, storey, what));
        let room_m = self.room_width_m();
        let spine = Wall {
            foot: middle - Vec3::X * half,
            along: Vec3::X,
            length_m: 2.0 * half,
            height_m: ROOM_M,
            thickness_m: PARTITION_M,
            front: color(2),
            back: color(3),
        };
        let door = |room: u32| {
            let from = (room as f32 + 0.75) * room_m - 0.45;
            Opening { along: [from, from + 0.9], height: [0.0, 2.05] }
        };
        let doors: Vec<_> = (0..rooms).map(door).collect();
        self.paint.wall(&spine, &doors);

        let room_depth_m = half_depth - 0.5 * PARTITION_M;
        for row in 0..2 {
            let outward = if row == 0 { 1.0 } else { -1.0 };
            let z = middle.z + outward * 0.5 * (half_depth + 0.5 * PARTITION_M);
            for room in 0..rooms {
                let x = -half + (room as f32 + 0.5) * room_m;
                let seed = [seed, storey * 2 + row, room];
                let width_m = room_m - PARTITION_M;
                let middle = Vec3::new(x, y, z);
                let place = Room { middle, width_m, depth_m: room_depth_m, outward, seed };
                let is_empty = row == 0 && room == 0 && self.kind.empty_room == Some(storey);
                if !is_empty {
                    self.furnish(&place);
                    self.lamp(&place);
                }
                if room > 0 {
                    let wall = Wall {
                        foot: Vec3::new(x - 0.5 * room_m, y, z + 0.5 * room_depth_m),
                        along: Vec3::NEG_Z,
                        length_m: room_depth_m,
                        front: pick(&ROOM_COLORS, place.chance(1)),
                        back: pick(&ROOM_COLORS, place.chance(2)),
                        ..spine
                    };
                    self.paint.wall(&wall, &[]);
                }
            }
        }
    }

    /// Adds a few large things: a bed and a wardrobe, a table with two stools, or a sofa and
    /// shelves.
    fn furnish(&mut self, room: &Room) {
        let Room { middle, width_m, depth_m, outward, .. } = *room;
        let wood = pick(&WOOD, room.chance(3));
        let cloth = pick(&CLOTH, room.chance(4));
        let left = -0.5 * width_m;
        let inner = -0.5 * depth_m * outward;
        let paint = &mut self.paint;
        let mut stand = |x: f32, z: f32, size: [f32; 3], color: Vec3| {
            paint.stand(middle + Vec3::new(x, 0.0, z), Vec3::from(size), color);
        };
        match (room.chance(5) * 3.0) as u32 {
            0 => {
                stand(left + 1.1, 0.2 * outward, [2.0, 0.5, 1.6], cloth);
                stand(left + 0.1, 0.2 * outward, [0.1, 0.9, 1.6], wood);
                stand(left + 0.9, inner + 0.35 * outward, [1.6, 2.1, 0.6], wood);
            }
            1 => {
                let top = Vec3::new(0.0, 0.72, 0.3 * outward);
                stand(0.0, 0.3 * outward, [0.12, 0.72, 0.12], wood);
                stand(-0.9, 0.3 * outward, [0.4, 0.45, 0.4], cloth);
                stand(0.9, 0.3 * outward, [0.4, 0.45, 0.4], cloth);
                stand(left + 0.35, inner + 1.2 * outward, [0.6, 0.9, 2.2], WHITE);
                let half = Vec3::new(0.7, 0.0, 0.45);
                let low = middle + top - half;
                self.paint.block(low, middle + top + half + Vec3::Y * 0.04, Faces::ALL, wood);
            }
            _ => {
                stand(0.0, 0.25 * outward, [2.0, 0.42, 0.85], cloth);
                stand(0.0, -0.15 * outward, [2.0, 0.8, 0.2], cloth);
                stand(left + 0.2, 0.0, [0.35, 1.9, 1.4], wood);
            }
        }
    }

    /// Adds the face of a lamp directly under the ceiling.
    fn lamp(&mut self, room: &Room) {
        if room.chance(6) > LIT_ROOMS {
            return;
        }
        let center = room.middle + Vec3::Y * (ROOM_M - 0.05);
        let half = 0.3;
        let face = quad(center, Vec3::X * half, Vec3::Z * half);
        let faces = Faces { y: [false; 2], ..Faces::ALL };
        let low = Vec3::new(-half, 0.0, -half);
        let rim = cuboid(center + low, center - low + Vec3::Y * 0.05, faces);
        self.paint.add(rim, WHITE);
        append(&mut self.lamps, face);
    }

    fn roof(&mut self) {
        let Kind { width_m, depth_m, seed, .. } = *self.kind;
        let top = self.top_m();
        let middle = Vec3::new(0.0, top, -0.5 * depth_m);
        let half = Vec2::new(0.5 * width_m, 0.5 * depth_m);
        if self.kind.roof == Roof::Flat {
            self.paint.level(middle, half.x, half.y, true, Vec3::splat(0.22));
            let all = FrameFaces { top: true, bottom: false, outer: true };
            let mut parapet = frame(half, half - 0.25, [top, top + 0.7], all);
            for position in &mut parapet.positions {
                position.z += middle.z;
            }
            self.paint.add(parapet, self.kind.facade);
            let hut = middle + Vec3::new((chance(seed, 90, 0) - 0.5) * half.x, 0.0, -0.3 * half.y);
            self.paint.stand(hut, Vec3::new(3.0, 2.4, 3.0), WHITE * 0.8);
            let fan = middle + Vec3::new((chance(seed, 91, 0) - 0.5) * half.x, 0.0, 0.4 * half.y);
            self.paint.stand(fan, Vec3::new(1.6, 1.1, 1.2), Vec3::splat(0.45));
            return;
        }
        let tiles = pick(
            &[Vec3::new(0.42, 0.14, 0.09), Vec3::new(0.30, 0.12, 0.08), Vec3::splat(0.14)],
            chance(seed, 92, 0),
        );
        // Slopes of 36 degrees that overhang the front and the back by 30 cm.
        let rise = 0.72 * half.y;
        let over = 0.3;
        let slope = 0.5 * Vec3::new(0.0, 0.72 * (half.y + over), half.y + over);
        let center = |side: f32| middle + Vec3::Y * rise - Vec3::new(0.0, slope.y, -side * slope.z);
        for side in [1.0, -1.0] {
            let down = Vec3::new(0.0, -slope.y, side * slope.z);
            let along = Vec3::X * (side * half.x);
            self.paint.add(quad(center(side), along, -down), tiles);
            // The underside of the overhang is visible.
            let thin = Vec3::Y * 0.02;
            self.paint.add(quad(center(side) - thin, along, down), tiles);
        }
        for side in [1.0, -1.0] {
            let mut gable = Mesh::default();
            let x = Vec3::X * (side * half.x);
            let low = |z: f32| middle + x + Vec3::Z * z * side;
            append(&mut gable, quad(middle + x, Vec3::NEG_Z * (side * half.y), Vec3::Y));
            gable.positions = vec![low(half.y), low(-half.y), middle + x + Vec3::Y * rise];
            gable.normals.truncate(3);
            gable.uvs.truncate(3);
            gable.tangents.truncate(3);
            gable.indices = vec![0, 1, 2];
            self.paint.add(gable, self.kind.facade);
        }
        let chimney = middle + Vec3::new((chance(seed, 93, 0) - 0.5) * half.x, 0.5 * rise, -0.8);
        self.paint.stand(chimney, Vec3::new(0.7, rise, 0.7), Vec3::new(0.35, 0.16, 0.11));
    }
}
