//! Updates the octree to a list: finds the nodes that exist, those that are renewed, and places for
//! their bricks.
//!
//! Everything is recorded without knowing the counts on the CPU: buffers have a capacity, counts
//! stay on the GPU, and one thread compares the two (`needs.wgsl`). Later passes write the octree
//! only if nothing overflows.

use bytemuck::{Pod, Zeroable};

use super::OctreeBuilder;
use super::layout::TreeLayout;
use super::tree::{Scratch, Tree};
use crate::GiError;
use crate::Grid;
use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundIndirect, BoundScan, Buffer, Indirect, Kernel, LayoutBuilder,
    Pipelines, Recorder, Run, Scan, ShaderLibrary, counted_buffer, storage_buffer,
};
use crate::volume::CELL_FORMAT;
use crate::voxels::{BitLevel, BoundPyramid, Pyramid, VoxelList, level_first_word};

/// `Needs` of `needs.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct TreeNeeds {
    pub(crate) overflow: u32,
    pub(crate) groups: u32,
    pub(crate) renewals: u32,
    pub(crate) brick_places: u32,
    pub(crate) bricks: u32,
    pub(crate) first_place: u32,
    padding: [u32; 2],
    pub(crate) node_groups: [u32; 3],
    padding_2: u32,
    pub(crate) renewal_groups: [u32; 3],
    padding_3: u32,
    pub(crate) cell_groups: [u32; 3],
    padding_4: u32,
    pub(crate) texel_groups: [u32; 3],
    padding_5: u32,
    pub(crate) free: [[u32; 4]; 3],
    pub(crate) needed: [[u32; 4]; 3],
}

/// Bits of [`TreeNeeds::overflow`]: too many nodes.
pub(crate) const OVERFLOW_PLACES: u32 = 1;
/// Too many renewed nodes.
pub(crate) const OVERFLOW_RENEWALS: u32 = 2;
/// The atlas is full.
pub(crate) const OVERFLOW_BRICKS: u32 = 4;

/// Bytes of `Places` of `needs.wgsl`.
const PLACES_BYTES: u64 = 44;

/// State that persists from list to list and does not depend on capacities.
#[derive(Debug)]
pub(super) struct State {
    /// [`TreeNeeds`].
    pub needs: Buffer,
    /// `Places` of `needs.wgsl`.
    places: Buffer,
    /// A bit per voxel, set if its change was missed.
    missed: Buffer,
}

impl State {
    pub fn new(device: &wgpu::Device, grid: &Grid) -> Self {
        Self {
            needs: counted_buffer(device, "needs", size_of::<TreeNeeds>() as u64),
            places: storage_buffer(device, "octree: places of bricks", PLACES_BYTES),
            missed: storage_buffer(device, "octree: missed", level_first_word(grid, 1) * 4),
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.missed.size()
    }
}

/// Kernels that update the octree to a list.
#[derive(Debug)]
pub(super) struct FollowKernels {
    scan: Scan,
    pyramid: Pyramid,
    indirect: Indirect,
    layouts: Layouts,
    mark: Kernel,
    count_groups: Kernel,
    count_renewals: Kernel,
    list_renewals: Kernel,
    masks: Kernel,
    needs: Kernel,
    take_places: Kernel,
    give_places_back: Kernel,
    build: Kernel,
    inherit: Kernel,
    carry: Kernel,
    refill: Kernel,
    join_missed: Kernel,
    note_missed: Kernel,
}

#[derive(Debug)]
struct Layouts {
    /// Group 0: the grid and the tree.
    tree: wgpu::BindGroupLayout,
    /// As `tree`, plus the tree's nodes.
    search: wgpu::BindGroupLayout,
    mark: wgpu::BindGroupLayout,
    groups: wgpu::BindGroupLayout,
    renewals: wgpu::BindGroupLayout,
    masks: wgpu::BindGroupLayout,
    needs: wgpu::BindGroupLayout,
    places: wgpu::BindGroupLayout,
    build: wgpu::BindGroupLayout,
    inherit: wgpu::BindGroupLayout,
    carry: wgpu::BindGroupLayout,
    refill: wgpu::BindGroupLayout,
    missed: wgpu::BindGroupLayout,
}

/// A list, an octree, and the bits of changed cells, bound together.
#[derive(Debug)]
pub(super) struct BoundFollow {
    /// A bit for each node below the root, level 1 first, and one for the root.
    node_bits: Buffer,
    /// Number of groups before each word of `node_bits`.
    group_ranks: Buffer,
    /// A bit per node, set if it is renewed or removed.
    renewed: Buffer,
    renewed_ranks: Buffer,
    words: u64,
    old: [Buffer; 2],
    run_starts: Buffer,
    /// Group 0 three times: without nodes, with the previous nodes, and with the shown nodes.
    tree: BindGroup,
    so_far: BindGroup,
    shown: BindGroup,
    mark: [BindGroup; 2],
    mark_words: u64,
    pyramid: BoundPyramid,
    groups: BindGroup,
    group_scan: BoundScan,
    renewals: BindGroup,
    renewed_scan: BoundScan,
    /// Arguments of a dispatch over renewals before the needs are known.
    all_renewals: BoundIndirect,
    masks: BindGroup,
    run_scan: BoundScan,
    needs: BindGroup,
    places: BindGroup,
    build: BindGroup,
    inherit: BindGroup,
    carry: BindGroup,
    refill: BindGroup,
}

impl BoundFollow {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let bits = [&self.node_bits, &self.group_ranks, &self.renewed, &self.renewed_ranks];
        bits.into_iter().map(|buffer| buffer.size()).sum()
    }
}

/// The bits of missed voxels, bound to the bits of changed cells.
#[derive(Debug)]
pub(super) struct BoundMissed {
    group: BindGroup,
    words: u64,
}

impl FollowKernels {
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary) -> Result<Self, GiError> {
        let layout = |uniforms: u32, read: u32, written: u32, label: &str| {
            let layout = (0..uniforms).fold(LayoutBuilder::compute(), |layout, _| layout.uniform());
            let layout = (0..read).fold(layout, |layout, _| layout.storage());
            (0..written).fold(layout, |layout, _| layout.storage_mut()).build(device, label)
        };
        let layouts = Layouts {
            tree: layout(2, 0, 0, "volume::octree::tree"),
            search: layout(2, 1, 0, "volume::octree::search"),
            mark: layout(0, 1, 1, "volume::octree::mark"),
            groups: layout(0, 1, 1, "volume::octree::groups"),
            renewals: layout(0, 1, 2, "volume::octree::renewals"),
            masks: layout(0, 5, 2, "volume::octree::masks"),
            needs: layout(0, 4, 2, "volume::octree::needs"),
            places: layout(1, 1, 3, "volume::octree::places"),
            build: layout(1, 2, 2, "volume::octree::build_ranked"),
            inherit: layout(1, 4, 1, "volume::octree::inherit"),
            carry: layout(1, 2, 1, "volume::octree::carry"),
            refill: LayoutBuilder::compute()
                .uniform()
                .storage()
                .storage()
                .storage()
                .storage_texture(wgpu::TextureViewDimension::D3, CELL_FORMAT)
                .build(device, "volume::octree::refill"),
            missed: layout(1, 0, 2, "volume::octree::missed"),
        };
        let kernel = |module: &str, entry: &str, globals, layout| {
            let module = format!("volume::octree::{module}");
            Kernel::new(device, shaders, &module, entry, &[globals, layout])
        };
        let Layouts { tree, search, .. } = &layouts;
        Ok(Self {
            scan: Scan::new(device, shaders)?,
            pyramid: Pyramid::new(device, shaders, tree)?,
            indirect: Indirect::new(device, shaders)?,
            mark: kernel("mark", "main", tree, &layouts.mark)?,
            count_groups: kernel("groups", "count", tree, &layouts.groups)?,
            count_renewals: kernel("renewals", "count", tree, &layouts.renewals)?,
            list_renewals: kernel("renewals", "list", tree, &layouts.renewals)?,
            masks: kernel("masks", "main", search, &layouts.masks)?,
            needs: kernel("needs", "main", tree, &layouts.needs)?,
            take_places: kernel("places", "take", tree, &layouts.places)?,
            give_places_back: kernel("places", "give_back", tree, &layouts.places)?,
            build: kernel("build_ranked", "main", tree, &layouts.build)?,
            inherit: kernel("inherit", "main", search, &layouts.inherit)?,
            carry: kernel("carry", "main", search, &layouts.carry)?,
            refill: kernel("refill", "main", search, &layouts.refill)?,
            join_missed: kernel("missed", "join", tree, &layouts.missed)?,
            note_missed: kernel("missed", "note", tree, &layouts.missed)?,
            layouts,
        })
    }

    /// The layout of group 0 of kernels that do not search for nodes.
    pub fn tree_layout(&self) -> &wgpu::BindGroupLayout {
        &self.layouts.tree
    }

    /// Binds the bits of changed cells to those of missed ones.
    pub fn bind_missed(
        &self,
        device: &wgpu::Device,
        grid: &Grid,
        state: &State,
        changed: &Buffer,
    ) -> BoundMissed {
        let group = BindGroupBuilder::new(&self.layouts.missed)
            .buffer(&state.needs)
            .buffer(&state.missed)
            .buffer(changed)
            .build(device, "volume::octree::missed");
        BoundMissed { group, words: level_first_word(grid, 1) }
    }

    /// Call before an update to a list: marks missed changes as changed.
    pub fn join_missed(
        &self,
        recorder: &mut Recorder<'_>,
        globals: &BindGroup,
        bound: &BoundMissed,
    ) {
        self.join_missed.run_linear(recorder, &[globals, &bound.group], bound.words);
    }

    /// Call after an update to a list, and after one of its light: marks changes as missed on
    /// overflow.
    pub fn note_missed(
        &self,
        recorder: &mut Recorder<'_>,
        globals: &BindGroup,
        bound: &BoundMissed,
    ) {
        self.note_missed.run_linear(recorder, &[globals, &bound.group], bound.words);
    }

    /// Group 0 of kernels that search a tree's nodes.
    pub fn bind_search(
        &self,
        device: &wgpu::Device,
        grid_uniform: &Buffer,
        (uniform, octree): (&Buffer, &Buffer),
    ) -> BindGroup {
        BindGroupBuilder::new(&self.layouts.search)
            .buffer(grid_uniform)
            .buffer(uniform)
            .buffer(octree)
            .build(device, "volume::octree::search")
    }

    /// Binds a list, an octree and the bits of changed cells.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        (grid, grid_uniform, layout): (&Grid, &Buffer, &TreeLayout),
        (voxels, changed): (&VoxelList, &Buffer),
        (tree, scratch, state): (&Tree, &Scratch, &State),
    ) -> BoundFollow {
        let words = u64::from(layout.bit_words());
        // The root has its own word, in which the pyramid may end.
        let bits = |label| storage_buffer(device, label, (words + 1) * 4);
        let [node_bits, group_ranks] = ["octree: node bits", "octree: group ranks"].map(bits);
        let [renewed, renewed_ranks] = ["octree: renewed", "octree: renewed ranks"].map(bits);
        let levels: Vec<BitLevel> =
            (grid.levels..=layout.root_level).map(|level| layout.bits(level)).collect();
        let Layouts { tree: tree_layout, mark, groups, renewals, masks, .. } = &self.layouts;
        let group = |layout: &wgpu::BindGroupLayout, buffers: &[&Buffer], label: &str| {
            let group = BindGroupBuilder::new(layout);
            buffers.iter().fold(group, |group, &buffer| group.buffer(buffer)).build(device, label)
        };
        let marks = |cells| group(mark, &[cells, &node_bits], "volume::octree::mark");
        let mark_renewed = group(mark, &[changed, &renewed], "volume::octree::mark");
        let run_words = scratch.run_starts.size() / 4;
        let run = Run { first: 0, end: words as u32 };
        let zero = storage_buffer(device, "no overflow", 4);
        let layouts = &self.layouts;
        let needs = &state.needs;
        let renewals_group = group(
            renewals,
            &[&renewed, &renewed_ranks, &scratch.renewals],
            "volume::octree::renewals",
        );
        let masks = group(
            masks,
            &[
                &voxels.occupancy,
                &voxels.ranks,
                &voxels.nodes,
                &node_bits,
                &renewed_ranks,
                &scratch.renewals,
                &scratch.run_starts,
            ],
            "volume::octree::masks",
        );
        let needs_group = group(
            &layouts.needs,
            &[
                &group_ranks,
                &renewed_ranks,
                &scratch.renewals,
                &scratch.run_starts,
                &state.places,
                needs,
            ],
            "volume::octree::needs",
        );
        let places = group(
            &layouts.places,
            &[needs, &scratch.run_starts, &scratch.renewals, &tree.free_runs, &tree.octree],
            "volume::octree::places",
        );
        let build = group(
            &layouts.build,
            &[needs, &node_bits, &group_ranks, &tree.octree, &tree.sites],
            "volume::octree::build_ranked",
        );
        let inherit = group(
            &layouts.inherit,
            &[needs, &tree.sites, &renewed, &renewed_ranks, &scratch.renewals, &tree.octree],
            "volume::octree::inherit",
        );
        let carry = group(
            &layouts.carry,
            &[needs, &scratch.renewals, changed, &tree.values],
            "volume::octree::carry",
        );
        let refill = BindGroupBuilder::new(&layouts.refill)
            .buffer(needs)
            .buffer(&scratch.renewals)
            .buffer(changed)
            .buffer(&tree.values)
            .view(&tree.atlas)
            .build(device, "volume::octree::refill");
        let old = (&tree.uniform, &scratch.old_octree);
        BoundFollow {
            words,
            old: [&tree.octree, &scratch.old_octree].map(Buffer::clone),
            run_starts: scratch.run_starts.clone(),
            tree: group(tree_layout, &[grid_uniform, &tree.uniform], "volume::octree::tree"),
            so_far: self.bind_search(device, grid_uniform, old),
            shown: self.bind_search(device, grid_uniform, (&tree.uniform, &tree.octree)),
            mark: [marks(&voxels.occupancy), mark_renewed],
            mark_words: level_first_word(grid, grid.levels),
            pyramid: self.pyramid.bind_levels(device, &node_bits, &levels),
            groups: group(groups, &[&node_bits, &group_ranks], "volume::octree::groups"),
            group_scan: self.scan.bind(device, &group_ranks, words as u32 + 1),
            renewals: renewals_group,
            renewed_scan: self.scan.bind(device, &renewed_ranks, words as u32 + 1),
            all_renewals: self.indirect.bind(device, &renewed_ranks, &[run], &zero),
            masks,
            run_scan: self.scan.bind(device, &scratch.run_starts, run_words as u32),
            needs: needs_group,
            places,
            build,
            inherit,
            carry,
            refill,
            node_bits,
            group_ranks,
            renewed,
            renewed_ranks,
        }
    }

    /// Updates the octree to the list, unless something overflows. Without a caller's builder,
    /// nodes are built by ranks.
    pub fn run(
        &self,
        recorder: &mut Recorder<'_>,
        bound: &BoundFollow,
        needs: &Buffer,
        builder: Option<&dyn OctreeBuilder>,
    ) {
        let [octree, old_octree] = &bound.old;
        recorder.copy((octree, 0), (old_octree, 0), octree.size());
        for buffer in [&bound.node_bits, &bound.renewed, &bound.run_starts] {
            recorder.clear(buffer);
        }
        // Finds existing and renewed nodes.
        for group in &bound.mark {
            self.mark.run_linear(recorder, &[&bound.tree, group], bound.mark_words);
        }
        self.pyramid.run(recorder, &bound.tree, &bound.pyramid);
        self.count_groups.run_linear(recorder, &[&bound.tree, &bound.groups], bound.words);
        self.scan.run_bound(recorder, &bound.group_scan);
        let renewals = [&bound.tree, &bound.renewals];
        self.count_renewals.run_linear(recorder, &renewals, bound.words);
        self.scan.run_bound(recorder, &bound.renewed_scan);
        self.list_renewals.run_linear(recorder, &renewals, bound.words);

        // Computes the needed memory, and whether it fits.
        self.indirect.run(recorder, &bound.all_renewals);
        recorder.compute("volume::octree::masks", |pass| {
            let arguments = &bound.all_renewals.arguments;
            self.masks.dispatch_indirect(pass, &[&bound.so_far, &bound.masks], arguments, 0);
        });
        self.scan.run_bound(recorder, &bound.run_scan);
        self.needs.run(recorder, &[&bound.tree, &bound.needs], [1; 3]);

        // Writes places of bricks, nodes, and their content.
        let at = |member: usize| member as u64;
        let of_renewals = at(std::mem::offset_of!(TreeNeeds, renewal_groups));
        let of_nodes = at(std::mem::offset_of!(TreeNeeds, node_groups));
        let of_cells = at(std::mem::offset_of!(TreeNeeds, cell_groups));
        let of_texels = at(std::mem::offset_of!(TreeNeeds, texel_groups));
        recorder.compute("volume::octree::places", |pass| {
            for kernel in [&self.take_places, &self.give_places_back] {
                let groups = [&bound.tree, &bound.places];
                kernel.dispatch_indirect(pass, &groups, needs, of_renewals);
            }
        });
        match builder {
            Some(builder) => builder.build(recorder, &bound.tree),
            None => {
                self.build.run_linear(recorder, &[&bound.tree, &bound.build], bound.words.max(1));
            }
        }
        recorder.compute("volume::octree::inherit", |pass| {
            let groups = [&bound.so_far, &bound.inherit];
            self.inherit.dispatch_indirect(pass, &groups, needs, of_nodes);
        });
        recorder.compute("volume::octree::carry", |pass| {
            let groups = [&bound.shown, &bound.carry];
            self.carry.dispatch_indirect(pass, &groups, needs, of_cells);
        });
        recorder.compute("volume::octree::refill", |pass| {
            let groups = [&bound.shown, &bound.refill];
            self.refill.dispatch_indirect(pass, &groups, needs, of_texels);
        });
    }
}
