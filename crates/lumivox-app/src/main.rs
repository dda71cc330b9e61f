//! The `lumivox` program; all of it is in the library [`lumivox_app`].

use std::process::ExitCode;

use lumivox_app::{Host, guard, run};

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    do_without_a_desktop();
    guard(|| run(std::env::args_os(), &Host::of_process())).into()
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
