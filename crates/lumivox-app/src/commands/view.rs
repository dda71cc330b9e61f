//! `lumivox view`: the window.

use lumivox_console::{Console, SceneRequest};
use lumivox_explorer::Explorer;

use crate::cli::WindowArgs;
use crate::disk::Disk;
use crate::host::Host;
use crate::opening;
use crate::window::{self, Config, Restore, Start};

/// Shows the window until it is closed.
///
/// # Errors
/// When there is no display or no GPU, or the scene cannot be found.
pub fn run(args: &WindowArgs, host: &Host) -> anyhow::Result<()> {
    // Progress bars would disturb the prompt that may run in the terminal.
    host.bars().set_draw_target(indicatif::ProgressDrawTarget::hidden());
    if let Some(source) = args.scene() {
        crate::args::scene::check(source)?;
    }
    let settings = args.explore.settings()?;
    // Cheap checks come first.
    let event_loop = window::event_loop()?;
    // Open the device on a thread with low priority, which the driver's threads inherit.
    let open = || {
        window::give_way();
        host.open_gpu(&args.explore.gpu.options())
    };
    let gpu = std::thread::scope(|scope| scope.spawn(open).join());
    let gpu = gpu.map_err(|_| anyhow::anyhow!("the driver's thread has failed"))??;
    let mut config = Config::load(args.fresh);
    let explore = &args.explore;
    let mut explorer = Explorer::new(gpu, settings, explore.cones.preset());
    config.apply(&mut explorer, &explore.given(), explore.cones.preset.is_some());
    let opening = args.scene().map(|source| SceneRequest {
        camera: explore.picture.camera.clone(),
        ..opening::of(explore, source.clone())
    });
    let options = explore.gpu.options();
    let console = Console::new(explorer, Box::new(Disk))
        .with_defaults(explore.load.clone(), explore.light.sources.clone());
    let _terminal = Restore;
    let device = args.window_device;
    window::run(event_loop, Start { console, opening, options, config, device })
}
