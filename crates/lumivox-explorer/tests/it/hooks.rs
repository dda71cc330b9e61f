//! The classics among other settings: pictures do not depend on earlier settings or on the order of
//! threads.

#![allow(clippy::float_cmp)] // Equal to the bit is the claim.

use glam::UVec2;
use lumivox_explorer::parameters::{find_parameter, find_preset};
use lumivox_render::{MemoryEstimate, MemoryUse, RenderError, RenderSettings, Renderer};

use crate::common::{builtin, gpu, own_gpu, picture, renderer};

fn small() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(40, 24),
        resolution: 32,
        frames: 2,
        bounces: 2,
        shadow_resolution: 128,
        ..RenderSettings::default()
    }
}

/// Sets a setting by its name.
fn take(settings: &mut RenderSettings, name: &str, value: &str) {
    let row = find_parameter(name).expect("a setting");
    row.set(settings, row.parse(value).expect("a value")).expect("in range");
}

fn set(renderer: &mut Renderer, settings: &RenderSettings) {
    pollster::block_on(renderer.set_settings(settings.clone(), &mut |_| {})).expect("in range");
}

#[test]
#[ignore = "slow: over three seconds"]
fn settings_may_change_in_any_order() {
    let (gpu, scene) = (gpu(), builtin("cornell"));
    let mut changing = renderer(&gpu, &scene, small());
    let mut before = picture(&mut changing);
    let mut asked = small();
    for (name, value) in [
        ("voxelizer", "dominant-axis"),
        ("injection", "photons"),
        ("voxelizer", "conservative"),
        ("level_gain", "4"),
        ("level_gain", "2"),
        ("jitter", "off"),
        ("volume", "octree"),
        ("voxelizer", "three-plane"),
        ("injection", "direct"),
        ("clear_of_walls", "off"),
        ("width_attenuation", "1"),
        ("voxelizer", "exact"),
        ("volume", "dense"),
        ("octree_builder", "locks"),
    ] {
        take(&mut asked, name, value);
        set(&mut changing, &asked);
        assert_eq!(*changing.settings(), asked);
        let seen = picture(&mut changing);
        let mut fresh = renderer(&gpu, &scene, asked.clone());
        assert!(seen == picture(&mut fresh), "{name} {value}: something of before is left");
        assert_eq!(changing.memory(), fresh.memory(), "{name} {value}");
        assert!(seen != before, "{name} {value} changed nothing");
        before = seen;
    }
    // Back to the physical settings.
    for (name, value) in [
        ("level_gain", "1"),
        ("jitter", "on"),
        ("clear_of_walls", "on"),
        ("width_attenuation", "0"),
    ] {
        take(&mut asked, name, value);
    }
    assert!(asked.cone_model.is_none());
}

#[test]
fn cones_out_of_range_are_refused_by_their_names() {
    let row = find_parameter("level_gain").expect("a setting");
    let error = row.parse("9").expect_err("too much");
    assert_eq!(error.to_string(), "level_gain is a number from 1 to 8 (factor); got \"9\"");
    let cones = lumivox_classics::report::ReportCones { level_gain: 9.0, ..Default::default() };
    let settings = RenderSettings { cone_model: cones.model(), ..small() };
    let error = settings.validate(&wgpu::Limits::default()).expect_err("too much");
    assert!(matches!(error, RenderError::Setting { name: "level_gain", .. }), "{error}");
}

/// Pictures have the same bits in every run, whichever builder builds the octree's nodes; only the
/// builder with locks has counts.
#[test]
#[ignore = "slow: over three seconds"]
fn pictures_are_equal_for_lock_and_rank_builders() {
    let gpu = gpu();
    let of = |builder: &str| {
        let mut settings = RenderSettings { frames: 3, shadow_resolution: 512, ..small() };
        take(&mut settings, "octree_builder", builder);
        let mut renderer = renderer(&gpu, &builtin("cornell"), settings);
        let bits = picture(&mut renderer).hdr.into_iter().map(|pixel| pixel.map(f32::to_bits));
        let counts = renderer.gi().octree_stats().expect("an octree").counts;
        (bits.collect::<Vec<_>>(), counts.into_iter().map(|(name, _)| name).collect::<Vec<_>>())
    };
    let (ranks, none) = of("ranks");
    assert_eq!(none, [""; 0]);
    for _ in 0..2 {
        let (locks, counts) = of("locks");
        assert!(locks == ranks, "the picture differs");
        assert_eq!(counts, ["lock_passes", "deferred"]);
    }
}

/// A dense volume has no nodes: choosing one, by name or by a preset, removes the builder of the
/// nodes.
#[test]
fn choosing_a_dense_volume_removes_the_octree_builder() {
    let mut settings = small();
    take(&mut settings, "octree_builder", "locks");
    assert!(matches!(settings.volume, lumivox::VolumeKind::Octree));
    assert!(settings.octree_builder.is_some());
    let report = settings.with_preset(find_preset("report").expect("a preset"), None);
    assert!(report.octree_builder.is_none(), "the preset's octree is built by ranks");
    take(&mut settings, "volume", "dense");
    assert!(settings.octree_builder.is_none());
    take(&mut settings, "volume", "octree");
    assert!(settings.octree_builder.is_none());
}

/// Settings that link other shaders are all chosen twice; the second time nothing is compiled.
#[test]
#[ignore = "slow: over three seconds"]
fn repeating_settings_compiles_no_new_pipelines() {
    let gpu = own_gpu();
    let mut renderer = renderer(&gpu, &builtin("cornell"), small());
    let mut go_round = || {
        for (name, value) in [
            ("voxelizer", "conservative"),
            ("injection", "photons"),
            ("octree_builder", "locks"),
            ("level_gain", "2"),
        ] {
            let mut settings = small();
            take(&mut settings, name, value);
            set(&mut renderer, &settings);
            picture(&mut renderer);
        }
        gpu.pipelines.counts()
    };
    let first = go_round();
    assert_eq!(go_round(), first);
}

/// The estimate is compared with the renderer's memory.
#[test]
fn the_memory_of_photons_is_estimated() {
    let scene = builtin("two-rooms");
    let mut settings = RenderSettings { resolution: 48, ..small() };
    let list_of = |settings: &RenderSettings| {
        let estimate = MemoryEstimate::new(&scene, settings).expect("an estimate");
        let is_list = |part: &&MemoryUse| part.name == "voxel list (about)";
        estimate.parts.iter().find(is_list).expect("a voxel list").bytes as f64
    };
    let without = list_of(&settings);
    take(&mut settings, "injection", "photons");
    let estimated = list_of(&settings);
    let memory = renderer(&gpu(), &scene, settings).memory();
    let of_list = memory
        .iter()
        .filter(|part| ["voxels", "light"].iter().any(|prefix| part.name.starts_with(prefix)));
    let truth: f64 = of_list.map(|part| part.bytes as f64).sum();
    assert!(estimated > without);
    // Surfaces that share a voxel limit the accuracy.
    assert!((estimated / truth - 1.0).abs() < 0.4, "{estimated} is not {truth}");
}
