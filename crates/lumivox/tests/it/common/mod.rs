//! The device of the tests: the adapter that wgpu finds, with WebGPU's default limits, so that
//! tested code runs in browsers. Without an adapter tests fail.

use std::sync::OnceLock;

use lumivox::gpu::Pipelines;

/// The device of all tests of this program, and shared pipelines: each is linked and compiled once.
///
/// # Panics
/// When there is no adapter: run the tests through `./test`, which installs a software driver.
pub fn device() -> (Pipelines, wgpu::Queue) {
    static SHARED: OnceLock<(Pipelines, wgpu::Queue)> = OnceLock::new();
    SHARED.get_or_init(open).clone()
}

fn open() -> (Pipelines, wgpu::Queue) {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(descriptor);
    let adapter =
        pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .expect(
                "no GPU adapter: run the tests through ./test, which installs a software driver",
            );
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("test"),
        required_limits: wgpu::Limits::default(),
        ..Default::default()
    }))
    .expect("a device with WebGPU's default limits");
    (Pipelines::new(&device), queue)
}
