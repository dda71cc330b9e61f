//! The arguments of `voxels`.

use clap::Args;

use super::{GpuArgs, SceneArg};
use crate::args::settings::{SettingArgs, VolumeGroups};

/// The arguments of `voxels`.
#[derive(Args, Debug)]
pub struct VoxelsArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The voxels.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
