//! What the window and scripts start from.

use clap::Args;
use lumivox_console::{Failure, LoadArgs, SceneSource};
use lumivox_render::RenderSettings;

use super::load::scene_source;
use super::{ConeArgs, GpuArgs, LightArgs, PictureArgs};
use crate::args::settings::{Given, SettingArgs, VolumeGroups};
use crate::commands::settings;

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
    pub voxels: SettingArgs<VolumeGroups>,

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

impl ExploreArgs {
    /// The settings that the command line gives.
    pub fn given(&self) -> Vec<Given> {
        let Self { picture, voxels, light, cones, .. } = self;
        given([picture.settings.given(), voxels.given(), light.settings.given()], cones)
    }

    /// All settings that the first picture has.
    ///
    /// # Errors
    /// When two options contradict each other.
    pub fn settings(&self) -> Result<RenderSettings, Failure> {
        settings::of(self.cones.preset(), self.picture.size, &self.given())
    }
}

/// All settings that a command line gives, those of the cones last.
pub fn given(others: [&[Given]; 3], cones: &ConeArgs) -> Vec<Given> {
    [others.concat().as_slice(), cones.settings.given()].concat()
}
