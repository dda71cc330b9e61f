//! Exclusive prefix sums over `u32` buffers.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary,
};
use crate::gpu::{storage_buffer, uniform_buffer};

/// Invocations of a workgroup.
pub(crate) const SCAN_WORKGROUP_SIZE: u32 = 256;
/// Elements that one invocation handles.
pub(crate) const SCAN_ITEMS: u32 = 8;
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
    /// When the shader does not link.
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

    /// Replaces each of the first `count` elements of `values` by the sum of all before it.
    ///
    /// With a last element of zero, it becomes the total of the others.
    pub fn run(&self, recorder: &mut Recorder, values: &Buffer, count: u32) {
        if count == 0 {
            return;
        }
        let device = recorder.device().clone();
        let blocks = count.div_ceil(BLOCK);
        let totals = storage_buffer(&device, "scan totals", u64::from(blocks) * 4);
        let params = ScanParams { count, padding: [0; 3] };
        let params = uniform_buffer(&device, "scan parameters", &params);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&params)
            .buffer(values)
            .buffer(&totals)
            .build(&device, "gpu::scan");
        let threads = u64::from(blocks) * u64::from(SCAN_WORKGROUP_SIZE);
        self.blocks.run_linear(recorder, &[&group], threads);
        if blocks > 1 {
            self.run(recorder, &totals, blocks);
            self.add.run_linear(recorder, &[&group], threads);
        }
    }
}
