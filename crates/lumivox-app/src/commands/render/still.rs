//! A single picture.

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::Context as _;
use lumivox_render::{RenderProgress, Renderer};

use super::job::RenderJob;
use super::noise::render;
use super::report::Report;
use crate::progress::words;

/// Renders the current scene from `camera`, writes and reports.
///
/// # Errors
/// When the device or the disk fails.
pub fn run(
    mut stage: RenderJob<'_>,
    camera: &lumivox_scene::Camera,
    file: &Path,
) -> anyhow::Result<()> {
    let progress = &stage.progress;
    let mut tell = |step: RenderProgress| {
        progress.set(words(step.stage), step.done, step.total);
    };
    let (gpu, scene, settings) = (&stage.gpu, &stage.scene, stage.settings.clone());
    let renderer = Renderer::new(gpu, scene, Some(camera), settings, &mut tell);
    let mut renderer = pollster::block_on(renderer)?;
    stage.clock.seconds.preparing = stage.clock.lap();
    let mut goes_on = |step| {
        tell(step);
        ControlFlow::Continue(())
    };
    let rendered = render(&mut renderer, stage.may_stop(), &mut goes_on)?;
    let (picture, noise) = rendered.context("nothing stops it")?;
    stage.clock.seconds.rendering = stage.clock.lap();
    progress.set("writing", 0, 1);
    picture.write(file)?;
    let seconds = stage.clock.stop();
    drop(stage.progress);

    let (gpu, scene) = (&stage.gpu, &stage.scene);
    let report = Report::new(file, gpu, scene, &renderer, &picture, seconds, &stage.notes);
    let report = report.with_noise(noise);
    if stage.args.json {
        return stage.host.print_json(&report);
    }
    stage.host.print(&report.text(stage.is_verbose))
}
