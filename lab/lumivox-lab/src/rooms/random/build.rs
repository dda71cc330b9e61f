//! The solids of a room under construction, its surfaces, and the free space between them.
//!
//! A room is made of convex prisms: slabs, posts, steps, boards. Their planes decide whether a
//! point is inside a solid, so that sensors, lamps and cameras are placed in the air. Everything of
//! one material is one mesh.

use glam::{Vec2, Vec3};
use lumivox_scene::builtin::build::{checker, glaze, glowing, lacquer, place};
use lumivox_scene::builtin::shapes::append;
use lumivox_scene::{Mesh, Scene, Shading};

use super::dice::Dice;
use super::{EYES, FEWEST_SENSORS, Kind, RANDOM_SENSORS};

/// The distances of usual and of random sensors from solids, m.
const SENSOR_GAP_M: f32 = 0.005;
const RANDOM_SENSOR_GAP_M: f32 = 0.05;
/// The distances of point lights and of eyes from solids, m.
const LAMP_GAP_M: f32 = 0.15;
const EYE_GAP_M: f32 = 0.25;
/// The most positions to try.
const TRIES: usize = 2000;
/// The area of a panel that glows with 1000 cd/m², in m²; thin lamps give about the same light.
const PANEL_M2: f32 = 0.36;

/// A region in which nothing can be placed: a solid, or the outside.
enum Blocked {
    /// The points with `normal.dot(p) < offset` for all planes.
    Convex(Vec<(Vec3, f32)>),
    Ball(Vec3, f32),
}

impl Blocked {
    /// Whether a point is inside the region widened by `gap_m`.
    fn holds(&self, point: Vec3, gap_m: f32) -> bool {
        match self {
            Self::Convex(planes) => {
                planes.iter().all(|(normal, offset)| normal.dot(point) - offset < gap_m)
            }
            Self::Ball(center, radius_m) => point.distance(*center) < radius_m + gap_m,
        }
    }
}

/// A room under construction.
pub(super) struct Build {
    pub(super) dice: Dice,
    pub(super) kind: Kind,
    /// The inner size, m: x and z from minus half of it, y from 0; a sloped roof goes higher.
    pub(super) size_m: Vec3,
    pub(super) half: Vec3,
    pub(super) wall_m: f32,
    pub(super) is_open: bool,
    /// The height from which a panel hangs, m.
    pub(super) hang_m: f32,
    blocked: Vec<Blocked>,
    scene: Scene,
    /// The triangles of each material.
    meshes: Vec<Mesh>,
    /// The material of the walls.
    pub(super) walls: usize,
}

impl Build {
    /// A room without geometry; the walls have a material.
    pub(super) fn new(dice: Dice, kind: Kind, size_m: Vec3, wall_m: f32, is_open: bool) -> Self {
        let mut build = Self {
            dice,
            kind,
            size_m,
            half: 0.5 * size_m,
            wall_m,
            is_open,
            hang_m: size_m.y,
            blocked: Vec::new(),
            scene: Scene::default(),
            meshes: Vec::new(),
            walls: 0,
        };
        build.walls = build.surface(false);
        build
    }

    /// A random material. Plain rooms have rough dielectrics; others also have smooth ones and
    /// checkers, and metal for things.
    fn surface(&mut self, is_thing: bool) -> usize {
        let Self { dice, scene, .. } = self;
        let name = format!("surface {}", scene.materials.len());
        if self.kind == Kind::Plain {
            let color = dice.point(Vec3::splat(0.4), Vec3::splat(0.85));
            return lacquer(scene, &name, color, 1.0);
        }
        let roughness = dice.between(0.2, 1.0);
        match dice.draw() {
            ..0.3 if is_thing => {
                let color = dice.point(Vec3::splat(0.5), Vec3::splat(0.95));
                let metal = lacquer(scene, &name, color, roughness);
                if let Shading::MetallicRoughness(shading) = &mut scene.materials[metal].shading {
                    shading.metallic = 1.0;
                }
                metal
            }
            ..0.55 => {
                let colors = [(); 2].map(|()| [(); 3].map(|()| dice.whole(60, 235) as u8));
                let checkered = checker(scene, &name, colors);
                glaze(scene, checkered, roughness);
                checkered
            }
            _ => {
                let color = dice.point(Vec3::splat(0.2), Vec3::splat(0.85));
                lacquer(scene, &name, color, roughness)
            }
        }
    }

    /// The material of another thing; all things of a plain room share one.
    pub(super) fn thing(&mut self) -> usize {
        if self.kind == Kind::Plain && self.scene.materials.len() > 1 {
            return 1;
        }
        self.surface(true)
    }

    /// Adds triangles that block nothing.
    pub(super) fn triangles(&mut self, material: usize, mesh: Mesh) {
        if self.meshes.len() <= material {
            self.meshes.resize_with(material + 1, Mesh::default);
        }
        append(&mut self.meshes[material], mesh);
    }

    /// Adds a prism: a convex polygon, extruded along a vector.
    pub(super) fn prism(&mut self, material: usize, base: &[Vec3], along: Vec3) {
        let mut base = base.to_vec();
        if (base[1] - base[0]).cross(base[2] - base[1]).dot(along) < 0.0 {
            base.reverse();
        }
        let top: Vec<Vec3> = base.iter().map(|corner| *corner + along).collect();
        let next = |i: usize| (i + 1) % base.len();
        let side = |i: usize| vec![base[i], base[next(i)], top[next(i)], top[i]];
        let sides = (0..base.len()).map(side);
        let bottom = base.iter().rev().copied().collect();
        let mut planes = Vec::new();
        for corners in sides.chain([bottom, top.clone()]) {
            let mesh = face(&corners);
            planes.push((mesh.normals[0], mesh.normals[0].dot(corners[0])));
            self.triangles(material, mesh);
        }
        self.blocked.push(Blocked::Convex(planes));
    }

    pub(super) fn cuboid(&mut self, material: usize, low: Vec3, high: Vec3) {
        let base = [(low.x, low.z), (low.x, high.z), (high.x, high.z), (high.x, low.z)];
        self.prism(
            material,
            &base.map(|(x, z)| Vec3::new(x, low.y, z)),
            Vec3::Y * (high.y - low.y),
        );
    }

    /// Adds a round thing, which blocks a ball.
    pub(super) fn ball(&mut self, material: usize, mut mesh: Mesh, center: Vec3, radius_m: f32) {
        for position in &mut mesh.positions {
            *position += center;
        }
        self.triangles(material, mesh);
        self.blocked.push(Blocked::Ball(center, radius_m));
    }

    /// Adds a box-shaped part of a wall.
    pub(super) fn slab(&mut self, low: [f32; 3], high: [f32; 3]) {
        self.cuboid(self.walls, low.into(), high.into());
    }

    /// Adds a wall that faces z, from the floor up, with or without a hole: its x, z, height, and
    /// the hole's x and y.
    pub(super) fn wall(
        &mut self,
        x: [f32; 2],
        z: [f32; 2],
        height_m: f32,
        hole: Option<[[f32; 2]; 2]>,
    ) {
        let Some([hole_x, hole_y]) = hole else {
            return self.slab([x[0], 0.0, z[0]], [x[1], height_m, z[1]]);
        };
        self.slab([x[0], 0.0, z[0]], [hole_x[0], height_m, z[1]]);
        self.slab([hole_x[1], 0.0, z[0]], [x[1], height_m, z[1]]);
        self.slab([hole_x[0], hole_y[1], z[0]], [hole_x[1], height_m, z[1]]);
        if hole_y[0] > 0.01 {
            self.slab([hole_x[0], 0.0, z[0]], [hole_x[1], hole_y[0], z[1]]);
        }
    }

    /// Blocks the region beyond planes: the points with `normal.dot(p) > offset` for all of them.
    pub(super) fn beyond<const N: usize>(&mut self, planes: [(Vec3, f32); N]) {
        let planes = planes.map(|(normal, offset)| (-normal, -offset));
        self.blocked.push(Blocked::Convex(planes.to_vec()));
    }

    pub(super) fn is_free(&self, point: Vec3, gap_m: f32) -> bool {
        !self.blocked.iter().any(|blocked| blocked.holds(point, gap_m))
    }

    /// The first free point that `draw` returns.
    fn free_point(&mut self, gap_m: f32, mut draw: impl FnMut(&mut Dice) -> Vec3) -> Option<Vec3> {
        (0..TRIES).find_map(|_| {
            let point = draw(&mut self.dice);
            self.is_free(point, gap_m).then_some(point)
        })
    }

    pub(super) fn lamp_position(&mut self) -> Vec3 {
        let (half, height_m) = (self.half, self.size_m.y);
        let low = Vec3::new(-0.5 * half.x, 0.6 * height_m, -0.5 * half.z);
        let high = Vec3::new(0.5 * half.x, 0.9 * height_m, 0.5 * half.z);
        let point = self.free_point(LAMP_GAP_M, |dice| dice.point(low, high));
        point.unwrap_or(Vec3::Y * 0.5 * height_m)
    }

    /// Hangs a glowing panel from the middle of the ceiling, or from elsewhere if something is in
    /// its way.
    pub(super) fn panel(&mut self) {
        let dice = &mut self.dice;
        let is_thin = self.kind == Kind::ThinLamp;
        let (along, across, thick_m) = if is_thin {
            let turn_rad = dice.between(0.0, std::f32::consts::PI);
            let along = Vec3::new(turn_rad.cos(), 0.0, turn_rad.sin());
            let across = Vec3::Y.cross(along);
            let half_length_m = dice.between(0.3, 0.75);
            (
                along * half_length_m,
                across * dice.between(0.01, 0.025),
                dice.pick(&[0.01, 0.02, 0.03]),
            )
        } else {
            (Vec3::X * 0.3, Vec3::Z * 0.3, dice.pick(&[0.01, 0.05, 0.1]))
        };
        let gap_m = dice.pick(&[0.001, 0.02, 0.2]);
        let middle = Vec3::Y * (self.hang_m - thick_m - gap_m);
        let corners = [along + across, along - across, -along - across, across - along];
        let half = self.half;
        let place = (0..TRIES).find_map(|tried| {
            let moved = Vec3::new(self.dice.between(-0.7, 0.7), 0.0, self.dice.between(-0.7, 0.7));
            let at = if tried == 0 { middle } else { middle + moved * half };
            let mut points = corners.iter().copied().chain([Vec3::ZERO]);
            points.all(|corner| self.is_free(at + corner, 0.0)).then_some(at)
        });
        let at = place.unwrap_or(middle);
        let area_m2 = 4.0 * along.length() * across.length();
        let radiance = 1000.0 * PANEL_M2 / if is_thin { area_m2 } else { PANEL_M2 };
        let glow = glowing(&mut self.scene, "panel", Vec3::splat(radiance));
        self.prism(glow, &corners.map(|corner| at + corner), Vec3::Y * thick_m);
    }

    /// Places and directions of sensors, all in free space: up to five usual ones, and random ones
    /// in rooms that are not plain or have too few usual ones.
    pub(super) fn sensors(&mut self) -> Vec<(Vec3, Vec3)> {
        let Vec3 { x, z, .. } = self.half;
        let height_m = self.size_m.y;
        let usual = [
            (Vec3::new(0.0, 0.01, 0.0), Vec3::Y),
            (Vec3::new(0.3 * x, 0.8, 0.2 * z), Vec3::Y),
            (Vec3::new(-x + 0.02, 1.5, 0.1), Vec3::X),
            (Vec3::new(x - 0.15, 0.05, z - 0.15), Vec3::Y),
            (Vec3::new(0.5 * x, height_m - 0.02, 0.6 * z), Vec3::NEG_Y),
        ];
        let mut sensors: Vec<_> =
            usual.into_iter().filter(|(at, _)| self.is_free(*at, SENSOR_GAP_M)).collect();
        let random = if self.kind == Kind::Plain { 0 } else { RANDOM_SENSORS };
        let wanted = (sensors.len() + random).max(FEWEST_SENSORS);
        let (low, high) = (Vec3::new(-x, 0.0, -z), Vec3::new(x, height_m, z));
        while sensors.len() < wanted {
            let at = self.free_point(RANDOM_SENSOR_GAP_M, |dice| dice.point(low, high));
            let Some(at) = at else { break };
            let normal = self.dice.pick(&Vec3::AXES) * self.dice.pick(&[1.0, -1.0]);
            sensors.push((at, normal));
        }
        sensors
    }

    /// Free places for an eye, and the place to look at.
    pub(super) fn eyes(&mut self) -> (Vec<Vec3>, Vec3) {
        let Vec3 { x, z, .. } = self.half;
        let (low, high) = (Vec3::new(-x, 0.9, -z), Vec3::new(x, 1.9, z));
        let eyes = (0..EYES)
            .filter_map(|_| self.free_point(EYE_GAP_M, |dice| dice.point(low, high)))
            .collect();
        (eyes, Vec3::Y * 0.4 * self.size_m.y)
    }

    /// The scene, an object for each material.
    pub(super) fn finish(mut self, is_double_sided: bool) -> Scene {
        for (material, mesh) in self.meshes.into_iter().enumerate() {
            let name = self.scene.materials[material].name.clone();
            self.scene.materials[material].double_sided = is_double_sided;
            place(&mut self.scene, &name, mesh, material);
        }
        self.scene
    }
}

/// A flat convex polygon, counter-clockwise seen from its front; textures repeat every metre.
pub(super) fn face(corners: &[Vec3]) -> Mesh {
    let along = (corners[1] - corners[0]).normalize();
    let normal = along.cross(corners[2] - corners[1]).normalize();
    let up = normal.cross(along);
    let count = corners.len();
    Mesh {
        positions: corners.to_vec(),
        normals: vec![normal; count],
        uvs: corners.iter().map(|p| Vec2::new(along.dot(*p), -up.dot(*p))).collect(),
        tangents: vec![along.extend(1.0); count],
        indices: (2..count as u32).flat_map(|i| [0, i - 1, i]).collect(),
        ..Mesh::default()
    }
}
