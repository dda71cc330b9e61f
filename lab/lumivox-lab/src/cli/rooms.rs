//! The arguments of `rooms`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::TypedValueParser;
use glam::UVec2;
use lumivox_app::parts::{GpuArgs, physical_preset};
use lumivox_console::values::choices::among;
use lumivox_console::values::{number, size};
use lumivox_render::PresetChoice;

use crate::rooms::random::Kind;

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab rooms
  lumivox-lab rooms --seed 7 --count 40 --kinds plain --resolutions 64,128 --json rooms.json
  lumivox-lab rooms --seed 19 --count 1 --keep rooms
  lumivox-lab rooms --kinds tent,door-ajar --preset high
";

/// A value of `--kinds`: a kind, or all of them.
#[derive(Clone, Copy, Debug)]
pub struct KindChoice(Option<Kind>);

impl KindChoice {
    const ALL: [Self; 13] = {
        let mut all = [Self(None); 13];
        let mut kind = 0;
        while kind < Kind::ALL.len() {
            all[kind + 1] = Self(Some(Kind::ALL[kind]));
            kind += 1;
        }
        all
    };

    /// Reads the name of a kind.
    pub fn parser() -> impl TypedValueParser<Value = Self> {
        among(&Self::ALL, |choice| match choice.0 {
            None => ("all", "each of the kinds below"),
            Some(kind) => (kind.name(), kind.summary()),
        })
    }

    /// The chosen kinds.
    pub fn kinds(self) -> Vec<Kind> {
        self.0.map_or(Kind::ALL.to_vec(), |kind| vec![kind])
    }
}

/// The arguments of `rooms`.
#[derive(Args, Debug)]
pub struct RoomsArgs {
    /// Seed of the first room, a number from 0 to 4294967295; the next room has the next one
    /// [default: of the clock]
    ///
    /// Seeds and kinds decide the rooms, on any machine.
    #[arg(long, value_name = "SEED", value_parser = number::whole(0..=u32::MAX))]
    #[arg(allow_negative_numbers = true, help_heading = "Rooms")]
    pub seed: Option<u32>,

    /// Number of rooms, 1 to 1000000
    #[arg(long, value_name = "COUNT", value_parser = number::whole(1..=1_000_000))]
    #[arg(default_value = "24", allow_negative_numbers = true, help_heading = "Rooms")]
    pub count: u32,

    /// Kinds of rooms, separated by commas, in turn: a room's is that at its seed modulo their number
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = KindChoice::parser())]
    #[arg(default_value = "all", help_heading = "Rooms")]
    pub kinds: Vec<KindChoice>,

    /// Folder for files of the rooms, .glb, and of their sensors, .csv for `lumivox measure --points`
    /// [default: none]
    #[arg(long, value_name = "FOLDER", help_heading = "Rooms")]
    pub keep: Option<PathBuf>,

    /// Preset of quality against cost
    #[arg(long, value_name = "NAME", value_parser = physical_preset())]
    #[arg(default_value = "balanced", help_heading = "Measurement")]
    pub preset: PresetChoice,

    /// Voxels along the scene's longest axis, separated by commas: multiples of 8 from 16 to 1024
    #[arg(long, value_name = "VOXELS", value_delimiter = ',', value_parser = number::resolution)]
    #[arg(visible_alias = "resolution", default_value = "64", allow_hyphen_values = true)]
    #[arg(help_heading = "Measurement")]
    pub resolutions: Vec<u32>,

    /// Samples of each sensor by the path tracer, a number from 32 to 16777216; pixels of the picture
    /// have a 64th of them, at least 32
    #[arg(long, value_name = "SAMPLES", value_parser = number::whole(32..=1 << 24))]
    #[arg(default_value = "2048", allow_negative_numbers = true, help_heading = "Measurement")]
    pub samples: u32,

    /// Frames to average, 1 to 65536
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(default_value = "32", allow_negative_numbers = true, help_heading = "Measurement")]
    pub frames: u32,

    /// Width and height of the camera's picture in pixels, each from 1 to 16384
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size)]
    #[arg(default_value = "48x36", allow_hyphen_values = true, help_heading = "Measurement")]
    pub size: UVec2,

    /// Write the figures of all rooms as JSON to a file, or to stdout instead of text with `-`
    /// [default: text]
    #[arg(long, value_name = "FILE|-", help_heading = "Messages")]
    pub json: Option<PathBuf>,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}
