//! A sequence of pictures, which share as much work as possible.

use std::time::Instant;

use lumivox_console::report::{AdapterReport, SceneCounts, bytes, count, counted, memory_table};
use lumivox_console::{Failure, shown};
use lumivox_render::{Exposure, Metering, Picture, RenderSettings, Renderer};
use lumivox_scene::{Camera, Scene};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::clock::Seconds;
use super::report::{CameraReport, NoteReport, RendererReport};
use super::{RenderJob, light};
use crate::cli::RenderArgs;
use crate::commands::settings;
use crate::progress::ProgressDisplay;
use crate::progress::words;
use crate::sequence::{Frame, FrameFiles, Index, Start};
use crate::timeline::{Moments, PathFile, PictureTimes};

/// The number of pictures that determine the common exposure.
const METERED: u64 = 5;

/// Renders the missing pictures, and reports.
///
/// # Errors
/// When the existing pictures do not fit, or the device or the disk fails.
pub fn run(mut stage: RenderJob<'_>, path: Option<&PathFile>) -> anyhow::Result<()> {
    let PictureTimes::Sequence(moments) = stage.schedule.times.clone() else {
        anyhow::bail!("a sequence without moments")
    };
    let mut files = FrameFiles::new(&stage.args.output)?;
    files.fit(moments.count)?;
    files.make_folder()?;
    let _lock = files.lock()?;
    let settings = settings_of(&stage, &moments, path);
    let start = Index::new(moments.count, settings).start(&files, stage.args.timeline.restart)?;
    let Start { mut index, missing } = start;
    if !missing.is_empty() {
        let tell = |done, total| stage.progress.set("looking at the motion", done, total);
        let bounds = stage.schedule.bounds(&mut stage.scene, &mut { tell })?;
        stage.settings.grid_bounds = stage.schedule.animation.map(|_| bounds);
    }
    index.adapter = lumivox_render::describe(&stage.gpu.adapter_info);
    stage.progress.stop_on_interrupt(stage.host)?;
    let stopped = |done: usize| {
        let there = moments.count as usize - missing.len() + done;
        Failure::stopped(format!(
            "stopped: {there} of {} pictures are there; the same command continues",
            moments.count
        ))
    };

    let mut renderer: Option<Renderer> = None;
    let is_shared = stage.settings.exposure == Exposure::Auto && files.are_exposed();
    if is_shared && stage.settings.view.is_light() && !missing.is_empty() {
        if index.exposure.is_none() {
            let Some((metered, stops)) = meter(&mut stage, &moments)? else {
                return Err(stopped(0).into());
            };
            (renderer, index.exposure) = (Some(metered), Some(stops));
        }
        let shared = index.exposure.map_or(Exposure::Auto, Exposure::Stops);
        stage.settings.exposure = shared;
        if let Some(renderer) = &mut renderer {
            renderer.set_exposure(shared);
        }
    }
    let mut metering: Option<Metering> = None;
    for (done, &number) in missing.iter().enumerate() {
        let start = Instant::now();
        let time_s = moments.time_s(number);
        stage.schedule.pose(&mut stage.scene, time_s)?;
        let camera = stage.schedule.camera(&stage.scene, time_s, moments.share(number));
        let step = Step {
            stage: "picture",
            progress: &stage.progress,
            done: done as u32,
            total: missing.len() as u32,
        };
        let ready = step.prepare(renderer.take(), &stage, &camera)?;
        let renderer = renderer.insert(ready);
        stage.clock.seconds.preparing += stage.clock.lap();
        let Some(picture) = step.render(renderer)? else {
            return Err(stopped(done).into());
        };
        stage.clock.seconds.rendering += stage.clock.lap();
        picture.write(&files.path(number))?;

        let settings = renderer.settings();
        metering = settings.view.is_light().then(|| settings.exposure.meter(&picture.hdr));
        let frame = Frame {
            number,
            file: files.name(number),
            bytes: std::fs::metadata(files.path(number))?.len(),
            time_s,
            camera: serde_json::to_value(CameraReport::new(&camera))?,
            exposure: metering.map(|metering| metering.stops),
            seconds: start.elapsed().as_secs_f64(),
        };
        index.add(frame, &files)?;
        stage.clock.seconds.writing += stage.clock.lap();
    }
    stage.clock.seconds.total = stage.clock.start.elapsed().as_secs_f64();
    drop(stage.progress);

    let report = Report {
        files: files.pattern().display().to_string(),
        index: files.index().display().to_string(),
        size: stage.args.picture.size.to_array(),
        pictures: moments.count,
        rendered: missing.len(),
        exposure: index.exposure,
        notes: NoteReport::all(&stage.notes, metering.and_then(|metering| metering.warning)),
        scene: SceneCounts::new(&stage.scene),
        renderer: renderer.as_ref().map(RendererReport::new),
        seconds: stage.clock.seconds,
        settings: stage.settings.clone(),
        adapter: AdapterReport::new(&stage.gpu.adapter_info),
    };
    if stage.args.json {
        return stage.host.print_json(&report);
    }
    stage.host.print(&report.text(stage.is_verbose))
}

/// The exposure of all pictures: the median over some of them, spread over the sequence and
/// rendered roughly. A single picture might only show a wall. Also returns the renderer used;
/// `None` if it was stopped.
fn meter(stage: &mut RenderJob<'_>, moments: &Moments) -> anyhow::Result<Option<(Renderer, f32)>> {
    let mut numbers: Vec<u32> = (0..METERED)
        .map(|i| (u64::from(moments.count) * (2 * i + 1) / (2 * METERED)) as u32)
        .collect();
    numbers.dedup();
    let total = numbers.len() as u32;
    let mut renderer: Option<Renderer> = None;
    let mut stops = Vec::new();
    for (done, number) in numbers.into_iter().enumerate() {
        if stage.progress.is_stopped() {
            return Ok(None);
        }
        let time_s = moments.time_s(number);
        stage.schedule.pose(&mut stage.scene, time_s)?;
        let camera = stage.schedule.camera(&stage.scene, time_s, moments.share(number));
        let step = Step { stage: "metering", progress: &stage.progress, done: done as u32, total };
        let ready = step.prepare(renderer.take(), stage, &camera)?;
        let ready = renderer.insert(ready);
        pollster::block_on(ready.render_frame())?;
        let picture = pollster::block_on(ready.finish())?;
        stops.push(Exposure::Auto.stops(&picture.hdr));
    }
    let renderer = renderer.ok_or_else(|| anyhow::anyhow!("a sequence without pictures"))?;
    Ok(Some((renderer, median(stops))))
}

/// The median; the higher of the two middle values of an even number, and 0 without values.
fn median(mut values: Vec<f32>) -> f32 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// A picture's place among those to be rendered.
struct Step<'a> {
    stage: &'static str,
    progress: &'a ProgressDisplay,
    done: u32,
    total: u32,
}

impl Step<'_> {
    /// A renderer prepared for this picture, made from that of the picture before if there is one.
    fn prepare(
        &self,
        before: Option<Renderer>,
        stage: &RenderJob<'_>,
        camera: &Camera,
    ) -> anyhow::Result<Renderer> {
        let mut tell = |step: lumivox_render::RenderProgress| match self.done {
            0 => self.progress.set(words(step.stage), step.done, step.total),
            _ => self.tell_share(0.0),
        };
        let Some(mut renderer) = before else {
            let (gpu, scene, settings) = (&stage.gpu, &stage.scene, stage.settings.clone());
            let renderer = Renderer::new(gpu, scene, Some(camera), settings, &mut tell);
            return Ok(pollster::block_on(renderer)?);
        };
        if stage.schedule.animation.is_some() {
            pollster::block_on(renderer.set_scene(&stage.scene, &mut tell))?;
        }
        renderer.set_camera(camera.clone());
        Ok(renderer)
    }

    /// Renders the picture. Returns `None` if the user stopped it; a later run then renders it
    /// again.
    fn render(&self, renderer: &mut Renderer) -> anyhow::Result<Option<Picture>> {
        let mut tell = |step| {
            self.tell(step);
            self.progress.goes_on()
        };
        Ok(pollster::block_on(renderer.render_until(&mut tell))?)
    }

    fn tell(&self, step: lumivox_render::RenderProgress) {
        self.tell_share(f64::from(step.done) / f64::from(step.total.max(1)));
    }

    fn tell_share(&self, share: f64) {
        self.progress.set_within(self.stage, self.done, self.total, share);
    }
}

/// All settings that decide what the pictures show, under the names of the command line.
fn settings_of(
    stage: &RenderJob<'_>,
    moments: &Moments,
    path: Option<&PathFile>,
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

/// The report on a sequence.
#[derive(Clone, Debug, Serialize)]
struct Report {
    /// The pictures' files, with # for the digits of the number.
    files: String,
    /// The index's file.
    index: String,
    /// Width and height in pixels.
    size: [u32; 2],
    /// Pictures of the whole sequence.
    pictures: u32,
    /// Pictures that were rendered now; the others existed.
    rendered: usize,
    /// Exposure in stops, if all pictures have the same.
    exposure: Option<f32>,
    /// Notes on what was chosen for the scene, and on problems with the light of the last picture.
    notes: Vec<NoteReport>,
    scene: SceneCounts,
    /// `None` if no picture had to be rendered.
    #[serde(flatten)]
    renderer: Option<RendererReport>,
    /// Wall-clock times.
    seconds: Seconds,
    #[serde(serialize_with = "settings::serialize")]
    settings: RenderSettings,
    adapter: AdapterReport,
}

impl Report {
    fn text(&self, is_verbose: bool) -> String {
        let Self { files, scene, seconds, settings, .. } = self;
        let [width, height] = self.size;
        let pictures = counted(self.pictures as usize, "picture", "pictures");
        let mut text =
            format!("{files}: {pictures} of {width}x{height}, view {}", settings.view.name());
        if let Some(stops) = self.exposure {
            text += &format!(", exposure {stops:.2}");
        }
        let there = (self.pictures as usize).saturating_sub(self.rendered);
        if there > 0 {
            text += &format!("; {} of them were there already", count(there as u64));
        }
        text += &format!("\n  index    {}\n", self.index);
        text += &format!(
            "  scene    {}: {}, {}, {}\n",
            shown::line(&scene.name),
            counted(scene.triangles, "triangle", "triangles"),
            counted(scene.materials, "material", "materials"),
            counted(scene.lights, "light", "lights"),
        );
        text += &self.notes.iter().map(NoteReport::line).collect::<String>();
        if let Some(renderer) = &self.renderer {
            let [x, y, z] = renderer.grid.dimensions;
            text += &format!(
                "  voxels   {} in {x} x {y} x {z} of {:.4} m\n  memory   {} on the GPU\n",
                count(renderer.voxels.into()),
                renderer.grid.voxel_size_m,
                bytes(renderer.memory_bytes)
            );
        }
        text += &format!(
            "  time     {:.2} s: loading {:.2}, preparing {:.2}, rendering {:.2}, writing {:.2}",
            seconds.total, seconds.loading, seconds.preparing, seconds.rendering, seconds.writing
        );
        if self.rendered > 0 {
            let each = (seconds.total - seconds.loading) / self.rendered as f64;
            text += &format!("; {each:.2} a picture");
        }
        text += &format!("\n  GPU      {}\n", self.adapter.description);
        if let Some(renderer) = self.renderer.as_ref().filter(|_| is_verbose) {
            text.push('\n');
            text += &renderer.times.table("stage and pass (of a frame: mean)");
            text.push('\n');
            text += &memory_table(&renderer.memory);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_values_are_below_the_median() {
        assert_eq!(median(vec![3.0, -9.0, 1.0, 7.0, 2.0]), 2.0);
        assert_eq!(median(vec![5.0, 4.0]), 5.0);
        assert_eq!(median(Vec::new()), 0.0);
    }
}
