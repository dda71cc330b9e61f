//! The shape of each kind of room.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};
use lumivox_scene::Mesh;
use lumivox_scene::builtin::shapes::sphere;

use super::Kind;
use super::build::{Build, face};

/// Segments around a body of about four thousand triangles.
const BODY_SEGMENTS: u32 = 64;

impl Build {
    /// Builds walls, floor and ceiling, and what is in the room.
    pub(super) fn shape(&mut self) {
        match self.kind {
            Kind::SlopedRoof => self.sloped_roof(),
            Kind::LShape => self.l_shape(),
            Kind::Tent => return self.tent(),
            _ => self.shell(),
        }
        match self.kind {
            Kind::Stairs => self.stairs(),
            Kind::Columns => self.columns(),
            Kind::Round => self.round_things(),
            Kind::Corners => return self.corners(),
            Kind::RoomInRoom => self.inner_room(),
            Kind::DoorAjar => self.door_ajar(),
            Kind::Mesh => self.bodies(),
            _ => {}
        }
        self.blocks();
    }

    /// A box of slabs; with a window if it is open.
    fn shell(&mut self) {
        let (Vec3 { x, z, .. }, t, height_m) = (self.half, self.wall_m, self.size_m.y);
        self.floor();
        self.slab([-x - t, height_m, -z - t], [x + t, height_m + t, z + t]);
        self.slab([-x - t, 0.0, -z - t], [-x, height_m, z + t]);
        self.slab([x, 0.0, -z - t], [x + t, height_m, z + t]);
        self.slab([-x, 0.0, z], [x, height_m, z + t]);
        self.window_wall();
        self.beyond([(Vec3::Y, height_m)]);
    }

    /// The floor of a rectangular room.
    fn floor(&mut self) {
        let (Vec3 { x, z, .. }, t) = (self.half, self.wall_m);
        self.slab([-x - t, -t, -z - t], [x + t, 0.0, z + t]);
        self.outside();
    }

    /// Blocks the region below the floor and beyond the walls.
    fn outside(&mut self) {
        let Vec3 { x, z, .. } = self.half;
        for plane in
            [(Vec3::NEG_Y, 0.0), (Vec3::X, x), (Vec3::NEG_X, x), (Vec3::Z, z), (Vec3::NEG_Z, z)]
        {
            self.beyond([plane]);
        }
    }

    /// The wall at -z.
    fn window_wall(&mut self) {
        let (Vec3 { x, z, .. }, t, size) = (self.half, self.wall_m, self.size_m);
        let hole = self.is_open.then(|| {
            let width_m = self.dice.between(0.8, (0.8 * size.x).min(3.0));
            let height_m = self.dice.between(0.8, (0.8 * size.y).min(2.2));
            let left = self.dice.between(-x + 0.2, x - 0.2 - width_m);
            let low = self.dice.between(0.0, size.y - height_m - 0.1);
            [[left, left + width_m], [low, low + height_m]]
        });
        self.wall([-x, x], [-z - t, -z], size.y, hole);
    }

    /// Up to three blocks on the floor.
    fn blocks(&mut self) {
        for _ in 0..self.dice.whole(0, 3) {
            let edges = self.dice.point(Vec3::splat(0.3), Vec3::splat(1.2));
            let reach = self.half - 0.1;
            let high = (reach - edges).max(0.1 - reach);
            let corner = self.dice.point(-reach.with_y(0.0), high.with_y(0.0));
            // Blocks of plain rooms may overlap.
            let is_clear = |build: &Self| {
                [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE, Vec2::splat(0.5)].iter().all(|at| {
                    let point = corner + edges * Vec3::new(at.x, 0.0, at.y);
                    build.is_free(point.with_y(0.02), 0.0)
                })
            };
            if self.kind == Kind::Plain || is_clear(self) {
                let material = self.thing();
                self.cuboid(material, corner, corner + edges);
            }
        }
    }

    /// A pent roof or a gable over walls of the room's height.
    fn sloped_roof(&mut self) {
        let (Vec3 { x, z, .. }, t, eaves_m) = (self.half, self.wall_m, self.size_m.y);
        let ridge_m = eaves_m + self.dice.between(0.5, 1.6);
        let ridge_x = if self.dice.is(0.5) { x } else { self.dice.between(-0.4, 0.4) * x };
        let mut line = vec![Vec2::new(-x, eaves_m), Vec2::new(ridge_x, ridge_m)];
        if ridge_x < x {
            line.push(Vec2::new(x, eaves_m));
        }
        self.floor();
        let walls = self.walls;
        let profile = |build: &mut Self, corners: &[Vec2], z: [f32; 2]| {
            let corners: Vec<Vec3> = corners.iter().map(|p| p.extend(z[0])).collect();
            build.prism(walls, &corners, Vec3::Z * (z[1] - z[0]));
        };
        let whole = [-z - t, z + t];
        let parts = line.len() - 1;
        for (i, part) in line.windows(2).enumerate() {
            let [mut from, mut to] = [part[0], part[1]];
            let slope = (to.y - from.y) / (to.x - from.x);
            let step = Vec2::new(t, slope * t);
            self.beyond([(Vec3::new(-slope, 1.0, 0.0).normalize(), {
                (from.y - slope * from.x) / (1.0 + slope * slope).sqrt()
            })]);
            // The walls at both ends reach up to the roof's lower side.
            if i == 0 {
                let foot = from.with_y(0.0);
                profile(self, &[foot - Vec2::X * t, foot, from, from - step], whole);
                from -= step;
            }
            if i + 1 == parts {
                let foot = to.with_y(0.0);
                profile(self, &[foot, foot + Vec2::X * t, to + step, to], whole);
                to += step;
            }
            let up = Vec2::Y * (t * (1.0 + slope * slope).sqrt());
            profile(self, &[from, to, to + up, from + up], whole);
        }
        self.slab([-x, 0.0, z], [x, eaves_m, z + t]);
        self.window_wall();
        let gable = [line[0], Vec2::new(x, eaves_m), line[1]];
        profile(self, &gable, [z, z + t]);
        profile(self, &gable, [-z - t, -z]);
    }

    /// A room without its corner at +x and +z.
    fn l_shape(&mut self) {
        let (Vec3 { x, z, .. }, t, height_m) = (self.half, self.wall_m, self.size_m.y);
        let inner_x = self.dice.between(-0.3, 0.3) * x;
        let inner_z = self.dice.between(-0.3, 0.3) * z;
        self.floor_of_l([-t, 0.0], [inner_x, inner_z]);
        self.floor_of_l([height_m, height_m + t], [inner_x, inner_z]);
        self.slab([-x - t, 0.0, -z - t], [-x, height_m, z + t]);
        self.slab([x, 0.0, -z - t], [x + t, height_m, inner_z + t]);
        self.slab([-x, 0.0, z], [inner_x + t, height_m, z + t]);
        self.slab([inner_x, 0.0, inner_z], [inner_x + t, height_m, z]);
        self.slab([inner_x + t, 0.0, inner_z], [x, height_m, inner_z + t]);
        self.window_wall();
        self.beyond([(Vec3::X, inner_x), (Vec3::Z, inner_z)]);
        self.beyond([(Vec3::Y, height_m)]);
        self.outside();
    }

    /// Floor or ceiling of an L, between two heights.
    fn floor_of_l(&mut self, y: [f32; 2], [inner_x, inner_z]: [f32; 2]) {
        let (Vec3 { x, z, .. }, t) = (self.half, self.wall_m);
        self.slab([-x - t, y[0], -z - t], [x + t, y[1], inner_z + t]);
        self.slab([-x - t, y[0], inner_z + t], [inner_x + t, y[1], z + t]);
    }

    /// A ridge over two sheets, with a sheet as floor and at each end; one end has a door if the
    /// room is open.
    fn tent(&mut self) {
        let (Vec3 { x, z, .. }, height_m) = (self.half, self.size_m.y);
        self.hang_m = 0.6 * height_m;
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let [left, right] = [-x, x].map(|x| move |z: f32| at(x, 0.0, z));
        let ridge = |z: f32| at(0.0, height_m, z);
        let mut sheets = vec![
            vec![left(-z), left(z), right(z), right(-z)],
            vec![left(z), left(-z), ridge(-z), ridge(z)],
            vec![right(-z), right(z), ridge(z), ridge(-z)],
            vec![right(z), left(z), ridge(z)],
        ];
        if self.is_open {
            let door = self.dice.between(0.15, 0.5) * x;
            sheets.push(vec![left(-z), at(-door, 0.0, -z), ridge(-z)]);
            sheets.push(vec![at(door, 0.0, -z), right(-z), ridge(-z)]);
        } else {
            sheets.push(vec![left(-z), right(-z), ridge(-z)]);
        }
        let cloth = self.walls;
        for sheet in &sheets {
            let mesh = face(sheet);
            let outwards = -mesh.normals[0];
            self.beyond([(outwards, outwards.dot(sheet[0]))]);
            self.triangles(cloth, mesh);
        }
        self.blocks();
    }

    /// Steps along the wall at -x or +x, solid or boards of 4 cm.
    fn stairs(&mut self) {
        let (Vec3 { x, z, .. }, height_m) = (self.half, self.size_m.y);
        let (rise_m, run_m) = (self.dice.between(0.16, 0.2), self.dice.between(0.24, 0.3));
        let width_m = self.dice.between(0.7, 1.1);
        let steps = ((2.0 * z - 0.4) / run_m).min((height_m - 0.5) / rise_m) as u32;
        let (is_solid, is_left) = (self.dice.is(0.5), self.dice.is(0.5));
        let from = if is_left { -x } else { x - width_m };
        let material = self.thing();
        for step in 0..steps {
            let start = -z + 0.2 + step as f32 * run_m;
            let top_m = (step + 1) as f32 * rise_m;
            let low_m = if is_solid { 0.0 } else { top_m - 0.04 };
            let low = Vec3::new(from, low_m, start);
            self.cuboid(material, low, Vec3::new(from + width_m, top_m, start + run_m));
        }
    }

    fn columns(&mut self) {
        let material = self.thing();
        let radius_m = self.dice.between(0.08, 0.3);
        let sides = self.dice.pick(&[6, 12, 24]);
        let reach = (self.half - 0.5).with_y(0.0);
        for _ in 0..self.dice.whole(2, 6) {
            let foot = self.dice.point(-reach, reach);
            let base = polygon(sides, |cos, sin| foot + radius_m * Vec3::new(cos, 0.0, sin));
            self.prism(material, &base, Vec3::Y * self.size_m.y);
        }
    }

    /// Spheres on the floor or in the air, and tubes from wall to wall.
    fn round_things(&mut self) {
        let size_m = self.size_m;
        for _ in 0..self.dice.whole(2, 4) {
            let radius_m = self.dice.between(0.15, 0.5);
            let center = self.place_of_ball(radius_m);
            let material = self.thing();
            self.ball(material, sphere(radius_m, 48), center, radius_m);
        }
        for _ in 0..self.dice.whole(1, 3) {
            let radius_m = self.dice.between(0.02, 0.12);
            let (along, across) =
                if self.dice.is(0.5) { (Vec3::X, Vec3::Z) } else { (Vec3::Z, Vec3::X) };
            let y = self.dice.between(0.5, 0.95) * (size_m.y - radius_m);
            let side = self.dice.between(-0.9, 0.9) * (self.half.dot(across) - radius_m);
            let end = Vec3::Y * y + across * side - along * self.half.dot(along);
            let base = polygon(24, |cos, sin| end + radius_m * (cos * across + sin * Vec3::Y));
            let material = self.thing();
            self.prism(material, &base, along * size_m.dot(along));
        }
    }

    /// The middle of a ball on the floor or, less often, in the air.
    fn place_of_ball(&mut self, radius_m: f32) -> Vec3 {
        let reach = self.half - radius_m;
        let (low, high) = (-reach, reach.with_y(self.size_m.y - radius_m));
        let place = self.dice.point(low.with_y(radius_m), high);
        if self.dice.is(0.7) { place.with_y(radius_m) } else { place }
    }

    /// A cupboard or a table in most corners, at the walls or a few centimetres from them.
    fn corners(&mut self) {
        for (side_x, side_z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            if self.dice.is(0.2) {
                continue;
            }
            let mut size_m = self.dice.point(Vec3::splat(0.4), Vec3::new(1.2, 2.2, 1.2));
            if self.dice.is(0.3) {
                size_m.y = self.size_m.y;
            }
            let side = Vec3::new(side_x, 0.0, side_z);
            let corner = side * (self.half - self.dice.pick(&[0.0, 0.0, 0.01, 0.03]));
            let material = self.thing();
            let mut block = |from: Vec3, to: Vec3| {
                let (from, to) = (corner + from, corner + to);
                self.cuboid(material, from.min(to), from.max(to));
            };
            let inwards = -side * size_m;
            if size_m.y > 1.0 {
                block(Vec3::ZERO, inwards.with_y(size_m.y));
                continue;
            }
            block(Vec3::Y * 0.71, inwards.with_y(0.74));
            for foot in [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(1.0, 0.0, 1.0)] {
                let foot = foot * (inwards + 0.04 * side);
                block(foot, foot - 0.04 * side + Vec3::Y * 0.71);
            }
        }
    }

    /// A room with walls of its own, 30 cm or more from the outer ones, mostly with a doorway.
    fn inner_room(&mut self) {
        let t = self.dice.pick(&[0.01, 0.03, 0.05, 0.1, 0.2]);
        let share = self.dice.point(Vec3::new(0.38, 0.6, 0.38), Vec3::new(0.55, 0.85, 0.55));
        let inner = share * self.size_m;
        let reach = (self.half - 0.5 * inner - t - 0.3).with_y(0.0);
        let middle = self.dice.point(-reach, reach);
        let (low, high) = (middle - 0.5 * inner, middle + 0.5 * inner);
        let (x, z, top_m) = ([low.x, high.x], [low.z, high.z], inner.y);
        self.slab([x[0] - t, 0.0, z[0] - t], [x[0], top_m, z[1] + t]);
        self.slab([x[1], 0.0, z[0] - t], [x[1] + t, top_m, z[1] + t]);
        self.slab([x[0], 0.0, z[1]], [x[1], top_m, z[1] + t]);
        self.slab([x[0] - t, top_m, z[0] - t], [x[1] + t, top_m + t, z[1] + t]);
        let doorway = self.dice.is(0.75).then(|| {
            let width_m = self.dice.between(0.5, 0.8);
            let left = self.dice.between(x[0] + 0.1, x[1] - 0.1 - width_m);
            [[left, left + width_m], [0.0, top_m.min(2.2) - 0.2]]
        });
        self.wall(x, [z[0] - t, z[0]], top_m, doorway);
    }

    /// A wall across the room with a doorway, and its door, open by 2 to 60 degrees.
    fn door_ajar(&mut self) {
        let (Vec3 { x, z, .. }, height_m) = (self.half, self.size_m.y);
        let front = self.dice.between(-0.3, 0.3) * z;
        let width_m = self.dice.between(0.7, 1.0);
        let left = self.dice.between(-x + 0.2, x - 0.2 - width_m);
        let doorway = [[left, left + width_m], [0.0, 2.0]];
        self.wall([-x, x], [front - self.wall_m, front], height_m, Some(doorway));
        let (sin, cos) = self.dice.between(2.0, 60.0).to_radians().sin_cos();
        let (along, across) =
            (Vec3::new(cos, 0.0, sin) * width_m, Vec3::new(-sin, 0.0, cos) * 0.04);
        let hinge = Vec3::new(left, 0.005, front + 0.002);
        let base = [hinge, hinge + along, hinge + along + across, hinge + across];
        let material = self.thing();
        self.prism(material, &base, Vec3::Y * 1.99);
    }

    /// Dented balls of thousands of triangles.
    fn bodies(&mut self) {
        for _ in 0..self.dice.whole(1, 3) {
            let radius_m = self.dice.between(0.25, 0.6);
            let center = self.place_of_ball(radius_m);
            let phase = self.dice.point(Vec3::ZERO, Vec3::splat(TAU));
            let waves = self.dice.point(Vec3::splat(3.0), Vec3::splat(9.0));
            let mut body = sphere(radius_m, BODY_SEGMENTS);
            for position in &mut body.positions {
                let [x, y, z] = (waves * *position / radius_m + phase).to_array();
                *position *= 0.8 + 0.2 * x.sin() * y.sin() * z.sin();
            }
            smooth(&mut body);
            let material = self.thing();
            self.ball(material, body, center, radius_m);
        }
    }
}

/// The corners of a regular polygon, from the cosine and the sine of each.
fn polygon(sides: u32, corner: impl Fn(f32, f32) -> Vec3) -> Vec<Vec3> {
    let angle_rad = |side: u32| TAU * side as f32 / sides as f32;
    (0..sides).map(|side| corner(angle_rad(side).cos(), angle_rad(side).sin())).collect()
}

/// Computes normals from the triangles' planes, weighted by area; vertices in one place share them.
fn smooth(mesh: &mut Mesh) {
    let key = |position: Vec3| position.to_array().map(|part| (part * 1e5).round() as i32);
    let mut sums = std::collections::HashMap::new();
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner]);
        for corner in [a, b, c] {
            *sums.entry(key(corner)).or_insert(Vec3::ZERO) += (b - a).cross(c - a);
        }
    }
    for (index, position) in mesh.positions.iter().enumerate() {
        let normal = sums[&key(*position)].normalize();
        mesh.normals[index] = normal;
        let tangent = mesh.tangents[index].truncate().reject_from(normal).normalize();
        mesh.tangents[index] = tangent.extend(1.0);
    }
}
