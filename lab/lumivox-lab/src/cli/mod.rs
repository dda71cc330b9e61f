//! The command line: commands, options, and their help.

mod dynamic;
mod kernels;
mod motion;
mod quality;
mod rooms;
mod volumes;
mod voxelizers;

use clap::{ArgAction, Parser, Subcommand};
use lumivox_app::Host;
use lumivox_app::parts::{CODES, Program};

pub use dynamic::DynamicArgs;
pub use kernels::KernelsArgs;
pub use motion::MotionArgs;
pub use quality::QualityArgs;
pub use rooms::RoomsArgs;
pub use volumes::VolumesArgs;
pub use voxelizers::VoxelizersArgs;

/// Measures Lumivox itself
///
/// For its developers: errors of light and pictures against a path tracer, in many scenes and in
/// motion, the memory of volumes, and comparisons of voxelizers. It also writes the pages about
/// them.
#[derive(Debug, Parser)]
#[command(name = "lumivox-lab", version, max_term_width = 100, after_help = CODES)]
pub struct Cli {
    /// Print more: -v adds notes, -vv details [default: warnings only]
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

    fn run_command(&self, host: &Host) -> Option<anyhow::Result<()>> {
        Some(match self.command.as_ref()? {
            Command::Quality(args) => crate::quality::run(args, host),
            Command::Rooms(args) => crate::rooms::run(args, host),
            Command::Motion(args) => crate::motion::run(args, host),
            Command::Volumes(args) => crate::volumes::run(args, host),
            Command::Voxelizers(args) => crate::voxelizers::run(args, host),
            Command::Dynamic(args) => crate::dynamic::run(args, host),
            Command::Kernels(args) => crate::kernels::run(args, host),
            Command::CompileKernels => crate::kernels::compile(host),
        })
    }
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Measure the errors of built-in scenes for presets and resolutions, and write a page about
    /// them
    #[command(after_help = quality::EXAMPLES)]
    Quality(Box<QualityArgs>),
    /// Measure the errors of light in rooms at random, which nobody tuned it for
    #[command(after_help = rooms::EXAMPLES)]
    Rooms(Box<RoomsArgs>),
    /// Measure errors, flicker, delay and cost while camera, light or things move, one frame a step
    #[command(after_help = motion::EXAMPLES)]
    Motion(Box<MotionArgs>),
    /// Measure memory, build time and trace time of dense and octree volumes
    #[command(after_help = volumes::EXAMPLES)]
    Volumes(Box<VolumesArgs>),
    /// Voxelize a scene with every voxelizer, and print the errors against the exact one
    ///
    /// The voxels found, missing and extra; the share of the surface that is missed; the error of
    /// colours; and the time.
    #[command(after_help = voxelizers::EXAMPLES)]
    Voxelizers(Box<VoxelizersArgs>),
    /// Measure the gain of keeping the voxels of static triangles while others move
    ///
    /// Small objects are chosen first, and moved by up to three voxels at a time. Each move is
    /// voxelized and lit twice, as a whole and with the static surface kept, and both must give the
    /// same voxels with the same light, to the bit.
    #[command(after_help = dynamic::EXAMPLES)]
    Dynamic(Box<DynamicArgs>),
    /// Compile every kernel for AMD's GPUs, without one: registers, waves and instructions
    ///
    /// The compiler is that of Mesa's driver RADV, for the chips navi21 and vega10. On Linux only.
    #[command(after_help = kernels::EXAMPLES)]
    Kernels(Box<KernelsArgs>),
    /// Compile the kernels on standard input for the chip that the environment names
    #[command(hide = true)]
    CompileKernels,
}

#[cfg(test)]
#[path = "../../../../crates/lumivox-app/src/cli/rules.rs"]
mod rules;
