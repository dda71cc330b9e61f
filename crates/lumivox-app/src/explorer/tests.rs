use glam::Vec3;

use super::*;

#[test]
fn placements_go_there_and_back() {
    let placement = Placement {
        position: Vec3::new(1.0, -2.0, 3.0),
        rotation_deg: Vec3::new(30.0, -40.0, 100.0),
        scale: Vec3::new(1.0, 2.0, 0.5),
    };
    let back = Placement::of(placement.matrix());
    assert!(back.position.abs_diff_eq(placement.position, 1e-5), "{back:?}");
    assert!(back.rotation_deg.abs_diff_eq(placement.rotation_deg, 1e-3), "{back:?}");
    assert!(back.scale.abs_diff_eq(placement.scale, 1e-5), "{back:?}");
}
