//! Opens a device, for programs without one.

use crate::GiError;

/// Opens the first adapter that wgpu finds, without a window and with WebGPU's default limits,
/// which suffice for this crate. For tools, tests and examples; an engine has its own device.
///
/// # Errors
/// [`GiError::Device`] if there is no adapter (on Linux, the package `mesa-vulkan-drivers` provides
/// a software one), or if the adapter does not open a device.
pub async fn open_device() -> Result<(wgpu::Device, wgpu::Queue), GiError> {
    let fail = |reason: String| GiError::Device { doing: "opening a device", reason };
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = instance
        .request_adapter(&wgpu::RequestAdapterOptions::default())
        .await
        .map_err(|error| fail(format!("{error}; install a driver for Vulkan, Metal or DX12")))?;
    let descriptor = wgpu::DeviceDescriptor { label: Some("lumivox"), ..Default::default() };
    adapter.request_device(&descriptor).await.map_err(|error| fail(error.to_string()))
}
