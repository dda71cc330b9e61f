//! The arguments of `quality`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use lumivox_app::parts::{GpuArgs, physical_preset};
use lumivox_console::values::{number, size};
use lumivox_render::PresetChoice;

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab quality docs/generated --cache target/quality
  lumivox-lab quality report cornell atrium --presets balanced,high --resolutions 128
";

/// The arguments of `quality`.
#[derive(Args, Debug)]
pub struct QualityArgs {
    /// Folder for the page, a file quality.md, and its pictures, images/quality/
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,

    /// Names of the built-in scenes to measure, with all presets at all resolutions, or "materials"
    /// for balls of all materials in all lights [default: materials, cornell and atrium so, and all
    /// other scenes only at the middle resolution without the preset fast]
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,

    /// Number of rooms at random of each set, plain ones and all kinds, 0 to 10000 [default: 20; 0 if
    /// scenes are named]
    ///
    /// The page begins with the distribution of their errors. Their seeds are fresh each time.
    #[arg(long, value_name = "COUNT", value_parser = number::whole(0..=10_000))]
    #[arg(allow_negative_numbers = true, help_heading = "Measurement")]
    pub rooms: Option<u32>,

    /// Folder for files of references and measurements, so that a later run continues where this
    /// one stopped [default: none]
    ///
    /// It is only valid for the same version on the same machine; delete it after a change of
    /// either.
    #[arg(long, value_name = "FOLDER", help_heading = "Measurement")]
    pub cache: Option<PathBuf>,

    /// Measure nothing: write the page from the cache [default: off]
    #[arg(long, requires = "cache", help_heading = "Measurement")]
    pub kept: bool,

    /// Presets to measure, separated by commas
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = physical_preset())]
    #[arg(default_value = "fast,balanced,high", help_heading = "Measurement")]
    pub presets: Vec<PresetChoice>,

    /// Voxels along the scene's longest axis, separated by commas: multiples of 8 from 16 to 1024
    ///
    /// Rotated scenes are only measured at the middle one.
    #[arg(long, value_name = "VOXELS", value_delimiter = ',', value_parser = number::resolution)]
    #[arg(default_value = "64,128,256", allow_hyphen_values = true, help_heading = "Measurement")]
    pub resolutions: Vec<u32>,

    /// Width and height in pixels, each from 1 to 16384
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size)]
    #[arg(default_value = "96x72", allow_hyphen_values = true, help_heading = "Measurement")]
    pub size: UVec2,

    /// Samples of each pixel of the references, a number from 32 to 16777216
    #[arg(long, value_name = "SAMPLES", value_parser = number::whole(32..=1 << 24))]
    #[arg(default_value = "512", allow_negative_numbers = true, help_heading = "Measurement")]
    pub samples: u32,

    /// Frames to average, 1 to 65536
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(default_value = "32", allow_negative_numbers = true, help_heading = "Measurement")]
    pub frames: u32,

    /// Number of grid positions over which figures at the middle resolution are averaged, 1 to 64
    ///
    /// Other resolutions, and rotated scenes, are measured in one position.
    #[arg(long, value_name = "COUNT", value_parser = number::whole(1..=64))]
    #[arg(default_value = "2", allow_negative_numbers = true, help_heading = "Measurement")]
    pub offsets: u32,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
