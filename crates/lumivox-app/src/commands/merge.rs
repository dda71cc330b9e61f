//! `lumivox merge`: adds up the parts of a reference.

use lumivox_console::Failure;
use lumivox_console::report::counted;
use lumivox_render::ImageFormat;
use lumivox_render::reference::{BATCH, PartError, ReferenceLayers, ReferenceMerge, ReferencePart};
use lumivox_scene::read_regular;
use serde::Serialize;

use super::reference::{Noise, write};
use crate::args::output;
use crate::cli::MergeArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;

/// Reads, adds and writes.
///
/// # Errors
/// When a part cannot be read or does not fit, or the picture cannot be written; the message says
/// what.
pub fn run(args: &MergeArgs, host: &Host) -> anyhow::Result<()> {
    output::check(&args.output)?;
    let progress = ProgressDisplay::start(host, "adding parts");
    let mut merge = ReferenceMerge::new(args.allow_mixed);
    let total = args.parts.len() as u32;
    for (done, file) in args.parts.iter().enumerate() {
        progress.set("adding parts", done as u32, total);
        let fail =
            |error: PartError| anyhow::Error::from(error).context(file.display().to_string());
        let bytes = read_regular(file).map_err(|error| {
            Failure::input(format!(
                "{}: cannot read the part: {error}; check the path and its permissions",
                file.display()
            ))
        })?;
        let part = ReferencePart::from_bytes(&bytes).map_err(fail)?;
        merge.add(part).map_err(fail)?;
    }
    progress.set("writing", 0, 1);
    let Some(layers) = merge.layers()? else { return Ok(()) };
    write_layers(&layers, args, host)?;
    drop(progress);
    let report = Report {
        file: args.output.display().to_string(),
        size: layers.size.to_array(),
        parts: merge.count(),
        batches: layers.samples / BATCH,
        samples: layers.samples,
        noise_percent: Noise::of(&layers),
    };
    if args.json { host.print_json(&report) } else { host.print(&report.text()) }
}

/// Writes the picture. Only a PNG file needs a GPU.
fn write_layers(layers: &ReferenceLayers, args: &MergeArgs, host: &Host) -> anyhow::Result<()> {
    match ImageFormat::from_path(&args.output)? {
        ImageFormat::Exr => Ok(layers.write_exr(&args.output)?),
        ImageFormat::Png => write(layers, &host.open_gpu(&args.gpu.options())?, &args.output),
    }
}

#[derive(Clone, Debug, Serialize)]
struct Report {
    file: String,
    size: [u32; 2],
    /// Distinct parts.
    parts: usize,
    /// Number of batches of 16 samples.
    batches: u32,
    /// Samples of each pixel.
    samples: u32,
    noise_percent: Noise,
}

impl Report {
    fn text(&self) -> String {
        let [width, height] = self.size;
        format!(
            "{}: {width} x {height}, {} samples a pixel from {}; noise: {}\n",
            self.file,
            self.samples,
            counted(self.parts, "part", "parts"),
            self.noise_percent.text()
        )
    }
}
