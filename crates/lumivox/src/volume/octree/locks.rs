//! The builder with locks: passes over threads that come again until none is left (`locks.wgsl`).

use bytemuck::{Pod, Zeroable};

use super::tree::Tree;
use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundIndirect, Buffer, Indirect, Kernel, LayoutBuilder, Pipelines,
    Recorder, Run, ShaderLibrary, storage_buffer, uniform_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

/// `DEFERRED` of `locks.wgsl`, and the counter before it, which is zero.
const DEFERRED: u32 = 2;

/// `LockPass` of `locks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LockPass {
    pub(crate) pass_number: u32,
    pub(crate) padding: [u32; 3],
}

#[derive(Debug)]
pub(super) struct LockBuilder {
    pass_layout: wgpu::BindGroupLayout,
    adopt_layout: wgpu::BindGroupLayout,
    pass: Kernel,
    adopt: Kernel,
    indirect: Indirect,
}

/// What it needs for a list.
#[derive(Debug)]
pub(super) struct BoundLocks {
    children: Buffer,
    locks: Buffer,
    sites: Buffer,
    /// The groups made, zero, and the threads that each pass has deferred.
    pub counters: Buffer,
    deferred: [Buffer; 2],
    items: u64,
    passes: Vec<BindGroup>,
    /// The arguments of all passes but the first.
    arguments: Vec<BoundIndirect>,
    adopt: BindGroup,
}

impl BoundLocks {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let own = [&self.children, &self.locks, &self.sites, &self.counters];
        own.into_iter().chain(&self.deferred).map(|buffer| buffer.size()).sum()
    }
}

/// How it went, from the words of [`BoundLocks::counters`]: the passes until nothing was deferred, and the threads that were.
///
/// # Errors
/// [`GiError::Device`] if it did not end with the nodes that ranks have counted, which would be a defect.
pub(super) fn count_passes(counters: &[u32], groups: u32) -> Result<(u32, u64), GiError> {
    let deferred = &counters[DEFERRED as usize..];
    let left = deferred.last().copied().unwrap_or(0);
    if counters[0] + 1 != groups || left > 0 {
        return Err(GiError::Device {
            doing: "building the octree with locks",
            reason: format!(
                "it made {} groups of nodes of {groups}, and {left} threads were left over",
                counters[0] + 1
            ),
        });
    }
    let passes = deferred.iter().take_while(|count| **count > 0).count() as u32 + 1;
    Ok((passes, deferred.iter().map(|count| u64::from(*count)).sum()))
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
            .storage()
            .build(device, "volume::octree::locks");
        let adopt_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
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

    /// Binds a list and an octree.
    ///
    /// # Errors
    /// [`GiError::Limit`] when its lists do not fit.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        grid: &Grid,
        voxels: &VoxelList,
        (tree, verdict): (&Tree, &Buffer),
    ) -> Result<BoundLocks, GiError> {
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let mut memory = Memory::new(device);
        let slots = tree.room.slots;
        let items = voxels.node_capacity() * 8;
        let children = memory.buffer("octree: children", slots, 4, remedy)?;
        let locks = memory.buffer("octree: locks", slots, 4, remedy)?;
        let sites = memory.buffer("octree: locked sites", slots, 8, remedy)?;
        let deferred = [
            memory.buffer("octree: deferred threads", items, 4, remedy)?,
            memory.buffer("octree: deferred threads", items, 4, remedy)?,
        ];
        // A thread is deferred once a level at most; the last pass shows that none is left.
        let passes = grid.morton_edge(0).ilog2() + 2;
        let counters = storage_buffer(device, "octree: counters", u64::from(DEFERRED + passes) * 4);
        let no_overflow = storage_buffer(device, "no overflow", 4);
        let groups = (0..passes)
            .map(|pass_number| {
                let params = LockPass { pass_number, padding: [0; 3] };
                let uniform = uniform_buffer(device, "lock pass", &params);
                BindGroupBuilder::new(&self.pass_layout)
                    .buffer(&uniform)
                    .buffer(&voxels.nodes)
                    .buffer(&children)
                    .buffer(&locks)
                    .buffer(&sites)
                    .buffer(&counters)
                    .buffer(&deferred[(pass_number % 2) as usize])
                    .buffer(&deferred[((pass_number + 1) % 2) as usize])
                    .buffer(&voxels.counts)
                    .build(device, "volume::octree::locks")
            })
            .collect();
        let arguments = (1..passes)
            .map(|pass_number| {
                let run = Run { first: DEFERRED - 1, end: DEFERRED + pass_number - 1 };
                self.indirect.bind(device, &counters, &[run], &no_overflow)
            })
            .collect();
        let adopt = BindGroupBuilder::new(&self.adopt_layout)
            .buffer(verdict)
            .buffer(&children)
            .buffer(&locks)
            .buffer(&sites)
            .buffer(&tree.octree)
            .buffer(&tree.sites)
            .build(device, "volume::octree::adopt");
        Ok(BoundLocks {
            children,
            locks,
            sites,
            counters,
            deferred,
            items,
            passes: groups,
            arguments,
            adopt,
        })
    }

    /// Builds the nodes, if there is room for them.
    pub fn build(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, bound: &BoundLocks) {
        for buffer in [&bound.children, &bound.locks, &bound.sites, &bound.counters] {
            recorder.clear(buffer);
        }
        for (pass_number, group) in bound.passes.iter().enumerate() {
            let Some(arguments) = pass_number.checked_sub(1).map(|i| &bound.arguments[i]) else {
                self.pass.run_linear(recorder, &[globals, group], bound.items);
                continue;
            };
            self.indirect.run(recorder, arguments);
            recorder.compute("volume::octree::locks::main", |pass| {
                self.pass.dispatch_indirect(pass, &[globals, group], &arguments.arguments, 0);
            });
        }
        let slots = bound.children.size() / 4;
        self.adopt.run_linear(recorder, &[globals, &bound.adopt], slots);
    }
}
