//! `lumivox-lab quality`: the page on errors, from our own measurements.

mod cases;
mod materials;
mod noise;
mod page;
mod rooms;

use std::collections::{BTreeMap, btree_map};
use std::path::Path;

use anyhow::Context as _;
use lumivox_app::Host;
use lumivox_app::parts::{
    Kept, Measured, ProgressDisplay, Subject, Truth, output, reference, strip, write_strip,
};
use lumivox_console::Failure;
use lumivox_render::reference::ReferenceSettings;
use lumivox_render::{Gpu, RenderSettings};
use lumivox_scene::{Scene, builtin};

use crate::cli::QualityArgs;
use crate::machine;
use cases::{Case, Entry, PICTURES, Rotation, cases};

/// Matt scenes that are measured with glossy surfaces, too.
const GLOSSY: [&str; 5] =
    ["cornell-glossy", "two-rooms-glossy", "atrium-glossy", "arcade-glossy", "panel-glossy"];

/// The name in `--scenes` for balls of all materials.
const MATERIALS: &str = "materials";

/// Makes missing measurements, and writes the page.
///
/// # Errors
/// When there is no such scene, something cannot be rendered, or a file cannot be written.
pub fn run(args: &QualityArgs, host: &Host) -> anyhow::Result<()> {
    let names = scene_names(&args.scenes)?;
    let pictures = args.folder.join(PICTURES);
    output::make_folder(&pictures)?;
    let mut store = Kept::open(args.cache.as_deref(), settings_in_words(args))?;
    let mut progress = ProgressDisplay::start(host, "starting");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let mut cases = cases(&names, !args.scenes.is_empty(), &args.presets, &args.resolutions);
    if args.kept {
        cases.retain(|case| store.get(&case.key()).is_some());
    }
    progress.stop_on_interrupt(host)?;
    let rooms = rooms::measure(args, &gpu, &progress)?;
    let mut truths: BTreeMap<String, Truth> = BTreeMap::new();
    for (index, case) in cases.iter().enumerate() {
        let (done, total) = (index as u32, cases.len() as u32);
        let work = QualityRun { args, gpu: &gpu, progress: &progress, pictures: &pictures };
        if store.get(&case.key()).is_none() {
            tracing::warn!("{} of {total}: {case}", done + 1);
            let entry = work.measure(case, &mut truths);
            if progress.is_stopped() {
                return Err(stopped(args, done, total).into());
            }
            store.put(case.key(), entry.with_context(|| case.to_string())?)?;
        }
    }
    let is_asked = args.scenes.is_empty() || args.scenes.iter().any(|name| name == MATERIALS);
    let materials = if is_asked { Some(materials::measure(args, &gpu, &progress)?) } else { None };
    let noise = first_frames(args, &gpu, &progress, &names, rooms.as_ref(), &mut truths)?;
    let chart = if cases.is_empty() { None } else { Some(page::chart(&cases, &store)?) };
    let text = page::page(
        args,
        &machine(&gpu),
        &cases,
        &store,
        rooms.as_ref(),
        materials.as_ref(),
        &noise,
    );
    let chart = chart.map(|chart| (pictures.join("error-against-cost.svg"), chart));
    for (file, text) in chart.into_iter().chain([(args.folder.join("quality.md"), text)]) {
        output::write(&file, text.as_bytes())?;
    }
    drop(progress);
    host.print(&format!("{}\n", args.folder.join("quality.md").display()))
}

/// Measures first frames of all scenes and, if `rooms` are measured, of rooms with daylight.
fn first_frames(
    args: &QualityArgs,
    gpu: &Gpu,
    progress: &ProgressDisplay,
    names: &[String],
    rooms: Option<&rooms::Rooms>,
    truths: &mut BTreeMap<String, Truth>,
) -> anyhow::Result<noise::Rows> {
    let mut meter = noise::Meter::open(args, gpu, progress)?;
    for name in names {
        let scene = builtin::scene(name)?;
        let truth =
            if args.kept { None } else { Some(truth_of(args, gpu, progress, &scene, truths)?) };
        meter.measure(name, &|| Ok(builtin::scene(name)?), truth)?;
    }
    if let Some(rooms) = rooms {
        meter.measure_rooms(rooms.seed())?;
    }
    Ok(meter.into_rows())
}

/// The reference of a built-in scene: from an earlier call, from the cache, or traced.
fn truth_of<'t>(
    args: &QualityArgs,
    gpu: &Gpu,
    progress: &ProgressDisplay,
    scene: &Scene,
    truths: &'t mut BTreeMap<String, Truth>,
) -> anyhow::Result<&'t Truth> {
    let entry = match truths.entry(scene.name.clone()) {
        btree_map::Entry::Occupied(known) => return Ok(known.into_mut()),
        btree_map::Entry::Vacant(entry) => entry,
    };
    let settings = ReferenceSettings {
        size: args.size,
        samples: args.samples,
        ..ReferenceSettings::default()
    };
    let file = args.cache.as_ref().map(|cache| cache.join(format!("{}.exr", scene.name)));
    // All built-in scenes have a camera.
    let camera = &scene.cameras[0];
    let subject = Subject { gpu, scene, camera, progress };
    Ok(entry.insert(reference(&subject, settings, file.as_deref())?))
}

/// The failure that reports how much a stopped run has measured.
fn stopped(args: &QualityArgs, done: u32, total: u32) -> Failure {
    let kept = match &args.cache {
        Some(cache) => format!("{} has them, and the same command continues", cache.display()),
        None => "nothing is kept without a --cache".to_owned(),
    };
    Failure::stopped(format!("stopped after {done} of {total} measurements; {kept}"))
}

/// Describes the settings of all measurements.
fn settings_in_words(args: &QualityArgs) -> String {
    format!(
        "{} x {} pixels, {} samples, {} frames, {} places of the grid, version {}",
        args.size.x,
        args.size.y,
        args.samples,
        args.frames,
        args.offsets,
        env!("CARGO_PKG_VERSION")
    )
}

/// The names of the scenes to measure.
fn scene_names(asked: &[String]) -> anyhow::Result<Vec<String>> {
    let small = builtin::names().iter().copied().filter(|name| !builtin::is_large(name));
    let known: Vec<&str> = small.chain(GLOSSY).collect();
    if asked.is_empty() {
        return Ok(known.into_iter().map(str::to_owned).collect());
    }
    let scenes: Vec<String> = asked.iter().filter(|name| *name != MATERIALS).cloned().collect();
    if let Some(name) = scenes.iter().find(|name| !known.contains(&name.as_str())) {
        let known = known.join(", ");
        return Err(Failure::input(format!(
            "there is no built-in scene {name}; there are: {known}; and {MATERIALS}"
        ))
        .into());
    }
    Ok(scenes)
}

/// A rotated scene; its camera rotates with it, so that the picture stays the same.
fn turned(name: &str, rotation: Rotation) -> anyhow::Result<Scene> {
    let mut scene = builtin::scene(name)?;
    scene.rotate(rotation.angles_rad());
    Ok(scene)
}

/// The common data of all measurements.
struct QualityRun<'a> {
    args: &'a QualityArgs,
    gpu: &'a Gpu,
    progress: &'a ProgressDisplay,
    pictures: &'a Path,
}

impl QualityRun<'_> {
    fn subject<'a>(&'a self, scene: &'a Scene) -> Subject<'a> {
        // All built-in scenes have a camera.
        let camera = &scene.cameras[0];
        Subject { gpu: self.gpu, scene, camera, progress: self.progress }
    }

    fn measure(&self, case: &Case, truths: &mut BTreeMap<String, Truth>) -> anyhow::Result<Entry> {
        let straight = builtin::scene(&case.scene)?;
        let scene = turned(&case.scene, case.rotation)?;
        let subject = |scene| self.subject(scene);
        let truth = truth_of(self.args, self.gpu, self.progress, &straight, truths)?;
        let settings = RenderSettings {
            size: self.args.size,
            frames: self.args.frames,
            resolution: case.resolution,
            ..RenderSettings::default().with_preset(case.preset, None)
        };
        let measured = Measured::new(&subject(&scene), truth, &settings, case.offsets(self.args))?;
        if let Some(name) = case.picture(&self.args.resolutions) {
            let title = format!("{case}");
            write_strip(&self.pictures.join(name), &strip(&title, &measured.rows(truth))?)?;
        }
        Ok(Entry { figures: measured.figures.clone(), leak: measured.leak, cost: measured.cost })
    }
}
