//! `lumivox info`: the report on this machine, or on a scene.

mod machine;
mod scene;

use crate::cli::InfoArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::settings;

/// Describes the scene if one is named, and the machine otherwise.
///
/// # Errors
/// When the scene cannot be read, or stdout cannot be written. A machine without a GPU is not an
/// error.
pub fn run(args: &InfoArgs, host: &Host) -> anyhow::Result<()> {
    let Some(source) = &args.scene else {
        let report = machine::Report::new();
        return if args.json { host.print_json(&report) } else { host.print(&report.text()) };
    };
    crate::args::scene::check(source)?;
    let settings = settings::of_voxels(&args.voxels)?;
    let progress = ProgressDisplay::start(host, "loading");
    let scene = crate::args::scene::load(source, &args.load, &progress)?;
    let report = scene::Report::new(&scene, &settings)?;
    drop(progress);
    if args.json { host.print_json(&report) } else { host.print(&report.text()) }
}
