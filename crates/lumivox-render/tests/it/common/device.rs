//! The device of the tests.

use std::sync::OnceLock;

use lumivox_render::{Gpu, GpuOptions};

/// The device of all tests of this program, so that shared shaders are linked and compiled once.
/// Its limits are WebGPU's defaults, as in a browser.
///
/// # Panics
/// When there is no adapter.
pub fn gpu() -> Gpu {
    static SHARED: OnceLock<Gpu> = OnceLock::new();
    SHARED.get_or_init(own_gpu).clone()
}

/// Another such device, for a test that counts its resources.
///
/// # Panics
/// When there is no adapter.
pub fn own_gpu() -> Gpu {
    let options = GpuOptions { portable: true, ..GpuOptions::default() };
    pollster::block_on(Gpu::new(&options))
        .expect("a GPU adapter: run the tests through ./test, which installs a software driver")
}
