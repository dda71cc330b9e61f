//! The command line: commands, options, and their help.
//!
//! Each option states its unit, range and default; the tests below check that.

mod bake;
mod bench;
mod compare;
mod cones;
mod explore;
mod gpu;
mod light;
mod load;
mod measure;
mod merge;
mod picture;
mod reference;
mod run;
mod timeline;
mod view;
mod voxels;
mod window;

use std::path::PathBuf;

use clap::{ArgAction, Args, Parser, Subcommand};
use lumivox_console::{Failure, SceneSource};
use lumivox_render::RenderSettings;

pub use bake::BakeArgs;
pub use bench::{BenchArgs, VolumeChoice};
pub use compare::CompareArgs;
pub use cones::ConeArgs;
pub use explore::ExploreArgs;
pub use gpu::GpuArgs;
pub use light::LightArgs;
pub use load::SceneArg;
pub use measure::{MeasureArgs, Method};
pub use merge::MergeArgs;
pub use picture::PictureArgs;
pub use reference::ReferenceArgs;
pub use run::{CommandsArgs, RunArgs};
pub use timeline::TimelineArgs;
pub use view::ViewArgs;
pub use voxels::VoxelsArgs;
pub use window::{WindowArgs, WindowDevice};

use crate::args::number;
use crate::args::settings::{Given, SettingArgs, VolumeGroups};
use crate::commands;
use crate::exit;
use crate::host::Host;
use crate::program::Program;
use crate::settings;
use crate::timeline::{AnimationName, animation};
pub use load::scene_source;

const EXAMPLES: &str = "\
Examples:
  lumivox render builtin:cornell -o cornell.png
  lumivox render hall.glb -o hall.exr --size 1920x1080 --preset high --frames 64
  lumivox view hall.glb
  lumivox voxels builtin:atrium --resolution 256
  lumivox info hall.glb
  lumivox scenes

Log: warnings go to stderr; -v adds notes, -vv details. The environment variable RUST_LOG overrules
both (as in RUST_LOG=lumivox=trace).
";

const RENDER_EXAMPLES: &str = "\
Examples:
  The Cornell box, as a picture and as radiance in cd/m2:
    lumivox render builtin:cornell -o cornell.png
    lumivox render builtin:cornell -o cornell.exr

  A hall of your own under sun and sky, finely:
    lumivox render hall.glb -o hall.png --size 1920x1080 --resolution 256 --preset high \\
        --sun 0.3,1,0.4,90000 --environment 2000,2600,3600

  From a place of your choice, with a field of view of 60 degrees:
    lumivox render hall.glb -o hall.png --camera 4,1.7,0,0,1.5,0,60

  Sequences: an animation with its own camera, a turn round a model, a walk:
    lumivox render robot.glb -o robot_####.png --animation walk --time 0..2 --fps 30
    lumivox render helmet.glb -o helmet --orbit 360 --time 0..6
    lumivox render hall.glb -o walk --camera-path walk.json

  What the cones see, and what they cost:
    lumivox render builtin:atrium -o voxels.png --view voxels --level 1
    lumivox render builtin:atrium -o wires.png --wire-voxels over --level 3
    lumivox render builtin:atrium -o atrium.png -v
";

/// Global illumination by voxel cone tracing
///
/// Lumivox renders scenes with indirect light: it turns triangles into voxels, computes the light
/// of the voxels, and gathers it with cones at every pixel. All of it runs on the GPU, in physical
/// units.
#[derive(Debug, Parser)]
#[command(name = "lumivox", version, max_term_width = 100)]
#[command(after_help = format!("{EXAMPLES}\n{}", exit::CODES))]
pub struct Cli {
    /// Print more: -v adds notes and, after rendering, tables of times and memory; -vv adds details
    /// [default: warnings only]
    #[arg(short, long, action = ArgAction::Count, global = true, help_heading = "Messages")]
    pub verbose: u8,

    /// The command.
    #[command(subcommand)]
    pub command: Option<Command>,
}

impl Program for Cli {
    fn verbosity(&self) -> u8 {
        self.verbose
    }

    fn tells_warnings(&self) -> bool {
        matches!(self.command, Some(Command::Info(_)))
    }

    fn run_command(&self, host: &Host) -> Option<anyhow::Result<()>> {
        Some(match self.command.as_ref()? {
            Command::Render(args) => commands::render::run(args, self.verbose, host),
            Command::View(args) => commands::view::run(args, host),
            Command::Reference(args) => commands::reference::run(args, host),
            Command::Merge(args) => commands::merge::run(args, host),
            Command::Measure(args) => commands::measure::run(args, host),
            Command::Bake(args) => commands::bake::run(args, host),
            Command::Info(args) => commands::info::run(args, host),
            Command::Voxels(args) => commands::voxels::run(args, host),
            Command::Bench(args) => commands::bench::run(args, host),
            Command::Convert(args) => commands::convert::run(args, host),
            Command::Compare(args) => commands::compare::run(args, host),
            Command::Run(args) => commands::run::run(args, host),
            Command::Commands(args) => commands::run::list(args.markdown, host),
            Command::Scenes => commands::scenes::run(host),
        })
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to a picture
    #[command(after_long_help = format!("{RENDER_EXAMPLES}\n{}", exit::CODES))]
    Render(Box<RenderArgs>),
    /// Open a window to view a scene and change it while it is rendered
    #[command(after_long_help = window::EXAMPLES)]
    View(Box<WindowArgs>),
    /// Path-trace a scene: the reference that errors of renderings are measured against
    #[command(
        after_help = "Examples:\n  lumivox reference builtin:cornell -o cornell.exr --samples \
                            1024\n  lumivox reference hall.glb -o hall.exr --samples 4096 \
                            --checkpoint hall.sums --resume"
    )]
    Reference(Box<ReferenceArgs>),
    /// Add up the parts of a reference that several runs or machines have traced
    #[command(
        after_help = "Examples:\n  lumivox reference hall.glb --batches 0..8 --part a.part\n  lumivox \
                            reference hall.glb --batches 8..16 --part b.part\n  lumivox merge \
                            a.part b.part -o hall.exr"
    )]
    Merge(MergeArgs),
    /// Describe the GPUs of this machine, or a scene
    #[command(after_help = "Examples:\n  lumivox info\n  lumivox info hall.glb --json")]
    Info(InfoArgs),
    /// Voxelize a scene, and print the number of voxels, their memory and time
    #[command(
        after_help = "Examples:\n  lumivox voxels builtin:atrium\n  lumivox voxels hall.glb \
                            --resolution 256 --isotropic --json"
    )]
    Voxels(Box<VoxelsArgs>),
    /// Measure the speed of standard cases, beside published figures: a report to read or to send
    /// in
    #[command(after_help = bench::EXAMPLES)]
    Bench(Box<BenchArgs>),
    /// Write a scene as one GLB file (glTF 2.0)
    #[command(
        after_help = "Examples:\n  lumivox convert hall.obj --unit cm -o hall.glb\n  lumivox \
                            convert robot.glb --animation walk --time 1.5 -o pose.glb"
    )]
    Convert(ConvertArgs),
    /// Measure the error of a picture against a reference: bias, RMSE, 95th percentile, FLIP
    #[command(after_help = compare::EXAMPLES)]
    Compare(Box<CompareArgs>),
    /// Measure light: lux at points or on a workplane, cd/m2 along rays or in a picture
    #[command(after_help = measure::EXAMPLES, mut_arg("surroundings", measure::of_measurements))]
    Measure(Box<MeasureArgs>),
    /// Bake light into a file: an irradiance volume of Bevy, or a lightmap
    #[command(after_help = bake::EXAMPLES, mut_arg("surroundings", measure::of_measurements))]
    Bake(Box<BakeArgs>),
    /// Run commands that show and change a scene and save pictures of it: a script, or a prompt
    #[command(after_help = run::EXAMPLES)]
    Run(Box<RunArgs>),
    /// List the commands of `run`
    Commands(CommandsArgs),
    /// List the built-in scenes
    Scenes,
}

/// The arguments of `render`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The picture's file: .png (8 bits a channel) or .exr (floats, in cd/m2); for a sequence a
    /// folder, or a file with #### for the number [required]
    ///
    /// A file of that name is replaced once the picture is complete, never half. In a folder,
    /// pictures are PNG files with the names 0000.png and so on. An index in JSON beside the
    /// pictures says what each shows (index.json, or the file's name with `index` for ####). The
    /// same command continues a sequence that was stopped.
    #[arg(short, long, value_name = "FILE|FOLDER", help_heading = "Picture")]
    pub output: PathBuf,

    /// Size, camera, view and exposure of the picture.
    #[command(flatten)]
    pub picture: PictureArgs,

    /// Motion of the scene and the camera.
    #[command(flatten)]
    pub timeline: TimelineArgs,

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

    /// Print one JSON object instead of text, with times of all passes [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

impl RenderArgs {
    /// The settings that the command line gives.
    pub fn given(&self) -> Vec<Given> {
        let Self { picture, voxels, light, cones, .. } = self;
        explore::given([picture.settings.given(), voxels.given(), light.settings.given()], cones)
    }

    /// All settings of the picture, or of the first one.
    ///
    /// # Errors
    /// When two options contradict each other.
    pub fn settings(&self) -> Result<RenderSettings, Failure> {
        settings::of(self.cones.preset(), self.picture.size, &self.given())
    }
}

/// The arguments of `info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// Describe this scene instead: a glTF, OBJ, PLY or STL file, or builtin:NAME [default:
    /// describe the machine]
    #[arg(value_name = "SCENE", value_parser = scene_source())]
    pub scene: Option<SceneSource>,

    /// How its file is read.
    #[command(flatten)]
    pub load: lumivox_console::LoadArgs,

    /// The voxels whose memory is estimated.
    #[command(flatten)]
    pub voxels: SettingArgs<VolumeGroups>,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

/// The arguments of `convert`.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The file to write, .glb [required]
    ///
    /// A file of that name is replaced once the new one is complete, never half.
    #[arg(short, long, value_name = "FILE", help_heading = "Scene")]
    pub output: PathBuf,

    /// The time of the animation that is written, in seconds, -10000 to 10000 [default: the scene
    /// as its file shows it]
    ///
    /// The animations themselves are not written.
    #[arg(long, value_name = "SECONDS", value_parser = number::number(-10_000.0..=10_000.0))]
    #[arg(allow_hyphen_values = true, help_heading = "Scene")]
    pub time: Option<f32>,

    /// The animation to show: its name or number, or all at once [default: the first, if there is a
    /// --time]
    ///
    /// Numbers count from 0; `lumivox info SCENE` lists them.
    #[arg(long, value_name = "NAME|NUMBER|all", value_parser = animation)]
    #[arg(help_heading = "Scene")]
    pub animation: Option<AnimationName>,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

#[cfg(test)]
mod rules;
#[cfg(test)]
mod tests;
