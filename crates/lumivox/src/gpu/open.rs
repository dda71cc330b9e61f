//! A device for programs that have none.

use crate::GiError;

/// Opens the adapter that wgpu finds first, without a window and with WebGPU's default limits, which are enough for
/// everything here: for tools, tests and examples. An engine has a device of its own.
///
/// # Errors
/// [`GiError::Device`] when there is no adapter (on Linux, Mesa's `mesa-vulkan-drivers` bring one in software), or when
/// it gives no device.
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
