//! What a picture shows of a scene, and how: what `render`, `run` and `view` have in common.

use clap::Args;
use glam::UVec2;

use crate::args::camera::{self, CameraChoice};
use crate::args::settings::{PictureGroups, SettingArgs};
use crate::args::size;

/// A picture.
#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Width and height in pixels, each from 1 to 32768 (or less, as the GPU allows)
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size)]
    #[arg(default_value = "640x360", allow_hyphen_values = true)]
    pub size: UVec2,

    /// Where from: a camera's name or number, or position and target in metres [default: the
    /// scene's first camera, else `framing`, the view that shows it best]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists the cameras. PX,PY,PZ is the eye, TX,TY,TZ
    /// what it looks at, and FOV the vertical field of view in degrees, 1 to 170 (default: 45).
    /// `outside` and `inside` are views of the whole and from within, as good as they are found.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true)]
    pub camera: Option<CameraChoice>,

    /// Frames, exposure, view and overlay.
    #[command(flatten)]
    pub settings: SettingArgs<PictureGroups>,
}

impl PictureArgs {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size.x as f32 / self.size.y as f32
    }
}
