//! The arguments of `bake`.

use std::path::PathBuf;

use clap::Args;
use glam::Vec3;
use lumivox_console::SourceArgs;
use lumivox_render::lightmap::{LARGEST, SMALLEST};

use super::{ConeArgs, GpuArgs, Method, SceneArg, ViewArgs};
use crate::args::settings::{LightGroups, SettingArgs, VolumeGroups};
use crate::args::{Refused, number};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  Light for all of a level, from probes 1 m apart, in seconds:
    lumivox bake level.glb -o level.ktx2 --spacing 1
  A room of it, finely and without bias:
    lumivox bake level.glb -o room.ktx2 --box 0,0,0,6,3,4 --spacing 0.25 --method paths --samples 4096
  Its surfaces, in a lightmap for the meshes' second UV set:
    lumivox bake level.glb -o level.exr --lightmap --size 2048
";

/// The arguments of `bake`.
#[derive(Args, Debug)]
pub struct BakeArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// File for the volume, ending in .ktx2, or for the lightmap, ending in .exr or .ktx2
    #[arg(short, long, value_name = "FILE", help_heading = "Baking")]
    pub output: PathBuf,

    /// Distance between probes in metres, 1e-3 to 1e6 [default: a 24th of the box's longest edge]
    ///
    /// At most half the width of the smallest room, so that each has a probe.
    #[arg(long, value_name = "METRES", value_parser = number::number(1e-3..=1e6))]
    #[arg(allow_negative_numbers = true, help_heading = "Probes")]
    pub spacing: Option<f32>,

    /// Two corners of the box of probes, in metres [default: all of the scene]
    #[arg(id = "box", long = "box", value_name = "X,Y,Z,X,Y,Z", value_parser = corners)]
    #[arg(allow_hyphen_values = true, help_heading = "Probes")]
    pub corners: Option<(Vec3, Vec3)>,

    /// Bake the light on surfaces into an image, instead of probes [default: off]
    ///
    /// Everything static is baked. If the texture coordinates of nodes overlap, each node has its
    /// own part of the image; --json lists them.
    #[arg(long, help_heading = "Lightmap", conflicts_with_all = ["spacing", "box"])]
    pub lightmap: bool,

    /// Number of the meshes' set of texture coordinates for the lightmap, 0 or 1
    ///
    /// 1 is the second one, in glTF as in Blender. Coordinates must be within the unit
    /// square, and triangles of a node may not overlap.
    #[arg(long, value_name = "NUMBER", value_parser = number::whole(0..=1), requires = "lightmap")]
    #[arg(help_heading = "Lightmap", default_value = "1", allow_negative_numbers = true)]
    pub uv: u32,

    /// Edge of the lightmap in texels, 16 to 4096
    #[arg(long, value_name = "TEXELS", value_parser = number::whole(SMALLEST..=LARGEST))]
    #[arg(help_heading = "Lightmap", default_value = "1024", allow_negative_numbers = true)]
    #[arg(requires = "lightmap")]
    pub size: u32,

    /// Texels along a metre of surface, 1e-3 to 1e6, instead of --size [default: fills --size]
    #[arg(long, value_name = "TEXELS", value_parser = number::number(1e-3..=1e6))]
    #[arg(help_heading = "Lightmap", allow_negative_numbers = true)]
    #[arg(requires = "lightmap", conflicts_with = "size")]
    pub density: Option<f32>,

    /// Bake also the light straight from lamps and suns into the lightmap [default: off]
    ///
    /// Then the renderer must not add it.
    #[arg(long, help_heading = "Lightmap", requires = "lightmap")]
    pub direct: bool,

    /// The method: cones in voxels, or paths, each with its noise
    #[arg(long, value_name = "NAME", value_enum, default_value = "cones")]
    #[arg(help_heading = "Baking")]
    pub method: Method,

    /// Frames of the cones' mean, 1 to 65536
    #[arg(long, value_name = "FRAMES", value_parser = number::whole(1..=65_536))]
    #[arg(help_heading = "Baking", default_value = "256", allow_negative_numbers = true)]
    pub frames: u32,

    /// Samples of the path tracer for a texel or a probe's direction, a number from 1 to 16777216
    #[arg(long, visible_alias = "spp", value_name = "SAMPLES")]
    #[arg(value_parser = number::whole(1..=1 << 24), help_heading = "Baking")]
    #[arg(default_value = "1024", allow_negative_numbers = true)]
    pub samples: u32,

    /// Seed of the path tracer's random numbers, 0 to 4294967295
    #[arg(long, value_name = "NUMBER", value_parser = number::whole(0..=u32::MAX))]
    #[arg(help_heading = "Baking", default_value = "0", allow_negative_numbers = true)]
    pub seed: u32,

    /// The time; the camera counts only for the voxels of cascades.
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

    /// Print one JSON object about the volume instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

/// Parses two corners of a box; returns its minimum and maximum.
fn corners(text: &str) -> Result<(Vec3, Vec3), Refused> {
    let numbers: [f32; 6] = number::list(text, "X,Y,Z,X,Y,Z")?;
    let [one, other] = [0, 3].map(|at| Vec3::from_slice(&numbers[at..]));
    let (min, max) = (one.min(other), one.max(other));
    if numbers.iter().any(|number| number.abs() > 1e6) || !(max - min).cmpgt(Vec3::ZERO).all() {
        let rule = "expected two corners that differ in all three numbers, each from -1e6 to 1e6";
        return Err(Refused::OutOfRange(rule.to_owned()));
    }
    Ok((min, max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_boxes_are_refused() {
        assert_eq!(
            corners("2,3,-1,0,4,5"),
            Ok((Vec3::new(0.0, 3.0, -1.0), Vec3::new(2.0, 4.0, 5.0)))
        );
        assert!(matches!(corners("1,2,3,4,2,6"), Err(Refused::OutOfRange(_))));
        assert!(matches!(corners("1,2,3"), Err(Refused::Malformed(_))));
    }
}
