//! Tests that a device's second renderer reuses the pipelines of the first.

use glam::UVec2;
use lumivox::{Directionality, VolumeKind};
use lumivox_render::{RenderProgress, RenderSettings, Renderer, ShadowMethod};

use crate::common::{builtin, own_gpu, picture};

/// Goes twice through all settings that link other shaders.
#[test]
#[ignore = "slow: over three seconds"]
fn a_second_renderer_compiles_no_new_pipelines() {
    let (gpu, scene) = (own_gpu(), builtin("cornell"));
    let mut heard = Vec::new();
    let mut hear = |step: RenderProgress| {
        if step.stage == "compile" {
            heard.push((step.done, step.total));
        }
    };
    let size = UVec2::new(64, 48);
    let settings = RenderSettings { size, resolution: 16, frames: 1, ..Default::default() };
    let renderer = Renderer::new(&gpu, &scene, None, settings.clone(), &mut hear);
    let mut renderer = pollster::block_on(renderer).expect("a renderer");
    let counts = gpu.pipelines.counts();
    // Pipelines for masks, textures and moving frames are created only when needed.
    assert!(counts.made < counts.pipelines, "{counts:?}");
    let total = counts.made as u32;
    assert_eq!(heard, (0..=total).map(|done| (done, total)).collect::<Vec<_>>());

    let volume = VolumeKind::Octree;
    let directionality = Directionality::Isotropic;
    let round = [
        RenderSettings { volume, ..settings.clone() },
        RenderSettings { directionality, ..settings.clone() },
        RenderSettings { shadows: ShadowMethod::Cone, ..settings.clone() },
        settings.clone(),
    ];
    let go_round = |renderer: &mut Renderer| {
        for settings in &round {
            let mut ignore = |_| {};
            let change = renderer.set_settings(settings.clone(), &mut ignore);
            pollster::block_on(change).expect("other settings");
            picture(renderer);
        }
        gpu.pipelines.counts()
    };
    let first = go_round(&mut renderer);
    assert!(first.pipelines > counts.pipelines, "{first:?}, {counts:?}");
    assert_eq!(go_round(&mut renderer), first);
    // Another grid and another scene, while the first renderer still exists.
    let other = builtin("two-rooms");
    let settings = RenderSettings { resolution: 24, ..settings };
    let mut other = crate::common::renderer(&gpu, &other, settings);
    picture(&mut other);
    // The scene has no emitters, so diffuse light and reflections use smaller kernels.
    let mut both = first;
    both.made += 2;
    assert_eq!(gpu.pipelines.counts(), both);
}
