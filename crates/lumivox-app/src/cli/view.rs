//! Options of a still picture.

use clap::Args;

use crate::args::camera::{self, CameraChoice};
use crate::args::number;
use crate::timeline::{AnimationName, animation};

/// The camera and the time of a still picture.
#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
pub struct ViewArgs {
    /// The camera: its name or number, or position and target in metres [default: the scene's first
    /// camera, else `framing`, the view that shows the scene best]
    ///
    /// As for `lumivox render`.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true)]
    pub camera: Option<CameraChoice>,

    /// The time that is shown, in seconds, -10000 to 10000 [default: the scene as its file shows
    /// it]
    #[arg(long, value_name = "SECONDS", value_parser = number::number(-10_000.0..=10_000.0))]
    #[arg(allow_hyphen_values = true)]
    pub time: Option<f32>,

    /// The animation to show: its name or number, or all at once [default: the first, if there is a
    /// --time]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists them.
    #[arg(long, value_name = "NAME|NUMBER|all", value_parser = animation)]
    pub animation: Option<AnimationName>,
}
