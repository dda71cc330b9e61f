//! Tests of scenes that move between pictures: reused resources must not affect the result.

#![allow(clippy::float_cmp)] // Equal to the bit is the claim.

use glam::{Mat4, UVec2, Vec3};
use lumivox::TraceSettings;
use lumivox_render::{RenderError, RenderSettings, Renderer};
use lumivox_scene::{Camera, Instance, Scene};

use crate::common::{builtin, gpu, picture, renderer};

fn settings(scenes: &[&Scene]) -> RenderSettings {
    let bounds = scenes.iter().map(|scene| scene.bounds()).reduce(lumivox_scene::Bounds::union);
    RenderSettings {
        size: UVec2::new(48, 27),
        resolution: 32,
        frames: 2,
        shadow_resolution: 128,
        grid_bounds: bounds,
        ..RenderSettings::default()
    }
}

/// Cornell, and Cornell with the last instance moved, a mesh bent, and the lamp elsewhere.
fn poses() -> (Scene, Scene) {
    let rest = builtin("cornell");
    let mut moved = rest.clone();
    let last = moved.instances.len() - 1;
    let up = Mat4::from_translation(Vec3::new(0.1, 0.2, -0.1));
    moved.instances[last].world_from_local = up * moved.instances[last].world_from_local;
    let mesh = moved.instances[last].mesh;
    for position in &mut moved.meshes[mesh].positions {
        position.y *= 0.75;
    }
    for light in &mut moved.lights {
        light.position.x += 0.2;
    }
    (rest, moved)
}

/// Buffers keep their capacity; no other memory remains.
fn assert_no_leak(travelling: &Renderer, fresh: &Renderer) {
    let bytes =
        |renderer: &Renderer| renderer.memory().iter().map(|part| part.bytes).sum::<u64>() as f64;
    let [was, is] = [fresh, travelling].map(bytes);
    assert!((0.9 * was..1.3 * was).contains(&is), "{is} bytes, a fresh renderer has {was}");
}

/// Instances of one mesh share a draw call; single instances in it can move or change in other
/// ways.
#[test]
#[ignore = "slow: over three seconds"]
fn moved_instances_match_a_fresh_renderer() {
    let gpu = gpu();
    let mut rest = builtin("cornell");
    let block = rest.instances[4].clone();
    for number in 0..5 {
        let place = Mat4::from_translation(Vec3::new(0.0, 0.25 * number as f32, 0.0));
        let world_from_local = place * block.world_from_local * Mat4::from_scale(Vec3::splat(0.3));
        rest.instances.push(Instance { world_from_local, is_static: false, ..block.clone() });
    }
    let settings = settings(&[&rest]);
    let mut travelling = renderer(&gpu, &rest, settings.clone());
    let first = picture(&mut travelling);
    let last = rest.instances.len() - 1;
    let mut scene = rest.clone();
    let shift = |scene: &mut Scene, number: usize, by: Vec3| {
        let place = &mut scene.instances[number].world_from_local;
        *place = Mat4::from_translation(by) * *place;
    };
    let mut step = |scene: &Scene, moved: &[usize], what: &str| {
        pollster::block_on(travelling.move_instances(scene, moved, &mut |_| {})).expect("it fits");
        let seen = picture(&mut travelling);
        let mut fresh = renderer(&gpu, scene, settings.clone());
        assert!(seen == picture(&mut fresh), "{what}: it differs from a fresh renderer's");
        assert_eq!(travelling.voxel_stats().voxels, fresh.voxel_stats().voxels, "{what}");
        assert_no_leak(&travelling, &fresh);
        assert!(seen != first, "{what}: it shows");
    };
    shift(&mut scene, last, Vec3::new(0.2, -0.3, 0.1));
    step(&scene, &[last], "the last one");
    shift(&mut scene, last - 2, Vec3::new(-0.3, 0.0, 0.2));
    shift(&mut scene, 0, Vec3::X * 0.05);
    step(&scene, &[0, last - 2], "one among others, and walls");
    scene.instances[last - 1].is_hidden = true;
    step(&scene, &[last - 1], "one that is hidden");
    scene.instances[last - 1].is_hidden = false;
    scene.instances[last - 3].world_from_local *= Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    step(&scene, &[last - 3, last - 1], "one that is mirrored, and one that is back");
}

/// Unchanged static instances are not voxelized again, and pictures equal a new renderer's.
#[test]
#[ignore = "slow: over three seconds"]
fn unchanged_static_instances_are_not_voxelized_again() {
    let gpu = gpu();
    let (mut rest, mut moved) = poses();
    for scene in [&mut rest, &mut moved] {
        if let Some(last) = scene.instances.last_mut() {
            last.is_static = false;
        }
    }
    let mut hidden = rest.clone();
    hidden.instances.pop();
    let mut shifted = moved.clone();
    shifted.instances[0].world_from_local =
        Mat4::from_translation(Vec3::X * 0.1) * rest.instances[0].world_from_local;
    // Depending on bounces in the voxels, all light is stored, or only changes.
    for bounces in [1, 3] {
        let settings = RenderSettings { bounces, ..settings(&[&rest, &moved]) };
        let mut travelling = renderer(&gpu, &rest, settings.clone());
        let poses =
            [(&moved, true), (&rest, true), (&hidden, true), (&moved, true), (&shifted, false)];
        let poses = if bounces == 1 { vec![poses[0], poses[4]] } else { poses.to_vec() };
        for (step, (pose, is_kept)) in poses.into_iter().enumerate() {
            pollster::block_on(travelling.set_scene(pose, &mut |_| {})).expect("the same scene");
            assert_eq!(travelling.voxel_stats().static_reused, is_kept, "step {step}");
            let seen = picture(&mut travelling);
            let mut fresh = renderer(&gpu, pose, settings.clone());
            assert!(!fresh.voxel_stats().static_reused);
            assert!(seen == picture(&mut fresh), "step {step}, {bounces} bounces: it differs");
            assert_eq!(travelling.voxel_stats().voxels, fresh.voxel_stats().voxels, "step {step}");
            // Hidden geometry keeps its memory.
            if pose.instances.len() == rest.instances.len() {
                assert_no_leak(&travelling, &fresh);
            }
        }
    }
}

#[test]
fn a_camera_that_moves_and_returns_finds_the_same_picture() {
    let (rest, _) = poses();
    let mut renderer = renderer(&gpu(), &rest, settings(&[&rest]));
    let camera = renderer.camera().clone();
    let first = picture(&mut renderer);
    let position = camera.position + Vec3::new(0.3, 0.1, 0.0);
    renderer.set_camera(Camera { position, ..camera.clone() });
    assert!(picture(&mut renderer) != first);
    renderer.set_camera(camera);
    assert!(picture(&mut renderer) == first);
}

#[test]
fn the_grid_covers_the_given_bounds() {
    let (rest, moved) = poses();
    let mut settings = settings(&[&rest]);
    let bounds = rest.bounds();
    settings.grid_bounds = Some(lumivox_scene::Bounds { min: bounds.min, max: bounds.max * 3.0 });
    let mut renderer = renderer(&gpu(), &rest, settings);
    let grid = *renderer.gi().grid();
    assert!(grid.voxel_size_m > bounds.size().max_element() / 16.0);
    pollster::block_on(renderer.set_scene(&moved, &mut |_| {})).expect("the same scene");
    assert_eq!(*renderer.gi().grid(), grid);
}

#[test]
fn set_scene_refuses_a_different_scene() {
    let (rest, _) = poses();
    let mut renderer = renderer(&gpu(), &rest, settings(&[&rest]));
    let error = pollster::block_on(renderer.set_scene(&builtin("spheres"), &mut |_| {}));
    let error = error.expect_err("other materials");
    assert!(matches!(error, RenderError::Setting { .. }), "{error}");
    assert!(error.to_string().contains("materials"), "{error}");
}

/// Frames that do not wait have the voxels and shadows of a new renderer at once, and its light
/// after some frames.
#[test]
#[ignore = "slow: over three seconds"]
fn frames_after_a_move_converge_to_a_fresh_renderer() {
    let gpu = gpu();
    let mut rest = builtin("cornell");
    let block = rest.instances.len() - 1;
    rest.instances[block].is_static = false;
    let mut moved = rest.clone();
    let up = Mat4::from_translation(Vec3::new(0.1, 0.2, -0.1));
    moved.instances[block].world_from_local = up * moved.instances[block].world_from_local;
    for light in &mut moved.lights {
        light.position.x += 0.2;
    }
    let settings = RenderSettings { frames: 1, bounces: 16, ..settings(&[&rest, &moved]) };
    let mut fresh = renderer(&gpu, &moved, settings.clone());
    let expected = picture(&mut fresh);
    let mut travelling = renderer(&gpu, &rest, RenderSettings { bounces: 1, ..settings });
    let mut frames = Vec::new();
    for _ in 0..16 {
        let voxels =
            pollster::block_on(travelling.render_moved(&moved, &[block])).expect("it fits");
        gpu.wait("testing").expect("the device works");
        frames.push((voxels, picture(&mut travelling)));
    }
    let mean = |picture: &lumivox_render::Picture| {
        let sum: f64 = picture.hdr.iter().map(|pixel| f64::from(pixel[1])).sum();
        sum / picture.hdr.len() as f64
    };
    let late = frames.iter().filter(|(voxels, _)| voxels.is_late).count();
    let (last, seen) = frames.last().expect("there are frames");
    assert!(late < 8 && !last.is_late, "{late} frames were late");
    assert_eq!(last.voxels, fresh.voxel_stats().voxels);
    let error = |picture| (mean(picture) / mean(&expected) - 1.0).abs();
    assert!(error(seen) < 0.01, "{} is off by {}", mean(seen), error(seen));
    assert!(error(&frames[0].1) > error(seen), "light comes bounce by bounce");
    for renderer in [&mut travelling, &mut fresh] {
        renderer.set_view(lumivox_render::View::Direct, 0).expect("it has this view");
    }
    assert!(
        picture(&mut travelling) == picture(&mut fresh),
        "the block and its shadows are in place"
    );
}

/// A block grows twentyfold in a single step and overflows the buffers. The overflow is known a
/// frame later, when nothing moves; the picture is incomplete until the voxels are up to date.
#[test]
#[ignore = "slow: over three seconds"]
fn a_change_that_overflows_buffers_is_completed_later() {
    let gpu = gpu();
    let mut grown = builtin("cornell");
    let block = grown.instances.len() - 1;
    grown.instances[block].is_static = false;
    let mut small = grown.clone();
    small.instances[block].world_from_local *= Mat4::from_scale(Vec3::splat(0.05));
    let settings = RenderSettings {
        resolution: 96,
        bounces: 8,
        trace: TraceSettings { temporal: true, ..TraceSettings::default() },
        ..settings(&[&small, &grown])
    };
    let mut travelling = renderer(&gpu, &small, settings.clone());
    picture(&mut travelling);
    pollster::block_on(travelling.move_instances(&grown, &[block], &mut |_| {})).expect("it fits");
    picture(&mut travelling);
    let told = travelling.gi().status();
    assert!(!told.is_late && !told.is_pending && travelling.is_complete(), "{told:?}");
    assert_eq!(told.voxels, renderer(&gpu, &grown, settings).voxel_stats().voxels);
}
