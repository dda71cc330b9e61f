//! The arguments of `merge`.

use std::path::PathBuf;

use clap::Args;

use super::GpuArgs;

/// The arguments of `merge`.
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// The files of `lumivox reference --part`, in any order
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,

    /// The picture's file: .exr (floats, all layers) or .png (8 bits a channel, tone mapped) [required]
    ///
    /// A file of that name is replaced once the picture is complete, never half.
    #[arg(short, long, value_name = "FILE", help_heading = "Picture")]
    pub output: PathBuf,

    /// Add parts of different programs, GPUs and drivers, too [default: off]
    ///
    /// The mean is right, but it does not have the bits of one machine.
    #[arg(long, help_heading = "Parts")]
    pub allow_mixed: bool,

    /// The GPU, which exposes a .png.
    #[command(flatten)]
    pub gpu: GpuArgs,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}
