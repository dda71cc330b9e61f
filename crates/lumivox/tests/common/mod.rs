//! A device for tests: the adapter that wgpu finds, with WebGPU's default limits, so that what passes here
//! runs in a browser. No adapter is a failure.

/// A device with WebGPU's default limits.
///
/// # Panics
/// When there is no adapter: run the tests through `./test`, which installs a software driver.
pub fn device() -> (wgpu::Device, wgpu::Queue) {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(descriptor);
    let adapter =
        pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .expect(
                "no GPU adapter: run the tests through ./test, which installs a software driver",
            );
    pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
        label: Some("test"),
        required_limits: wgpu::Limits::default(),
        ..Default::default()
    }))
    .expect("a device with WebGPU's default limits")
}
