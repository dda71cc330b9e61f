//! Frames with an octree, whose own buffers may overflow.

use super::*;

/// The octree's buffers overflow while those of the voxels do not: it keeps its content, even if
/// light changes, and later applies all missed changes.
#[test]
#[ignore = "slow: over three seconds"]
fn an_overflowing_octree_keeps_its_former_content() {
    let volume = VolumeKind::Octree;
    let mut stage = Stage::with(volume, Vec3::new(1.0, 0.7, 0.9), 64);
    // A box and a plate in the air that grow and turn.
    let geometry = room_with_a_box().build(&stage.device);
    let sized = |size: f32, turn: f32| {
        let place = at(0.5, 0.35, 0.45) * Mat4::from_rotation_y(turn);
        moved(&geometry, place * Mat4::from_scale(Vec3::splat(size)))
    };
    stage.catch_up(&sized(0.5, 0.0));
    let lamp = |stage: &Stage, x| stage.lamp(Vec3::new(x, 0.4, 0.7), Vec3::ONE);
    let lights = lamp(&stage, 0.2);
    stage.light(&lights, 2);
    let nodes = |stage: &Stage| read_nodes(&stage.device, &stage.queue, &stage.gi);
    let mut late = 0;
    for step in 1..10 {
        let before = nodes(&stage);
        let grown = sized(0.5 + 0.4 * step as f32, 0.6 * step as f32);
        stage.voxelize(&grown);
        let voxels = stage.gi.voxels().expect("a list").voxel_count();
        let lights = lamp(&stage, 0.2 + 0.02 * step as f32);
        stage.light(&lights, 2);
        if stage.overflows() {
            late += 1;
            assert!(nodes(&stage) == before, "step {step} ({voxels} voxels) has changed something");
        }
    }
    assert!(late > 0, "there was room all the time");
    let last = sized(4.1, 5.4);
    stage.catch_up(&last);
    stage.assert_fresh(&last, "in the end");
}
