//! Arguments of indirect dispatches, computed on the GPU from the lengths of runs of work items.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary,
};
use crate::gpu::{storage_buffer, upload};

/// A run of work items whose number is only known on the GPU: its bounds, as indices into the
/// prefix sum of the items (`Run` of `indirect.wgsl`).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Run {
    /// Index of its first item.
    pub first: u32,
    /// Index of the first item after it.
    pub end: u32,
}

/// Kernel that computes arguments of indirect dispatches ([`Kernel::dispatch_indirect`]) from the
/// lengths of runs.
#[derive(Debug)]
pub struct Indirect {
    layout: wgpu::BindGroupLayout,
    kernel: Kernel,
}

impl Indirect {
    /// Bytes of the arguments of one dispatch.
    pub const STRIDE: u64 = 12;

    /// Links the kernel.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .storage()
            .storage()
            .storage_mut()
            .storage()
            .build(device, "gpu::indirect");
        let kernel = Kernel::new(device, shaders, "gpu::indirect", "main", &[&layout])?;
        Ok(Self { layout, kernel })
    }

    /// Binds arguments for one dispatch per run, with a thread per item; those of the `i`-th run
    /// start at `i * STRIDE`. Each [`Self::run`] writes them.
    ///
    /// `item_starts` is the exclusive prefix sum of the items. If the first word of `overflow` is
    /// nonzero when the kernel runs, nothing is dispatched.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        item_starts: &Buffer,
        runs: &[Run],
        overflow: &Buffer,
    ) -> BoundIndirect {
        let bytes = runs.len() as u64 * Self::STRIDE;
        let arguments = storage_buffer(device, "indirect arguments", bytes);
        let runs_buffer = upload(device, "runs of items", runs);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(item_starts)
            .buffer(&runs_buffer)
            .buffer(&arguments)
            .buffer(overflow)
            .build(device, "gpu::indirect");
        BoundIndirect { group, runs: runs.len() as u64, arguments }
    }

    /// Computes the arguments.
    pub fn run(&self, recorder: &mut Recorder<'_>, bound: &BoundIndirect) {
        self.kernel.run_linear(recorder, &[&bound.group], bound.runs);
    }
}

/// Runs of items, and the arguments of their dispatches.
#[derive(Debug)]
pub struct BoundIndirect {
    group: BindGroup,
    runs: u64,
    /// [`Indirect::STRIDE`] bytes per run.
    pub arguments: Buffer,
}
