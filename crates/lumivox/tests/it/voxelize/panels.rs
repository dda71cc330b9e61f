//! A wall and a panel in front of it, in one voxel.

use glam::Vec3;
use lumivox::voxels::FaceRecord;
use lumivox::{Geometry, SurfaceMaterial};

use crate::voxelize::read::{Lab, ReadList, morton_decode};
use crate::voxelize::scenes::{Mesh, unit_grid};

/// Edge of the grid, in voxels and metres.
pub const EDGE: f32 = 16.0;

/// Lobes.
pub const UP: u32 = 2;
pub const DOWN: u32 = 3;

pub const WALL_REFLECTANCE: f32 = 0.2;
pub const PANEL_REFLECTANCE: f32 = 0.6;

/// A square facing down, cut into `cells` * `cells` squares.
pub fn ceiling(height: f32, (low, high): (f32, f32), cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let at = |i: u32| low + (high - low) * i as f32 / cells as f32;
    for x in 0..cells {
        for z in 0..cells {
            let corner = |x: u32, z: u32| Vec3::new(at(x), height, at(z));
            mesh.quad([corner(x, z), corner(x + 1, z), corner(x + 1, z + 1), corner(x, z + 1)]);
        }
    }
    mesh
}

/// A wall and a glowing panel below it, both facing down.
#[derive(Clone)]
pub struct Layers {
    pub wall: Mesh,
    pub panel: Mesh,
    pub double_sided: bool,
    pub panel_first: bool,
    /// Whether the wall and the panel are static.
    pub is_static: [bool; 2],
}

impl Layers {
    /// The wall fills the grid's cross-section; the panel is `gap` voxels below, from `panel.0` to
    /// `panel.1`.
    pub fn new(height: f32, gap: f32, panel: (f32, f32)) -> Self {
        Self {
            wall: ceiling(height, (0.0, EDGE), 1),
            panel: ceiling(height - gap, panel, 1),
            double_sided: false,
            panel_first: false,
            is_static: [false; 2],
        }
    }

    pub fn voxelize(&self, lab: &Lab) -> ReadList {
        let material = |reflectance: f32, emission: f32| SurfaceMaterial {
            reflectance: Vec3::splat(reflectance).extend(1.0),
            emission: Vec3::splat(emission),
            double_sided: self.double_sided,
            ..Default::default()
        };
        let mut batches: Vec<_> = [&self.wall, &self.panel]
            .into_iter()
            .zip(self.is_static)
            .enumerate()
            .map(|(index, (mesh, is_static))| {
                let mut batch = mesh.batch(&lab.device, index as u32);
                batch.draws[0].is_static = is_static;
                batch
            })
            .collect();
        if self.panel_first {
            batches.reverse();
        }
        let materials = vec![material(WALL_REFLECTANCE, 0.0), material(PANEL_REFLECTANCE, 8.0)];
        lab.voxelize(&unit_grid(EDGE as u32), &Geometry::new(batches, materials))
    }
}

/// The faces of a lobe in the middle column's voxel at y = 8, the lowest first.
pub fn middle_faces(list: &ReadList, lobe: u32) -> Vec<FaceRecord> {
    let in_middle =
        |face: &&FaceRecord| face.lobe == lobe && morton_decode(face.cell).to_array() == [8, 8, 8];
    let mut faces: Vec<_> = list.faces.iter().filter(in_middle).copied().collect();
    faces.sort_by(|a, b| a.position_in_world[1].total_cmp(&b.position_in_world[1]));
    faces
}

/// Asserts reflectance, emission, height and area of a panel or a wall.
pub fn assert_is(face: &FaceRecord, (reflectance, emission): (f32, f32), height: f32, case: &str) {
    let (emits, reflects) = (face.emission[0], face.reflectance[0]);
    assert!((emits - emission).abs() < 1e-3, "{case}: emits {emits}, not {emission}");
    assert!((reflects - reflectance).abs() < 1e-3, "{case}: reflects {reflects}");
    let apart = face.position_in_world[1] - height;
    assert!(apart.abs() < 1e-3, "{case}: {apart} voxels off");
    let area = face.vector_area;
    assert!((area[1].abs() - 1.0).abs() < 1e-3, "{case}: an area of {area:?}");
    let covered = [face.mask_low, face.mask_high, face.profiles[0], face.profiles[1]];
    assert_eq!(covered, [u32::MAX; 4], "{case}");
}

/// Reflectance and emission.
pub const WALL: (f32, f32) = (WALL_REFLECTANCE, 0.0);
pub const PANEL: (f32, f32) = (PANEL_REFLECTANCE, 8.0);

/// Asserts that a panel and the wall behind it are two faces, in either order.
pub fn assert_are_apart(lab: &Lab, method: &str) {
    for gap in [0.01, 0.8] {
        for (double_sided, panel_first) in [(false, false), (false, true), (true, false)] {
            let layers = Layers::new(8.9, gap, (0.0, EDGE));
            let list = Layers { double_sided, panel_first, ..layers }.voxelize(lab);
            let case = format!("{method}, {gap} voxels, {double_sided}");
            let lobes = if double_sided { vec![DOWN, UP] } else { vec![DOWN] };
            for lobe in lobes {
                let faces = middle_faces(&list, lobe);
                assert_eq!(faces.len(), 2, "{case}: {faces:?}");
                assert_is(&faces[0], PANEL, 8.9 - gap, &case);
                assert_is(&faces[1], WALL, 8.9, &case);
            }
        }
    }
}
