//! The arguments of `compare`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use lumivox_console::{LoadArgs, SceneSource};

use super::load::scene_source;
use super::{ConeArgs, GpuArgs, LightArgs, ViewArgs};
use crate::args::settings::{SettingArgs, VolumeGroups};
use crate::args::{number, size};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox compare builtin:cornell -o cornell.png
  lumivox compare hall.glb --reference hall.exr --samples 2048 --preset high --json
  lumivox compare --images reference.exr ours.exr
  lumivox compare --images reference.exr ours.exr -o strip.png --json
";

/// The arguments of `compare`.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// The scene that is rendered and path-traced: a glTF, OBJ, PLY or STL file, or builtin:NAME
    /// [default: none; required without
    /// --images]
    #[arg(value_name = "SCENE", value_parser = scene_source())]
    pub scene: Option<SceneSource>,

    /// Two picture files of one size: the reference, and the picture to compare with it (.exr,
    /// .hdr, .png or .jpg) [default: none; required without a SCENE]
    ///
    /// OpenEXR and Radiance files hold linear light. PNG and JPEG files are decoded from sRGB; they
    /// hold what a screen shows, so both must have been made with the same exposure and curve.
    #[arg(long, num_args = 2, value_names = ["REFERENCE", "OURS"], conflicts_with = "scene")]
    #[arg(help_heading = "Pictures", required_unless_present = "scene")]
    pub images: Vec<PathBuf>,

    /// The layer of OpenEXR files with named layers [default: the one without a name, else the
    /// first]
    ///
    /// It is the part of the channels' names before the last dot, as in full.R, or a part's name.
    #[arg(long, value_name = "NAME", requires = "images", help_heading = "Pictures")]
    pub layer: Option<String>,

    /// PNG file for a strip: the reference, the picture, and where it is too dark or too bright
    /// [default: none]
    ///
    /// Small pictures are enlarged. A file of that name is replaced.
    #[arg(short, long, value_name = "FILE", help_heading = "Pictures")]
    pub output: Option<PathBuf>,

    /// File of the scene's reference, .exr: read if it exists, else traced and written [default:
    /// none, always trace]
    #[arg(long, value_name = "FILE", conflicts_with = "images", help_heading = "Reference")]
    pub reference: Option<PathBuf>,

    /// Samples of each pixel of the reference, a number from 1 to 16777216
    ///
    /// Noise falls with their square root. The errors are printed with it; the RMSE excludes it.
    #[arg(long, visible_alias = "spp", value_name = "SAMPLES")]
    #[arg(value_parser = number::whole(1..=1 << 24), help_heading = "Reference")]
    #[arg(default_value = "256", allow_negative_numbers = true)]
    pub samples: u32,

    /// Frames to average, 1 to 65536
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(help_heading = "Rendering", default_value = "32", allow_negative_numbers = true)]
    pub frames: u32,

    /// Number of grid positions over which the errors are averaged, 1 to 64
    ///
    /// The first position is --grid-offset. Errors of voxels depend on where walls fall in the
    /// grid.
    #[arg(long, value_name = "COUNT", value_parser = number::whole(1..=64))]
    #[arg(help_heading = "Rendering", default_value = "2", allow_negative_numbers = true)]
    pub offsets: u32,

    /// Width and height in pixels, each from 1 to 16384
    ///
    /// Errors hardly depend on it; time is proportional to the number of pixels.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, help_heading = "Picture")]
    #[arg(default_value = "160x90", allow_hyphen_values = true)]
    pub size: UVec2,

    /// The camera and the time of the picture.
    #[command(flatten)]
    pub view: ViewArgs,

    /// How the scene's file is read.
    #[command(flatten)]
    pub load: LoadArgs,

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

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}
