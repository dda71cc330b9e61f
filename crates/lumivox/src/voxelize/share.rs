//! A share of the surface, static or dynamic, during the walks.
//!
//! Buffers may be larger than needed. If one is too small, everything is still counted, and the
//! share is collected again in larger buffers ([`Share::reserve`]).

use super::batch::{Fallbacks, SplitBatch, SplitCounts};
use super::hook::{Walk, WalkStep};
use super::input::{DrawRecord, ShareInput};
use super::kernels::Kernels;
use super::{VoxelFaces, Voxelizer};
use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundScan, Buffer, Kernel, Recorder, storage_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::voxels::{BoundNodes, Cells, FaceRecord, NodeRecord, RankedBits};
use crate::{Geometry, GiError, Grid};

/// Common arguments of all passes of a voxelization.
pub(super) struct Work<'a, 'r> {
    /// The voxelizer, which may have its own walker.
    pub voxelizer: &'a Voxelizer,
    pub kernels: &'a Kernels,
    pub grid: &'a Grid,
    /// Group 0.
    pub globals: &'a BindGroup,
    pub recorder: &'a mut Recorder<'r>,
    pub memory: Memory<'a>,
}

impl Work<'_, '_> {
    /// The error's remedy if a buffer of the surface does not fit.
    pub fn remedy(&self) -> Remedy {
        Remedy::Surface(self.grid.dimensions.max_element())
    }
}

/// Numbers of triangles, items and pieces of a share.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShareCounts {
    pub triangles: u64,
    pub degenerate: u64,
    pub outside: u64,
    /// Triangles of draws outside of the walked boxes.
    pub left_out: u64,
    pub items: u64,
    pub pieces: u64,
}

/// The collected data of a share; it does not depend on the other share.
#[derive(Debug)]
pub(super) struct Share {
    /// Occupancy bits of the finest level.
    bits: RankedBits,
    cells: Cells,
    batches: Vec<SplitBatch>,
    mark_groups: Vec<BindGroup>,
    voxels: Option<Voxels>,
    sums: Option<Sums>,
    /// Counts that have been read back.
    pub counts: ShareCounts,
}

/// Per-voxel data.
#[derive(Debug)]
struct Voxels {
    capacity: u64,
    /// `VoxelFaces`.
    faces: Buffer,
    nodes: Buffer,
    /// The index of each voxel's first face, with the total at the end.
    first_faces: Buffer,
    pieces: Buffer,
    scan: BoundScan,
    bound_nodes: BoundNodes,
    faces_group: BindGroup,
    walk_groups: Vec<BindGroup>,
}

/// Sums of the faces, laid out as `FaceSlot` of `face_sums.wgsl`.
#[derive(Debug)]
struct Sums {
    capacity: u64,
    buffer: Buffer,
    /// `Needs` of `needs.wgsl`: whether the sums fit.
    needs: Buffer,
    walk_groups: Vec<BindGroup>,
}

impl Share {
    /// An empty share.
    pub fn new(work: &mut Work<'_, '_>) -> Result<Self, GiError> {
        let list = &work.kernels.list;
        let bits = list.bits(&mut work.memory, work.grid, 1)?;
        let cells = list.cells(&mut work.memory, work.grid, &bits)?;
        Ok(Self {
            bits,
            cells,
            batches: Vec::new(),
            mark_groups: Vec::new(),
            voxels: None,
            sums: None,
            counts: ShareCounts::default(),
        })
    }

    /// Binds the batches of an input, unless they are already bound.
    pub fn bind(
        &mut self,
        work: &mut Work<'_, '_>,
        fallbacks: &Fallbacks,
        input: &ShareInput<'_>,
        geometry: &Geometry,
    ) -> Result<(), GiError> {
        let materials = &geometry.materials;
        let fits = self.batches.len() == input.batches.len()
            && self
                .batches
                .iter()
                .zip(&input.batches)
                .all(|(own, (batch, prepared))| own.fits((batch, prepared), materials));
        self.counts.triangles = input.triangle_count();
        if fits {
            return Ok(());
        }
        let mut batches = Vec::new();
        for (batch, prepared) in &input.batches {
            let source = (*batch, prepared);
            let (memory, kernels) = (&mut work.memory, work.kernels);
            batches.push(SplitBatch::new(memory, kernels, fallbacks, source, materials)?);
        }
        self.batches = batches;
        self.bind_walks(work);
        Ok(())
    }

    /// Creates the bind groups of the walks for the current batches and buffers.
    fn bind_walks(&mut self, work: &Work<'_, '_>) {
        let (device, layouts) = (work.memory.device(), &work.kernels.layouts);
        let batches = &self.batches;
        let groups = |layout: &wgpu::BindGroupLayout, buffers: &[&Buffer]| -> Vec<BindGroup> {
            let of_batch = |batch: &SplitBatch| {
                let group = BindGroupBuilder::new(layout).buffer(&batch.item_starts);
                let group = buffers.iter().fold(group, |group, &buffer| group.buffer(buffer));
                group.build(device, "voxelize::walk")
            };
            batches.iter().map(of_batch).collect()
        };
        let cells = &self.cells.buffer;
        self.mark_groups = groups(&layouts.mark, &[&self.bits.occupancy]);
        let Some(voxels) = &mut self.voxels else { return };
        voxels.walk_groups = groups(&layouts.planes, &[cells, &voxels.faces, &voxels.pieces]);
        let Some(sums) = &mut self.sums else { return };
        let buffers = [cells, &voxels.faces, &sums.buffer, &sums.needs];
        sums.walk_groups = groups(&layouts.accumulate, &buffers);
    }

    /// Capacity for voxels and faces.
    pub fn capacity(&self) -> [u64; 2] {
        [
            self.voxels.as_ref().map_or(0, |voxels| voxels.capacity),
            self.sums.as_ref().map_or(0, |sums| sums.capacity),
        ]
    }

    /// Allocates buffers for `capacity` voxels.
    pub fn reserve(&mut self, work: &mut Work<'_, '_>, capacity: u64) -> Result<(), GiError> {
        let remedy = work.remedy();
        let stride = size_of::<VoxelFaces>() as u64;
        // The binding of an array needs at least one element.
        let capacity = capacity.max(1);
        let faces = work.memory.buffer("planes of voxels", capacity, stride, remedy)?;
        let stride = size_of::<NodeRecord>() as u64;
        let nodes = work.memory.buffer("nodes of a share", capacity, stride, remedy)?;
        let first_faces = work.memory.buffer("first faces", capacity + 1, 4, remedy)?;
        let device = work.memory.device();
        let kernels = work.kernels;
        let faces_group = BindGroupBuilder::new(&kernels.layouts.faces)
            .buffer(&faces)
            .buffer(&first_faces)
            .buffer(&self.bits.ranks)
            .build(device, "voxelize::faces");
        let RankedBits { occupancy, ranks, .. } = &self.bits;
        self.voxels = Some(Voxels {
            capacity,
            pieces: storage_buffer(device, "pieces", 8),
            scan: kernels.scan.bind(device, &first_faces, capacity as u32 + 1),
            bound_nodes: kernels.list.bind_nodes(device, [occupancy, ranks, &nodes]),
            faces,
            nodes,
            first_faces,
            faces_group,
            walk_groups: Vec::new(),
        });
        self.bind_walks(work);
        Ok(())
    }

    /// Allocates sums for `capacity` faces; `needs` will contain whether they fit.
    pub fn reserve_sums(
        &mut self,
        work: &mut Work<'_, '_>,
        capacity: u64,
        needs: &Buffer,
    ) -> Result<(), GiError> {
        let stride = size_of::<FaceRecord>() as u64;
        let capacity = capacity.max(1);
        let buffer = work.memory.buffer("sums of faces", capacity, stride, work.remedy())?;
        let needs = needs.clone();
        self.sums = Some(Sums { capacity, buffer, needs, walk_groups: Vec::new() });
        self.bind_walks(work);
        Ok(())
    }

    /// Splits the triangles into items and marks the voxels that they touch, and those that are
    /// copied from the share `kept`.
    pub fn mark<'d>(
        &mut self,
        work: &mut Work<'_, '_>,
        draws: impl IntoIterator<Item = &'d [DrawRecord]>,
        kept: Option<&Self>,
    ) {
        for (batch, draws) in self.batches.iter_mut().zip(draws) {
            batch.split(work.recorder, work.kernels, work.globals, draws);
        }
        work.recorder.clear(&self.bits.occupancy);
        self.walk(work, WalkStep::Mark, &self.mark_groups);
        if let Some(kept) = kept {
            self.keep_bits(work, kept);
        }
        let (list, globals) = (&work.kernels.list, work.globals);
        list.rank(work.recorder, globals, &self.bits);
        list.fill_cells(work.recorder, globals, &self.cells);
    }

    /// Collects the planes of the voxels, including those copied from the share `kept`, and counts
    /// their faces.
    pub fn collect_planes(&self, work: &mut Work<'_, '_>, kept: Option<&Self>) {
        let Some(voxels) = &self.voxels else { return };
        let (kernels, globals) = (work.kernels, work.globals);
        work.recorder.clear(&voxels.faces);
        work.recorder.clear(&voxels.pieces);
        kernels.list.fill_nodes(work.recorder, globals, &voxels.bound_nodes);
        self.walk(work, WalkStep::Planes, &voxels.walk_groups);
        self.walk(work, WalkStep::MorePlanes, &voxels.walk_groups);
        if let Some(kept) = kept {
            self.keep(work, kept, &kernels.keep_lobes);
        }
        let groups = [globals, &voxels.faces_group];
        kernels.count_faces.run_linear(work.recorder, &groups, voxels.capacity);
        kernels.scan.run_bound(work.recorder, &voxels.scan);
        kernels.prepare_faces.run_linear(work.recorder, &groups, voxels.capacity);
    }

    /// Sums up the faces if nothing overflowed; copies the sums of faces from the share `kept`.
    pub fn sum_up(&self, work: &mut Work<'_, '_>, kept: Option<&Self>) {
        let Some(sums) = &self.sums else { return };
        work.recorder.clear(&sums.buffer);
        self.walk(work, WalkStep::Accumulate, &sums.walk_groups);
        if let Some(kept) = kept {
            self.keep(work, kept, &work.kernels.keep_faces);
        }
    }

    /// Copies the bits of voxels that are kept from an earlier share.
    fn keep_bits(&self, work: &mut Work<'_, '_>, before: &Self) {
        let group = BindGroupBuilder::new(&work.kernels.layouts.keep_bits)
            .buffer(&before.bits.occupancy)
            .buffer(&self.bits.occupancy)
            .build(work.memory.device(), "voxelize::keep_bits");
        let words = self.bits.occupancy.size() / 4;
        work.kernels.keep_bits.run_linear(work.recorder, &[work.globals, &group], words);
    }

    /// Runs a kernel of `keep.wgsl` over the voxels of an earlier share. Sums may be unallocated if
    /// the kernel does not read them.
    fn keep(&self, work: &mut Work<'_, '_>, before: &Self, kernel: &Kernel) {
        let (Some(old), Some(new)) = (&before.voxels, &self.voxels) else { return };
        let device = work.memory.device();
        let old_sums = before.sums.as_ref().map(|sums| &sums.buffer);
        let unused = storage_buffer(device, "no sums", size_of::<FaceRecord>() as u64);
        let sums = self.sums.as_ref().map_or(&unused, |sums| &sums.buffer);
        let group = BindGroupBuilder::new(&work.kernels.layouts.keep)
            .buffer(&before.bits.ranks)
            .buffer(&old.nodes)
            .buffer(&old.faces)
            .buffer(&self.cells.buffer)
            .buffer(&new.faces)
            .buffer(old_sums.unwrap_or(&unused))
            .buffer(sums)
            .build(device, "voxelize::keep");
        kernel.run_linear(work.recorder, &[work.globals, &group], old.capacity);
    }

    /// Walks over all items. Bind group 2 has the batch's starts of items, then the step's inputs
    /// and outputs.
    fn walk(&self, work: &mut Work<'_, '_>, step: WalkStep, groups: &[BindGroup]) {
        let Work { voxelizer, recorder, globals, grid, .. } = work;
        let batches = &self.batches;
        let walk = Walk { grid, label: step.label(), globals, batches, pass_groups: groups };
        voxelizer.walk(recorder, step, &walk);
    }

    /// Bits and ranks of the finest level.
    pub fn bits(&self) -> &RankedBits {
        &self.bits
    }

    /// Bits and ranks side by side.
    pub fn cells(&self) -> &Buffer {
        &self.cells.buffer
    }

    /// `VoxelFaces`, node, and index of the first face of each voxel; `None` before they are
    /// allocated.
    pub fn voxels(&self) -> Option<[&Buffer; 3]> {
        let voxels = self.voxels.as_ref()?;
        Some([&voxels.faces, &voxels.nodes, &voxels.first_faces])
    }

    /// The faces' sums; `None` before they are allocated.
    pub fn sums(&self) -> Option<&Buffer> {
        self.sums.as_ref().map(|sums| &sums.buffer)
    }

    /// The buffers to read back after voxels are marked, with the bytes of each: the number of
    /// voxels, then [`SplitCounts`] for each batch.
    pub fn marked_counts(&self) -> Vec<(&Buffer, u64, u64)> {
        let total = (&self.bits.ranks, self.bits.total_byte(), 4);
        let splits = self.batches.iter().map(|batch| (&batch.counts, 0, SPLIT_BYTES));
        [total].into_iter().chain(splits).collect()
    }

    /// Applies the read-back of [`Self::marked_counts`]. Returns the number of voxels.
    pub fn take_marked(&mut self, words: &[u32]) -> Result<u64, GiError> {
        let splits: Vec<SplitCounts> = words[1..]
            .chunks_exact(SPLIT_BYTES as usize / 4)
            .map(|words| bytemuck::pod_read_unaligned(bytemuck::cast_slice(words)))
            .collect();
        check_numbering(&splits)?;
        let sum = |count: fn(&SplitCounts) -> u32| splits.iter().map(|s| u64::from(count(s))).sum();
        self.counts.degenerate = sum(|split| split.degenerate);
        self.counts.outside = sum(|split| split.outside);
        self.counts.items = sum(|split| split.items);
        Ok(u64::from(words[0]))
    }

    /// The buffers to read back after the planes of `voxels` voxels are collected: the number of
    /// faces, and the low and high word of the number of pieces.
    pub fn face_counts(&self, voxels: u64) -> Vec<(&Buffer, u64, u64)> {
        let Some(own) = &self.voxels else { return Vec::new() };
        vec![(&own.first_faces, voxels * 4, 4), (&own.pieces, 0, 8)]
    }

    /// Applies the read-back of [`Self::face_counts`]. Returns the number of faces.
    pub fn take_faces(&mut self, words: &[u32]) -> u64 {
        self.counts.pieces = u64::from(words[2]) << 32 | u64::from(words[1]);
        u64::from(words[0])
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let voxels = self.voxels().into_iter().flatten().map(|buffer| buffer.size());
        let sums = self.sums().map_or(0, |sums| sums.size());
        self.bits.bytes() + self.cells.buffer.size() + voxels.sum::<u64>() + sums
    }
}

/// Bytes of [`SplitCounts`].
const SPLIT_BYTES: u64 = size_of::<SplitCounts>() as u64;

/// Rejects batches with more items than can be numbered.
fn check_numbering(splits: &[SplitCounts]) -> Result<(), GiError> {
    for split in splits {
        if split.items_overflow > 0 {
            return Err(GiError::Limit {
                what: "the numbering of a batch's work items".to_owned(),
                needed: (u64::from(split.items_overflow) << 32) + u64::from(split.items),
                unit: "numbers",
                limit: "u32::MAX",
                available: u64::from(u32::MAX),
                remedy: "share its draws out to several batches".to_owned(),
            });
        }
    }
    Ok(())
}
