//! The arguments of `bench`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::TypedValueParser;
use glam::UVec2;
use lumivox::VolumeKind;
use lumivox_console::values::choices::among;
use lumivox_console::{LoadArgs, SceneSource};
use lumivox_render::PresetChoice;

use super::GpuArgs;
use super::load::scene_source;
use crate::args::{choices, number, size};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox bench
  lumivox bench -o bench.md --json bench.json
  lumivox bench --quick
  lumivox bench --import lumivox-*.json
  lumivox bench --scene hall.glb --resolutions 256 --sizes 1920x1080 --presets high
";

/// A kind of volume on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeChoice {
    Dense,
    Octree,
}

impl VolumeChoice {
    /// All kinds.
    pub const ALL: [Self; 2] = [Self::Dense, Self::Octree];

    /// A parser of the names.
    pub fn parser() -> impl TypedValueParser<Value = Self> {
        among(&Self::ALL, |kind| match kind {
            Self::Dense => ("dense", "3D textures over the whole grid"),
            Self::Octree => ("octree", "memory in proportion to the surface"),
        })
    }

    /// The name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dense => "dense",
            Self::Octree => "octree",
        }
    }

    /// The volume, with default options.
    pub fn volume(self) -> VolumeKind {
        match self {
            Self::Dense => VolumeKind::Dense,
            Self::Octree => VolumeKind::Octree,
        }
    }
}

/// The arguments of `bench`.
#[derive(Args, Debug)]
pub struct BenchArgs {
    /// File for the report in Markdown, .md [default: none, the report goes to stdout]
    ///
    /// A file of that name is replaced once the new one is complete, never half.
    #[arg(short, long, value_name = "FILE", help_heading = "Report")]
    pub output: Option<PathBuf>,

    /// File for the report in JSON, .json, with every stage; - writes it to stdout, instead of the
    /// report in Markdown [default: none]
    #[arg(long, value_name = "FILE|-", help_heading = "Report")]
    pub json: Option<PathBuf>,

    /// Measure nothing: check results that visitors of the page exported, and print a table by GPU,
    /// milliseconds a frame in Markdown [default: none]
    #[arg(long, value_name = "FILE", num_args = 1.., help_heading = "Report")]
    #[arg(conflicts_with_all = ["output", "json", "quick", "scenes", "volumes", "resolutions", "presets", "sizes", "cache"])]
    pub import: Vec<PathBuf>,

    /// Measure only the small part of the standard cases: 64 voxels, 640x360; of these on a software
    /// driver only the Cornell box with preset fast [default: off]
    ///
    /// A software driver measures the small part even without this option, unless other options say
    /// what to measure.
    #[arg(long, help_heading = "Measurement")]
    pub quick: bool,

    /// Measure this scene: a file, or builtin:NAME; may be given several times [default: builtin:cornell
    /// and builtin:atrium]
    #[arg(long = "scene", value_name = "SCENE", value_parser = scene_source())]
    #[arg(help_heading = "Measurement")]
    pub scenes: Vec<SceneSource>,

    /// How scene files are read.
    #[command(flatten)]
    pub load: LoadArgs,

    /// Kinds of volumes, separated by commas [default: dense,octree]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = VolumeChoice::parser())]
    #[arg(help_heading = "Measurement")]
    pub volumes: Vec<VolumeChoice>,

    /// Voxels along the scene's longest axis, separated by commas: multiples of 8 from 16 to 1024
    /// [default: 64,128,256; 64 on a software driver]
    #[arg(long, value_name = "VOXELS", value_delimiter = ',', value_parser = number::resolution)]
    #[arg(allow_hyphen_values = true, help_heading = "Measurement")]
    pub resolutions: Vec<u32>,

    /// Presets, separated by commas [default: fast,balanced]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = choices::physical_preset())]
    #[arg(help_heading = "Measurement")]
    pub presets: Vec<PresetChoice>,

    /// Widths and heights of the pictures in pixels, separated by commas, each from 1 to 32768 (or to
    /// the GPU's own limit) [default: 640x360, and 1920x1080 at 128 voxels; 640x360 on a software driver]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_delimiter = ',', value_parser = size::size)]
    #[arg(allow_hyphen_values = true, help_heading = "Measurement")]
    pub sizes: Vec<UVec2>,

    /// Folder for a file of measurements, so that a later run continues where this one stopped
    /// [default: none]
    ///
    /// It is only valid for the same version on the same machine; delete it after a change of
    /// either.
    #[arg(long, value_name = "FOLDER", help_heading = "Measurement")]
    pub cache: Option<PathBuf>,

    /// The most frames of each measurement, 3 to 10000; those of slow devices end after some seconds
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(3..=10_000))]
    #[arg(default_value = "64", allow_negative_numbers = true, help_heading = "Measurement")]
    pub frames: u32,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
