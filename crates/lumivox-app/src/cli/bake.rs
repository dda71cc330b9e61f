//! The arguments of `bake`.

use std::path::PathBuf;

use clap::Args;

use super::{GpuArgs, LightArgs, SceneArg};
use crate::args::number;
use crate::args::settings::{SettingArgs, VolumeGroups};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox bake builtin:cornell -o cornell.ktx2
  lumivox bake hall.glb -o hall.ktx2 --spacing 0.5 --resolution 256 --frames 256
  lumivox bake hall.glb -o hall.ktx2 --json
";

/// The arguments of `bake`.
#[derive(Args, Debug)]
pub struct BakeArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The volume's file, .ktx2: a 3D texture of ambient cubes, as Bevy's `IrradianceVolume` reads it
    ///
    /// A file of that name is replaced once the new one is complete, never half.
    #[arg(short, long, value_name = "FILE", help_heading = "Volume")]
    pub output: PathBuf,

    /// Distance from one probe to the next in metres, 0.001 to 1000 [default: a sixteenth of the
    /// scene's longest edge]
    ///
    /// Half of it takes eight times the memory: 24 bytes a probe. Light that changes within it, such
    /// as beside a lamp or in a doorway, is blurred.
    #[arg(long, value_name = "METRES", value_parser = number::number(0.001..=1000.0))]
    #[arg(help_heading = "Volume", allow_negative_numbers = true)]
    pub spacing: Option<f32>,

    /// Frames whose mean is baked, 1 to 65536: their noise falls with the square root
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(help_heading = "Volume", default_value = "64", allow_negative_numbers = true)]
    pub frames: u32,

    /// The voxels that light is found in.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Light, and how it is found.
    #[command(flatten)]
    pub light: LightArgs,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
