//! `lumivox-lab motion`: errors, flicker, delay and cost while something moves.
//!
//! A sequence of steps is rendered with one frame each, exactly as a viewer would see it, and
//! compared with the path tracer's picture of the same pose.
//!
//! | file | is |
//! | --- | --- |
//! | `sequences.rs` | the table of sequences |
//! | `moves.rs` | the pose of each sequence at a step |
//! | `drive.rs` | a scene driven step by step, as the window does it |
//! | `truth.rs` | the path tracer's pictures |
//! | `seen.rs` | what becomes visible in a step |
//! | `figures.rs` | the formulas |
//! | `measure.rs` | one sequence from its poses to its figures |
//! | `report.rs` | the figures, as JSON and for people |
//! | `pictures.rs` | strips, animations and charts |
//! | `page.rs` | docs/generated/motion.md |
//! | `published.rs` | the page's table of figures of other renderers |

mod drive;
mod figures;
mod measure;
mod moves;
mod page;
mod pictures;
mod published;
mod report;
mod seen;
mod sequences;
mod truth;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use anyhow::Context as _;
use lumivox::Preset;
use lumivox_app::Host;
use lumivox_app::parts::{
    Kept, ProgressDisplay, check_light, check_scene, output, settings, stage,
};
use lumivox_console::report::AdapterReport;
use lumivox_console::{Failure, SceneSource};
use lumivox_render::{Gpu, PresetChoice, RenderSettings};
use lumivox_scene::{Camera, Scene};
use serde::Serialize;

use crate::cli::MotionArgs;
use crate::machine;
use measure::{Measured, Task};
use report::{Case, SequenceReport};
use sequences::{Home, SEQUENCES, Sequence};
use truth::Truths;

/// The page's file.
const PAGE: &str = "motion.md";
/// The presets on the page.
const PRESETS: [Preset; 2] = [Preset::Fast, Preset::Realtime];
/// The preset of the page's pictures.
const SHOWN: Preset = Preset::Realtime;
/// The rows of strips on the page.
const ROWS_ON_PAGE: usize = 2;

/// Measures the sequences, and reports.
///
/// # Errors
/// When a name is unknown, a scene cannot be read or has nothing to move, something cannot be
/// rendered, or a file cannot be written.
pub fn run(args: &MotionArgs, host: &Host) -> anyhow::Result<()> {
    let named = named(&args.sequence)?;
    check(args)?;
    let start = Instant::now();
    let mut progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    progress.stop_on_interrupt(host)?;
    let mut work = Work { args, gpu: &gpu, progress: &progress, staged: BTreeMap::new() };
    let sequences = work.chosen(named)?;
    if let Some(folder) = &args.doc {
        write_page(&mut work, &sequences, folder)?;
        drop(progress);
        return host.print(&format!("{}\n", folder.join(PAGE).display()));
    }
    let mut reports = Vec::new();
    let preset = args.cones.preset();
    for sequence in sequences {
        let measured = work.measure(sequence, preset)?;
        if let Some(folder) = &args.output {
            pictures::write(&measured, usize::MAX, folder)?;
        }
        reports.push(measured.report);
    }
    if let Some(folder) = &args.output {
        let named: Vec<_> =
            reports.iter().map(|report| (preset.name().to_owned(), report)).collect();
        pictures::write_charts(&named, folder)?;
    }
    drop(progress);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        size: args.size.to_array(),
        samples: args.samples,
        still_frames: measure::STILL_FRAMES,
        sequences: reports,
        seconds: start.elapsed().as_secs_f64(),
        adapter: AdapterReport::new(&gpu.adapter_info),
    };
    match args.json.as_deref() {
        Some(file) if file == Path::new("-") => host.print_json(&report),
        Some(file) => {
            let text = serde_json::to_string_pretty(&report)? + "\n";
            output::write(file, text.as_bytes())?;
            host.print(&report.text())
        }
        None => host.print(&report.text()),
    }
}

/// Checks all that needs no GPU.
fn check(args: &MotionArgs) -> anyhow::Result<()> {
    if args.doc.is_some() && args.cones.preset.is_some() {
        let names = PRESETS.map(|preset| PresetChoice::Cones(preset).name()).join(" and ");
        return Err(Failure::input(format!("--doc measures {names}; leave --preset out")).into());
    }
    if let Some(scene) = &args.scene {
        check_scene(scene)?;
    }
    check_light(&args.light.sources)?;
    if let Some(file) = args.json.as_deref().filter(|file| *file != Path::new("-")) {
        output::check_folder(file, &output::folder_of(file))?;
    }
    let pictures = args.doc.as_ref().map(|folder| folder.join(page::PICTURES));
    for folder in [&args.truth, &args.output, &pictures].into_iter().flatten() {
        output::make_folder(folder)?;
    }
    Ok(())
}

/// Measures the sequences that are not cached, with the presets of the page, and writes the page
/// and its pictures.
fn write_page(
    work: &mut Work<'_>,
    sequences: &[&'static Sequence],
    folder: &Path,
) -> anyhow::Result<()> {
    let folder_of_pictures = folder.join(page::PICTURES);
    let [settings, _] = work.settings(PresetChoice::default())?;
    let MotionArgs { samples, steps, cache, .. } = work.args;
    let version = env!("CARGO_PKG_VERSION");
    let words = format!("{samples} samples, {steps:?} steps, version {version}, {settings:?}");
    let mut kept = Kept::open(cache.as_deref(), words)?;
    let mut cases = Vec::new();
    for sequence in sequences {
        for preset in PRESETS {
            let is_shown = preset == SHOWN;
            let preset = PresetChoice::Cones(preset);
            let key = format!("{} {}", sequence.name, preset.name());
            if kept.get(&key).is_none() {
                let measured = work.measure(sequence, preset)?;
                if is_shown {
                    pictures::write(&measured, ROWS_ON_PAGE, &folder_of_pictures)?;
                }
                kept.put(key.clone(), measured.report)?;
            }
            let report: SequenceReport = kept.get(&key).cloned().context(key)?;
            cases.push(Case { preset: preset.name(), report, is_shown });
        }
    }
    let named: Vec<_> = cases.iter().map(|case| (case.preset.to_owned(), &case.report)).collect();
    pictures::write_charts(&named, &folder_of_pictures)?;
    let text = page::page(work.args, &machine(work.gpu), settings.resolution, &cases);
    output::write(&folder.join(PAGE), text.as_bytes())
}

/// The sequences of these names.
fn named(names: &[String]) -> Result<Vec<&'static Sequence>, Failure> {
    let one = |name: &String| {
        Sequence::named(name).ok_or_else(|| {
            let known: Vec<&str> = SEQUENCES.iter().map(|sequence| sequence.name).collect();
            let known = known.join(", ");
            Failure::input(format!("there is no sequence \"{name}\"; there are: {known}"))
        })
    };
    names.iter().map(one).collect()
}

/// The data that all measurements share.
struct Work<'a> {
    args: &'a MotionArgs,
    gpu: &'a Gpu,
    progress: &'a ProgressDisplay,
    /// Scenes loaded so far, by their names on the command line.
    staged: BTreeMap<String, (Scene, Camera)>,
}

impl Work<'_> {
    /// The sequences to measure.
    fn chosen(&mut self, named: Vec<&'static Sequence>) -> anyhow::Result<Vec<&'static Sequence>> {
        if !named.is_empty() {
            return Ok(named);
        }
        let all = || SEQUENCES.iter();
        let Some(source) = &self.args.scene else {
            return Ok(all().filter(|sequence| sequence.home != Home::Animated).collect());
        };
        if let SceneSource::Builtin(name) = source {
            let made_for_it = all().filter(|sequence| sequence.builtin() == Some(name.as_str()));
            let made_for_it: Vec<_> = made_for_it.collect();
            if !made_for_it.is_empty() {
                return Ok(made_for_it);
            }
        }
        let (scene, _) = self.stage(&source.clone())?;
        let home = |sequence: &&Sequence| match sequence.home {
            Home::Animated => !scene.animations().is_empty(),
            Home::Any(_) => scene.animations().is_empty() && sequence.name == "orbit",
            Home::Only(_) => false,
        };
        Ok(all().filter(home).collect())
    }

    /// Loads a scene and finds its camera; once for each name.
    fn stage(&mut self, source: &SceneSource) -> anyhow::Result<(Scene, Camera)> {
        let name = source.to_string();
        if let Some(staged) = self.staged.get(&name) {
            return Ok(staged.clone());
        }
        let MotionArgs { load, light, view, size, .. } = self.args;
        let staged = stage(source, load, &light.sources, view, *size, self.progress)?;
        self.staged.insert(name, staged.clone());
        Ok(staged)
    }

    /// The scene of a sequence, and its camera.
    fn scene_of(&mut self, sequence: &Sequence) -> anyhow::Result<(Scene, Camera)> {
        let source = match (&self.args.scene, sequence.builtin()) {
            (Some(source), _) => source.clone(),
            (None, Some(name)) => SceneSource::Builtin(name.to_owned()),
            (None, None) => {
                return Err(Failure::input(format!(
                    "the sequence {} is a file's own; give a SCENE with an animation",
                    sequence.name
                ))
                .into());
            }
        };
        self.stage(&source)
    }

    /// The settings of a preset with the command line's changes; and those of still pictures: the
    /// default preset without changes of the cones.
    fn settings(&self, preset: PresetChoice) -> anyhow::Result<[RenderSettings; 2]> {
        let MotionArgs { voxels, light, cones, size, .. } = self.args;
        let still = [voxels.given(), light.settings.given()].concat();
        let given = [still.as_slice(), cones.settings.given()].concat();
        let settings = settings::of(preset, *size, &given)?;
        if settings.look.is_some() {
            return Err(Failure::input(format!(
                "the preset {} is a look without physical units, which have no truth; choose another",
                preset.name()
            ))
            .into());
        }
        Ok([settings, settings::of(PresetChoice::default(), *size, &still)?])
    }

    fn measure(
        &mut self,
        sequence: &'static Sequence,
        preset: PresetChoice,
    ) -> anyhow::Result<Measured> {
        let (scene, camera) = self.scene_of(sequence)?;
        let [settings, balanced] = self.settings(preset)?;
        let task = Task {
            gpu: self.gpu,
            progress: self.progress,
            sequence,
            scene: &scene,
            camera: &camera,
            settings: &settings,
            balanced: &balanced,
            moving_steps: self.args.steps,
        };
        let MotionArgs { size, samples, truth, cache, .. } = self.args;
        let folder = truth.as_deref().or(cache.as_deref());
        tracing::info!("measuring {} with {}", sequence.name, preset.name());
        task.measure(&mut Truths::new(self.gpu, *size, *samples, folder))
    }
}

/// The figures of all sequences.
#[derive(Debug, Serialize)]
struct Report {
    version: &'static str,
    /// Width and height in pixels.
    size: [u32; 2],
    /// Samples of each pixel of the truth.
    samples: u32,
    /// Frames of the still pictures that pictures in motion are compared with.
    still_frames: u32,
    sequences: Vec<SequenceReport>,
    /// Total wall-clock time, s.
    seconds: f64,
    adapter: AdapterReport,
}

impl Report {
    fn text(&self) -> String {
        let [width, height] = self.size;
        let sequences: Vec<String> = self.sequences.iter().map(SequenceReport::text).collect();
        format!(
            "{}\n{width}x{height}, truth of {} samples a pixel, {:.0} s on {}\n\n  \
             In % of the truth's mean, its noise taken out; full is the irradiance by all light but that straight\n  \
             from lamps. Of still: the RMSE over that of the same pose after {} frames of balanced.\n",
            sequences.join("\n"),
            self.samples,
            self.seconds,
            self.adapter.name,
            self.still_frames
        )
    }
}
