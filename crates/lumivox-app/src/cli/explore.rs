//! What the window and scripts start from.

use clap::Args;
use glam::UVec2;
use lumivox::MAX_RESOLUTION;
use lumivox_render::{ToneMap, View};

use super::load::scene_source;
use super::{GpuArgs, LightArgs, LoadArgs, VoxelArgs};
use crate::args::camera::{self, CameraChoice};
use crate::args::cones::ConeArgs;
use crate::args::number::ExposureChoice;
use crate::args::overlay::OverlayArgs;
use crate::args::scene::SceneSource;
use crate::args::{choices, number, size};

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

    /// Width and height of the picture in pixels, each from 1 to 32768 (or less, as the GPU allows)
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, help_heading = "Picture")]
    #[arg(default_value = "640x360", allow_hyphen_values = true)]
    pub size: UVec2,

    /// Frames that are averaged while nothing moves, 1 to 65536
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(help_heading = "Picture", default_value = "16", allow_negative_numbers = true)]
    pub frames: u32,

    /// Where from: a camera's name or number, or position and target in metres [default: the
    /// scene's first camera, else `framing`, the view that shows it best]
    ///
    /// As of `lumivox render`.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(help_heading = "Picture", allow_hyphen_values = true)]
    pub camera: Option<CameraChoice>,

    /// What the picture shows
    #[arg(long, value_name = "VIEW", value_parser = choices::view(), help_heading = "Picture")]
    #[arg(default_value = "final")]
    pub view: View,

    /// Level of the voxels that are shown, 0 (finest) to the grid's coarsest
    #[arg(long, value_name = "LEVEL", value_parser = number::whole(0..=MAX_RESOLUTION.ilog2()))]
    #[arg(help_heading = "Picture", default_value = "0", allow_negative_numbers = true)]
    pub level: u32,

    /// Exposure in stops, -64 to 64, or auto [default: auto; preset vxct: 0 for scenes in display values,
    /// else such that white in the scene's light is white]
    ///
    /// As of `lumivox render`.
    #[arg(long, value_name = "STOPS|auto", value_parser = number::exposure)]
    #[arg(help_heading = "Picture", allow_hyphen_values = true)]
    pub exposure: Option<ExposureChoice>,

    /// Curve from radiance to the screen's range [default: neutral; preset vxct: raw]
    #[arg(long, value_name = "NAME", value_parser = choices::tone_map(), help_heading = "Picture")]
    pub tone_map: Option<ToneMap>,

    /// What is drawn over it.
    #[command(flatten)]
    pub overlay: OverlayArgs,

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
