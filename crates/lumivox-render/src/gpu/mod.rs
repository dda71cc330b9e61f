//! The GPU: choosing an adapter, opening a device and collecting its errors. Also tools for the
//! whole crate: screen-sized textures, read-back, memory and times.

mod faults;
pub(crate) mod memory;
#[cfg(not(target_arch = "wasm32"))]
mod pipeline_cache;
pub(crate) mod readback;
pub(crate) mod textures;
pub(crate) mod times;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use lumivox::gpu::Pipelines;

use crate::RenderError;
use faults::Faults;
use memory::available_memory;
#[cfg(not(target_arch = "wasm32"))]
use pipeline_cache::PipelineFile;
#[cfg(not(target_arch = "wasm32"))]
pub use pipeline_cache::pipeline_cache_folder;

/// The APIs that lumivox runs on. OpenGL is left out: it cannot guarantee WebGPU's default limits,
/// and probing for it prints errors on machines without a display.
#[cfg(not(target_arch = "wasm32"))]
const BACKENDS: wgpu::Backends =
    wgpu::Backends::VULKAN.union(wgpu::Backends::METAL).union(wgpu::Backends::DX12);
#[cfg(target_arch = "wasm32")]
const BACKENDS: wgpu::Backends = wgpu::Backends::BROWSER_WEBGPU;

/// Features that a device is opened with if its adapter supports them.
const USED_FEATURES: wgpu::Features =
    wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::PIPELINE_CACHE);

/// Options for choosing and opening a device.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GpuOptions {
    /// Part of the adapter's name, case-insensitive. `None` (the default) selects the fastest
    /// adapter: discrete before integrated before software.
    pub adapter: Option<String>,
    /// `true` limits the device to WebGPU's default limits, as in a browser, even if the adapter
    /// offers more. Default: `false`; then buffers and textures may be as large as the adapter
    /// allows.
    pub portable: bool,
    /// The folder that caches compiled pipelines across runs; [`pipeline_cache_folder`] returns the
    /// user's. `None` (the default) caches none. Only Vulkan drivers support it; browsers have
    /// their own cache.
    pub pipeline_cache: Option<std::path::PathBuf>,
}

/// Identifies an open device. wgpu's handles do not: handles of different instances can compare
/// equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GpuId(u64);

/// An open device.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Shared by all clones, and different for every other device.
    pub id: GpuId,
    /// The instance of the adapter; create surfaces that the device draws into from it.
    pub instance: wgpu::Instance,
    /// The adapter that the device was opened on.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Pipeline cache, shared by everything on the device.
    pub pipelines: Pipelines,
    /// Name, type, API and driver of the adapter.
    pub adapter_info: wgpu::AdapterInfo,
    /// Errors that were not polled yet.
    faults: Arc<Faults>,
    is_lost: Arc<AtomicBool>,
    #[cfg(not(target_arch = "wasm32"))]
    pipeline_file: Option<Arc<PipelineFile>>,
}

impl Gpu {
    /// The adapters of this machine, best first: discrete, integrated, virtual, software.
    pub async fn adapters() -> Vec<wgpu::AdapterInfo> {
        adapters(&instance()).await.iter().map(wgpu::Adapter::get_info).collect()
    }

    /// Opens a device.
    ///
    /// # Errors
    /// [`RenderError::Adapter`] when there is no adapter or none of that name, with a list of the
    /// others; [`RenderError::NoDevice`] when the adapter has no device with WebGPU's default
    /// limits.
    pub async fn new(options: &GpuOptions) -> Result<Self, RenderError> {
        let instance = instance();
        let adapter = choose(adapters(&instance).await, options.adapter.as_deref())?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("lumivox"),
            required_features: adapter.features() & USED_FEATURES,
            required_limits: limits(&adapter.limits(), options.portable),
            ..Default::default()
        };
        let (device, queue) = adapter.request_device(&descriptor).await.map_err(|error| {
            let adapter = describe(&adapter.get_info());
            RenderError::NoDevice { adapter, reason: error.to_string() }
        })?;
        let gpu = Self::with_device(instance, adapter, device, queue);
        #[cfg(not(target_arch = "wasm32"))]
        let gpu = gpu.with_pipeline_cache(options.pipeline_cache.as_deref());
        tracing::debug!("rendering on {}", describe(&gpu.adapter_info));
        Ok(gpu)
    }

    /// Uses a device that the caller has opened, for an engine or a window with its own device. It
    /// needs at least WebGPU's default limits, and [`wgpu::Features::TIMESTAMP_QUERY`] to measure
    /// the times of stages.
    ///
    /// Replaces the device's handlers for uncaptured errors and for device loss.
    pub fn with_device(
        instance: wgpu::Instance,
        adapter: wgpu::Adapter,
        device: wgpu::Device,
        queue: wgpu::Queue,
    ) -> Self {
        static DEVICES: AtomicU64 = AtomicU64::new(0);
        let id = GpuId(DEVICES.fetch_add(1, Ordering::Relaxed));
        let adapter_info = adapter.get_info();
        let faults = Arc::default();
        let is_lost = Arc::new(AtomicBool::new(false));
        hear_errors(&device, &faults, &is_lost);
        let pipelines = Pipelines::new(&device);
        Self {
            id,
            instance,
            adapter,
            device,
            queue,
            pipelines,
            adapter_info,
            faults,
            is_lost,
            #[cfg(not(target_arch = "wasm32"))]
            pipeline_file: None,
        }
    }

    /// Caches compiled pipelines in a folder ([`GpuOptions::pipeline_cache`]) if the device was
    /// opened with [`wgpu::Features::PIPELINE_CACHE`]. Call it on a new `Gpu`, before anything is
    /// created on it.
    #[cfg(not(target_arch = "wasm32"))]
    #[must_use]
    pub fn with_pipeline_cache(mut self, folder: Option<&std::path::Path>) -> Self {
        let open = |folder| PipelineFile::open(&self.device, &self.adapter_info, folder);
        self.pipeline_file = folder.and_then(open).map(Arc::new);
        if let Some(file) = &self.pipeline_file {
            self.pipelines = Pipelines::with_cache(&self.device, file.cache.clone());
        }
        self
    }

    /// Saves compiled pipelines, if there is a cache file.
    pub(crate) fn save_pipelines(&self) {
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(file) = &self.pipeline_file {
            file.save();
        }
    }

    /// Whether the adapter is a software driver on the CPU.
    pub fn is_software(&self) -> bool {
        self.adapter_info.device_type == wgpu::DeviceType::Cpu
    }

    /// Whether the device is lost: it is no longer usable, and its contents are gone. A new device
    /// can be opened.
    pub fn is_lost(&self) -> bool {
        self.is_lost.load(Ordering::Relaxed)
    }

    /// Reports failures on the device since the last call, outside of calls that return errors
    /// themselves: a lost device, no memory left, a refused command.
    ///
    /// Each thread that shares the device receives its own failures. Failures of threads that have
    /// ended or have never called this go to the next caller. A lost device is reported to all
    /// threads, at each call.
    ///
    /// # Errors
    /// [`RenderError::Device`] with the first failure.
    pub fn check(&self, doing: &'static str) -> Result<(), RenderError> {
        self.faults.take().map_or(Ok(()), |reason| Err(RenderError::Device { doing, reason }))
    }

    /// The error for something that does not fit into the device's memory; `bytes` is its size, if
    /// known. The free memory is known only for software drivers, which use main memory.
    pub(crate) fn out_of_memory(
        &self,
        what: impl Into<String>,
        needed: Option<u64>,
        remedy: &str,
    ) -> RenderError {
        let available = if self.is_software() { available_memory() } else { None };
        RenderError::OutOfMemory {
            what: what.into(),
            needed_mib: needed.map(|bytes| bytes.div_ceil(1 << 20)),
            available_mib: available.map(|bytes| bytes >> 20),
            remedy: remedy.to_owned(),
        }
    }

    /// Waits until the device has finished all submitted work. In browsers the page stays
    /// responsive.
    ///
    /// # Errors
    /// [`RenderError::Device`] when the device is lost.
    #[allow(clippy::unused_async, reason = "only browsers await")]
    pub async fn finished(&self, doing: &'static str) -> Result<(), RenderError> {
        #[cfg(not(target_arch = "wasm32"))]
        self.wait(doing)?;
        #[cfg(target_arch = "wasm32")]
        lumivox::internal::submitted_work_done(&self.queue).await;
        self.check(doing)
    }

    /// Waits until the device has finished all submitted work. In browsers, where nothing may
    /// block, it returns at once; see [`Self::finished`].
    ///
    /// # Errors
    /// [`RenderError::Device`] when the device is lost.
    pub fn wait(&self, doing: &'static str) -> Result<(), RenderError> {
        #[cfg(not(target_arch = "wasm32"))]
        lumivox::internal::note_wait();
        #[cfg(not(target_arch = "wasm32"))]
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| RenderError::Device { doing, reason: error.to_string() })?;
        self.check(doing)
    }
}

/// Describes an adapter: its name, kind, API and driver.
pub fn describe(info: &wgpu::AdapterInfo) -> String {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete GPU",
        wgpu::DeviceType::IntegratedGpu => "integrated GPU",
        wgpu::DeviceType::VirtualGpu => "virtual GPU",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "of unknown kind",
    };
    let driver = format!("{} {}", info.driver, info.driver_info);
    let driver = driver.trim();
    let driver = if driver.is_empty() { "driver unknown" } else { driver };
    format!("{} ({kind}, {:?}, {driver})", info.name, info.backend)
}

/// An instance with the supported APIs.
fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = BACKENDS;
    wgpu::Instance::new(descriptor)
}

async fn adapters(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    // Browsers expose one adapter, and accept a power preference.
    #[cfg(target_arch = "wasm32")]
    let mut adapters = {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        Vec::from_iter(instance.request_adapter(&options).await)
    };
    #[cfg(not(target_arch = "wasm32"))]
    let mut adapters = instance.enumerate_adapters(BACKENDS).await;
    // The sort is stable, so adapters of one type stay in the driver's order.
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

fn choose(adapters: Vec<wgpu::Adapter>, name: Option<&str>) -> Result<wgpu::Adapter, RenderError> {
    let wanted = name.unwrap_or_default().to_lowercase();
    let known: Vec<String> = adapters.iter().map(|a| describe(&a.get_info())).collect();
    let found = adapters
        .into_iter()
        .find(|adapter| describe(&adapter.get_info()).to_lowercase().contains(&wanted));
    found.ok_or_else(|| match name {
        Some(name) if !known.is_empty() => RenderError::Adapter {
            problem: format!("no GPU adapter has \"{name}\" in its name"),
            remedy: format!("there are: {}", known.join("; ")),
        },
        _ if cfg!(target_arch = "wasm32") => RenderError::Adapter {
            problem: "this browser offers no GPU to WebGPU".to_owned(),
            remedy:
                "switch hardware acceleration on in its settings, update the GPU's driver, or try \
                     another browser"
                    .to_owned(),
        },
        _ => RenderError::Adapter {
            problem: "this machine has no GPU adapter for Vulkan, Metal or Direct3D 12".to_owned(),
            remedy: "install the GPU's driver, or a software driver (on Debian and Ubuntu: \
                     mesa-vulkan-drivers)"
                .to_owned(),
        },
    })
}

/// WebGPU's default limits. Only size limits are raised to the adapter's, because the size of the
/// scene is the user's choice; the needs of the shaders are fixed.
fn limits(offered: &wgpu::Limits, portable: bool) -> wgpu::Limits {
    let defaults = wgpu::Limits::default();
    if portable {
        return defaults;
    }
    wgpu::Limits {
        max_buffer_size: offered.max_buffer_size.max(defaults.max_buffer_size),
        max_storage_buffer_binding_size: offered
            .max_storage_buffer_binding_size
            .max(defaults.max_storage_buffer_binding_size),
        max_texture_dimension_2d: offered
            .max_texture_dimension_2d
            .max(defaults.max_texture_dimension_2d),
        max_texture_dimension_3d: offered
            .max_texture_dimension_3d
            .max(defaults.max_texture_dimension_3d),
        ..defaults
    }
}

/// Stores the first error that reaches no error scope and the reason of a device loss. Without
/// these handlers wgpu would panic.
fn hear_errors(device: &wgpu::Device, faults: &Arc<Faults>, is_lost: &Arc<AtomicBool>) {
    let kept = faults.clone();
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| kept.keep(error.to_string())));
    let (kept, is_lost) = (faults.clone(), is_lost.clone());
    device.set_device_lost_callback(move |reason, message| {
        is_lost.store(true, Ordering::Relaxed);
        if reason != wgpu::DeviceLostReason::Destroyed {
            kept.lose(format!("the device was lost ({reason:?}): {message}"));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::own_gpu;

    #[test]
    fn an_unknown_adapter_is_an_error_that_lists_the_known_ones() {
        let options = GpuOptions { adapter: Some("no such".to_owned()), ..Default::default() };
        let error = pollster::block_on(Gpu::new(&options)).expect_err("nothing is called that");
        assert!(error.to_string().contains("\"no such\""), "{error}");
        assert!(error.to_string().contains("there are: "), "{error}");
    }

    #[test]
    fn an_adapter_is_found_by_part_of_its_name_in_any_case() {
        let known = pollster::block_on(Gpu::adapters());
        let part: String = known[0].name.to_uppercase().chars().take(5).collect();
        let options = GpuOptions { adapter: Some(part), portable: true, pipeline_cache: None };
        let gpu = pollster::block_on(Gpu::new(&options)).expect("a device");
        assert_eq!(gpu.adapter_info.name, known[0].name);
        assert_eq!(gpu.device.limits().max_buffer_size, wgpu::Limits::default().max_buffer_size);
    }

    #[test]
    fn loss_of_a_callers_device_is_noticed() {
        let own = own_gpu();
        let descriptor = wgpu::DeviceDescriptor::default();
        let (device, queue) = pollster::block_on(own.adapter.request_device(&descriptor)).unwrap();
        let gpu = Gpu::with_device(own.instance.clone(), own.adapter.clone(), device, queue);
        gpu.wait("testing").unwrap();
        assert!(!gpu.is_lost() && gpu.id != own.id && gpu.id == gpu.clone().id);
        gpu.device.destroy();
        let _ = gpu.wait("testing");
        assert!(gpu.is_lost() && !own.is_lost());
    }

    #[test]
    fn validation_errors_are_returned_by_check() {
        let gpu = own_gpu();
        assert!(gpu.check("testing").is_ok());
        let _ = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("impossible"),
            size: u64::MAX,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        });
        let error = gpu.check("testing").expect_err("no buffer is that large");
        assert!(error.to_string().contains("while testing"), "{error}");
    }
}
