//! A compute kernel: an entry point with its pipeline and its workgroup size.

use crate::gpu::pipelines::{ComputePlan, LazyCompute};
use crate::gpu::{
    BindGroup, Buffer, BufferHandle as _, ComputePass, Pipelines, Recorder, ShaderError,
    ShaderLibrary,
};

/// Workgroup size of kernels that run over a list (`@workgroup_size(LINEAR_WORKGROUP_SIZE)`).
pub const LINEAR_WORKGROUP_SIZE: u32 = 64;

/// WebGPU's default limit of workgroups per dimension.
pub(super) const MAX_WORKGROUPS: u32 = 65_535;

/// A compute pipeline with its workgroup size.
#[derive(Clone, Debug)]
pub struct Kernel {
    pipeline: LazyCompute,
    workgroup_size: [u32; 3],
    label: String,
}

impl Kernel {
    /// The entry point `entry` of the shader module `module`; bind group `i` has the layout
    /// `layouts[i]`. The pipeline is created by [`Pipelines::compile`] or at its first use.
    ///
    /// # Errors
    /// If the module does not link or validate, or has no such entry point.
    pub fn new(
        pipelines: &Pipelines,
        shaders: &ShaderLibrary,
        module: &str,
        entry: &str,
        layouts: &[&wgpu::BindGroupLayout],
    ) -> Result<Self, ShaderError> {
        let kernel = Self::deferred(pipelines, shaders, module, entry, layouts)?;
        pipelines.expect(&kernel.pipeline);
        Ok(kernel)
    }

    /// [`Self::new`] for kernels that most scenes do not run: [`Pipelines::compile`] skips their
    /// pipelines.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn deferred(
        pipelines: &Pipelines,
        shaders: &ShaderLibrary,
        module: &str,
        entry: &str,
        layouts: &[&wgpu::BindGroupLayout],
    ) -> Result<Self, ShaderError> {
        let entry = pipelines.shader(shaders, module)?.entry(entry)?;
        let (workgroup_size, label) = (entry.workgroup_size(), entry.label());
        let groups = layouts.iter().map(|layout| (*layout).clone()).collect();
        let pipeline = pipelines.compute(ComputePlan { entry, groups });
        Ok(Self { pipeline, workgroup_size, label })
    }

    /// Makes [`Pipelines::compile`] create the pipeline of a deferred kernel.
    pub(crate) fn expect(&self, pipelines: &Pipelines) {
        pipelines.expect(&self.pipeline);
    }

    /// Creates the pipelines of kernels that are about to run, in parallel.
    pub(crate) async fn make_all(kernels: impl IntoIterator<Item = &Self>) {
        let pipelines: Vec<_> = kernels.into_iter().map(|kernel| kernel.pipeline.clone()).collect();
        super::pipelines::make_all(&pipelines).await;
    }

    /// Invocations along x, y and z of one workgroup.
    pub fn workgroup_size(&self) -> [u32; 3] {
        self.workgroup_size
    }

    fn set(&self, pass: &mut ComputePass<'_>, groups: &[&BindGroup]) {
        pass.set_pipeline(self.pipeline.get());
        for (index, group) in groups.iter().enumerate() {
            pass.bind(index as u32, group);
        }
    }

    /// Runs over a grid of threads, within a pass.
    pub fn dispatch(&self, pass: &mut ComputePass<'_>, groups: &[&BindGroup], threads: [u32; 3]) {
        let [x, y, z] = std::array::from_fn(|i| threads[i].div_ceil(self.workgroup_size[i]));
        if x == 0 || y == 0 || z == 0 {
            return;
        }
        self.set(pass, groups);
        pass.dispatch_workgroups(x, y, z);
    }

    /// Runs over a list of `count` elements, within a pass. The workgroups are distributed over x
    /// and y, since one dimension only reaches 4 million threads. The shader finds its element with
    /// `package::gpu::dispatch::linear_index` and must check it against the count.
    pub fn dispatch_linear(&self, pass: &mut ComputePass<'_>, groups: &[&BindGroup], count: u64) {
        if count == 0 {
            return;
        }
        let workgroups = count.div_ceil(u64::from(self.workgroup_size[0]));
        let rows = workgroups.div_ceil(u64::from(MAX_WORKGROUPS));
        let columns = workgroups.div_ceil(rows);
        self.set(pass, groups);
        pass.dispatch_workgroups(columns as u32, rows as u32, 1);
    }

    /// Runs within a pass, with the workgroup counts stored in `arguments` at the byte `offset`.
    pub fn dispatch_indirect(
        &self,
        pass: &mut ComputePass<'_>,
        groups: &[&BindGroup],
        arguments: &Buffer,
        offset: u64,
    ) {
        self.set(pass, groups);
        pass.keep(arguments.kept());
        pass.dispatch_workgroups_indirect(arguments, offset);
    }

    /// Runs [`Self::dispatch_indirect`] in its own pass.
    pub fn run_indirect(
        &self,
        recorder: &mut Recorder<'_>,
        groups: &[&BindGroup],
        arguments: &Buffer,
        offset: u64,
    ) {
        recorder.compute(&self.label, |pass| {
            self.dispatch_indirect(pass, groups, arguments, offset);
        });
    }

    /// Runs [`Self::dispatch`] in its own pass.
    pub fn run(&self, recorder: &mut Recorder, groups: &[&BindGroup], threads: [u32; 3]) {
        recorder.compute(&self.label, |pass| self.dispatch(pass, groups, threads));
    }

    /// Runs [`Self::dispatch_linear`] in its own pass.
    pub fn run_linear(&self, recorder: &mut Recorder, groups: &[&BindGroup], count: u64) {
        recorder.compute(&self.label, |pass| self.dispatch_linear(pass, groups, count));
    }
}
