//! Comparison of a rendered scene with its reference.

use std::time::Instant;

use lumivox_console::report::AdapterReport;
use lumivox_console::{Comparison, SceneSource, shown};
use lumivox_render::RenderSettings;
use lumivox_render::reference::ReferenceSettings;
use serde::Serialize;

use crate::args::output;
use crate::cli::CompareArgs;
use crate::commands::staged::stage;
use crate::host::Host;
use crate::light;
use crate::progress::ProgressDisplay;
use crate::quality::{Measured, Subject, reference, strip, write_strip};
use crate::settings;

/// Renders, traces, compares and reports.
///
/// # Errors
/// When the scene cannot be read or rendered, or a file cannot be written.
pub fn run(source: &SceneSource, args: &CompareArgs, host: &Host) -> anyhow::Result<()> {
    let given =
        [args.voxels.given(), args.light.settings.given(), args.cones.settings.given()].concat();
    let settings = settings::of(args.cones.preset(), args.size, &given)?;
    let settings = RenderSettings { frames: args.frames, ..settings };
    if let Some(file) = &args.reference {
        output::check_kind(file, "exr", "references are written as OpenEXR")?;
    }
    crate::args::scene::check(source)?;
    light::check(&args.light.sources)?;
    let start = Instant::now();
    let mut progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    settings.validate(&gpu.device.limits())?;
    let (scene, camera) =
        stage(source, &args.load, &args.light.sources, &args.view, args.size, &progress)?;
    progress.stop_on_interrupt(host)?;
    let subject = Subject { gpu: &gpu, scene: &scene, camera: &camera, progress: &progress };
    let truth = ReferenceSettings {
        size: args.size,
        samples: args.samples,
        occlusion_distance_m: settings.trace.occlusion_distance_m,
        ..ReferenceSettings::default()
    };
    let truth = reference(&subject, truth, args.reference.as_deref())?;
    let measured = Measured::new(&subject, &truth, &settings, args.offsets)?;
    let figures = &measured.figures;
    let comparison = Comparison {
        scene: Some(scene.name.clone()),
        size: args.size.to_array(),
        one_bounce: figures.one_bounce,
        full: figures.full,
        final_picture: figures.picture,
        leak_percent: measured.leak.map(|leak| leak.one_bounce_percent),
        leak_full_percent: measured.leak.map(|leak| leak.full_percent),
        ..Comparison::default()
    };
    if let Some(file) = &args.output {
        progress.set("drawing", 0, 1);
        let title = format!("{}, camera {}", scene.name, camera.name);
        write_strip(file, &strip(&title, &measured.rows(&truth))?)?;
    }
    drop(progress);
    let report = Report {
        comparison,
        camera: camera.name.clone(),
        samples: truth.layers.samples,
        grid_offsets: args.offsets,
        frame_ms: measured.cost.frame_ms,
        samples_per_pixel: measured.cost.samples_per_pixel,
        settings,
        seconds: start.elapsed().as_secs_f64(),
        adapter: AdapterReport::new(&gpu.adapter_info),
    };
    if args.json { host.print_json(&report) } else { host.print(&report.text(args)) }
}

#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    comparison: Comparison,
    camera: String,
    /// Samples of each pixel of the reference.
    samples: u32,
    /// Grid positions that the figures are averaged over.
    grid_offsets: u32,
    /// Wall-clock time of a frame, without one-time work, ms.
    frame_ms: f64,
    /// Cone samples of a pixel in a frame.
    samples_per_pixel: f64,
    #[serde(serialize_with = "settings::serialize")]
    settings: RenderSettings,
    seconds: f64,
    adapter: AdapterReport,
}

impl Report {
    fn text(&self, args: &CompareArgs) -> String {
        let [width, height] = self.comparison.size;
        let scene = shown::line(self.comparison.scene.as_deref().unwrap_or_default());
        let mut text = format!(
            "{scene}, camera {}, {width}x{height}; reference of {} samples a pixel; mean of {} places of the \
             grid\n\n{}",
            shown::line(&self.camera),
            self.samples,
            self.grid_offsets,
            self.comparison.table()
        );
        text += &format!(
            "\n  {:.1} ms a frame, {:.0} cone samples a pixel\n",
            self.frame_ms, self.samples_per_pixel
        );
        if let Some(file) = &args.output {
            text += &format!("\n{}: reference, ours, error\n", file.display());
        }
        text
    }
}
