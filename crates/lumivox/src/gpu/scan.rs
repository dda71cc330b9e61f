//! Exclusive prefix sums over `u32` buffers.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary,
};
use crate::gpu::{storage_buffer, uniform_buffer};

/// Invocations per workgroup.
pub(super) const SCAN_WORKGROUP_SIZE: u32 = 256;
/// Elements that one invocation handles.
pub(super) const SCAN_ITEMS: u32 = 8;
const BLOCK: u32 = SCAN_WORKGROUP_SIZE * SCAN_ITEMS;

/// `ScanParams` of `scan.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct ScanParams {
    count: u32,
    padding: [u32; 3],
}

/// The kernels of the prefix sum.
#[derive(Debug)]
pub struct Scan {
    layout: wgpu::BindGroupLayout,
    blocks: Kernel,
    add: Kernel,
}

impl Scan {
    /// Compiles the kernels.
    ///
    /// # Errors
    /// If the shader does not link.
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage_mut()
            .storage_mut()
            .build(device, "gpu::scan");
        Ok(Self {
            blocks: Kernel::new(device, shaders, "gpu::scan", "scan", &[&layout])?,
            add: Kernel::new(device, shaders, "gpu::scan", "add", &[&layout])?,
            layout,
        })
    }

    /// Replaces each of the first `count` elements of `values` by the sum of the elements before
    /// it.
    ///
    /// A last element of zero becomes the total of the others.
    pub fn run(&self, recorder: &mut Recorder<'_>, values: &Buffer, count: u32) {
        let bound = self.bind(recorder.device(), values, count);
        self.run_bound(recorder, &bound);
    }

    /// Binds a buffer for repeated calls of [`Self::run_bound`].
    pub fn bind(&self, device: &wgpu::Device, values: &Buffer, count: u32) -> BoundScan {
        let mut levels = Vec::new();
        let (mut values, mut count) = (values.clone(), count);
        while count > 0 {
            let blocks = count.div_ceil(BLOCK);
            let totals = storage_buffer(device, "scan totals", u64::from(blocks) * 4);
            let params = ScanParams { count, padding: [0; 3] };
            let params = uniform_buffer(device, "scan parameters", &params);
            let group = BindGroupBuilder::new(&self.layout)
                .buffer(&params)
                .buffer(&values)
                .buffer(&totals)
                .build(device, "gpu::scan");
            levels.push((group, u64::from(blocks) * u64::from(SCAN_WORKGROUP_SIZE)));
            (values, count) = (totals, if blocks > 1 { blocks } else { 0 });
        }
        BoundScan { levels }
    }

    /// [`Self::run`] on a bound buffer.
    pub fn run_bound(&self, recorder: &mut Recorder<'_>, bound: &BoundScan) {
        recorder.compute("gpu::scan", |pass| {
            for (group, threads) in &bound.levels {
                self.blocks.dispatch_linear(pass, &[group], *threads);
            }
            for (group, threads) in bound.levels.iter().rev().skip(1) {
                self.add.dispatch_linear(pass, &[group], *threads);
            }
        });
    }
}

/// A buffer bound to a [`Scan`]: the sums of its blocks, of blocks of these sums, and so on.
#[derive(Debug)]
pub struct BoundScan {
    levels: Vec<(BindGroup, u64)>,
}
