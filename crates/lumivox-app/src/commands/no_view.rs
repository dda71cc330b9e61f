//! `lumivox view` in a build without the window.

use lumivox_console::Failure;

use crate::cli::WindowArgs;
use crate::host::Host;

/// Explains how to build the program with the window.
///
/// # Errors
/// Always. As with a window, a scene that cannot be found is reported first.
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
