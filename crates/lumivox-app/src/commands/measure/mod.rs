//! `lumivox measure`: light as numbers, by cones or by the path tracer.
//!
//! | file | is |
//! | --- | --- |
//! | `places.rs` | the points, rays or pixels that are measured |
//! | `readings.rs` | the light at these places, by either method |
//! | `report.rs` | tables, JSON and the sentence at the end |

mod places;
mod readings;
mod report;

use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use lumivox::VolumeKind;
use lumivox_console::report::AdapterReport;
use lumivox_console::{Failure, SourceArgs};
use lumivox_render::measure::Summary;
use lumivox_scene::{Picker, write_atomically};

use super::staged::stage;
use crate::args::{output, scene};
use crate::cli::{MeasureArgs, Method};
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::quality::{FalseColor, false_color_png};
use crate::{light, settings};
use places::Places;
pub use readings::{Task, gathers};
use report::Report;

/// The kind of an output file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Csv,
    Json,
    Png,
}

/// Measures, writes and reports.
///
/// # Errors
/// When any step fails; the message says which.
pub fn run(args: &MeasureArgs, host: &Host) -> anyhow::Result<()> {
    let kinds = args.output.iter().map(|file| check(file, args)).collect::<Result<Vec<_>, _>>()?;
    if args.rays.is_some() && args.method == Method::Cones {
        return Err(Failure::input(
            "--rays: cones have no single lines of sight; add --method paths, or measure a --picture",
        )
        .into());
    }
    for (option, is_given) in
        [("--area", args.area.is_some()), ("--spacing", args.spacing.is_some())]
    {
        if is_given && args.workplane.is_none() {
            let reason =
                format!("{option}: only a workplane has one; give its height with --workplane");
            return Err(Failure::input(reason).into());
        }
    }
    let places = Places::read(args)?;
    let given = [args.voxels.given(), args.light.given(), args.cones.settings.given()].concat();
    let settings = settings::of(args.cones.preset(), args.size, &given)?;
    scene::check(&args.scene.scene)?;
    light::check(&args.sources)?;
    let start = Instant::now();
    let mut progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    // No default light is added, unless --surroundings asks for some.
    let adds = args.sources.surroundings.is_some();
    let sources = SourceArgs { no_default_light: !adds, ..args.sources.clone() };
    let (scene, camera) =
        stage(&args.scene.scene, &args.scene.load, &sources, &args.view, args.size, &progress)?;
    let places = places.of_scene(&scene, args)?;
    progress.stop_on_interrupt(host)?;
    let shadow_maps =
        settings.fineness(&scene).shadow_maps.filter(|_| args.method == Method::Cones);
    let shade_remedy = if settings.volume == VolumeKind::Cascades {
        "Measure places that are far from each other one by one, or use --method paths."
    } else {
        "Use --volume cascades, which have finer ones around the places, or --method paths."
    };
    let bounces = given.iter().any(|(parameter, _)| parameter.name == "bounces");
    let bounces = bounces.then_some(settings.bounces);
    let task = Task { gpu: &gpu, scene: &scene, camera: &camera, progress: &progress };
    let readings = match args.method {
        Method::Cones => task.by_cones(&places, settings, args.frames)?,
        Method::Paths => task.by_paths(&places, args, bounces)?,
    };
    progress.set("writing", 0, 1);
    let values: Vec<f32> = readings.iter().map(|reading| reading.value).collect();
    // A picture has no places to check.
    let picker = (!places.at.is_empty()).then(|| Picker::new(&scene));
    let report = Report {
        scene: scene.name.clone(),
        what: places.what(),
        unit: places.unit(),
        size: places.size.map(|size| size.to_array()),
        method: match args.method {
            Method::Cones => "cones",
            Method::Paths => "paths",
        },
        frames: (args.method == Method::Cones).then_some(args.frames),
        samples: (args.method == Method::Paths).then_some(args.samples),
        summary: Summary::of(&values),
        seconds: start.elapsed().as_secs_f64(),
        adapter: AdapterReport::new(&gpu.adapter_info),
        inside: picker.as_ref().map_or_else(Vec::new, |picker| places.inside(picker)),
        in_lost_shade: picker
            .zip(shadow_maps)
            .map_or_else(Vec::new, |(picker, maps)| places.in_lost_shade(&scene, &picker, maps)),
        shade_remedy,
        places: &places,
        readings: &readings,
    };
    for (file, kind) in args.output.iter().zip(kinds) {
        let bytes = match kind {
            Kind::Csv => report.csv().into_bytes(),
            Kind::Json => report.json().to_string().into_bytes(),
            Kind::Png => picture(&report, &values, args.scale)?,
        };
        write(file, &bytes)?;
    }
    drop(progress);
    if args.json { host.print_json(&report.json()) } else { host.print(&report.text(&args.output)) }
}

/// Returns the kind of an output file, and checks that it can be written.
fn check(file: &Path, args: &MeasureArgs) -> anyhow::Result<Kind> {
    let ending = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let kind = match ending.as_str() {
        "csv" => Kind::Csv,
        "json" => Kind::Json,
        "png" if args.points.is_some() || args.rays.is_some() => {
            return Err(Failure::input(format!(
                "{}: points and rays have no picture; write .csv or .json, or measure a --workplane or a --picture",
                file.display()
            ))
            .into());
        }
        "png" => Kind::Png,
        _ => {
            return Err(Failure::input(format!(
                "{}: unknown kind of file; end the name in .csv, .json or .png",
                file.display()
            ))
            .into());
        }
    };
    output::check_folder(file, &output::folder_of(file))?;
    Ok(kind)
}

/// The picture in false colours, as PNG.
fn picture(
    report: &Report<'_>,
    values: &[f32],
    range: Option<(f32, f32)>,
) -> anyhow::Result<Vec<u8>> {
    let size = report.places.size.unwrap_or_default();
    let (title, figures) = (report.title(), report.figures());
    let (title, figures, unit) = (title.as_str(), figures.as_str(), report.unit);
    Ok(false_color_png(&FalseColor { title, figures, values, size, unit, range })?)
}

/// Writes a file, complete or not at all.
fn write(file: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_atomically(file, |out| out.write_all(bytes)).map_err(|error| {
        let reason = format!("{}: cannot write the readings: {error}", file.display());
        Failure::output(reason + "; check the folder and its permissions").into()
    })
}
