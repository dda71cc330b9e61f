//! Tests of hidden and unvoxelized instances, and of a scene's own grid bounds.

use std::ops::ControlFlow;

use glam::{UVec2, Vec3};
use lumivox_render::reference::{PathTracer, ReferenceSettings};
use lumivox_render::{MemoryEstimate, RenderError, RenderSettings, Renderer, View};
use lumivox_scene::{Bounds, Scene};

use crate::common::{builtin, gpu, picture, renderer};

fn settings() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 27),
        resolution: 32,
        frames: 2,
        shadow_resolution: 128,
        ..RenderSettings::default()
    }
}

/// The Cornell box, the box with one marked instance, and the box without that instance. All have
/// the same grid bounds.
fn marked(mark: impl Fn(&mut lumivox_scene::Instance)) -> (Scene, Scene, Scene) {
    let mut all = builtin("cornell");
    all.grid_bounds = Some(all.bounds());
    let (mut marked, mut without) = (all.clone(), all.clone());
    let block = all.instances.iter().position(|instance| instance.name == "tall block");
    let block = block.expect("it has a tall block");
    mark(&mut marked.instances[block]);
    without.instances.remove(block);
    (all, marked, without)
}

#[test]
fn hidden_instances_do_not_affect_the_picture() {
    let gpu = gpu();
    let (all, hidden, without) = marked(|instance| instance.is_hidden = true);
    let full = picture(&mut renderer(&gpu, &all, settings()));
    let mut toggled = renderer(&gpu, &hidden, settings());
    let mut bare = renderer(&gpu, &without, settings());
    let expected = picture(&mut bare);
    assert!(picture(&mut toggled) == expected, "it is not drawn, lit or in the voxels");
    assert!(full != expected, "the instance can be seen");
    assert_eq!(toggled.voxel_stats().voxels, bare.voxel_stats().voxels);
    // Show the instance and hide it again in the same renderer.
    for (scene, seen) in [(&all, &full), (&hidden, &expected)] {
        pollster::block_on(toggled.set_scene(scene, &mut |_| {})).expect("the same scene");
        assert!(picture(&mut toggled) == *seen);
    }
}

#[test]
fn reference_rays_ignore_hidden_instances() {
    let gpu = gpu();
    let (all, hidden, without) = marked(|instance| instance.is_hidden = true);
    let settings = ReferenceSettings { size: UVec2::new(24, 14), ..ReferenceSettings::default() };
    let trace = |scene: &Scene| {
        pollster::block_on(async {
            let mut reference = PathTracer::new(&gpu, scene, None, settings.clone()).await?;
            reference.render_batch(&mut |_| ControlFlow::Continue(())).await?;
            Ok::<_, RenderError>(reference.layers())
        })
        .expect("a reference")
    };
    let (full, seen, expected) = (trace(&all), trace(&hidden), trace(&without));
    assert!(seen.radiance == expected.radiance);
    assert!(full.radiance != expected.radiance);
}

#[test]
fn unvoxelized_instances_are_still_drawn() {
    let gpu = gpu();
    let (all, unvoxelized, without) = marked(|instance| instance.is_voxelized = false);
    let [mut full, mut marked, mut bare] =
        [&all, &unvoxelized, &without].map(|scene| renderer(&gpu, scene, settings()));
    let show = |renderer: &mut Renderer, view| {
        let settings = RenderSettings { view, ..settings() };
        pollster::block_on(renderer.set_settings(settings, &mut |_| {})).expect("valid");
        picture(renderer)
    };
    for view in [View::Albedo, View::Direct] {
        let is_shown = show(&mut full, view) == show(&mut marked, view);
        assert!(is_shown, "{view:?} shows it, with its shadow");
    }
    let voxels = |renderer: &Renderer| renderer.voxel_stats().voxels;
    assert_eq!(voxels(&marked), voxels(&bare));
    assert!(voxels(&full) > voxels(&bare));
    // The voxels are the same.
    let [seen, expected] = [&mut marked, &mut bare].map(|renderer| show(renderer, View::Voxels));
    let closer = |(a, b): (&[f32; 4], &[f32; 4])| (a[3] - b[3]).abs() < 1e-6;
    assert!(seen.hdr.iter().zip(&expected.hdr).all(closer));
}

#[test]
fn estimates_ignore_hidden_and_unvoxelized_instances() {
    let (all, hidden, without) = marked(|instance| instance.is_hidden = true);
    let (_, unvoxelized, _) = marked(|instance| instance.is_voxelized = false);
    let estimate = |scene: &Scene| MemoryEstimate::new(scene, &settings()).expect("an estimate");
    let bytes = |scene: &Scene, name: &str| {
        let parts = estimate(scene).parts;
        parts.iter().find(|part| part.name.starts_with(name)).expect("such a part").bytes
    };
    assert_eq!(estimate(&hidden).voxels, estimate(&without).voxels);
    assert_eq!(estimate(&unvoxelized).voxels, estimate(&without).voxels);
    assert!(estimate(&all).voxels > estimate(&without).voxels);
    assert_eq!(bytes(&hidden, "instances"), bytes(&without, "instances"));
    assert_eq!(bytes(&unvoxelized, "instances"), bytes(&all, "instances"));
}

#[test]
fn the_grid_covers_scene_bounds_unless_settings_override() {
    let gpu = gpu();
    let mut scene = builtin("cornell");
    let own = scene.bounds();
    let wide = Bounds { min: own.min - Vec3::splat(0.5), max: own.max + Vec3::splat(0.5) };
    let grid = |scene: &Scene, settings: RenderSettings| {
        let renderer: Renderer = renderer(&gpu, scene, settings);
        *renderer.gi().grid()
    };
    let plain = grid(&scene, settings());
    scene.grid_bounds = Some(wide);
    let wider = grid(&scene, settings());
    let expected = lumivox::Grid::fit(wide.min, wide.max, 32, Vec3::ZERO).expect("a grid");
    assert_eq!(wider, expected);
    let forced = RenderSettings { grid_bounds: Some(own), ..settings() };
    assert_eq!(grid(&scene, forced), plain);
    assert!(wider.voxel_size_m > plain.voxel_size_m);
}
