//! `lumivox reference`: a path-traced picture with its layers.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use lumivox_console::Failure;
use lumivox_console::report::{AdapterReport, SceneCounts};
use lumivox_render::reference::{
    BATCH, PathTracer, ReferenceLayers, ReferencePart, ReferenceProgress, ReferenceSettings,
};
use lumivox_render::{Exposure, Gpu, ImageFormat, Picture, ToneMap};
use lumivox_scene::{read_regular, write_atomically};
use serde::Serialize;

use super::staged::stage;
use crate::args::output;
use crate::args::scene;
use crate::cli::ReferenceArgs;
use crate::host::Host;
use crate::light;
use crate::lock::Lock;
use crate::progress::ProgressDisplay;

/// The time between checkpoints.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(30);

/// Traces, writes and reports.
///
/// # Errors
/// When any step fails; the message says which.
pub fn run(args: &ReferenceArgs, host: &Host) -> anyhow::Result<()> {
    if let Some(file) = &args.output {
        output::check(file)?;
    }
    for file in args.checkpoint.iter().chain(&args.part) {
        output::check_folder(file, &output::folder_of(file))?;
    }
    scene::check(&args.scene.scene)?;
    light::check(&args.sources)?;
    let checkpoint = args.checkpoint.as_deref();
    let _lock = checkpoint.map(|file| Lock::take(file, "keeps its sums there")).transpose()?;
    let start = Instant::now();
    let mut progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let (scene, camera) = stage(
        &args.scene.scene,
        &args.scene.load,
        &args.sources,
        &args.view,
        args.size,
        &progress,
    )?;

    progress.set("preparing", 0, 1);
    let (first_batch, samples) = match &args.batches {
        Some(batches) => (batches.start, (batches.end - batches.start) * BATCH),
        None => (0, args.samples),
    };
    if args.part.is_some() && !samples.is_multiple_of(BATCH) {
        return Err(Failure::input(format!(
            "--samples {samples}: a --part has whole batches of {BATCH}; ask for a multiple of {BATCH}"
        ))
        .into());
    }
    let settings = ReferenceSettings {
        size: args.size,
        samples,
        seed: args.seed,
        first_batch,
        bounces: args.bounces,
        occlusion_distance_m: args.occlusion_distance.unwrap_or(f32::INFINITY),
    };
    let tracer = PathTracer::new(&gpu, &scene, Some(&camera), settings);
    let mut tracer = pollster::block_on(tracer)?;
    if args.resume
        && let Some(file) = &args.checkpoint
    {
        resume(&mut tracer, file)?;
    }
    let resumed = tracer.samples();
    progress.stop_on_interrupt(host)?;
    tracing::info!("tracing; Ctrl-C writes the samples so far, after the batch of {BATCH}");
    trace(&mut tracer, args, &progress)?;

    progress.set("writing", 0, 1);
    let layers = tracer.layers();
    let is_complete = layers.samples >= samples;
    let file = match (&args.part, &args.output) {
        (Some(part), _) => {
            // Do not write an incomplete part: its name would not show that it is incomplete.
            if is_complete {
                write_part(&tracer.part(), part)?;
            }
            part
        }
        (None, Some(output)) => {
            write(&layers, &gpu, output)?;
            output
        }
        (None, None) => return Ok(()),
    };
    let seconds = start.elapsed().as_secs_f64();
    drop(progress);
    let report = Report {
        file: file.display().to_string(),
        batches: args.part.is_some().then(|| [first_batch, first_batch + layers.samples / BATCH]),
        size: layers.size.to_array(),
        scene: SceneCounts::new(&scene),
        camera: camera.name.clone(),
        samples: layers.samples,
        samples_before: resumed,
        is_complete,
        noise_percent: Noise::of(&layers),
        seconds,
        adapter: AdapterReport::new(&gpu.adapter_info),
    };
    if args.json { host.print_json(&report) } else { host.print(&report.text()) }?;
    if report.is_complete { Ok(()) } else { Err(stopped(args, &report, samples).into()) }
}

/// The failure that reports how much a stopped run has traced.
fn stopped(args: &ReferenceArgs, report: &Report, wanted: u32) -> Failure {
    let goes_on = match &args.checkpoint {
        Some(file) => format!("the same command with --resume continues from {}", file.display()),
        None => "with a --checkpoint it could be continued".to_owned(),
    };
    let (samples, file) = (report.samples, &report.file);
    let has = if args.part.is_some() { "is not written" } else { "has" };
    Failure::stopped(format!(
        "stopped after {samples} of {wanted} samples, which {file} {has}; {goes_on}"
    ))
}

/// Traces until all samples are done or Ctrl-C is pressed, and writes the checkpoint. It always
/// finishes the current batch, so that a resumed run gives the bits and the noise estimate of an
/// uninterrupted one.
fn trace(
    tracer: &mut PathTracer,
    args: &ReferenceArgs,
    progress: &ProgressDisplay,
) -> anyhow::Result<()> {
    let mut written = Instant::now();
    let mut is_told = false;
    let mut hear = |step: ReferenceProgress| {
        progress.set_within("sample", step.samples as u32, step.total, step.samples.fract());
        if progress.is_stopped() && !std::mem::replace(&mut is_told, true) {
            tracing::warn!(
                "stopping after this batch of {BATCH} samples; Ctrl-C again stops at once, without it"
            );
        }
        ControlFlow::Continue(())
    };
    loop {
        let goes_on = pollster::block_on(tracer.render_batch(&mut hear))?;
        let goes_on = goes_on && !progress.is_stopped();
        if let Some(file) = &args.checkpoint
            && (!goes_on || written.elapsed() >= CHECKPOINT_EVERY)
        {
            keep(tracer, file)?;
            written = Instant::now();
        }
        if !goes_on {
            return Ok(());
        }
    }
}

fn keep(tracer: &PathTracer, file: &Path) -> anyhow::Result<()> {
    let sums = tracer.checkpoint();
    let written = write_atomically(file, |out| std::io::Write::write_all(out, &sums));
    written.map_err(|error| {
        let reason = format!("{}: cannot write the checkpoint: {error}", file.display());
        Failure::output(reason + "; check the folder and its permissions").into()
    })
}

/// Writes a part, whole or not at all.
fn write_part(part: &ReferencePart, file: &Path) -> anyhow::Result<()> {
    let bytes = part.to_bytes();
    let written = write_atomically(file, |out| std::io::Write::write_all(out, &bytes));
    written.map_err(|error| {
        let reason = format!("{}: cannot write the part: {error}", file.display());
        Failure::output(reason + "; check the folder and its permissions").into()
    })
}

fn resume(tracer: &mut PathTracer, file: &Path) -> anyhow::Result<()> {
    let checkpoint = match read_regular(file) {
        Ok(checkpoint) => checkpoint,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => {
            return Err(Failure::input(format!(
                "{}: cannot read the checkpoint: {error}; check its permissions",
                file.display()
            ))
            .into());
        }
    };
    let resumed = tracer.resume(&checkpoint);
    resumed.map_err(|error| Failure::input(format!("{}: {error}", file.display())))?;
    tracing::info!("going on after {} samples", tracer.samples());
    Ok(())
}

/// Writes a reference: all layers as OpenEXR, or the picture as PNG.
///
/// # Errors
/// When the file cannot be written.
pub fn write(layers: &ReferenceLayers, gpu: &Gpu, file: &Path) -> anyhow::Result<()> {
    match ImageFormat::from_path(file)? {
        ImageFormat::Exr => layers.write_exr(file)?,
        ImageFormat::Png => {
            let hdr = layers.picture();
            let (exposure, curve) = (Exposure::Auto, ToneMap::default());
            let picture = Picture::develop(gpu, layers.size, hdr, exposure, curve);
            pollster::block_on(picture)?.write(file)?;
        }
    }
    Ok(())
}

/// The noise of each layer, in per cent: the root of the mean variance over the mean. `None` if the
/// layer is black or has one sample.
#[derive(Clone, Debug, Serialize)]
pub struct Noise {
    radiance: Option<f64>,
    direct: Option<f64>,
    one_bounce: Option<f64>,
    full: Option<f64>,
}

impl Noise {
    /// The noise of some layers.
    pub fn of(layers: &ReferenceLayers) -> Self {
        Self {
            radiance: noise_percent(&layers.radiance, &layers.radiance_variance),
            direct: noise_percent(&layers.direct, &layers.direct_variance),
            one_bounce: noise_percent(&layers.one_bounce, &layers.one_bounce_variance),
            full: noise_percent(&layers.full, &layers.full_variance),
        }
    }
}

impl Noise {
    /// The noise for people.
    pub fn text(&self) -> String {
        let noise =
            |name: &str, value: Option<f64>| value.map(|value| format!("{name} {value:.2} %"));
        let noises: Vec<String> = [
            noise("picture", self.radiance),
            noise("one bounce", self.one_bounce),
            noise("all bounces", self.full),
        ]
        .into_iter()
        .flatten()
        .collect();
        if noises.is_empty() { "unknown".to_owned() } else { noises.join(", ") }
    }
}

fn noise_percent(pixels: &[[f32; 3]], variances: &[f32]) -> Option<f64> {
    let channels = pixels.as_flattened();
    let mean = channels.iter().copied().map(f64::from).sum::<f64>() / channels.len() as f64;
    let sum: f64 = variances.iter().copied().map(f64::from).sum();
    let variance = sum / variances.len() as f64;
    (mean > 0.0 && variance.is_finite()).then(|| 100.0 * variance.sqrt() / mean)
}

#[derive(Clone, Debug, Serialize)]
struct Report {
    file: String,
    /// The first batch of a part, and the one after its last.
    #[serde(skip_serializing_if = "Option::is_none")]
    batches: Option<[u32; 2]>,
    size: [u32; 2],
    scene: SceneCounts,
    camera: String,
    /// Samples of each pixel.
    samples: u32,
    /// Samples of each pixel that come from the checkpoint.
    samples_before: u32,
    /// `true` if all requested samples were traced.
    is_complete: bool,
    noise_percent: Noise,
    seconds: f64,
    adapter: AdapterReport,
}

impl Report {
    fn text(&self) -> String {
        let [width, height] = self.size;
        let stopped = if self.is_complete { "" } else { " (stopped early)" };
        let noises = self.noise_percent.text();
        format!(
            "{}: {width} x {height}, {} samples a pixel{stopped}, {:.1} s; noise: {noises}\n",
            self.file, self.samples, self.seconds
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels with a mean of 5 and a mean variance of 0.25: the deviation is 0.5, a tenth of
    /// the mean.
    #[test]
    fn noise_is_the_deviation_over_the_mean() {
        let pixels = [[4.0, 5.0, 6.0], [6.0, 5.0, 4.0]];
        let noise = noise_percent(&pixels, &[0.4, 0.1]).unwrap();
        assert!((noise - 10.0).abs() < 1e-5, "{noise} %");
        assert_eq!(noise_percent(&[[0.0; 3]], &[0.1]), None, "black");
        assert_eq!(noise_percent(&[[1.0; 3]], &[f32::NAN]), None, "a single sample");
    }
}
