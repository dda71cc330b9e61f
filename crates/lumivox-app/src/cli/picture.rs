//! What a picture shows of a scene, and how: what `render`, `run` and `view` have in common.

use clap::Args;
use glam::UVec2;
use lumivox::MAX_RESOLUTION;
use lumivox_render::{ToneMap, View};

use crate::args::camera::{self, CameraChoice};
use crate::args::number::ExposureChoice;
use crate::args::overlay::OverlayArgs;
use crate::args::{choices, number, size};

/// A picture.
#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
pub struct PictureArgs {
    /// Width and height in pixels, each from 1 to 32768 (or less, as the GPU allows)
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size)]
    #[arg(default_value = "640x360", allow_hyphen_values = true)]
    pub size: UVec2,

    /// Frames that are averaged, 1 to 65536
    ///
    /// More: smoother edges and less noise, at proportional cost. One frame alone is jagged.
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(default_value = "16", allow_negative_numbers = true)]
    pub frames: u32,

    /// Where from: a camera's name or number, or position and target in metres [default: the
    /// scene's first camera, else `framing`, the view that shows it best]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists the cameras. PX,PY,PZ is the eye, TX,TY,TZ
    /// what it looks at, and FOV the vertical field of view in degrees, 1 to 170 (default: 45).
    /// `outside` and `inside` are views of the whole and from within, as good as they are found.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true)]
    pub camera: Option<CameraChoice>,

    /// What the picture shows
    ///
    /// Views of light are exposed and tone mapped in PNG and in cd/m2 in OpenEXR. The others are
    /// data: the quantity itself.
    #[arg(long, value_name = "VIEW", value_parser = choices::view())]
    #[arg(default_value = "final")]
    pub view: View,

    /// Level of the voxels for the views lod, voxels, wire-voxels, lit, nodes and bricks and for
    /// --wire-voxels, 0 (finest) to the grid's coarsest
    ///
    /// Each level more has voxels of twice the edge.
    #[arg(long, value_name = "LEVEL", value_parser = number::whole(0..=MAX_RESOLUTION.ilog2()))]
    #[arg(default_value = "0", allow_negative_numbers = true)]
    pub level: u32,

    /// Exposure in stops, -64 to 64, or auto, or auto-each [default: auto; preset vxct: 0 for scenes in
    /// display values, else such that white right at a lamp is white]
    ///
    /// PNG shows radiance in cd/m2 times 2 to the power of the stops. auto makes the picture's
    /// average a middle grey, up to 1.5 stops brighter or two darker so that white is nearly white,
    /// within what cameras do (EV100 -6 to 17); beyond that a warning says so. The pictures of a sequence all take the median of what five of them ask
    /// for, so that they do not flicker. With auto-each every picture finds its own. No effect on
    /// OpenEXR.
    #[arg(long, value_name = "STOPS|auto|auto-each", value_parser = number::exposure)]
    #[arg(allow_hyphen_values = true)]
    pub exposure: Option<ExposureChoice>,

    /// Curve from radiance to the screen's range, for PNG [default: neutral; preset vxct: raw for
    /// scenes in display values, else linear]
    #[arg(long, value_name = "NAME", value_parser = choices::tone_map())]
    pub tone_map: Option<ToneMap>,

    /// What is drawn over it.
    #[command(flatten)]
    pub overlay: OverlayArgs,
}

impl PictureArgs {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size.x as f32 / self.size.y as f32
    }
}
