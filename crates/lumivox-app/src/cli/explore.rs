//! The initial state of the window and of scripts.

use clap::Args;
use lumivox_console::{Failure, LoadArgs, SceneSource};
use lumivox_render::RenderSettings;

use super::load::scene_source;
use super::{ConeArgs, GpuArgs, LightArgs, PictureArgs};
use crate::args::settings::{Given, SettingArgs, VolumeGroups};
use crate::settings;

/// A scene, or none yet, and the settings of its first picture.
#[derive(Args, Debug)]
pub struct ExploreArgs {
    /// The scene to open: a file, or builtin:NAME [default: none]
    ///
    /// `lumivox scenes` lists the built-in ones.
    #[arg(long, value_name = "SCENE", value_parser = scene_source(), help_heading = "Scene")]
    pub scene: Option<SceneSource>,

    /// How its file, and those of scenes opened later, are read.
    #[command(flatten)]
    pub load: LoadArgs,

    /// Size, camera, view and exposure of the picture.
    #[command(flatten)]
    pub picture: PictureArgs,

    /// The voxels.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Light, and how it is found.
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
    /// The settings given on the command line.
    pub fn given(&self) -> Vec<Given> {
        let Self { picture, voxels, light, cones, .. } = self;
        given([picture.settings.given(), voxels.given(), light.settings.given()], cones)
    }

    /// All settings of the first picture.
    ///
    /// # Errors
    /// When two options contradict each other.
    pub fn settings(&self) -> Result<RenderSettings, Failure> {
        settings::of(self.cones.preset(), self.picture.size, &self.given())
    }
}

/// All settings given on a command line, those of the cones last.
pub fn given(others: [&[Given]; 3], cones: &ConeArgs) -> Vec<Given> {
    [others.concat().as_slice(), cones.settings.given()].concat()
}
