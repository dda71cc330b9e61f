//! The arguments of `measure`.

use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgGroup, Args, ValueEnum};
use glam::UVec2;
use lumivox_console::SourceArgs;

use super::{ConeArgs, GpuArgs, SceneArg, ViewArgs};
use crate::args::settings::{LightGroups, SettingArgs, VolumeGroups};
use crate::args::{Refused, number, size};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  Illuminance on the floor plan of an office, 0.85 m above its floor, with a picture:
    lumivox measure office.glb --workplane 0.85 -o desk.png -o desk.csv
  At the sensors of a file with the columns x, y, z, nx, ny, nz, without bias:
    lumivox measure office.glb --points sensors.csv --method paths --samples 4096 -o lux.csv
  Luminance along the lines of sight of a file, and of all that a camera sees:
    lumivox measure office.glb --rays sights.csv --method paths
    lumivox measure office.glb --picture --size 640x360 -o luminance.png
";

/// The way that light is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// By cones, in milliseconds, with the errors of voxels
    Cones,
    /// By the path tracer, without bias, with the standard error
    Paths,
}

/// The arguments of `measure`.
#[derive(Args, Debug)]
#[command(group = ArgGroup::new("what").required(true).args(["points", "workplane", "rays", "picture"]))]
pub struct MeasureArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// CSV file of points: x,y,z in metres, and where they face: nx,ny,nz, else up [default: none]
    ///
    /// A first line of names may give the columns in another order, or more of them. Points may be on
    /// surfaces or in the air.
    #[arg(long, value_name = "FILE", help_heading = "Measurement")]
    pub points: Option<PathBuf>,

    /// Height in metres of a level grid of points that face up, -1e6 to 1e6 [default: none]
    #[arg(long, value_name = "METRES", value_parser = number::number(-1e6..=1e6))]
    #[arg(allow_hyphen_values = true, help_heading = "Measurement")]
    pub workplane: Option<f32>,

    /// CSV file of lines of sight, x,y,z in metres and dx,dy,dz, with --method paths [default: none]
    #[arg(long, value_name = "FILE", help_heading = "Measurement")]
    pub rays: Option<PathBuf>,

    /// Measure the luminance of the camera's picture [default: off]
    #[arg(long, help_heading = "Measurement")]
    pub picture: bool,

    /// The part of the --workplane between two corners, in metres [default: all of the scene]
    #[arg(long, value_name = "X,Z,X,Z", value_parser = area)]
    #[arg(allow_hyphen_values = true, help_heading = "Measurement")]
    pub area: Option<[f64; 4]>,

    /// Edge of the --workplane's cells in metres, 1e-3 to 1e6 [default: a 24th of the longer side]
    #[arg(long, value_name = "METRES", value_parser = number::number(1e-3..=1e6))]
    #[arg(allow_negative_numbers = true, help_heading = "Measurement")]
    pub spacing: Option<f32>,

    /// Width and height of the --picture in pixels, each from 1 to 16384
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, help_heading = "Measurement")]
    #[arg(default_value = "640x360", allow_hyphen_values = true)]
    pub size: UVec2,

    /// The method: cones in voxels, or paths, each with its noise
    #[arg(long, value_name = "NAME", value_enum, default_value = "cones")]
    #[arg(help_heading = "Measurement")]
    pub method: Method,

    /// Frames of the cones' mean, 1 to 65536
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(help_heading = "Measurement", default_value = "64", allow_negative_numbers = true)]
    pub frames: u32,

    /// Samples of the path tracer for each point, ray or pixel, a number from 1 to 16777216
    #[arg(long, visible_alias = "spp", value_name = "SAMPLES")]
    #[arg(value_parser = number::whole(1..=1 << 24), help_heading = "Measurement")]
    #[arg(default_value = "1024", allow_negative_numbers = true)]
    pub samples: u32,

    /// Seed of the path tracer's random numbers, 0 to 4294967295
    #[arg(long, value_name = "NUMBER", value_parser = number::whole(0..=u32::MAX))]
    #[arg(help_heading = "Measurement", default_value = "0", allow_negative_numbers = true)]
    pub seed: u32,

    /// File for the readings, by its ending: .csv (a line each), .json, or .png (false colours with a
    /// scale, of a workplane or a picture); may be repeated [default: none]
    #[arg(short, long, value_name = "FILE", action = ArgAction::Append, help_heading = "Measurement")]
    pub output: Vec<PathBuf>,

    /// The readings in lux or cd/m2 at the ends of the colours' scale [default: 0 to the greatest]
    #[arg(long, value_name = "LOW..HIGH", value_parser = scale, requires = "output")]
    #[arg(allow_hyphen_values = true, help_heading = "Measurement")]
    pub scale: Option<(f32, f32)>,

    /// The camera and the time.
    #[command(flatten)]
    pub view: ViewArgs,

    /// The voxels.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Light added to the scene.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// How light is found.
    #[command(flatten)]
    pub light: SettingArgs<LightGroups>,

    /// The cones.
    #[command(flatten)]
    pub cones: ConeArgs,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,

    /// Print one JSON object with all readings instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

/// The option `--surroundings` with the help of measurements, which add no light by default.
pub fn of_measurements(surroundings: Arg) -> Arg {
    const HELP: &str =
        "Surroundings for a scene that has too little light of its own [default: none]";
    surroundings.help(HELP).long_help(HELP)
}

/// Parses two corners of a level rectangle; returns the least x and z, and the greatest.
fn area(text: &str) -> Result<[f64; 4], Refused> {
    let _: [f32; 4] = number::list(text, "X,Z,X,Z")?;
    // Map coordinates need f64.
    let corners = text.split(',').filter_map(|part| part.trim().parse().ok());
    let corners: Vec<f64> = corners.collect();
    let [x, z, other_x, other_z] = corners.try_into().unwrap_or_default();
    let is_far = [x, z, other_x, other_z].iter().any(|number| number.abs() > 1e8);
    let is_flat = (x - other_x).abs() <= 0.0 || (z - other_z).abs() <= 0.0;
    if is_far || is_flat {
        let rule = "expected two corners that differ in both numbers, each from -1e8 to 1e8";
        return Err(Refused::OutOfRange(rule.to_owned()));
    }
    Ok([x.min(other_x), z.min(other_z), x.max(other_x), z.max(other_z)])
}

/// Parses a range of readings, `LOW..HIGH`.
fn scale(text: &str) -> Result<(f32, f32), Refused> {
    let form = || Refused::Malformed("expected two numbers, LOW..HIGH".to_owned());
    let (low, high) = text.split_once("..").ok_or_else(form)?;
    let read = |text: &str| text.trim().parse::<f32>().map_err(|_| form());
    let (low, high) = (read(low)?, read(high)?);
    if low.is_finite() && high.is_finite() && 0.0 <= low && low < high {
        return Ok((low, high));
    }
    Err(Refused::OutOfRange("expected LOW..HIGH with LOW from 0, and HIGH above LOW".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_ranges_and_areas_are_refused() {
        assert_eq!(scale("0..500"), Ok((0.0, 500.0)));
        assert_eq!(area("2,3,-1,4"), Ok([-1.0, 3.0, 2.0, 4.0]));
        for text in ["5..5", "-1..5", "0..inf"] {
            assert!(matches!(scale(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        assert!(matches!(scale("5"), Err(Refused::Malformed(_))));
        assert!(matches!(area("1,2,1,3"), Err(Refused::OutOfRange(_))));
        assert!(matches!(area("1,2,3"), Err(Refused::Malformed(_))));
    }
}
