//! The builder with locks: passes over threads that come again until none is left (`locks.wgsl`).

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Indirect, Kernel, LayoutBuilder, Pipelines, Recorder, Run,
    ShaderLibrary, read_buffer, storage_buffer, uniform_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

/// `MAX_CELL_LEVELS` of `locks.wgsl`.
const MAX_CELL_LEVELS: usize = 12;
/// `DEFERRED` of `locks.wgsl`, and the counter before it, which is zero.
const DEFERRED: u32 = 2;

/// `LockPass` of `locks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LockPass {
    pub(crate) pass_number: u32,
    pub(crate) item_count: u32,
    pub(crate) capacity: u32,
    pub(crate) padding: u32,
    pub(crate) level_starts: [[u32; 4]; MAX_CELL_LEVELS],
}

/// How it went.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocksDone {
    /// Passes until nothing was deferred.
    pub passes: u32,
    /// Threads deferred in all of them.
    pub deferred: u64,
}

#[derive(Debug)]
pub(super) struct LockBuilder {
    pass_layout: wgpu::BindGroupLayout,
    adopt_layout: wgpu::BindGroupLayout,
    pass: Kernel,
    adopt: Kernel,
    indirect: Indirect,
}

impl LockBuilder {
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        tree_layout: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let pass_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage()
            .storage_mut()
            .build(device, "volume::octree::locks");
        let adopt_layout = LayoutBuilder::compute()
            .storage()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "volume::octree::adopt");
        let kernel =
            |module, layout| Kernel::new(device, shaders, module, "main", &[tree_layout, layout]);
        Ok(Self {
            pass: kernel("volume::octree::locks", &pass_layout)?,
            adopt: kernel("volume::octree::adopt", &adopt_layout)?,
            indirect: Indirect::new(device, shaders)?,
            pass_layout,
            adopt_layout,
        })
    }

    /// Builds the nodes into `octree` and `sites`, which have room for `groups` groups.
    ///
    /// # Errors
    /// [`GiError::Limit`] when its lists do not fit; [`GiError::Device`] if it does not end with the nodes that ranks
    /// have counted, which would be a defect.
    pub async fn build(
        &self,
        recorder: &mut Recorder<'_>,
        memory: &mut Memory<'_>,
        globals: &BindGroup,
        grid: &Grid,
        voxels: &VoxelList,
        (groups, octree, sites): (u32, &Buffer, &Buffer),
    ) -> Result<LocksDone, GiError> {
        let device = memory.device().clone();
        let queue = recorder.queue().clone();
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let cells = voxels.level_starts[grid.levels as usize];
        let items = u64::from(cells) * 8;
        let slots = u64::from(groups) * 8;
        let children = memory.buffer("octree: children", slots, 4, remedy)?;
        let locks = memory.buffer("octree: locks", slots, 4, remedy)?;
        let lists = [
            memory.buffer("octree: deferred threads", items, 4, remedy)?,
            memory.buffer("octree: deferred threads", items, 4, remedy)?,
        ];
        // A thread is deferred once a level at most; the last pass shows that none is left.
        let passes = grid.morton_edge(0).ilog2() + 2;
        let counters =
            storage_buffer(&device, "octree: counters", u64::from(DEFERRED + passes) * 4);
        let no_overflow = storage_buffer(&device, "no overflow", 4);
        let mut level_starts = [[u32::MAX; 4]; MAX_CELL_LEVELS];
        for (start, place) in voxels.level_starts.iter().zip(&mut level_starts) {
            place[0] = *start;
        }
        for pass_number in 0..passes {
            let params = LockPass {
                pass_number,
                item_count: items as u32,
                capacity: groups,
                padding: 0,
                level_starts,
            };
            let uniform = uniform_buffer(&device, "lock pass", &params);
            let group = BindGroupBuilder::new(&self.pass_layout)
                .buffer(&uniform)
                .buffer(&voxels.nodes)
                .buffer(&children)
                .buffer(&locks)
                .buffer(sites)
                .buffer(&counters)
                .buffer(&lists[(pass_number % 2) as usize])
                .buffer(&lists[((pass_number + 1) % 2) as usize])
                .build(&device, "volume::octree::locks");
            if pass_number == 0 {
                self.pass.run_linear(recorder, &[globals, &group], items);
                continue;
            }
            let run = Run { first: DEFERRED - 1, end: DEFERRED + pass_number - 1 };
            let bound = self.indirect.bind(&device, &counters, &[run], &no_overflow);
            self.indirect.run(recorder, &bound);
            recorder.compute("volume::octree::locks::main", |pass| {
                self.pass.dispatch_indirect(pass, &[globals, &group], &bound.arguments, 0);
            });
        }
        let group = BindGroupBuilder::new(&self.adopt_layout)
            .buffer(&children)
            .buffer(&locks)
            .buffer(sites)
            .buffer(octree)
            .build(&device, "volume::octree::adopt");
        self.adopt.run_linear(recorder, &[globals, &group], slots);
        recorder.flush();
        let bytes = u64::from(DEFERRED + passes) * 4;
        let counted: Vec<u32> = read_buffer(&device, &queue, &counters, 0..bytes).await?;
        let deferred = &counted[DEFERRED as usize..];
        let left = deferred.last().copied().unwrap_or(0);
        if counted[0] + 1 != groups || left > 0 {
            return Err(GiError::Device {
                doing: "building the octree with locks",
                reason: format!(
                    "it made {} groups of nodes of {groups}, and {left} threads were left over",
                    counted[0] + 1
                ),
            });
        }
        let passes = deferred.iter().take_while(|count| **count > 0).count() as u32 + 1;
        Ok(LocksDone { passes, deferred: deferred.iter().map(|count| u64::from(*count)).sum() })
    }
}
