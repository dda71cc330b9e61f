//! `lumivox compare`: errors of pictures against references.

mod files;
mod scene;

use lumivox_console::Failure;

use crate::args::output;
use crate::cli::CompareArgs;
use crate::host::Host;

/// Compares a scene with its reference, or two pictures, and reports.
///
/// # Errors
/// When something cannot be read or rendered, the two cannot be compared, or the strip cannot be
/// written.
pub fn run(args: &CompareArgs, host: &Host) -> anyhow::Result<()> {
    if let Some(file) = &args.output {
        output::check_kind(file, "png", "strips are written as PNG")?;
    }
    match (args.images.as_slice(), &args.scene) {
        ([reference, ours], _) => files::run(reference, ours, args, host),
        (_, Some(scene)) => scene::run(scene, args, host),
        _ => Err(Failure::input("give a SCENE, or --images REFERENCE OURS").into()),
    }
}
