//! `lumivox compare`: errors of pictures against references.

mod files;
mod scene;

use std::io;
use std::path::Path;

use image::RgbImage;
use image::codecs::png::PngEncoder;
use lumivox_console::Failure;
use lumivox_scene::write_atomically;

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

/// Writes a strip as PNG, complete or not at all.
///
/// # Errors
/// A [`Failure`] of output that names the file.
pub fn write_strip(file: &Path, image: &RgbImage) -> anyhow::Result<()> {
    let written = write_atomically(file, |out| {
        image.write_with_encoder(PngEncoder::new(out)).map_err(io::Error::other)
    });
    let failure = |error| format!("{}: cannot write the strip: {error}", file.display());
    written.map_err(|error| {
        Failure::output(failure(error) + "; check the folder and its permissions").into()
    })
}
