//! `lumivox convert`: writes a scene as one GLB file.

use lumivox_console::Failure;
use lumivox_console::report::{SceneCounts, bytes, counted};
use serde::Serialize;

use crate::args::output;
use crate::args::scene;
use crate::cli::ConvertArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::timeline::choose;

/// Reads a scene, poses it if asked to, and writes it.
///
/// # Errors
/// When the scene cannot be read or posed, or the file cannot be written; the message says what.
pub fn run(args: &ConvertArgs, host: &Host) -> anyhow::Result<()> {
    output::check_kind(&args.output, "glb", "scenes are written as GLB")?;
    scene::check(&args.scene.scene)?;
    let progress = ProgressDisplay::start(host, "loading");
    let mut scene = args.scene.load(&progress)?;
    if args.time.is_some() || args.animation.is_some() {
        let Some(animation) = choose(args.animation.as_ref(), &scene)? else {
            return Err(Failure::input(format!(
                "nothing moves in the scene \"{}\": it has no animation; leave --time out",
                scene.name
            ))
            .into());
        };
        scene.pose(animation, args.time.unwrap_or(0.0))?;
    }
    progress.set("writing", 0, 1);
    scene.save_glb(&args.output)?;
    drop(progress);

    let written = std::fs::metadata(&args.output).map_or(0, |data| data.len());
    let file = args.output.display().to_string();
    let report = Report { file, bytes: written, scene: SceneCounts::new(&scene) };
    if args.json {
        return host.print_json(&report);
    }
    let scene = &report.scene;
    host.print(&format!(
        "{}: {}, {}, {}, {}\n",
        report.file,
        counted(scene.triangles, "triangle", "triangles"),
        counted(scene.materials, "material", "materials"),
        counted(scene.lights, "light", "lights"),
        bytes(report.bytes)
    ))
}

/// The report on what was written.
#[derive(Clone, Debug, Serialize)]
struct Report {
    file: String,
    /// The file's length.
    bytes: u64,
    scene: SceneCounts,
}
