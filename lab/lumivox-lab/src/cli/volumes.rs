//! The arguments of `volumes`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use lumivox_app::parts::{GpuArgs, SceneArg};
use lumivox_console::values::{number, size};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab volumes builtin:cornell
  lumivox-lab volumes hall.glb --resolutions 64,128,256,512,1024 --no-trace -o memory.svg
  lumivox-lab volumes builtin:atrium --resolutions 128 --alternatives
";

/// The arguments of `volumes`.
#[derive(Args, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each is a switch of the command line")]
pub struct VolumesArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// Voxels along the scene's longest axis, separated by commas: multiples of 8 from 16 to 1024
    ///
    /// Volumes that do not fit the GPU are reported as such.
    #[arg(long, value_name = "VOXELS", value_delimiter = ',', value_parser = number::resolution)]
    #[arg(default_value = "64,128,256", allow_hyphen_values = true, help_heading = "Measurement")]
    pub resolutions: Vec<u32>,

    /// Keep one radiance a voxel instead of one for each of six directions [default: off]
    #[arg(long, help_heading = "Measurement")]
    pub isotropic: bool,

    /// Also measure an octree whose nodes are made by locks [default: off]
    #[arg(long, help_heading = "Measurement")]
    pub alternatives: bool,

    /// Do not measure the time of frames [default: off]
    #[arg(long, help_heading = "Measurement")]
    pub no_trace: bool,

    /// Width and height of the frames in pixels, each from 1 to 32768 (or to the GPU's own limit)
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size)]
    #[arg(default_value = "320x180", allow_hyphen_values = true, help_heading = "Measurement")]
    #[arg(conflicts_with = "no_trace")]
    pub size: UVec2,

    /// File for a chart of memory against resolution, .svg [default: none]
    ///
    /// A file of that name is replaced once the new one is complete, never half.
    #[arg(short, long, value_name = "FILE", help_heading = "Measurement")]
    pub output: Option<PathBuf>,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
