//! The arguments of `dynamic`.

use clap::Args;
use lumivox_app::parts::{GpuArgs, SceneArg, SettingArgs, VolumeGroups};
use lumivox_console::values::number;

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab dynamic hall.glb --share 0.1
  lumivox-lab dynamic builtin:atrium --share 0.01 --volume octree --json
";

/// The arguments of `dynamic`.
#[derive(Args, Debug)]
pub struct DynamicArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The voxels.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Share of the triangles that moves, 0.0001 to 1
    #[arg(long, value_name = "SHARE", value_parser = number::number(0.0001..=1.0))]
    #[arg(help_heading = "Measurement", default_value = "0.1", allow_negative_numbers = true)]
    pub share: f32,

    /// Number of moves, 1 to 1000
    #[arg(long, value_name = "MOVES", value_parser = number::whole(1..=1000))]
    #[arg(help_heading = "Measurement", default_value = "8", allow_negative_numbers = true)]
    pub moves: u32,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
