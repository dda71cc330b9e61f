//! The arguments of `voxelizers`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use lumivox_app::parts::{GpuArgs, SceneArg};
use lumivox_console::values::camera::{self, CameraChoice};
use lumivox_console::values::{number, size};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab voxelizers builtin:atrium
  lumivox-lab voxelizers builtin:cornell --rotate 17,31,5 --resolution 40 -o turned.png
";

/// The arguments of `voxelizers`.
#[derive(Args, Debug)]
pub struct VoxelizersArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// Voxels along the scene's longest axis, a multiple of 8 from 16 to 1024
    #[arg(long, value_name = "VOXELS", value_parser = number::resolution, default_value = "128")]
    #[arg(allow_hyphen_values = true, help_heading = "Voxels")]
    pub resolution: u32,

    /// Picture's file, .png: the voxels of each voxelizer as cubes, missing ones in magenta, extra
    /// ones in cyan [default: none]
    ///
    /// A file of that name is replaced once the picture is complete, never half.
    #[arg(short, long, value_name = "FILE", help_heading = "Picture")]
    pub output: Option<PathBuf>,

    /// Width and height of each voxelizer's picture in pixels, each from 1 to 32768
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, requires = "output")]
    #[arg(default_value = "400x300", allow_hyphen_values = true, help_heading = "Picture")]
    pub size: UVec2,

    /// The camera: its name or number, or position and target in metres [default: the scene's first
    /// camera, else `framing`, the view that shows the scene best]
    ///
    /// As for `lumivox render`.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true, requires = "output", help_heading = "Picture")]
    pub camera: Option<CameraChoice>,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
