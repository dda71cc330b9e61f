//! The arguments of `reference`.

use std::ops::Range;
use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use lumivox_console::SourceArgs;

use super::{GpuArgs, SceneArg, ViewArgs};
use crate::args::{number, size};

/// The arguments of `reference`.
#[derive(Args, Debug)]
pub struct ReferenceArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The picture's file: .exr (floats, all layers) or .png (8 bits a channel, tone mapped) [default:
    /// none; required without --part]
    ///
    /// The layers of an OpenEXR file: radiance in cd/m2 (R, G, B); direct; `one_bounce`, the
    /// irradiance in lux from emitters and from surfaces that lamps light directly; `full`, the
    /// irradiance of all light except that straight from lamps; occlusion, albedo, normal, depth;
    /// and variance, that of each pixel's mean. A file of that name is replaced once the picture is
    /// complete, never half. Ctrl-C finishes the batch of 16 samples, writes the picture and ends
    /// with the exit code 130; a second one ends at once.
    #[arg(short, long, value_name = "FILE", help_heading = "Picture")]
    #[arg(required_unless_present = "part")]
    pub output: Option<PathBuf>,

    /// Width and height in pixels, each from 1 to 16384
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, help_heading = "Picture")]
    #[arg(default_value = "640x360", allow_hyphen_values = true)]
    pub size: UVec2,

    /// The camera and the time of the picture.
    #[command(flatten)]
    pub view: ViewArgs,

    /// Samples of each pixel, a number from 1 to 16777216
    ///
    /// Noise falls with their square root: four times as many halve it.
    #[arg(long, visible_alias = "spp", value_name = "SAMPLES")]
    #[arg(value_parser = number::whole(1..=1 << 24), help_heading = "Paths")]
    #[arg(default_value = "256", allow_negative_numbers = true)]
    pub samples: u32,

    /// Seed of the random numbers, 0 to 4294967295
    ///
    /// The same seed gives the same picture, to the bit on the same GPU.
    #[arg(long, value_name = "NUMBER", value_parser = number::whole(0..=u32::MAX))]
    #[arg(help_heading = "Paths", default_value = "0", allow_negative_numbers = true)]
    pub seed: u32,

    /// Most bounces of indirect light, 0 to 4096 [default: no limit]
    #[arg(long, value_name = "BOUNCES", value_parser = number::whole(0..=4096))]
    #[arg(help_heading = "Paths", allow_negative_numbers = true)]
    pub bounces: Option<u32>,

    /// Reach of ambient occlusion in metres, 0 to 1e9 [default: unlimited]
    #[arg(long, value_name = "METRES", value_parser = number::number(0.0..=1e9))]
    #[arg(help_heading = "Paths", allow_negative_numbers = true)]
    pub occlusion_distance: Option<f32>,

    /// File that keeps the sums of the samples, written every half minute and at the end [default:
    /// none]
    ///
    /// With --resume a later run continues from there, to the same bits and the same noise as if it
    /// had never stopped, also after Ctrl-C. (Where --samples was reached and is not a multiple of
    /// 16, the bits may differ by rounding.) Only one run at a time may use the file.
    #[arg(long, value_name = "FILE", help_heading = "Paths")]
    pub checkpoint: Option<PathBuf>,

    /// Continue from the --checkpoint, if the file exists [default: off, start from nothing]
    #[arg(long, requires = "checkpoint", help_heading = "Paths")]
    pub resume: bool,

    /// File for the samples of some batches instead of a picture; `lumivox merge` adds such parts up
    /// [default: none]
    ///
    /// Parts that machines with the same program, GPU and driver have traced add up to the bits of
    /// one machine, in any order.
    #[arg(long, value_name = "FILE", conflicts_with = "output", help_heading = "Many machines")]
    pub part: Option<PathBuf>,

    /// The batches of 16 samples that the part has, from A to before B, numbers from 0 to 1048576
    /// [default: all batches of --samples]
    #[arg(long, value_name = "A..B", value_parser = number::range(MOST_BATCHES), requires = "part")]
    #[arg(conflicts_with_all = ["samples", "output"], allow_hyphen_values = true, help_heading = "Many machines")]
    pub batches: Option<Range<u32>>,

    /// Light added to the scene.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

/// The most batches of a reference: 16777216 samples.
const MOST_BATCHES: u32 = 1 << 20;
