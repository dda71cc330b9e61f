//! The cost of a device's second renderer: its pipelines are those of the first.

use std::time::Instant;

use glam::UVec2;
use lumivox::{Directionality, OctreeOptions, VolumeKind};
use lumivox_render::{RenderProgress, RenderSettings, Renderer, ShadowMethod};

use crate::common::{builtin, own_gpu, picture};

fn small() -> RenderSettings {
    RenderSettings { size: UVec2::new(64, 48), resolution: 64, frames: 1, ..Default::default() }
}

/// Resident memory of this process, MiB.
#[cfg(target_os = "linux")]
fn resident_mib() -> f64 {
    let statm = std::fs::read_to_string("/proc/self/statm").expect("the process's memory");
    let pages: f64 = statm.split(' ').nth(1).expect("a field").parse().expect("a number");
    pages * 4096.0 / f64::from(1 << 20)
}

/// Processor time of this process, s.
#[cfg(target_os = "linux")]
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("the process's times");
    let fields = stat.rsplit(')').next().expect("fields").split_whitespace().skip(11).take(2);
    fields.map(|ticks| ticks.parse::<f64>().expect("a number") / 100.0).sum()
}

/// Prints what docs and changelogs state; run it by
/// `cargo test -p lumivox-render --test it -- --ignored --nocapture pipelines`.
#[test]
#[ignore = "by hand: a measurement, with nothing to fail"]
#[cfg(target_os = "linux")]
fn what_renderers_cost_by_hand() {
    let (gpu, scene) = (own_gpu(), builtin("cornell"));
    for number in 1..=20 {
        let (start, processor) = (Instant::now(), processor_seconds());
        let mut stages = Vec::new();
        let mut hear = |step: RenderProgress| {
            if step.done == 0 || step.done == step.total {
                stages.push(format!("{} {:.2}", step.stage, start.elapsed().as_secs_f64()));
            }
        };
        let made = Renderer::new(&gpu, &scene, None, small(), &mut hear);
        let mut made = pollster::block_on(made).expect("a renderer");
        let seconds = start.elapsed().as_secs_f64();
        let processor = processor_seconds() - processor;
        picture(&mut made);
        drop(made);
        println!(
            "renderer {number}: {seconds:.2} s ({processor:.2} s of processors), then {:.1} MiB resident; {}",
            resident_mib(),
            stages.join(", ")
        );
    }
}

/// All settings that other shaders are linked for are gone through twice.
#[test]
fn a_second_renderer_asks_for_nothing_new() {
    let (gpu, scene) = (own_gpu(), builtin("cornell"));
    let mut heard = Vec::new();
    let mut hear = |step: RenderProgress| {
        if step.stage == "compile" {
            heard.push((step.done, step.total));
        }
    };
    let settings = RenderSettings { resolution: 16, ..small() };
    let renderer = Renderer::new(&gpu, &scene, None, settings.clone(), &mut hear);
    let mut renderer = pollster::block_on(renderer).expect("a renderer");
    let counts = gpu.pipelines.counts();
    // Pipelines of holes, textures and moving frames are made when something needs them.
    assert!(counts.made < counts.pipelines, "{counts:?}");
    let total = counts.made as u32;
    assert_eq!(heard, (0..=total).map(|done| (done, total)).collect::<Vec<_>>());

    let volume = VolumeKind::Octree(OctreeOptions::default());
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
    assert_eq!(gpu.pipelines.counts(), first);
}
