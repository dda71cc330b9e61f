//! The `lumivox` program; all of it is in the library [`lumivox_app`].

use std::process::ExitCode;

use lumivox_app::{Host, guard, run};

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    do_without_a_desktop();
    guard(|| run(std::env::args_os(), &Host::of_process())).into()
}

/// Keeps a Vulkan layer of Mesa's from asking a desktop that is not there for its favourite GPU.
///
/// The layer (`VkLayer_MESA_device_select`) does no more than to put that GPU first, and this program sorts them itself.
/// It asks by way of libwayland, which prints an "error:" of its own where it finds no socket. Who chooses a GPU by the
/// layer's variables still can.
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
    // SAFETY: no other thread reads the environment meanwhile, for this is the first thing that `main` does and there is
    // none yet.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
}
