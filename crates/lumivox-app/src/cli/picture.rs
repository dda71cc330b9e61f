//! Options of a picture that `render`, `run` and `view` have in common.

use clap::Args;
use glam::UVec2;

use crate::args::camera::{self, CameraChoice};
use crate::args::settings::{PictureGroups, SettingArgs};
use crate::args::size;

/// Size, camera, view and exposure of a picture.
#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Width and height in pixels, each from 1 to 32768 (or to the GPU's own limit)
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size)]
    #[arg(default_value = "640x360", allow_hyphen_values = true)]
    pub size: UVec2,

    /// The camera: its name or number, or position and target in metres [default: the scene's first
    /// camera, else `framing`, the view that shows the scene best]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists the cameras. PX,PY,PZ is the eye, TX,TY,TZ
    /// the point at the centre of the picture, and FOV the vertical field of view in degrees, 1 to
    /// 170 (default: 45). `outside` and `inside` are the best views found from outside and inside
    /// the scene.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true)]
    pub camera: Option<CameraChoice>,

    /// Frames, exposure, view and overlay.
    #[command(flatten)]
    pub settings: SettingArgs<PictureGroups>,
}

impl PictureArgs {
    /// Width over height of the picture.
    pub fn aspect(&self) -> f32 {
        self.size.x as f32 / self.size.y as f32
    }
}
