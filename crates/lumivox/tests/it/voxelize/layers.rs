//! Surfaces one behind the other in a voxel: what is seen is the front one.

use glam::Vec3;

use crate::voxelize::panels::{
    DOWN, EDGE, Layers, PANEL_REFLECTANCE, WALL_REFLECTANCE, assert_hides, assert_is_panel,
    ceiling, middle_face,
};
use crate::voxelize::read::Lab;
use crate::voxelize::scenes::Mesh;

#[test]
fn a_panel_hides_the_wall_behind_it() {
    assert_hides(&Lab::new(), "exact");
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
