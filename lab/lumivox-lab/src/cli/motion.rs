//! The arguments of `motion`.

use std::path::PathBuf;

use clap::Args;
use glam::UVec2;
use lumivox_app::parts::{
    ConeArgs, GpuArgs, LightArgs, SettingArgs, ViewArgs, VolumeGroups, scene_source,
};
use lumivox_console::values::{number, size};
use lumivox_console::{LoadArgs, SceneSource};

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox-lab motion builtin:cornell --sequence orbit,switch --truth target/truth
  lumivox-lab motion builtin:two-rooms --preset fast -o motion --json figures.json
  lumivox-lab motion robot.glb
  lumivox-lab motion --doc docs/generated --cache target/motion
";

/// The arguments of `motion`.
#[derive(Args, Debug)]
pub struct MotionArgs {
    /// The scene: a glTF, OBJ, PLY, STL or VXCT file, or builtin:NAME [default: for each sequence
    /// the built-in scene that it was made for]
    ///
    /// Without --sequence, a built-in scene is measured in the sequences made for it, a file in
    /// that of its own animation, or else in `orbit`.
    #[arg(value_name = "SCENE", value_parser = scene_source())]
    pub scene: Option<SceneSource>,

    /// Names of the sequences, separated by commas [default: those of the scene; all without a
    /// scene]
    ///
    /// orbit (the camera, about any scene), lamp (a lamp moves), switch (lamps go off and on),
    /// block (a block of cornell slides and turns), door (that of two-rooms closes and opens), sun
    /// (crosses the sky of atrium), animation (a file's own); orbit-glossy and block-glossy are
    /// those of cornell-glossy.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = "Measurement")]
    pub sequence: Vec<String>,

    /// Number of steps of each phase in which something moves, 1 to 10000 [default: 8 to 90, as the
    /// sequence has them]
    ///
    /// One frame is rendered for each step. Phases in which nothing moves keep their number.
    #[arg(long, value_name = "STEPS", value_parser = number::whole(1..=10_000))]
    #[arg(allow_negative_numbers = true, help_heading = "Measurement")]
    pub steps: Option<u32>,

    /// Samples of each pixel of the truth, a number from 32 to 16777216
    ///
    /// Noise falls with their square root. It is taken out of RMSE and flicker.
    #[arg(long, visible_alias = "spp", value_name = "SAMPLES")]
    #[arg(value_parser = number::whole(32..=1 << 24), help_heading = "Measurement")]
    #[arg(default_value = "64", allow_negative_numbers = true)]
    pub samples: u32,

    /// Folder for files of the path-traced truths of steps: read if they are there, else traced and
    /// written [default: none, always trace]
    ///
    /// Their names are made from scene, pose, size and samples. Delete it after a change of the
    /// path tracer.
    #[arg(long, value_name = "FOLDER", help_heading = "Measurement")]
    pub truth: Option<PathBuf>,

    /// Folder for picture files: a strip (truth, ours, error) and an animated picture of each
    /// sequence, and charts [default: none]
    #[arg(short, long, value_name = "FOLDER", help_heading = "Picture")]
    pub output: Option<PathBuf>,

    /// Measure all sequences (or those of --sequence) with the presets fast and realtime, and
    /// write a page into this folder: a file motion.md, and its pictures in images/motion/
    /// [default: none]
    #[arg(long, value_name = "FOLDER", help_heading = "Picture")]
    #[arg(conflicts_with_all = ["scene", "output", "json"])]
    pub doc: Option<PathBuf>,

    /// Folder for files of truths and measurements of the page, so that a later run continues where
    /// this one stopped [default: none]
    ///
    /// It is only valid for the same version on the same machine; delete it after a change of
    /// either.
    #[arg(long, value_name = "FOLDER", requires = "doc", conflicts_with = "truth")]
    #[arg(help_heading = "Measurement")]
    pub cache: Option<PathBuf>,

    /// Width and height in pixels, each from 1 to 16384
    ///
    /// The truth is traced at every step of pictures of up to 9216 pixels (128x72), and only at
    /// marked steps of larger ones.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, help_heading = "Picture")]
    #[arg(default_value = "96x54", allow_hyphen_values = true)]
    pub size: UVec2,

    /// The camera before anything moves.
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

    /// Write the figures of all sequences as JSON to a file, or to stdout instead of text with `-`
    /// [default: text]
    #[arg(long, value_name = "FILE|-", help_heading = "Messages")]
    pub json: Option<PathBuf>,
}
