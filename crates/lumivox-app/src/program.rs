//! A program: its command line, and its process.

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;
use lumivox_console::shown;

use crate::exit::{Exit, guard};
use crate::host::Host;
use crate::log;

/// The command line of a program.
pub trait Program: Parser {
    /// How often the option `-v` is given.
    fn verbosity(&self) -> u8;

    /// Whether the command's own output includes the scene's warnings.
    fn tells_warnings(&self) -> bool {
        false
    }

    /// Runs the command; `None` if none is given.
    fn run_command(&self, host: &Host) -> Option<anyhow::Result<()>>;
}

/// Runs a command line; its first word is the program's name. Without a command it prints the help.
pub fn run<P: Program>(args: impl IntoIterator<Item = OsString>, host: &Host) -> Exit {
    let args: Vec<OsString> = args.into_iter().collect();
    let program = match P::try_parse_from(&args) {
        Ok(program) => program,
        Err(error) => {
            // File names that a shell filled in may contain control characters, and messages repeat
            // them: escape them.
            let shown = args.iter().map(|arg| shown::line(&arg.to_string_lossy()).into_owned());
            let error = P::try_parse_from(shown).err().unwrap_or(error);
            return host.report_usage(&error);
        }
    };
    let _log = log::start(program.verbosity(), program.tells_warnings(), host);
    let done = program.run_command(host);
    let done = done.unwrap_or_else(|| host.print(&format!("{}\n", P::command().render_help())));
    match done {
        Ok(()) => Exit::Ok,
        Err(error) => host.report(&error),
    }
}

/// Runs a program as its process, by a function such as [`crate::run`]. Nothing may run before it.
pub fn main(run: impl FnOnce(std::env::ArgsOs, &Host) -> Exit) -> ExitCode {
    #[cfg(target_os = "linux")]
    do_without_a_desktop();
    guard(std::panic::AssertUnwindSafe(|| run(std::env::args_os(), &Host::of_process()))).into()
}

/// Keeps Mesa's Vulkan layer from asking a missing desktop for the preferred GPU.
///
/// The layer (`VkLayer_MESA_device_select`) only puts that GPU first, and this program sorts GPUs
/// itself. The layer asks through libwayland, which prints an "error:" of its own if it finds no
/// socket. The layer's own environment variables still work.
#[cfg(target_os = "linux")]
#[allow(unsafe_code, reason = "the only way to tell the layer")]
fn do_without_a_desktop() {
    use std::env::var_os;
    let is_absolute =
        |name| var_os(name).is_some_and(|value| std::path::Path::new(&value).is_absolute());
    let has_socket = is_absolute("XDG_RUNTIME_DIR")
        || is_absolute("WAYLAND_DISPLAY")
        || var_os("WAYLAND_SOCKET").is_some();
    let chooses = ["NODEVICE_SELECT", "MESA_VK_DEVICE_SELECT", "DRI_PRIME"];
    if has_socket || chooses.iter().any(|name| var_os(name).is_some()) {
        return;
    }
    // SAFETY: no other thread reads the environment meanwhile, because this is the first thing that
    // `main` does and no other thread exists yet.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
}
