//! The arguments of `compare`.

use std::path::PathBuf;

use clap::Args;

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox compare --images reference.exr ours.exr
  lumivox compare --images reference.exr ours.exr -o strip.png --json
";

/// What is compared, and how it is told.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// Two picture files of one size: the reference, and the one that is held against it (.exr, .hdr,
    /// .png or .jpg) [required]
    ///
    /// OpenEXR and Radiance hold linear light. PNG and JPEG are decoded from sRGB; they hold what a
    /// screen shows, so both must have been made with the same exposure and curve.
    #[arg(long, num_args = 2, value_names = ["REFERENCE", "OURS"], required = true)]
    #[arg(help_heading = "Pictures")]
    pub images: Vec<PathBuf>,

    /// Name of the layer to take from OpenEXR files that name their layers [default: the one without
    /// a name, else the first]
    ///
    /// It is what stands before the last dot of its channels' names, as in full.R, or a part's name.
    #[arg(long, value_name = "NAME", requires = "images", help_heading = "Pictures")]
    pub layer: Option<String>,

    /// PNG file to write a strip to: the reference, ours, and where ours is too dark or too bright
    /// [default: none]
    ///
    /// Small pictures are enlarged. A file of that name is replaced.
    #[arg(short, long, value_name = "FILE", help_heading = "Pictures")]
    pub output: Option<PathBuf>,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}
