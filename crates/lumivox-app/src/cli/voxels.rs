//! How voxels are made and where their light is stored, and the comparison of the ways to make them.

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

    /// Share of the triangles that moves, 0.0001 to 1: measure what it saves to keep the others
    /// [default: measure one voxelization of everything]
    ///
    /// Small things are chosen first, and moved by up to three voxels at a time. Each move is voxelized
    /// and lit once as a whole and once keeping what is static, and both must give the same voxels and the
    /// same light of them, to the bit.
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

/// The comparison of all ways to make voxels.
#[derive(Args, Debug)]
#[command(next_help_heading = "Comparison")]
pub struct VoxelizersArgs {
    /// Voxelize in every way that there is, and tell how far each is from the exact one [default: off]
    ///
    /// Voxels found, missing and too many; the share of the surface that is missed; the error of
    /// colours; and the time.
    #[arg(long, conflicts_with = "voxelizer")]
    pub compare_voxelizers: bool,

    /// A picture's file, .png: what each way finds as cubes, what it misses in magenta, what it finds
    /// too many in cyan [default: none]
    ///
    /// A file of that name is replaced once the picture is complete, never half.
    #[arg(short, long, value_name = "FILE", requires = "compare_voxelizers")]
    pub output: Option<PathBuf>,

    /// Width and height of each way's part of the picture in pixels, each from 1 to 32768
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, requires = "output")]
    #[arg(default_value = "400x300", allow_hyphen_values = true)]
    pub size: UVec2,

    /// Where from: a camera's name or number, or position and target in metres [default: the
    /// scene's first camera, else `framing`, the view that shows it best]
    ///
    /// As of `lumivox render`.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true, requires = "output")]
    pub camera: Option<CameraChoice>,
}
