//! The report on this machine.
//!
//! The device's limits decide how large a volume may be. Graphics APIs do not report free memory,
//! so only allocating shows whether it suffices. The report therefore gives the largest resolution
//! within the limits, and the memory of the usual resolutions.

use lumivox_console::report::{AdapterReport, Table, bytes};
use lumivox_render::{Gpu, GpuOptions, describe};
use serde::Serialize;

/// The report on this machine.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    version: &'static str,
    /// The adapter that is used if none is named; `None` without adapters.
    default_adapter: Option<String>,
    /// All adapters, the best first.
    adapters: Vec<Capabilities>,
}

/// The report on an adapter.
#[derive(Clone, Debug, Serialize)]
struct Capabilities {
    #[serde(flatten)]
    adapter: AdapterReport,
    /// Why it cannot run Lumivox; `None` if it can.
    problem: Option<String>,
    #[serde(flatten)]
    device: Option<DeviceReport>,
}

/// The capabilities of an adapter's device.
#[derive(Clone, Debug, Serialize)]
struct DeviceReport {
    max_buffer_bytes: u64,
    max_storage_binding_bytes: u64,
    max_texture_2d: u32,
    max_texture_3d: u32,
    /// How times of passes are measured.
    timing: &'static str,
    /// Whether shaders can compute in 16-bit floats. Lumivox only stores them, and does not need
    /// it.
    shader_f16: bool,
    /// The largest resolution of the dense volume for a cube-shaped scene, with its memory.
    largest_volume: VolumeReport,
    /// Volumes of the usual resolutions up to the largest.
    volumes: Vec<VolumeReport>,
    /// The largest resolution of an octree, if its surface fits the memory.
    largest_octree: u32,
}

/// The dense volume of a cube-shaped scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct VolumeReport {
    resolution: u32,
    /// Bytes with six lobes.
    bytes: u64,
    /// Bytes of an isotropic volume.
    isotropic_bytes: u64,
}

impl Report {
    /// Queries every adapter.
    pub fn new() -> Self {
        let known = pollster::block_on(adapters());
        let infos = pollster::block_on(Gpu::adapters());
        let adapters: Vec<Capabilities> = infos
            .iter()
            .map(|info| {
                let features = known
                    .iter()
                    .find(|adapter| adapter.get_info() == *info)
                    .map(wgpu::Adapter::features)
                    .unwrap_or_default();
                Capabilities::new(info, features)
            })
            .collect();
        let default_adapter = infos.first().map(|info| info.name.clone());
        Self { version: env!("CARGO_PKG_VERSION"), default_adapter, adapters }
    }

    /// The report for people.
    pub fn text(&self) -> String {
        let mut text = format!("Lumivox {}\n", self.version);
        if self.adapters.is_empty() {
            text += "\nThere is no GPU adapter for Vulkan, Metal or Direct3D 12 here, so nothing \
                     can be rendered. Install the GPU's driver, or a software driver (on Debian \
                     and Ubuntu: mesa-vulkan-drivers).\n";
        }
        for (place, adapter) in self.adapters.iter().enumerate() {
            text.push('\n');
            text += &adapter.text(place == 0);
        }
        text
    }
}

impl Capabilities {
    fn new(info: &wgpu::AdapterInfo, features: wgpu::Features) -> Self {
        // The whole description, so that no other adapter matches.
        let options = GpuOptions { adapter: Some(describe(info)), ..GpuOptions::default() };
        let opened = pollster::block_on(Gpu::new(&options));
        let (device, problem) = match opened {
            Ok(gpu) => (Some(DeviceReport::new(&gpu, features)), None),
            Err(error) => (None, Some(error.to_string())),
        };
        Self { adapter: AdapterReport::new(info), problem, device }
    }

    fn text(&self, is_default: bool) -> String {
        let mut text = self.adapter.description.clone();
        text += if is_default { "  <- used unless --adapter names another\n" } else { "\n" };
        let mut line = |name: &str, value: String| {
            text += &format!("  {name:<23} {value}\n");
        };
        if let Some(problem) = &self.problem {
            line("does not run Lumivox", problem.clone());
        }
        let Some(device) = &self.device else { return text };
        line("largest buffer", bytes(device.max_buffer_bytes));
        line("largest storage binding", bytes(device.max_storage_binding_bytes));
        line("largest picture", format!("{0} x {0} pixels", device.max_texture_2d));
        line("largest 3D texture", format!("{0} x {0} x {0} texels", device.max_texture_3d));
        line("times of passes", device.timing.to_owned());
        let half_floats = if device.shader_f16 { "yes" } else { "no" };
        line("half floats in shaders", format!("{half_floats} (not needed)"));
        let largest = device.largest_volume.resolution;
        line(
            "dense voxel volume",
            format!("up to resolution {largest} by the limits; for a cube:"),
        );
        let mut table = Table::new(&["    resolution", "six lobes", "--isotropic"]);
        for volume in &device.volumes {
            table.row([
                format!("    {}", volume.resolution),
                bytes(volume.bytes),
                bytes(volume.isotropic_bytes),
            ]);
        }
        text += &table.text();
        text + &format!(
            "  octree                  up to resolution {} by the limits; memory is proportional to the surface\n",
            device.largest_octree
        )
    }
}

impl DeviceReport {
    fn new(gpu: &Gpu, features: wgpu::Features) -> Self {
        let limits = gpu.device.limits();
        let timing = if gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            if gpu.is_software() {
                "by the clock, pass by pass (its timestamps cannot be trusted)"
            } else {
                "by timestamps"
            }
        } else {
            "by the clock, pass by pass (it has no timestamps)"
        };
        let largest = largest_resolution(&limits);
        let usual = [64, 128, 256, 512, 1024].into_iter().filter(|&n| n <= largest);
        Self {
            max_buffer_bytes: limits.max_buffer_size,
            max_storage_binding_bytes: limits.max_storage_buffer_binding_size,
            max_texture_2d: limits.max_texture_dimension_2d,
            max_texture_3d: limits.max_texture_dimension_3d,
            timing,
            shader_f16: features.contains(wgpu::Features::SHADER_F16),
            largest_volume: VolumeReport::new(largest),
            volumes: usual.map(VolumeReport::new).collect(),
            largest_octree: largest_octree(&limits),
        }
    }
}

impl VolumeReport {
    fn new(resolution: u32) -> Self {
        let cells = cells(resolution);
        let masks = mask_bytes(resolution);
        Self {
            resolution,
            bytes: cells * 8 * SLABS.pow(2) + masks,
            isotropic_bytes: cells * 8 + masks,
        }
    }
}

/// Slabs along an axis of a texture: the nine parts of a cell with six lobes, 8 bytes each, are in
/// 3 x 3 slabs.
const SLABS: u64 = 3;

/// The edges, in cells, of the levels of a cube's pyramid; the coarsest has at least four.
fn edges(resolution: u32) -> impl Iterator<Item = u64> {
    let levels = (resolution / 4).ilog2() + 1;
    (0..levels).map(move |level| u64::from(resolution >> level))
}

fn cells(resolution: u32) -> u64 {
    edges(resolution).map(|edge| edge.pow(3)).sum()
}

/// Bytes of the masks: two for each corner of a cell.
fn mask_bytes(resolution: u32) -> u64 {
    edges(resolution).map(|edge| (edge + 1).pow(3)).sum::<u64>() * 2
}

/// The largest resolution of a cube's volume within the limits.
fn largest_resolution(limits: &wgpu::Limits) -> u32 {
    let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    (lumivox::MIN_RESOLUTION..=lumivox::MAX_RESOLUTION)
        .step_by(8)
        .take_while(|&resolution| {
            u64::from(resolution) * SLABS <= u64::from(limits.max_texture_dimension_3d)
                && mask_bytes(resolution) <= binding
        })
        .last()
        .unwrap_or(0)
}

/// The largest resolution of a voxel list within the limits, whatever the surface: a word of
/// occupancy bits with its rank for every 32 cells of the enclosing cube, whose edge is a power of
/// two.
fn largest_octree(limits: &wgpu::Limits) -> u32 {
    let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    (lumivox::MIN_RESOLUTION..=lumivox::MAX_RESOLUTION)
        .step_by(8)
        .take_while(|n| u64::from(n.next_power_of_two()).pow(3) / 32 * 8 <= binding)
        .last()
        .unwrap_or(0)
}

/// All adapters. An open device does not list its adapter's features.
async fn adapters() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    // OpenGL is not used, and probing for it prints errors on machines without a display.
    let backends = wgpu::Backends::PRIMARY;
    descriptor.backends = backends;
    wgpu::Instance::new(descriptor).enumerate_adapters(backends).await
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the memory of a small volume with what the library reports.
    #[test]
    fn the_memory_is_what_the_library_allocates() {
        use lumivox::{Directionality, Gi, GiConfig, Grid};
        let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap();
        for directionality in [Directionality::SixLobes, Directionality::Isotropic] {
            let grid = Grid::fit(glam::Vec3::ZERO, glam::Vec3::ONE, 32, glam::Vec3::ZERO).unwrap();
            assert_eq!(grid.dimensions, glam::UVec3::splat(32));
            let config = GiConfig { directionality, keeps_cells: true, ..GiConfig::new(grid) };
            let gi = Gi::new(&gpu.device, &gpu.queue, config).unwrap();
            let memory = gi.memory();
            let volume = memory.iter().filter(|(name, _)| name.starts_with("volume"));
            let expected = VolumeReport::new(32);
            let expected = match directionality {
                Directionality::SixLobes => expected.bytes,
                Directionality::Isotropic => expected.isotropic_bytes,
            };
            // The masks may be rounded up to whole words.
            let sum = volume.map(|(_, bytes)| bytes).sum::<u64>();
            assert!(sum.abs_diff(expected) < 16, "{memory:?}, expected {expected}");
        }
    }

    #[test]
    fn default_limits_hold_a_dense_cube_of_384_and_an_octree_of_512() {
        assert_eq!(largest_resolution(&wgpu::Limits::default()), 384);
        let large = wgpu::Limits {
            max_texture_dimension_3d: 16_384,
            max_storage_buffer_binding_size: 1 << 40,
            max_buffer_size: 1 << 40,
            ..wgpu::Limits::default()
        };
        assert_eq!(largest_resolution(&large), lumivox::MAX_RESOLUTION);
        assert_eq!(largest_octree(&wgpu::Limits::default()), 512);
        assert_eq!(largest_octree(&large), lumivox::MAX_RESOLUTION);
    }
}
