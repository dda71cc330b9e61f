//! A sequence of pictures, which share as much work as possible.
//!
//! | file | is |
//! | --- | --- |
//! | `film.rs` | one renderer for all pictures |
//! | `report.rs` | what is printed at the end |

mod film;
mod report;

use std::time::Instant;

use lumivox_console::Failure;
use lumivox_console::report::{AdapterReport, SceneCounts};
use lumivox_render::{Exposure, Metering};
use lumivox_scene::Scene;
use serde_json::{Map, Value, json};

use super::job::RenderJob;
use super::report::{CameraReport, NoteReport, RendererReport};
use crate::cli::RenderArgs;
use crate::light;
use crate::sequence::{Frame, FrameFiles, Index, Start};
use crate::settings;
use crate::timeline::{History, Moments, PathFile, PictureTimes};
use film::{Film, Step};
use report::Report;

/// The number of pictures that determine the common exposure.
const METERED: u64 = 5;

/// Renders the missing pictures, and reports.
///
/// # Errors
/// When existing pictures have other settings, or the device or the disk fails.
pub fn run(mut stage: RenderJob<'_>, path: Option<&PathFile>) -> anyhow::Result<()> {
    let PictureTimes::Sequence(moments) = stage.schedule.times.clone() else {
        anyhow::bail!("a sequence without moments")
    };
    let timeline = &stage.args.timeline;
    let mut files = FrameFiles::new(&stage.args.output)?.of_range(timeline.pictures.clone());
    files.fit(moments.count)?;
    let asked = files.numbers(moments.count)?;
    files.make_folder()?;
    let _lock = files.lock()?;
    let history = history_of(&stage);
    let settings = settings_of(&stage, &moments, (path, history));
    let index = Index::new(moments.count, settings);
    let Start { mut index, missing } = index.start(&files, asked.clone(), timeline.restart)?;
    if !missing.is_empty() {
        let tell = |done, total| stage.progress.set("looking at the motion", done, total);
        let bounds = stage.schedule.bounds(&mut stage.scene, &mut { tell })?;
        stage.settings.grid_bounds = stage.schedule.animation.map(|_| bounds);
    }
    index.adapter = lumivox_render::describe(&stage.gpu.adapter_info);
    stage.progress.stop_on_interrupt(stage.host)?;
    let stopped = |done: usize| {
        let there = asked.len() - missing.len() + done;
        Failure::stopped(format!(
            "stopped: {there} of {} pictures are there; the same command continues",
            asked.len()
        ))
    };

    let mut film = Film::default();
    let is_shared = stage.settings.exposure == Exposure::Auto && files.are_exposed();
    if is_shared && stage.settings.view.is_light() && !missing.is_empty() {
        if index.exposure.is_none() {
            let Some((metered, stops)) = meter(&mut stage, &moments)? else {
                return Err(stopped(0).into());
            };
            index.exposure = Some(stops);
            if history == History::None {
                film = metered;
            }
        }
        let shared = index.exposure.map_or(Exposure::Auto, Exposure::Stops);
        stage.settings.exposure = shared;
        film.set_exposure(shared);
    }
    if history == History::None && film.renderer().is_none() && !missing.is_empty() {
        film = begun(&mut stage, &moments)?;
    }
    let mut metering: Option<Metering> = None;
    // With history, a picture depends on all before it, so a stopped sequence restarts at the
    // first.
    let numbers: Vec<u32> = match (history, missing.last()) {
        (History::Kept, Some(&last)) => (0..=last).collect(),
        _ => missing.clone(),
    };
    let mut written = 0;
    for (done, &number) in (0..).zip(&numbers) {
        let start = Instant::now();
        let time_s = moments.time_s(number);
        stage.schedule.pose(&mut stage.scene, time_s)?;
        let camera = stage.schedule.camera(&stage.scene, time_s, moments.share(number));
        let is_missing = missing.binary_search(&number).is_ok();
        let stage_name = if is_missing { "picture" } else { "picture again" };
        let total = numbers.len() as u32;
        let step = Step { stage: stage_name, progress: &stage.progress, done, total };
        film.show(&step, &stage, &camera, history)?;
        stage.clock.seconds.preparing += stage.clock.lap();
        let Some(picture) = film.render(&step, &stage, history)? else {
            return Err(stopped(written).into());
        };
        stage.clock.seconds.rendering += stage.clock.lap();
        if !is_missing {
            continue;
        }
        if index.frames.is_empty() {
            index.write(&files)?;
        }
        picture.write(&files.path(number))?;

        let settings = &stage.settings;
        metering = settings.view.is_light().then(|| settings.exposure.meter(&picture.hdr));
        let frame = Frame {
            number,
            file: files.name(number),
            bytes: std::fs::metadata(files.path(number))?.len(),
            time_s,
            camera: serde_json::to_value(CameraReport::new(&stage.scene, &camera))?,
            exposure: metering.map(|metering| metering.stops),
            seconds: start.elapsed().as_secs_f64(),
        };
        index.add(frame, &files)?;
        written += 1;
        stage.clock.seconds.writing += stage.clock.lap();
    }
    stage.clock.seconds.total = stage.clock.start.elapsed().as_secs_f64();
    drop(stage.progress);

    let report = Report {
        files: files.pattern().display().to_string(),
        index: files.index().display().to_string(),
        size: stage.args.picture.size.to_array(),
        pictures: asked.len() as u32,
        rendered: missing.len(),
        rendered_again: numbers.len() - missing.len(),
        exposure: index.exposure,
        notes: NoteReport::all(&stage.notes, metering.and_then(|metering| metering.warning)),
        scene: SceneCounts::new(&stage.scene),
        renderer: film.renderer().map(RendererReport::new),
        seconds: stage.clock.seconds,
        settings: stage.settings.clone(),
        adapter: AdapterReport::new(&stage.gpu.adapter_info),
    };
    if stage.args.json {
        return stage.host.print_json(&report);
    }
    stage.host.print(&report.text(stage.is_verbose))
}

/// The exposure of all pictures: the median over a few, spread over the sequence and rendered
/// roughly, since a single picture might only show a wall. Also returns the renderer used; `None`
/// if the user stopped it.
fn meter(stage: &mut RenderJob<'_>, moments: &Moments) -> anyhow::Result<Option<(Film, f32)>> {
    let mut numbers: Vec<u32> = (0..METERED)
        .map(|i| (u64::from(moments.count) * (2 * i + 1) / (2 * METERED)) as u32)
        .collect();
    numbers.dedup();
    let total = numbers.len() as u32;
    let mut film = begun(stage, moments)?;
    let mut stops = Vec::new();
    for (done, number) in (0..).zip(numbers) {
        if stage.progress.is_stopped() {
            return Ok(None);
        }
        let time_s = moments.time_s(number);
        stage.schedule.pose(&mut stage.scene, time_s)?;
        let camera = stage.schedule.camera(&stage.scene, time_s, moments.share(number));
        let step = Step { stage: "metering", progress: &stage.progress, done, total };
        film.show(&step, stage, &camera, History::None)?;
        stops.push(Exposure::Auto.stops(&film.glimpse()?.hdr));
    }
    Ok(Some((film, median(stops))))
}

/// A film that has shown the first picture's scene, even if another picture is rendered first: the
/// first scene sets a renderer's unit of radiance, and all runs must have the same unit.
fn begun(stage: &mut RenderJob<'_>, moments: &Moments) -> anyhow::Result<Film> {
    let time_s = moments.time_s(0);
    stage.schedule.pose(&mut stage.scene, time_s)?;
    let camera = stage.schedule.camera(&stage.scene, time_s, 0.0);
    let step = Step { stage: "picture", progress: &stage.progress, done: 0, total: 1 };
    let mut film = Film::default();
    film.show(&step, stage, &camera, History::None)?;
    Ok(film)
}

/// The median; the higher of the two middle values of an even number, and 0 without values.
fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// The requested history; [`History::None`] without temporal tracing.
fn history_of(stage: &RenderJob<'_>) -> History {
    if stage.settings.trace.temporal { stage.args.timeline.history } else { History::None }
}

/// All settings that decide what the pictures show, under the names of the command line.
fn settings_of(
    stage: &RenderJob<'_>,
    moments: &Moments,
    (path, history): (Option<&PathFile>, History),
) -> Map<String, Value> {
    let args = stage.args;
    let mut settings = settings::report(&stage.settings);
    let more = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "scene": scene_settings(args),
        "size": args.picture.size.to_array(),
        "light": light::settings(&args.light.sources),
        "time": [moments.range_s.start, moments.range_s.end],
        "fps": moments.fps,
        "animation": animation_name(&stage.scene, stage.schedule.animation),
        "camera": args.picture.camera.as_ref().map(ToString::to_string),
        "camera_path": path.map(|path| &path.keys),
        "orbit": args.timeline.orbit,
        "history": history.name(),
    });
    if let Value::Object(more) = more {
        settings.extend(more);
    }
    settings
}

fn scene_settings(args: &RenderArgs) -> Value {
    let load = &args.scene.load;
    json!({
        "name": args.scene.scene.to_string(),
        "file": crate::args::scene::stamp_of(&args.scene.scene),
        "scene_in_file": load.scene_in_file,
        "up": if load.up == lumivox_scene::UpAxis::Z { "z" } else { "y" },
        "unit": load.unit,
        "crease": load.crease,
        "rotate": load.rotate.to_array(),
        "texture_memory": load.texture_memory,
    })
}

fn animation_name(scene: &Scene, choice: Option<lumivox_scene::AnimationChoice>) -> Option<String> {
    match choice? {
        lumivox_scene::AnimationChoice::All => Some("all".to_owned()),
        lumivox_scene::AnimationChoice::One(index) => {
            scene.animations().get(index).map(|animation| animation.name.clone())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_of_odd_even_and_empty_lists() {
        assert_eq!(median(vec![3.0, -9.0, 1.0, 7.0, 2.0]), 2.0);
        assert_eq!(median(vec![5.0, 4.0]), 5.0);
        assert_eq!(median(Vec::new()), 0.0);
    }
}
