//! Builds an octree's nodes by concurrent descent, in passes until no thread is deferred
//! (`descend.wgsl`).
//!
//! The first octree builders on GPUs worked like this (Crassin and Green 2012, "Octree-based sparse
//! voxelization using the GPU hardware rasterizer", OpenGL Insights chapter 22). It is here for
//! comparison with the numbering by ranks. Both make the same nodes; only here their order depends
//! on the threads. The nodes are built in separate buffers and copied at the end (`adopt.wgsl`),
//! since the octree does not store locks.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};

use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Recorder, ShaderLibrary,
    storage_buffer, uniform_buffer,
};
use lumivox::hooks::{OctreeBuilder, OctreeBuilding, OctreeParts, TreeToBuild};
use lumivox::internal::{BoundIndirect, Indirect, Memory, Remedy, Run};
use lumivox::{GiError, Grid};

use crate::with_modules;

/// Builds nodes with threads that descend together and split nodes under locks, as
/// [`lumivox::GiConfig::octree_builder`]. A thread that fails to take a lock tries again in the
/// next pass. The order of nodes differs in every run, that of bricks does not.
///
/// [`lumivox::OctreeStats::counts`] has `lock_passes`, the number of passes including the last,
/// which deferred nothing, and `deferred`, the number of retries in all passes.
pub fn locks() -> Arc<dyn OctreeBuilding> {
    Arc::new(Locks)
}

/// The name of the builder.
pub const NAME: &str = "locks";

#[derive(Debug)]
struct Locks;

impl OctreeBuilding for Locks {
    fn name(&self) -> &'static str {
        NAME
    }

    fn make(&self, parts: &OctreeParts<'_>) -> Result<Box<dyn OctreeBuilder>, GiError> {
        Ok(Box::new(LockBuilder::new(parts)?))
    }
}

/// The shader modules of this folder.
const MODULES: &[(&str, &str)] = &[
    ("classics::locks::adopt", include_str!("adopt.wgsl")),
    ("classics::locks::descend", include_str!("descend.wgsl")),
];

/// The index of the first pass's counter of deferred threads; the counter before it is zero.
const LOCKS_DEFERRED: u32 = 2;

/// The library with the modules of this folder.
fn link_into(shaders: &ShaderLibrary) -> ShaderLibrary {
    let mut library = with_modules(shaders, MODULES);
    library.constant_u32("LOCKS_DEFERRED", LOCKS_DEFERRED);
    library
}

/// `LockPass` of `descend.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct LockPass {
    pass_number: u32,
    padding: [u32; 3],
}

/// Builds an octree's nodes.
#[derive(Debug)]
struct LockBuilder {
    grid: Grid,
    pass_layout: wgpu::BindGroupLayout,
    adopt_layout: wgpu::BindGroupLayout,
    pass: Kernel,
    adopt: Kernel,
    indirect: Indirect,
    /// The number of recorded passes: a thread is deferred at most once per level, and the last
    /// pass shows that no thread is left.
    passes: u32,
    /// The counters of `descend.wgsl`: allocated groups, zero, and the deferred threads of each
    /// pass.
    counters: Buffer,
    bound: Option<BoundLocks>,
}

/// The buffers and bind groups for one list of voxels and one octree.
#[derive(Debug)]
struct BoundLocks {
    children: Buffer,
    locks: Buffer,
    sites: Buffer,
    deferred: [Buffer; 2],
    places: u64,
    items: u64,
    passes: Vec<BindGroup>,
    /// The arguments of all passes but the first.
    arguments: Vec<BoundIndirect>,
    adopt: BindGroup,
}

impl LockBuilder {
    fn new(parts: &OctreeParts<'_>) -> Result<Self, GiError> {
        let OctreeParts { device, grid, globals, .. } = *parts;
        let shaders = &link_into(parts.shaders);
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
            .build(device, "classics::locks::descend");
        let adopt_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "classics::locks::adopt");
        let kernel =
            |module, layout| Kernel::new(device, shaders, module, "main", &[globals, layout]);
        let passes = grid.morton_edge(0).ilog2() + 2;
        Ok(Self {
            grid: *grid,
            pass: kernel("classics::locks::descend", &pass_layout)?,
            adopt: kernel("classics::locks::adopt", &adopt_layout)?,
            indirect: Indirect::new(device, shaders)?,
            passes,
            counters: storage_buffer(
                device,
                "octree: counters",
                u64::from(LOCKS_DEFERRED + passes) * 4,
            ),
            bound: None,
            pass_layout,
            adopt_layout,
        })
    }
}

impl OctreeBuilder for LockBuilder {
    fn bind(&mut self, device: &wgpu::Device, tree: &TreeToBuild<'_>) -> Result<(), GiError> {
        let TreeToBuild { voxels, places, needs, octree, sites: sites_out } = *tree;
        let remedy = Remedy::Surface(self.grid.dimensions.max_element());
        let memory = Memory::new(device);
        let items = voxels.node_capacity() * 8;
        let children = memory.buffer("octree: children", places, 4, remedy)?;
        let locks = memory.buffer("octree: locks", places, 4, remedy)?;
        let sites = memory.buffer("octree: locked sites", places, 8, remedy)?;
        let deferred = [
            memory.buffer("octree: deferred threads", items, 4, remedy)?,
            memory.buffer("octree: deferred threads", items, 4, remedy)?,
        ];
        let no_overflow = storage_buffer(device, "no overflow", 4);
        let passes = (0..self.passes)
            .map(|pass_number| {
                let params = LockPass { pass_number, padding: [0; 3] };
                let uniform = uniform_buffer(device, "lock pass", &params);
                BindGroupBuilder::new(&self.pass_layout)
                    .buffer(&uniform)
                    .buffer(&voxels.nodes)
                    .buffer(&children)
                    .buffer(&locks)
                    .buffer(&sites)
                    .buffer(&self.counters)
                    .buffer(&deferred[(pass_number % 2) as usize])
                    .buffer(&deferred[((pass_number + 1) % 2) as usize])
                    .buffer(&voxels.counts)
                    .build(device, "classics::locks::descend")
            })
            .collect();
        let arguments = (1..self.passes)
            .map(|pass_number| {
                let run = Run { first: LOCKS_DEFERRED - 1, end: LOCKS_DEFERRED + pass_number - 1 };
                self.indirect.bind(device, &self.counters, &[run], &no_overflow)
            })
            .collect();
        let adopt = BindGroupBuilder::new(&self.adopt_layout)
            .buffer(needs)
            .buffer(&children)
            .buffer(&locks)
            .buffer(&sites)
            .buffer(octree)
            .buffer(sites_out)
            .build(device, "classics::locks::adopt");
        self.bound = Some(BoundLocks {
            children,
            locks,
            sites,
            deferred,
            places,
            items,
            passes,
            arguments,
            adopt,
        });
        Ok(())
    }

    fn release(&mut self) {
        self.bound = None;
    }

    fn build(&self, recorder: &mut Recorder<'_>, globals: &BindGroup) {
        let Some(bound) = &self.bound else {
            return;
        };
        for buffer in [&bound.children, &bound.locks, &bound.sites, &self.counters] {
            recorder.clear(buffer);
        }
        for (pass_number, group) in bound.passes.iter().enumerate() {
            let Some(arguments) = pass_number.checked_sub(1).map(|i| &bound.arguments[i]) else {
                self.pass.run_linear(recorder, &[globals, group], bound.items);
                continue;
            };
            self.indirect.run(recorder, arguments);
            recorder.compute("classics::locks::descend::main", |pass| {
                self.pass.dispatch_indirect(pass, &[globals, group], &arguments.arguments, 0);
            });
        }
        self.adopt.run_linear(recorder, &[globals, &bound.adopt], bound.places);
    }

    fn counters(&self) -> Option<&Buffer> {
        Some(&self.counters)
    }

    fn check(&self, counters: &[u32], groups: u32) -> Result<Vec<(&'static str, u64)>, GiError> {
        let (passes, deferred) = count_passes(counters, groups)?;
        Ok(vec![("lock_passes", passes), ("deferred", deferred)])
    }

    fn memory(&self) -> Vec<(&'static str, u64)> {
        let bound = self.bound.as_ref().map_or(0, BoundLocks::bytes);
        vec![("volume: locks of nodes", self.counters.size() + bound)]
    }
}

impl BoundLocks {
    /// Bytes on the GPU.
    fn bytes(&self) -> u64 {
        let own = [&self.children, &self.locks, &self.sites];
        own.into_iter().chain(&self.deferred).map(|buffer| buffer.size()).sum()
    }
}

/// From the counters: the number of passes until nothing was deferred, and of deferred threads.
///
/// # Errors
/// [`GiError::Device`] if nodes are missing or threads are left over, which would be a bug.
fn count_passes(counters: &[u32], groups: u32) -> Result<(u64, u64), GiError> {
    let deferred = &counters[LOCKS_DEFERRED as usize..];
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
    let passes = deferred.iter().take_while(|count| **count > 0).count() as u64 + 1;
    Ok((passes, deferred.iter().map(|count| u64::from(*count)).sum()))
}

#[cfg(test)]
mod tests {
    use lumivox::{GiError, shaders};
    use lumivox_reflect::{check_modules, check_struct};

    use super::{LockPass, count_passes, link_into};

    #[test]
    fn shaders_are_valid_and_struct_layouts_match() {
        let library = link_into(&shaders::library());
        assert!(check_modules(&library, "classics::locks") > 0);
        check_struct::<LockPass>(&library, "classics::locks::descend", "LockPass");
    }

    #[test]
    fn passes_are_counted_until_no_thread_is_deferred() {
        assert_eq!(count_passes(&[4, 0, 0, 0, 0], 5).expect("all is there"), (1, 0));
        assert_eq!(count_passes(&[4, 0, 70, 9, 0], 5).expect("all is there"), (3, 79));
    }

    /// Otherwise the tree would have holes.
    #[test]
    fn leftover_threads_and_missing_groups_are_errors() {
        for (counters, groups, says) in [
            ([4, 0, 70, 9, 2], 5, "2 threads were left over"),
            ([3, 0, 70, 9, 0], 5, "4 groups of nodes of 5"),
            ([5, 0, 70, 9, 0], 5, "6 groups of nodes of 5"),
        ] {
            let error = count_passes(&counters, groups).expect_err("it cannot be right");
            assert!(matches!(error, GiError::Device { .. }), "{error}");
            assert!(error.to_string().contains(says), "{error}");
        }
    }
}
