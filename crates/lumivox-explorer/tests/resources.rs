//! The classics free their GPU resources when other settings are chosen, and with the renderer.
//!
//! It has its own program, since resources are counted per process.

#[allow(dead_code, unused_imports)] // The renderer's own tests use the rest.
#[path = "../../lumivox-render/tests/it/common/mod.rs"]
mod common;

use common::{builtin, gpu, picture, renderer};
use glam::UVec2;
use lumivox::gpu::LiveResources;
use lumivox_explorer::parameters::find_parameter;
use lumivox_render::RenderSettings;

#[test]
#[ignore = "slow: over three seconds"]
fn classics_leak_no_gpu_resources() {
    let (gpu, scene) = (gpu(), builtin("cornell"));
    let physical = RenderSettings {
        size: UVec2::new(48, 32),
        resolution: 24,
        shadow_resolution: 128,
        frames: 2,
        ..RenderSettings::default()
    };
    let with = |name: &str, value: &str| {
        let row = find_parameter(name).expect("a setting");
        let mut settings = physical.clone();
        row.set(&mut settings, row.parse(value).expect("a value")).expect("in range");
        settings
    };
    let variants = [
        with("voxelizer", "conservative"),
        with("injection", "photons"),
        with("octree_builder", "locks"),
        with("level_gain", "2"),
        physical.clone(),
    ];
    let held = variants.clone().map(|settings| {
        let mut renderer = renderer(&gpu, &scene, settings);
        picture(&mut renderer);
        LiveResources::now()
    });
    let nothing = LiveResources { buffers: 0, textures: 0, buffer_bytes: 0 };
    assert_eq!(LiveResources::now(), nothing);
    let mut changing = renderer(&gpu, &scene, physical.clone());
    picture(&mut changing);
    for (settings, held) in variants.into_iter().zip(held) {
        pollster::block_on(changing.set_settings(settings, &mut |_| {})).expect("other settings");
        picture(&mut changing);
        assert_eq!(LiveResources::now(), held);
    }
    drop(changing);
    assert_eq!(LiveResources::now(), nothing);
}
