//! Tests which surface is walked again when boxes move, or static draws are added or removed.

use super::*;

/// Asserts that the voxels have the bits of a new clipmap at the place.
#[track_caller]
fn assert_fresh(lit: &Lit, geometry: &Geometry, place: Vec3) {
    let fresh = Lit::of(geometry, cascades(place, 3, 32), &[], Vec3::ONE, 0).faces();
    let own = lit.faces();
    assert_eq!(own.len(), fresh.len());
    for (key, face) in &fresh {
        let is_same = bytemuck::bytes_of(&own[key]) == bytemuck::bytes_of(face);
        assert!(is_same, "{key:?}: {:?}, not {face:?}", own[key]);
    }
}

/// Only surface that has entered moved boxes is walked. After any move, the voxels equal those of a
/// new clipmap.
#[test]
#[ignore = "slow: over three seconds"]
fn only_surface_entering_the_boxes_is_voxelized() {
    let (device, _) = device();
    let floor = || {
        let size = Vec3::new(6.0, 0.0, 6.0);
        let [x, z] = [Vec3::X * size.x, Vec3::Z * size.z];
        room().quad(ROOM - 0.5 * size - 0.1 * Vec3::Y, z, x, lambert(0.5, 0.0)).fixed()
    };
    let start = ROOM + Vec3::new(0.5, 0.35, 0.45);
    let stride = STRIDE as f32 * VOXEL_M;
    let mut lit = Lit::new(floor(), cascades(start, 3, 32), &[], Vec3::ONE, 1);
    let geometry = floor().build(&device);
    pollster::block_on(lit.gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    // The first move walks everything, since no static surface is kept before.
    lit.follow(&geometry, start + stride * Vec3::X);
    let all = lit.gi.static_items();
    let offsets = [
        ([2.0, 0.0, 0.0], 4),
        ([-2.0, 1.0, 0.0], 1),
        ([-1.0, 0.0, -4.0], 1),
        ([14.0, 0.0, 0.0], 0),
    ];
    for (offset, less) in offsets {
        let place = start + stride * Vec3::from(offset);
        let frames = lit.follow(&geometry, place);
        let items = lit.gi.static_items();
        println!("{items} of {all} items after {frames} frames");
        assert!(items * less <= all, "{items} of {all} at {offset:?}");
        assert_fresh(&lit, &floor().build(&device), place);
    }
}

/// A room with small plates in it, all static.
fn plates() -> SceneBuilder {
    (0..16_u8)
        .fold(room(), |scene, plate| {
            let share = |step: f32| (step * f32::from(plate)).fract();
            let place = Vec3::new(share(0.8191), share(0.6711), share(0.5497));
            let corner = ROOM + Vec3::new(0.8, 0.5, 0.7) * place + 0.05;
            scene.quad(corner, Vec3::new(0.08, 0.02, 0.0), 0.08 * Vec3::Z, lambert(0.6, 0.0))
        })
        .fixed()
}

/// The geometry without some of its draws.
fn without(geometry: &Geometry, gone: &[usize]) -> Geometry {
    let mut geometry = geometry.clone();
    let mut number = 0..;
    geometry.batches[0].draws.retain(|_| !gone.contains(&number.next().expect("without end")));
    geometry
}

/// If static draws are added or removed while boxes move, only their surroundings are walked, and
/// the voxels equal those of a new clipmap.
#[test]
#[ignore = "slow: over three seconds"]
fn only_surface_near_changed_draws_is_voxelized() {
    let geometry = plates().build(&device().0);
    let start = ROOM + Vec3::new(0.5, 0.35, 0.45);
    let stride = STRIDE as f32 * VOXEL_M;
    let last = geometry.batches[0].draws.len() - 1;
    let mut lit = Lit::of(&geometry, cascades(start, 3, 32), &[], Vec3::ONE, 1);
    lit.follow(&geometry, start + stride * Vec3::X);
    let all = lit.gi.static_items();
    let moves: [(&[usize], f32, u64); 3] =
        [(&[last], 1.0, 4), (&[], 1.0, 2), (&[last - 5], 2.0, 1)];
    for (gone, along, less) in moves {
        let place = start + along * stride * Vec3::X;
        let now = without(&geometry, gone);
        let frames = lit.follow(&now, place);
        let items = lit.gi.static_items();
        println!("without {gone:?}: {items} of {all} items after {frames} frames");
        assert!(items * less <= all, "{items} of {all} without {gone:?}");
        assert_fresh(&lit, &now, place);
    }
    // With another material everything is walked.
    let mut painted = geometry.clone();
    painted.materials[last].reflectance.x = 0.1;
    lit.follow(&painted, start + 2.0 * stride * Vec3::X);
    assert_fresh(&lit, &painted, start + 2.0 * stride * Vec3::X);
}

/// Even if draws are added or removed in every frame, the voxels are updated, a few frames late.
#[test]
#[ignore = "slow: over three seconds"]
fn voxels_follow_draws_that_change_every_frame() {
    let geometry = plates().build(&device().0);
    let start = ROOM + Vec3::new(0.5, 0.35, 0.45);
    let first = geometry.batches[0].draws.len() - 16;
    let mut lit = Lit::of(&geometry, cascades(start, 3, 32), &[], Vec3::ONE, 1);
    let mut counts = std::collections::BTreeSet::new();
    for frame in 0..40 {
        let gone: Vec<usize> = (0..frame % 16).map(|plate| first + plate).collect();
        counts.insert(lit.frame(&without(&geometry, &gone)).voxels);
    }
    assert!(counts.len() > 4, "{counts:?}");
    lit.follow(&geometry, start);
    assert_fresh(&lit, &geometry, start);
}

/// If a static draw is removed and added again before the voxels without it are ready, the earlier
/// voxels are kept.
#[test]
#[ignore = "slow: over three seconds"]
fn voxels_are_kept_if_a_draw_returns_at_once() {
    let geometry = plates().build(&device().0);
    let place = ROOM + Vec3::new(0.5, 0.35, 0.45);
    let gone = without(&geometry, &[geometry.batches[0].draws.len() - 1]);
    let mut lit = Lit::of(&geometry, cascades(place, 3, 32), &[], Vec3::ONE, 1);
    lit.follow(&geometry, place);
    assert!(lit.frame(&gone).is_late);
    assert_eq!(lit.follow(&geometry, place), 1);
    assert_fresh(&lit, &geometry, place);
}
