//! A hall of 12 x 8 m, 6 m high, with a gallery all around, under a roof with a rectangular
//! opening. The sun shines through it onto cloths between the columns; everything else is lit
//! indirectly.
//!
//! Everything is solid: walls, slab and roof are 25 to 30 cm thick, and hidden faces are omitted,
//! so that light enters only through the opening.

use glam::{Vec2, Vec3};

use super::build::{WHITE, checker, diffuse, place, tile};
use super::shapes::{Faces, FrameFaces, cuboid, cylinder, frame, merge, quad};
use crate::{Camera, Environment, Light, LightKind, Scene};

/// Half the hall's length along x and width along z, and its height.
const HALL_M: Vec2 = Vec2::new(6.0, 4.0);
const HEIGHT_M: f32 = 6.0;
const WALL_M: f32 = 0.3;
/// Half the edges of the opening in the roof.
const OPENING_M: Vec2 = Vec2::new(3.6, 1.7);
/// Half the edges of the hole in the gallery.
const WELL_M: Vec2 = Vec2::new(4.4, 2.0);
/// Heights of the lower and upper side of the gallery's slab.
const SLAB_M: [f32; 2] = [2.75, 3.0];
const PARAPET_M: Vec2 = Vec2::new(0.12, 0.9);
const COLUMN_RADIUS_M: f32 = 0.16;
/// Columns on each long side, and their distance along x.
const COLUMNS: usize = 6;
const COLUMN_STEP_M: f32 = 1.68;
/// Distance of the columns' axes from the gallery's edge, outwards.
const COLUMN_INSET_M: f32 = 0.25;

pub(super) fn scene() -> Scene {
    let mut scene = Scene::default();
    let stone = diffuse(&mut scene, "stone", Vec3::new(0.66, 0.62, 0.55));
    let plaster = diffuse(&mut scene, "plaster", WHITE);
    let tiles = checker(&mut scene, "tiles", [[206, 186, 158], [150, 98, 72]]);
    shell(&mut scene, plaster, tiles);
    gallery(&mut scene, stone);
    cloths(&mut scene);

    scene.lights.push(Light {
        name: "sun".to_owned(),
        intensity: 80_000.0,
        color: Vec3::new(1.0, 0.96, 0.90),
        direction: Vec3::new(0.30, -1.0, 0.36).normalize(),
        ..Light::typical(LightKind::Directional)
    });
    scene.environment =
        Environment { radiance: Vec3::new(2000.0, 2800.0, 4000.0), ..Environment::default() };

    scene.cameras.push(Camera {
        name: "along the hall".to_owned(),
        ..Camera::look_at(Vec3::new(-5.6, 1.65, -0.6), Vec3::new(3.0, 2.3, 0.4), 1.05)
    });
    scene.cameras.push(Camera {
        name: "from the gallery".to_owned(),
        ..Camera::look_at(Vec3::new(-5.4, 4.6, -3.2), Vec3::new(2.0, 1.6, 1.0), 1.05)
    });
    scene
}

/// Floor, outer walls and roof.
fn shell(scene: &mut Scene, plaster: usize, tiles: usize) {
    let outer = HALL_M + WALL_M;
    let (x, z) = (Vec3::X * outer.x, Vec3::Z * outer.y);
    // Half-metre tiles: one repetition of the image is two by two tiles.
    place(scene, "floor", tile(quad(Vec3::ZERO, x, -z), 2.0 * outer.x, 2.0 * outer.y), tiles);
    let ground = Faces { y: [true, false], ..Faces::ALL };
    let ground =
        cuboid(Vec3::new(-outer.x, -WALL_M, -outer.y), Vec3::new(outer.x, 0.0, outer.y), ground);
    let sides = FrameFaces { top: false, bottom: false, outer: true };
    let walls = frame(outer, HALL_M, [0.0, HEIGHT_M], sides);
    let all = FrameFaces { top: true, bottom: true, outer: true };
    let roof = frame(outer, OPENING_M, [HEIGHT_M, HEIGHT_M + WALL_M], all);
    place(scene, "ground, walls and roof", merge([ground, walls, roof]), plaster);
}

/// The gallery's slab and parapet, and the columns that carry it and the roof.
fn gallery(scene: &mut Scene, stone: usize) {
    let slab = FrameFaces { top: true, bottom: true, outer: false };
    let parapet = FrameFaces { top: true, bottom: false, outer: true };
    let top = SLAB_M[1] + PARAPET_M.y;
    let parts = [
        frame(HALL_M, WELL_M, SLAB_M, slab),
        frame(WELL_M + PARAPET_M.x, WELL_M, [SLAB_M[1], top], parapet),
    ];
    place(scene, "gallery", merge(parts), stone);

    let mut columns = Vec::new();
    for i in 0..COLUMNS {
        for side in [-1.0, 1.0] {
            let foot = Vec3::new(column_x(i), 0.0, side * (WELL_M.y + COLUMN_INSET_M));
            columns.push(cylinder(foot, COLUMN_RADIUS_M, SLAB_M[0], 24));
            let foot = foot + Vec3::Y * SLAB_M[1];
            columns.push(cylinder(foot, COLUMN_RADIUS_M, HEIGHT_M - SLAB_M[1], 24));
        }
    }
    place(scene, "columns", merge(columns), stone);
}

fn column_x(i: usize) -> f32 {
    (i as f32 - (COLUMNS - 1) as f32 * 0.5) * COLUMN_STEP_M
}

/// Cloths of 2 cm in every gap between two columns, hanging from the gallery.
fn cloths(scene: &mut Scene) {
    let colors = [
        ("red cloth", Vec3::new(0.62, 0.06, 0.05)),
        ("blue cloth", Vec3::new(0.07, 0.16, 0.58)),
        ("yellow cloth", Vec3::new(0.72, 0.50, 0.06)),
    ];
    let materials = colors.map(|(name, albedo)| diffuse(scene, name, albedo));
    for side in [-1.0, 1.0] {
        for gap in 0..COLUMNS - 1 {
            // The two sides of the hall start with different colours.
            let pick = (gap + usize::from(side > 0.0)) % colors.len();
            let middle = (column_x(gap) + column_x(gap + 1)) * 0.5;
            let z = side * (WELL_M.y + COLUMN_INSET_M);
            let cloth = cuboid(
                Vec3::new(middle - 0.5, 0.85, z - 0.01),
                Vec3::new(middle + 0.5, SLAB_M[0], z + 0.01),
                Faces::NO_TOP,
            );
            place(scene, colors[pick].0, cloth, materials[pick]);
        }
    }
}
