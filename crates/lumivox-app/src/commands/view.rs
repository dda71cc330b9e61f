//! `lumivox view`: the window.

use indicatif::MultiProgress;
use lumivox_explorer::Explorer;

use super::{open_gpu, settings};
use crate::cli::WindowArgs;
use crate::console::Console;
use crate::opening::Opening;
use crate::window::{self, Config, Start};

/// Shows the window until it is closed.
///
/// # Errors
/// When there is no display or no GPU, or the scene cannot be found.
pub fn run(args: &WindowArgs, bars: &MultiProgress) -> anyhow::Result<()> {
    // Bars are for terminals that nobody types commands into.
    bars.set_draw_target(indicatif::ProgressDrawTarget::hidden());
    if let Some(source) = args.scene() {
        source.check()?;
    }
    // First what is cheap to fail.
    let event_loop = window::event_loop()?;
    let gpu = open_gpu(&args.explore.gpu)?;
    let mut config = Config::load(args.fresh);
    let preset = args.explore.cones.preset();
    let mut explorer = Explorer::new(gpu, settings::of_explore(&args.explore), preset);
    config.apply(&mut explorer, std::env::args());
    let opening = args.scene().map(|source| Opening {
        camera: args.explore.camera.clone(),
        ..Opening::of(&args.explore, source.clone())
    });
    let options = lumivox_render::GpuOptions {
        adapter: args.explore.gpu.adapter.clone(),
        portable: args.explore.gpu.portable,
    };
    let console = Console::new(explorer)
        .with_defaults(args.explore.load.clone(), args.explore.light.sources.clone());
    window::run(event_loop, Start { console, opening, options, config })
}
