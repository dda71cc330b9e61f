//! Surfaces one behind the other in a voxel: a face for each plane.

use crate::voxelize::panels::{
    DOWN, EDGE, Layers, PANEL, WALL, assert_are_apart, assert_is, ceiling, middle_faces,
};
use crate::voxelize::read::Lab;

#[test]
fn a_panel_and_the_wall_behind_it_are_two_faces() {
    assert_are_apart(&Lab::new(), "exact");
}

#[test]
fn a_face_records_the_covered_part_of_its_voxel() {
    // The panel ends in the middle of the voxel, along x and z: a quarter of the voxel's side.
    let list = Layers::new(8.6, 0.2, (0.0, 8.5)).voxelize(&Lab::new());
    let faces = middle_faces(&list, DOWN);
    let [panel, wall] = faces.as_slice() else { panic!("{faces:?}") };
    assert_is(wall, WALL, 8.6, "the wall");
    assert!((panel.emission[0] - 8.0).abs() < 1e-3, "{panel:?}");
    assert!((panel.vector_area[1] + 0.25).abs() < 1e-3, "{panel:?}");
    // The lower halves of x and z, and the next bit, which the border touches.
    assert_eq!([panel.profiles[0], panel.profiles[1]], [0x1ffff; 2], "{panel:?}");
    assert_eq!([panel.mask_low, panel.mask_high], [0x1f1f_1f1f, 0x1f], "{panel:?}");
    // The quarter's diagonals: u + v up to a half, u - v up to a quarter to both sides.
    assert_eq!(panel.profiles[2], 0x1ffff, "{panel:?}");
    assert_eq!(panel.profiles[3] & 0xff, 0x80, "{panel:?}");
}

#[test]
fn finely_tessellated_planes_become_single_faces() {
    let lab = Lab::new();
    let layers = Layers::new(8.5, 0.1, (0.0, EDGE));
    // Cells of half a voxel, and of a tenth.
    for cells in [37, 150] {
        let layers = Layers {
            wall: ceiling(8.5, (0.0, EDGE), cells),
            panel: ceiling(8.4, (0.0, EDGE), cells + 3),
            ..layers.clone()
        };
        let faces = middle_faces(&layers.voxelize(&lab), DOWN);
        assert_eq!(faces.len(), 2, "{cells} cells: {faces:?}");
        assert_is(&faces[0], PANEL, 8.4, &format!("{cells} cells"));
        assert_is(&faces[1], WALL, 8.5, &format!("{cells} cells"));
    }
}

#[test]
fn static_and_dynamic_surface_get_separate_faces() {
    let lab = Lab::new();
    for is_static in [[true, false], [false, true]] {
        for gap in [0.0, 0.1] {
            let layers = Layers { is_static, ..Layers::new(8.9, gap, (0.0, EDGE)) };
            let mut faces = middle_faces(&layers.voxelize(&lab), DOWN);
            // At equal heights faces are in the order of shares.
            faces.sort_by(|a, b| b.emission[0].total_cmp(&a.emission[0]));
            assert_eq!(faces.len(), 2, "{is_static:?}: {faces:?}");
            assert_is(&faces[0], PANEL, 8.9 - gap, &format!("{is_static:?}"));
            assert_is(&faces[1], WALL, 8.9, &format!("{is_static:?}"));
        }
    }
}
