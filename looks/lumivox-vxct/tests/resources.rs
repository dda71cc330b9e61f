//! The look's GPU resources are freed when another look is chosen, and with the renderer.
//!
//! In its own program, since resources are counted per process.

#[allow(dead_code, unused_imports)] // The renderer's own tests use the rest.
#[path = "../../../crates/lumivox-render/tests/it/common/mod.rs"]
mod common;

use std::sync::Arc;

use common::{builtin, gpu, picture, renderer};
use glam::UVec2;
use lumivox::gpu::LiveResources;
use lumivox_render::RenderSettings;
use lumivox_vxct::VxctSettings;

#[test]
fn the_vxct_look_leaks_no_gpu_resources() {
    let gpu = gpu();
    let physical = RenderSettings {
        size: UVec2::new(48, 32),
        resolution: 24,
        shadow_resolution: 128,
        frames: 2,
        ..RenderSettings::default()
    };
    // A volume keeps the cells that were created for a look; a new volume has none.
    let look = RenderSettings {
        look: Some(Arc::new(VxctSettings::default())),
        resolution: 32,
        ..physical.clone()
    };
    let scene = builtin("cornell");
    let held = [&physical, &look].map(|settings| {
        let mut renderer = renderer(&gpu, &scene, settings.clone());
        picture(&mut renderer);
        LiveResources::now()
    });
    let nothing = LiveResources { buffers: 0, textures: 0, buffer_bytes: 0 };
    assert_eq!(LiveResources::now(), nothing);
    let mut changing = renderer(&gpu, &scene, physical.clone());
    picture(&mut changing);
    for (settings, held) in [(&look, &held[1]), (&physical, &held[0])] {
        pollster::block_on(changing.set_settings(settings.clone(), &mut |_| {}))
            .expect("other settings");
        picture(&mut changing);
        let now = LiveResources::now();
        assert_eq!(now.textures, held.textures);
        // Targets of cones keep a uniform.
        assert!((held.buffers..=held.buffers + 1).contains(&now.buffers), "{now:?}, not {held:?}");
    }
}
