//! Surfaces one behind the other in a voxel: what is seen is the front one.

use glam::Vec3;
use lumivox::voxels::FaceRecord;
use lumivox::{Geometry, SurfaceMaterial, VoxelizeMethod};

use crate::voxelize::overlap::unit_grid;
use crate::voxelize::read::{Lab, ReadList};
use crate::voxelize::scenes::Mesh;

/// Voxels along the grid's edges, and metres.
const EDGE: f32 = 16.0;

/// Lobes.
const UP: u32 = 2;
const DOWN: u32 = 3;

const WALL_REFLECTANCE: f32 = 0.2;
const PANEL_REFLECTANCE: f32 = 0.6;

/// A square that looks down, cut into `cells` * `cells` squares.
fn ceiling(height: f32, (low, high): (f32, f32), cells: u32) -> Mesh {
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

/// A wall and a glowing panel below it, both of which look down.
#[derive(Clone)]
struct Layers {
    wall: Mesh,
    panel: Mesh,
    double_sided: bool,
    panel_first: bool,
    /// Of the wall and the panel.
    is_static: [bool; 2],
}

impl Layers {
    /// The wall fills the grid's cross-section; the panel is `gap` voxels below, from `panel.0` to `panel.1`.
    fn new(height: f32, gap: f32, panel: (f32, f32)) -> Self {
        Self {
            wall: ceiling(height, (0.0, EDGE), 1),
            panel: ceiling(height - gap, panel, 1),
            double_sided: false,
            panel_first: false,
            is_static: [false; 2],
        }
    }

    fn voxelize(&self, lab: &Lab) -> ReadList {
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
        lab.voxelize(&unit_grid(EDGE as u32), &Geometry { batches, materials })
    }
}

/// The face of that lobe in the middle column's voxel at y = 8.
fn middle_face(list: &ReadList, lobe: u32) -> FaceRecord {
    *list
        .faces
        .iter()
        .find(|face| face.lobe == lobe && list.voxel(face.voxel) == [8, 8, 8])
        .expect("a face")
}

fn assert_is_panel(face: &FaceRecord, height: f32, case: &str) {
    let (emission, reflectance) = (face.emission[0], face.reflectance[0]);
    assert!((emission - 8.0).abs() < 1e-3, "{case}: emits {emission}, not 8");
    assert!((reflectance - PANEL_REFLECTANCE).abs() < 1e-3, "{case}: reflects {reflectance}");
    let apart = face.position_in_world[1] - height;
    assert!(apart.abs() < 1e-3, "{case}: {apart} voxels off the panel");
    let area = face.vector_area;
    assert!((area[1] + 1.0).abs() < 1e-3, "{case}: an area of {area:?}");
}

#[test]
fn a_panel_hides_the_wall_behind_it() {
    let exact = Lab::new();
    for method in VoxelizeMethod::ALL {
        let lab = exact.switched_to(method);
        for gap in [0.001, 0.1, 0.8] {
            for (double_sided, panel_first) in [(false, false), (false, true), (true, false)] {
                let layers = Layers::new(8.9, gap, (0.0, EDGE));
                let list = Layers { double_sided, panel_first, ..layers }.voxelize(&lab);
                let case = format!("{}, {gap} voxels, {double_sided}", method.name());
                assert_is_panel(&middle_face(&list, DOWN), 8.9 - gap, &case);
                if double_sided {
                    let above = middle_face(&list, UP);
                    assert!(above.emission[0] < 1e-3, "{case}: the wall is seen, not {above:?}");
                }
            }
        }
    }
}

#[test]
fn half_a_panel_hides_half_of_the_wall() {
    // The panel ends in the middle of the voxel, along x and z: a quarter of it is the panel's.
    let list = Layers::new(8.6, 0.2, (0.0, 8.5)).voxelize(&Lab::new());
    let face = middle_face(&list, DOWN);
    let expected = 0.25 * PANEL_REFLECTANCE + 0.75 * WALL_REFLECTANCE;
    assert!((face.emission[0] - 2.0).abs() < 1e-3, "{face:?}");
    assert!((face.reflectance[0] - expected).abs() < 1e-3, "{face:?}");
    assert!((face.position_in_world[1] - 8.55).abs() < 1e-3, "{face:?}");
    assert!((face.vector_area[1] + 1.0).abs() < 1e-3, "{face:?}");
}

#[test]
fn fine_meshes_hide_as_well() {
    let lab = Lab::new();
    let layers = Layers::new(8.5, 0.1, (0.0, EDGE));
    // Cells of half a voxel, and smaller than the raster's points are apart.
    for cells in [37, 150] {
        let layers = Layers {
            wall: ceiling(8.5, (0.0, EDGE), cells),
            panel: ceiling(8.4, (0.0, EDGE), cells + 3),
            ..layers.clone()
        };
        let face = middle_face(&layers.voxelize(&lab), DOWN);
        assert_is_panel(&face, 8.4, &format!("{cells} cells"));
    }
}

#[test]
fn what_moves_hides_what_is_static_and_the_other_way_round() {
    let lab = Lab::new();
    for is_static in [[true, false], [false, true]] {
        let layers = Layers { is_static, ..Layers::new(8.9, 0.1, (0.0, EDGE)) };
        assert_is_panel(&middle_face(&layers.voxelize(&lab), DOWN), 8.8, &format!("{is_static:?}"));
    }
}

#[test]
fn nothing_hides_what_is_beside_it() {
    // A step of two squares in one voxel, at different heights, and a wall across: more surface than one layer.
    let mut layers = Layers::new(8.8, 0.5, (0.0, EDGE));
    let square = |x: (f32, f32), y: f32| {
        [[x.0, 0.0], [x.1, 0.0], [x.1, EDGE], [x.0, EDGE]].map(|[x, z]| Vec3::new(x, y, z))
    };
    layers.wall = Mesh::default();
    layers.wall.quad(square((8.5, EDGE), 8.8));
    layers.panel = Mesh::default();
    layers.panel.quad(square((0.0, 8.5), 8.3));
    layers.panel.quad(
        [[0.0, 0.0], [EDGE, 0.0], [EDGE, EDGE], [0.0, EDGE]].map(|[x, y]| Vec3::new(x, y, 8.5)),
    );
    let face = middle_face(&layers.voxelize(&Lab::new()), DOWN);
    let mean = 0.5 * (PANEL_REFLECTANCE + WALL_REFLECTANCE);
    assert!((face.reflectance[0] - mean).abs() < 1e-3, "{face:?}");
    assert!((face.emission[0] - 4.0).abs() < 1e-3, "{face:?}");
}
