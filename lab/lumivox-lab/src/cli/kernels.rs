//! The arguments of `kernels`.

use std::path::PathBuf;

use clap::Args;
use lumivox_app::parts::GpuArgs;

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab kernels
  lumivox-lab kernels -o docs/generated/kernels.md
  lumivox-lab kernels --against docs/generated/kernels.md
";

/// The arguments of `kernels`.
#[derive(Args, Debug)]
pub struct KernelsArgs {
    /// Page's file, .md [default: none, the table is printed]
    ///
    /// A file of that name is replaced.
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub output: Option<PathBuf>,

    /// Page's file to compare with, .md [default: none]
    ///
    /// The command fails if a kernel needs a tenth more registers or instructions than in the page,
    /// or spills. Pages of other versions of the driver are not compared.
    #[arg(long, value_name = "FILE", help_heading = "Output", conflicts_with = "output")]
    pub against: Option<PathBuf>,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
