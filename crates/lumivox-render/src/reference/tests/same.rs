//! Tests that results are bit-identical, however they are traced, and that pictures are equal at
//! any scale.

use std::ops::ControlFlow;

use super::*;

fn zoo() -> Scene {
    zoo::scene()
}

fn small() -> ReferenceSettings {
    ReferenceSettings { size: UVec2::new(24, 14), samples: 40, ..ReferenceSettings::default() }
}

#[test]
#[ignore = "slow: over three seconds"]
fn bands_and_interruptions_do_not_change_the_bits() {
    let scene = zoo();
    let whole = traced(&scene, &small());
    assert!(whole == traced(&scene, &small()), "two runs differ");

    let mut banded = tracer(&scene, &small());
    banded.uploaded.band_rows = 3;
    let mut last = 0.0;
    let mut hear = |progress: super::super::ReferenceProgress| {
        assert!(progress.samples > last && progress.total == 40, "{progress:?} after {last}");
        last = progress.samples;
        ControlFlow::Continue(())
    };
    pollster::block_on(banded.render(&mut hear)).expect("a reference");
    assert_eq!(last, 40.0);
    assert!(whole == banded.layers(), "bands differ");

    // A break between batches does not change a bit.
    let mut first = tracer(&scene, &small());
    let mut go_on = |_| ControlFlow::Continue(());
    let is_more = pollster::block_on(first.render_batch(&mut go_on)).expect("a reference");
    assert!(is_more && first.samples() == 16);
    let mut second = tracer(&scene, &small());
    second.resume(&first.checkpoint()).expect("the same is traced");
    assert!(whole == finish(second), "what was resumed differs");
    assert!(whole == finish(first), "what was gone on with differs");
}

#[test]
fn a_stopped_render_drops_incomplete_samples() {
    let scene = zoo();
    let after_20 = |progress: super::super::ReferenceProgress| {
        if progress.samples >= 20.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut whole = tracer(&scene, &small());
    pollster::block_on(whole.render(&mut { after_20 })).expect("a reference");
    assert_eq!(whole.samples(), 20);
    assert_eq!(whole.layers().samples, 20);
    // Samples that only the first bands have are dropped.
    let mut banded = tracer(&scene, &small());
    banded.uploaded.band_rows = 3;
    pollster::block_on(banded.render(&mut { after_20 })).expect("a reference");
    assert_eq!(banded.samples(), 16);
    // At the end of a batch all samples are complete, and tracing can stop, too.
    let after_16 = |progress: super::super::ReferenceProgress| {
        if progress.samples >= 16.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut ended = tracer(&scene, &small());
    ended.uploaded.band_rows = 3;
    pollster::block_on(ended.render(&mut { after_16 })).expect("a reference");
    assert_eq!(ended.samples(), 16);
}

#[test]
fn another_seed_changes_only_the_noise() {
    let scene = builtin("cornell");
    let [a, b] = [0, 1].map(|seed| traced(&scene, &ReferenceSettings { seed, ..settings(16, 32) }));
    assert!(a != b, "seeds do nothing");
    Estimate::radiance(&a).assert_near("radiance", Estimate::radiance(&b));
    Estimate::full(&a).assert_near("irradiance", Estimate::full(&b));
}

#[test]
fn checkpoints_of_other_scenes_or_settings_are_refused() {
    let scene = builtin("cornell");
    let made = |scene: &Scene, settings: &ReferenceSettings| tracer(scene, settings);
    let checkpoint = made(&scene, &small()).checkpoint();
    let refused = |scene: &Scene, settings: &ReferenceSettings| {
        made(scene, settings).resume(&checkpoint).is_err()
    };
    assert!(!refused(&scene, &small()));
    assert!(!refused(&scene, &ReferenceSettings { samples: 99, ..small() }), "more may follow");
    assert!(refused(&scene, &ReferenceSettings { seed: 9, ..small() }));
    assert!(refused(&scene, &ReferenceSettings { bounces: Some(3), ..small() }));
    assert!(refused(&scene, &ReferenceSettings { occlusion_distance_m: 1.0, ..small() }));
    assert!(refused(&scene, &ReferenceSettings { size: UVec2::new(14, 24), ..small() }));
    let mut brighter = scene.clone();
    brighter.lights[0].color.x *= 0.5;
    assert!(refused(&brighter, &small()));
    let mut moved = scene.clone();
    moved.cameras[0].position.x += 0.01;
    assert!(refused(&moved, &small()));
    let mut painted = scene;
    painted.materials[0].emissive.y += 1.0;
    assert!(refused(&painted, &small()));
}

/// Powers of two change only exponents, so layers that do not depend on the unit of radiance are
/// unchanged.
#[test]
#[ignore = "slow: over three seconds"]
fn scaling_the_scene_does_not_change_the_result() {
    let scene = zoo();
    let whole = traced(&scene, &small());
    for factor in [1.0 / 1024.0, 1024.0] {
        let mut scaled = scene.clone();
        let scale = Mat4::from_scale(Vec3::splat(factor));
        scaled.instances.iter_mut().for_each(|i| i.world_from_local = scale * i.world_from_local);
        for camera in &mut scaled.cameras {
            camera.position *= factor;
            camera.near_m *= factor;
        }
        let layers = traced(&scaled, &small());
        assert_eq!(layers.coverage, whole.coverage);
        let depth: Vec<f32> = layers.depth_m.iter().map(|depth| depth / factor).collect();
        assert_eq!(depth, whole.depth_m);
        assert_eq!(layers.albedo, whole.albedo);
        // Rounding changes one path in thousands.
        Estimate::radiance(&layers).assert_near("scaled", Estimate::radiance(&whole));
        let same = layers.radiance.iter().zip(&whole.radiance).filter(|(a, b)| a == b).count();
        println!("{factor}: {same} of {} pixels to the bit", whole.radiance.len());
        assert!(2 * same > whole.radiance.len(), "only {same} pixels are the same");
    }
}

/// Parts of several tracers, added in any order, have the bits of a single run.
#[test]
#[ignore = "slow: over three seconds"]
fn merged_parts_equal_one_whole_run() {
    let scene = zoo();
    let whole = ReferenceSettings { samples: 48, ..small() };
    let part = |first_batch, samples| {
        let settings = ReferenceSettings { samples, first_batch, ..whole.clone() };
        let mut tracer = tracer(&scene, &settings);
        let mut go_on = |_| ControlFlow::Continue(());
        pollster::block_on(tracer.render(&mut go_on)).expect("a reference");
        let bytes = tracer.part().to_bytes();
        super::super::ReferencePart::from_bytes(&bytes).expect("a part")
    };
    let mut merge = super::super::ReferenceMerge::default();
    for part in [part(1, 32), part(0, 16)] {
        merge.add(part).expect("it fits");
    }
    let merged = merge.layers().expect("all batches").expect("layers");
    assert!(merged == traced(&scene, &whole));
}
