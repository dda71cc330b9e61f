//! `lumivox view` in a build without the window.

use lumivox_console::Failure;

use crate::cli::WindowArgs;
use crate::host::Host;

/// Tells how a build with the window is made.
///
/// # Errors
/// Always; first, as with a window, when the scene cannot be found.
pub fn run(args: &WindowArgs, _: &Host) -> anyhow::Result<()> {
    if let Some(source) = args.scene() {
        crate::args::scene::check(source)?;
    }
    Err(Failure::display(
        "this build of lumivox has no window: run `./lumivox view`, which builds it, or build it with `cargo build \
         --release -p lumivox-app --features window`; `lumivox render` makes pictures and `lumivox run` runs scripts \
         without one",
    )
    .into())
}
