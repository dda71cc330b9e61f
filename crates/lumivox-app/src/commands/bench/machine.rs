//! The machine that was measured.

use lumivox_console::report::AdapterReport;
use lumivox_render::Gpu;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// The GPU's name.
    pub name: String,
    /// `DiscreteGpu`, `IntegratedGpu`, `VirtualGpu`, `Cpu` or `Other`.
    pub kind: String,
    /// The graphics API.
    pub backend: String,
    /// The driver's name and version.
    pub driver: String,
    /// Numbers of vendor and device, as the API reports them; 0 if it does not.
    pub vendor_and_device: [u32; 2],
    /// The operating system and the processor's architecture.
    pub system: String,
    /// Threads that the processor runs at once.
    pub cores: usize,
    /// `true` if the device has timestamps.
    pub timestamps: bool,
    /// Nanoseconds of a tick of the timestamps; `None` without them.
    pub timestamp_period_ns: Option<f32>,
    /// The device's limits on what can be measured.
    pub limits: Limits,
}

/// Limits of a device.
#[allow(clippy::struct_field_names, reason = "the names are wgpu's")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    pub max_buffer_size: u64,
    pub max_storage_buffer_binding_size: u64,
    pub max_texture_dimension_2d: u32,
    pub max_texture_dimension_3d: u32,
    pub max_compute_workgroup_storage_size: u32,
    pub max_compute_invocations_per_workgroup: u32,
}

impl Machine {
    /// The machine of a device.
    pub fn new(gpu: &Gpu) -> Self {
        let info = &gpu.adapter_info;
        let AdapterReport { name, backend, driver, kind, .. } = AdapterReport::new(info);
        let timestamps = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let limits = gpu.device.limits();
        Self {
            name,
            kind,
            backend,
            driver,
            vendor_and_device: [info.vendor, info.device],
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            cores: std::thread::available_parallelism().map_or(1, Into::into),
            timestamps,
            timestamp_period_ns: timestamps.then(|| gpu.queue.get_timestamp_period()),
            limits: Limits {
                max_buffer_size: limits.max_buffer_size,
                max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
                max_texture_dimension_2d: limits.max_texture_dimension_2d,
                max_texture_dimension_3d: limits.max_texture_dimension_3d,
                max_compute_workgroup_storage_size: limits.max_compute_workgroup_storage_size,
                max_compute_invocations_per_workgroup: limits.max_compute_invocations_per_workgroup,
            },
        }
    }
}
