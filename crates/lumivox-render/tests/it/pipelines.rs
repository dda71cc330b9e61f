//! The cost of a device's second renderer: its pipelines are those of the first.

use glam::UVec2;
use lumivox::{Directionality, VolumeKind};
use lumivox_render::{RenderProgress, RenderSettings, Renderer, ShadowMethod};

use crate::common::{builtin, own_gpu, picture};

/// All settings that other shaders are linked for are gone through twice.
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
    // Pipelines of holes, textures and moving frames are made when something needs them.
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
    // Another grid, another scene, while the first one is still there.
    let other = builtin("two-rooms");
    let settings = RenderSettings { resolution: 24, ..settings };
    let mut other = crate::common::renderer(&gpu, &other, settings);
    picture(&mut other);
    // It has no emitters: diffuse light and reflections have smaller kernels of their own.
    let mut both = first;
    both.made += 2;
    assert_eq!(gpu.pipelines.counts(), both);
}
