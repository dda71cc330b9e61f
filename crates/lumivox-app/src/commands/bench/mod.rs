//! `lumivox bench`: the speed of standard cases on this machine, beside published figures.

mod clock;
mod machine;
mod measure;
mod motion;
mod page;
mod plan;
mod report;
mod visitors;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use lumivox_console::Failure;
use lumivox_scene::{Staging, builtin};

use super::kept::Kept;
use super::staged;
use crate::args::{output, scene};
use crate::cli::BenchArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use machine::Machine;
use measure::{Bench, Subject};
use page::page;
use plan::{Case, Motion, Plan};
use report::{FORMAT, Report, Row};

/// The report that was published with the last release, made by this command.
const PUBLISHED: &str = include_str!("published.json");
/// The scene on which clocks are compared.
const CLOCK_SCENE: &str = "cornell";

/// Measures, and writes the reports; or imports results of the page.
///
/// # Errors
/// When a scene cannot be read, there is no GPU, or a file cannot be written. A case that cannot be
/// measured is not an error: its row has the reason.
pub fn run(args: &BenchArgs, host: &Host) -> anyhow::Result<()> {
    if !args.import.is_empty() {
        return host.print(&visitors::table(&args.import)?);
    }
    for source in &args.scenes {
        scene::check(source)?;
    }
    if let Some(file) = &args.output {
        output::check_kind(file, "md", "the report is written as Markdown")?;
    }
    let json = args.json.as_deref();
    let is_json_on_stdout = json == Some(Path::new("-"));
    if let Some(file) = json.filter(|_| !is_json_on_stdout) {
        output::check_kind(file, "json", "the figures are written as JSON")?;
    }
    let mut progress = ProgressDisplay::start(host, "loading");
    let mut gpu = host.open_gpu(&args.gpu.options())?;
    let plan = Plan::new(args, gpu.is_software());
    let subjects = subjects(args, &plan, &progress)?;
    progress.stop_on_interrupt(host)?;
    progress.set("comparing clocks", 0, 1);
    let (timing, timing_report) = clock::choose(&gpu, &builtin::scene(CLOCK_SCENE)?);
    let mut report = Report {
        format: FORMAT,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        build: if cfg!(debug_assertions) { "debug" } else { "release" }.to_owned(),
        machine: Machine::new(&gpu),
        cases: plan.words.to_owned(),
        frames: args.frames,
        timing: timing_report,
        rows: Vec::new(),
    };
    let settings = format!("{} frames, {}, {}", report.frames, report.build, report.version);
    let mut kept = Kept::open(args.cache.as_deref(), settings)?;
    let total = (plan.cases.len() * Motion::ALL.len()) as u32;
    for (case, motion) in
        plan.cases.iter().flat_map(|case| Motion::ALL.map(|motion| (case, motion)))
    {
        let id = case.id(motion);
        if let Some(row) = kept.get(&id) {
            report.rows.push(Row::clone(row));
            continue;
        }
        let done = report.rows.len() as u32;
        progress.set("measuring", done, total);
        // If a case lost the device, open it again; if that fails, later cases report the loss.
        if gpu.is_lost()
            && let Ok(another) = host.open_gpu(&args.gpu.options())
        {
            gpu = another;
        }
        let bench =
            Bench { gpu: &gpu, timing, frames: args.frames, progress: &progress, done, total };
        let row = measure(&bench, &subjects[case.scene], case, motion);
        if progress.is_stopped() {
            break;
        }
        kept.put(id, row.clone())?;
        report.rows.push(row);
    }
    let is_stopped = progress.is_stopped();
    drop(progress);
    write(args, host, &report, is_json_on_stdout)?;
    if is_stopped {
        let done = report.rows.len();
        return Err(Failure::stopped(format!(
            "stopped after {done} of {total} measurements, which were written"
        ))
        .into());
    }
    Ok(())
}

/// Measures a case; its row reports errors and panics.
fn measure(bench: &Bench<'_>, subject: &Subject, case: &Case, motion: Motion) -> Row {
    let measured = catch_unwind(AssertUnwindSafe(|| bench.measure(subject, case, motion)));
    let measured = match measured {
        Ok(measured) => measured.map_err(|error| error.to_string()),
        // The panic hook has printed the message.
        Err(_) => Err("a defect of Lumivox or of the driver; stderr has its message".to_owned()),
    };
    Row::new(case, motion, measured)
}

/// Loads and lights the scenes.
fn subjects(
    args: &BenchArgs,
    plan: &Plan,
    progress: &ProgressDisplay,
) -> anyhow::Result<Vec<Subject>> {
    let largest = plan.cases.iter().map(|case| case.size).max_by_key(|size| size.x * size.y);
    let size = largest.unwrap_or_default();
    let load = |source| {
        let mut scene = scene::load(source, &args.load, progress)?;
        let camera = staged::look_at(&mut scene, None, size, Staging::Auto, progress)?;
        Ok(Subject { scene, camera })
    };
    plan.scenes.iter().map(load).collect()
}

/// The published report.
fn published() -> Option<Report> {
    serde_json::from_str(PUBLISHED).ok()
}

/// Writes the report files, and prints the report that goes to stdout.
fn write(
    args: &BenchArgs,
    host: &Host,
    report: &Report,
    is_json_on_stdout: bool,
) -> anyhow::Result<()> {
    let page = page(report, published().as_ref());
    if let Some(file) = &args.output {
        output::write(file, page.as_bytes())?;
    }
    match &args.json {
        Some(_) if is_json_on_stdout => return host.print_json(report),
        Some(file) => {
            output::write(file, format!("{}\n", serde_json::to_string_pretty(report)?).as_bytes())?;
        }
        None => {}
    }
    if args.output.is_some() { Ok(()) } else { host.print(&page) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every case that a software driver measures without options is in the published report, which
    /// names its build.
    #[test]
    fn the_published_report_has_the_current_format_and_cases() {
        let published: Report = serde_json::from_str(PUBLISHED).unwrap();
        assert_eq!(published.format, FORMAT);
        assert!(["release", "debug"].contains(&published.build.as_str()));
        assert!(!published.machine.name.is_empty() && !published.rows.is_empty());
        let plan = plan::tests::plan("", true);
        for case in &plan.cases {
            for motion in Motion::ALL {
                let id = case.id(motion);
                let row = published.rows.iter().find(|row| row.id == id);
                assert!(row.is_some(), "{id} is missing");
            }
        }
        let measured = published.rows.iter().filter_map(|row| row.figures.as_ref());
        assert!(measured.clone().count() > published.rows.len() / 2);
        assert!(measured.clone().all(|figures| figures.frame.whole.median > 0.0));
    }
}
