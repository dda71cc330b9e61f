//! What the window and scripts start from.

use clap::Args;
use lumivox_console::{LoadArgs, SceneSource};

use super::load::scene_source;
use super::{GpuArgs, LightArgs, PictureArgs, VoxelArgs};
use crate::args::cones::ConeArgs;

/// A scene, or none yet, and the settings that its first picture has.
#[derive(Args, Debug)]
pub struct ExploreArgs {
    /// The scene to begin with: a file, or builtin:NAME [default: none]
    ///
    /// `lumivox scenes` lists the built-in ones.
    #[arg(long, value_name = "SCENE", value_parser = scene_source(), help_heading = "Scene")]
    pub scene: Option<SceneSource>,

    /// How its file is read, and those of scenes that are opened later.
    #[command(flatten)]
    pub load: LoadArgs,

    /// What the picture shows, and how.
    #[command(flatten)]
    pub picture: PictureArgs,

    /// The voxels.
    #[command(flatten)]
    pub voxels: VoxelArgs,

    /// What shines.
    #[command(flatten)]
    pub light: LightArgs,

    /// The cones.
    #[command(flatten)]
    pub cones: ConeArgs,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
