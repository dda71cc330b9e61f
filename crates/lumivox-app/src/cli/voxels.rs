//! The arguments of `voxels`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;

use super::{GpuArgs, SceneArg};
use crate::args::camera::{self, CameraChoice};
use crate::args::settings::{SettingArgs, VolumeGroups};
use crate::args::{number, size};

/// The arguments of `voxels`.
#[derive(Args, Debug)]
pub struct VoxelsArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The voxels.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Share of the triangles that moves, 0.0001 to 1: measure the gain of keeping the others
    /// [default: measure one voxelization of everything]
    ///
    /// Small objects are chosen first, and moved by up to three voxels at a time. Each move is
    /// voxelized and lit twice, as a whole and with the static surface kept, and both must give the
    /// same voxels with the same light, to the bit.
    #[arg(long, value_name = "SHARE", value_parser = number::number(0.0001..=1.0))]
    #[arg(help_heading = "Measurement", allow_negative_numbers = true)]
    #[arg(conflicts_with = "compare_voxelizers")]
    pub dynamic_share: Option<f32>,

    /// Number of moves for --dynamic-share, 1 to 1000
    #[arg(long, value_name = "MOVES", value_parser = number::whole(1..=1000))]
    #[arg(help_heading = "Measurement", default_value = "8", allow_negative_numbers = true)]
    #[arg(requires = "dynamic_share")]
    pub moves: u32,

    /// The comparison.
    #[command(flatten)]
    pub comparison: VoxelizersArgs,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// The comparison of all voxelizers.
#[derive(Args, Debug)]
#[command(next_help_heading = "Comparison")]
pub struct VoxelizersArgs {
    /// Voxelize with every voxelizer, and print the errors against the exact one [default: off]
    ///
    /// The voxels found, missing and extra; the share of the surface that is missed; the error of
    /// colours; and the time.
    #[arg(long, conflicts_with = "voxelizer")]
    pub compare_voxelizers: bool,

    /// Picture's file, .png: the voxels of each voxelizer as cubes, missing ones in magenta, extra
    /// ones in cyan [default: none]
    ///
    /// A file of that name is replaced once the picture is complete, never half.
    #[arg(short, long, value_name = "FILE", requires = "compare_voxelizers")]
    pub output: Option<PathBuf>,

    /// Width and height of each voxelizer's picture in pixels, each from 1 to 32768
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, requires = "output")]
    #[arg(default_value = "400x300", allow_hyphen_values = true)]
    pub size: UVec2,

    /// The camera: its name or number, or position and target in metres [default: the scene's first
    /// camera, else `framing`, the view that shows the scene best]
    ///
    /// As for `lumivox render`.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true, requires = "output")]
    pub camera: Option<CameraChoice>,
}
