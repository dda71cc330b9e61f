//! Unites the shares in the list of voxels.
//!
//! The list is changed in place. The faces of static surface are at the front of the list and stay
//! there; after them come the faces of the voxels that dynamic surface touches, including the
//! static faces of those voxels. Bits and ranks are built beside the list's and committed only if
//! everything fits, which the GPU decides (`needs.wgsl`).

use bytemuck::{Pod, Zeroable};

use super::VoxelFaces;
use super::share::{Share, Work};
use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundScan, Buffer, Staged, counted_buffer, storage_buffer,
    uniform_buffer,
};
use crate::voxels::{
    BoundInner, BoundNodes, BoundPyramid, FaceRecord, LIST_COUNT_BYTES, RankedBits, VoxelList,
    level_block, level_first_word,
};
use crate::{GiError, Grid};

/// `ResolveParams` of `resolve.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct ResolveParams {
    pub emission_scale: f32,
    padding: [u32; 3],
}

/// `UnitedVoxel` of `unite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct UnitedVoxel {
    pub lobes: u32,
    pub fixed_lobes: u32,
    pub moving_lobes: u32,
    padding: u32,
    pub first_sums: [u32; 2],
    pub scales: [f32; 2],
}

/// `Capacity` of `needs.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct Capacity {
    pub voxels: u32,
    pub sums: u32,
    pub nodes: u32,
    pub faces: u32,
    pub fixed_faces: u32,
    padding: [u32; 3],
}

/// `Needs` of `needs.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Needs {
    pub overflow: u32,
    pub moving_voxels: u32,
    pub moving_faces: u32,
    pub sums: u32,
    pub nodes: u32,
    padding: [u32; 3],
}

impl Needs {
    /// No overflow, for `voxels` voxels.
    pub fn of_voxels(voxels: u64) -> Self {
        Self { moving_voxels: voxels as u32, ..Self::zeroed() }
    }
}

const _: () = assert!(size_of::<VoxelFaces>() >= size_of::<FaceRecord>());

/// Bits of [`Needs::overflow`]: the voxels of the dynamic share do not fit.
pub(super) const OVERFLOW_VOXELS: u32 = 1;
/// The sums of the dynamic share do not fit.
pub(super) const OVERFLOW_SUMS: u32 = 2;
/// The nodes of all levels do not fit.
pub(super) const OVERFLOW_NODES: u32 = 4;
/// The faces of the list do not fit.
pub(super) const OVERFLOW_FACES: u32 = 8;

/// The union of both shares.
#[derive(Debug)]
pub(super) struct Union {
    /// Zeros, bound in place of a missing share.
    nothing: Buffer,
    /// Bits of all levels of the new list.
    merged: RankedBits,
    pyramid: BoundPyramid,
    /// The voxels that dynamic surface touches in the current list: bits of the finest level.
    moving_before: Buffer,
    /// [`Needs`].
    needs: Buffer,
    params: Staged,
    merge: Option<BindGroup>,
    united: Option<United>,
    bound: Option<BoundList>,
}

/// Buffers for the voxels that dynamic surface touches.
#[derive(Debug)]
struct United {
    capacity: u64,
    voxels: Buffer,
    faces: Buffer,
    /// The indices of the voxels' first faces in the current list.
    former: Buffer,
    scan: BoundScan,
    group: BindGroup,
}

/// Bindings to the list.
#[derive(Debug)]
struct BoundList {
    /// The faces of the voxels that dynamic surface touches.
    moving_faces: Buffer,
    capacity: Capacity,
    /// Words of the bits, plus one for the total.
    words: u64,
    nodes: u64,
    needs: BindGroup,
    resolve: BindGroup,
    starts: BindGroup,
    former: BindGroup,
    compare: BindGroup,
    commit_cells: BindGroup,
    commit_faces: BindGroup,
    describe: BindGroup,
    bound_nodes: BoundNodes,
    inner: BoundInner,
}

/// The data that lighting needs to move light to a list that is about to be committed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moving<'a> {
    /// [`Needs`].
    pub needs: &'a Buffer,
    /// For each voxel that dynamic surface touches, the index of its first face among `faces`.
    pub united_faces: &'a Buffer,
    /// The faces that the list gets after those of static surface.
    pub faces: &'a Buffer,
    /// For each voxel, the index of its first face in the current list; `0xffffffff` if it has
    /// none.
    pub former: &'a Buffer,
    /// Capacity for voxels.
    pub voxels: u64,
}

impl Union {
    pub fn new(work: &mut Work<'_, '_>) -> Result<Self, GiError> {
        let (list, grid) = (&work.kernels.list, work.grid);
        let merged = list.bits(&mut work.memory, grid, grid.levels)?;
        let device = work.memory.device();
        let pyramid = list.pyramid.bind(device, grid, &merged.occupancy);
        let bytes = level_first_word(grid, 1) * 4;
        let needs = counted_buffer(device, "needs", size_of::<Needs>() as u64);
        let params = Staged::new(device, "resolve parameters", size_of::<ResolveParams>() as u64);
        Ok(Self {
            // One element of the largest type: the minimum for the binding of an array.
            nothing: storage_buffer(device, "nothing", size_of::<VoxelFaces>() as u64),
            merged,
            pyramid,
            moving_before: storage_buffer(device, "moving before", bytes),
            needs,
            params,
            merge: None,
            united: None,
            bound: None,
        })
    }

    /// [`Needs`].
    pub fn needs(&self) -> &Buffer {
        &self.needs
    }

    /// Binds the shares' bits.
    pub fn bind_shares(&mut self, work: &Work<'_, '_>, shares: [Option<&Share>; 2]) {
        let bits = |share: Option<&Share>| {
            share.map_or(&self.nothing, |share| &share.bits().occupancy).clone()
        };
        let [fixed, moving] = shares.map(bits);
        let group = BindGroupBuilder::new(&work.kernels.layouts.merge_bits)
            .buffer(&fixed)
            .buffer(&moving)
            .buffer(&self.merged.occupancy);
        self.merge = Some(group.build(work.memory.device(), "voxelize::merge_bits"));
    }

    /// Merges the bits of both shares.
    pub fn merge(&self, work: &mut Work<'_, '_>) {
        let Some(merge) = &self.merge else { return };
        let (kernels, globals) = (work.kernels, work.globals);
        let words = level_first_word(work.grid, 1);
        kernels.merge_bits.run_linear(work.recorder, &[globals, merge], words);
        kernels.list.pyramid.run(work.recorder, globals, &self.pyramid);
        kernels.list.rank(work.recorder, globals, &self.merged);
    }

    /// The buffer to read back after bits are merged: the number of nodes of all levels.
    pub fn node_count(&self, grid: &Grid) -> (&Buffer, u64, u64) {
        (&self.merged.ranks, level_first_word(grid, grid.levels) * 4, 4)
    }

    /// Binds the shares' voxels, and allocates united ones for those that dynamic surface touches.
    pub fn bind_voxels(
        &mut self,
        work: &mut Work<'_, '_>,
        [fixed, moving]: [Option<&Share>; 2],
    ) -> Result<(), GiError> {
        let remedy = work.remedy();
        let capacity = moving.map_or(1, |moving| moving.capacity()[0].max(1));
        let stride = size_of::<UnitedVoxel>() as u64;
        let voxels = work.memory.buffer("united voxels", capacity, stride, remedy)?;
        let faces = work.memory.buffer("united faces", capacity + 1, 4, remedy)?;
        let former = work.memory.buffer("former faces", capacity, 4, remedy)?;
        let device = work.memory.device();
        let nothing = &self.nothing;
        let [fixed_faces, ..] = fixed.and_then(Share::voxels).unwrap_or([nothing; 3]);
        let [moving_faces, moving_nodes, ..] =
            moving.and_then(Share::voxels).unwrap_or([nothing; 3]);
        let group = BindGroupBuilder::new(&work.kernels.layouts.unite)
            .buffer(fixed.map_or(nothing, Share::cells))
            .buffer(fixed_faces)
            .buffer(moving.map_or(nothing, |moving| &moving.bits().ranks))
            .buffer(moving_nodes)
            .buffer(moving_faces)
            .buffer(&voxels)
            .buffer(&faces)
            .build(device, "voxelize::unite");
        let scan = work.kernels.scan.bind(device, &faces, capacity as u32 + 1);
        self.united = Some(United { capacity, voxels, faces, former, scan, group });
        Ok(())
    }

    /// Computes the lobes of the voxels that dynamic surface touches.
    pub fn unite(&self, work: &mut Work<'_, '_>) {
        let Some(united) = &self.united else { return };
        let groups = [work.globals, &united.group];
        work.kernels.unite.run_linear(work.recorder, &groups, united.capacity);
        work.kernels.scan.run_bound(work.recorder, &united.scan);
    }

    /// Binds the list that is updated. `changed` has a bit per cell.
    pub fn bind_list(
        &mut self,
        work: &mut Work<'_, '_>,
        [fixed, moving]: [Option<&Share>; 2],
        (list, fixed_count): (&VoxelList, u32),
        changed: &Buffer,
    ) -> Result<(), GiError> {
        let Some(united) = &self.united else { return Ok(()) };
        let [voxels, sums] = moving.map_or([0; 2], Share::capacity).map(|count| count as u32);
        let capacity = Capacity {
            voxels,
            sums,
            nodes: list.node_capacity() as u32,
            faces: list.face_capacity() as u32,
            fixed_faces: fixed_count,
            padding: [0; 3],
        };
        let moving_count = u64::from(capacity.faces.saturating_sub(fixed_count)).max(1);
        let stride = size_of::<FaceRecord>() as u64;
        let remedy = work.remedy();
        let moving_faces = work.memory.buffer("moving faces", moving_count, stride, remedy)?;
        let (device, kernels) = (work.memory.device(), work.kernels);
        let layouts = &kernels.layouts;
        let capacity_uniform = uniform_buffer(device, "capacity", &capacity);
        let nothing = &self.nothing;
        let [_, fixed_nodes, fixed_faces] = fixed.and_then(Share::voxels).unwrap_or([nothing; 3]);
        let [_, moving_nodes, own_faces] = moving.and_then(Share::voxels).unwrap_or([nothing; 3]);
        let moving_bits = moving.map(Share::bits);
        let needs = BindGroupBuilder::new(&layouts.needs)
            .buffer(&capacity_uniform)
            .buffer(&self.merged.ranks)
            .buffer(moving_bits.map_or(nothing, |bits| &bits.ranks))
            .buffer(own_faces)
            .buffer(&united.faces)
            .buffer(&self.needs)
            .buffer(&list.counts)
            .build(device, "voxelize::needs");
        let resolve = BindGroupBuilder::new(&layouts.resolve_shares)
            .buffer(self.params.buffer())
            .buffer(&self.needs)
            .buffer(&united.voxels)
            .buffer(&united.faces)
            .buffer(fixed.and_then(Share::sums).unwrap_or(nothing))
            .buffer(moving.and_then(Share::sums).unwrap_or(nothing))
            .buffer(moving_nodes)
            .buffer(&moving_faces)
            .build(device, "voxelize::resolve_shares");
        let starts = BindGroupBuilder::new(&layouts.starts)
            .buffer(&self.needs)
            .buffer(moving_nodes)
            .buffer(&united.faces)
            .buffer(&moving_faces)
            .build(device, "voxelize::starts");
        let former = BindGroupBuilder::new(&layouts.former)
            .buffer(&self.needs)
            .buffer(moving_nodes)
            .buffer(&list.occupancy)
            .buffer(&list.ranks)
            .buffer(&list.first_faces)
            .buffer(&united.former)
            .build(device, "voxelize::former");
        let compare = BindGroupBuilder::new(&layouts.compare)
            .buffer(&self.needs)
            .buffer(moving_nodes)
            .buffer(&united.faces)
            .buffer(&moving_faces)
            .buffer(&united.former)
            .buffer(&list.faces)
            .buffer(changed)
            .build(device, "voxelize::compare");
        let commit_cells = BindGroupBuilder::new(&layouts.commit_cells)
            .buffer(&self.needs)
            .buffer(&self.merged.occupancy)
            .buffer(&self.merged.ranks)
            .buffer(moving_bits.map_or(nothing, |bits| &bits.occupancy))
            .buffer(&self.moving_before)
            .buffer(&list.occupancy)
            .buffer(&list.ranks)
            .buffer(changed)
            .build(device, "voxelize::commit_cells");
        let commit_faces = BindGroupBuilder::new(&layouts.commit_faces)
            .buffer(&self.needs)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&moving_faces)
            .buffer(&list.faces)
            .build(device, "voxelize::commit_faces");
        let describe = BindGroupBuilder::new(&layouts.describe)
            .buffer(&self.needs)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .slice(&list.counts, level_block(0), LIST_COUNT_BYTES)
            .buffer(fixed.map_or(nothing, Share::cells))
            .buffer(fixed_nodes)
            .buffer(fixed_faces)
            .buffer(moving.map_or(nothing, Share::cells))
            .buffer(moving_nodes)
            .buffer(&united.faces)
            .buffer(&list.nodes)
            .buffer(&list.first_faces)
            .build(device, "voxelize::describe");
        let buffers = [&list.occupancy, &list.ranks, &list.nodes];
        self.bound = Some(BoundList {
            capacity,
            words: level_first_word(work.grid, work.grid.levels) + 1,
            nodes: list.node_capacity(),
            needs,
            resolve,
            starts,
            former,
            compare,
            commit_cells,
            commit_faces,
            describe,
            bound_nodes: kernels.list.bind_nodes(device, buffers),
            inner: kernels.list.bind_inner(device, work.grid, list),
            moving_faces,
        });
        Ok(())
    }

    /// Decides whether everything fits; if not, later passes do nothing.
    pub fn check_fit(&self, work: &mut Work<'_, '_>) {
        let Some(bound) = &self.bound else { return };
        let groups = [work.globals, &bound.needs];
        work.kernels.needs.run(work.recorder, &groups, [1; 3]);
    }

    /// Computes the faces of the voxels that dynamic surface touches, and marks those that differ
    /// from the list.
    pub fn resolve(&mut self, work: &mut Work<'_, '_>, emission_scale: f32) {
        let (Some(united), Some(bound)) = (&self.united, &self.bound) else { return };
        let params = ResolveParams { emission_scale, padding: [0; 3] };
        self.params.set(work.recorder, bytemuck::bytes_of(&params));
        let Work { kernels, recorder, globals, .. } = work;
        let count = united.capacity;
        kernels.resolve_shares.run_linear(recorder, &[globals, &bound.resolve], count);
        kernels.starts.run_linear(recorder, &[globals, &bound.starts], count);
        kernels.former.run_linear(recorder, &[globals, &bound.former], count);
        kernels.compare.run_linear(recorder, &[globals, &bound.compare], count);
    }

    /// The data that lighting needs before the list is committed.
    pub fn moving(&self) -> Option<Moving<'_>> {
        let (united, bound) = self.united.as_ref().zip(self.bound.as_ref())?;
        Some(Moving {
            needs: &self.needs,
            united_faces: &united.faces,
            faces: &bound.moving_faces,
            former: &united.former,
            voxels: united.capacity,
        })
    }

    /// Commits the new list.
    pub fn commit(&self, work: &mut Work<'_, '_>) {
        let Some(bound) = &self.bound else { return };
        let Work { kernels, recorder, globals, .. } = work;
        kernels.commit_cells.run_linear(recorder, &[globals, &bound.commit_cells], bound.words);
        let moving = u64::from(bound.capacity.faces - bound.capacity.fixed_faces);
        kernels.commit_faces.run_linear(recorder, &[globals, &bound.commit_faces], moving);
        kernels.list.fill_nodes(recorder, globals, &bound.bound_nodes);
        kernels.describe.run_linear(recorder, &[globals, &bound.describe], bound.nodes);
        kernels.list.inner_lobes(recorder, globals, &bound.inner);
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let united = self.united.iter().flat_map(|own| [&own.voxels, &own.faces, &own.former]);
        let bound = self.bound.iter().map(|bound| &bound.moving_faces);
        let buffers = united.chain(bound).chain([&self.moving_before]);
        self.merged.bytes() + buffers.map(|buffer| buffer.size()).sum::<u64>()
    }
}

/// Computes the faces of the static share, at the front of a list.
pub(super) fn resolve_fixed(
    work: &mut Work<'_, '_>,
    share: &Share,
    list: &VoxelList,
    emission_scale: f32,
) {
    let Some(([voxels, nodes, first_faces], sums)) = share.voxels().zip(share.sums()) else {
        return;
    };
    let params = ResolveParams { emission_scale, padding: [0; 3] };
    let device = work.memory.device();
    let params = uniform_buffer(device, "resolve parameters", &params);
    let group = BindGroupBuilder::new(&work.kernels.layouts.resolve)
        .buffer(&params)
        .buffer(voxels)
        .buffer(sums)
        .buffer(nodes)
        .buffer(&list.faces)
        .build(device, "voxelize::resolve");
    let count = share.capacity()[0];
    work.kernels.resolve.run_linear(work.recorder, &[work.globals, &group], count);
    let needs = uniform_buffer(device, "needs", &Needs::of_voxels(count));
    let group = BindGroupBuilder::new(&work.kernels.layouts.starts)
        .buffer(&needs)
        .buffer(nodes)
        .buffer(first_faces)
        .buffer(&list.faces)
        .build(device, "voxelize::starts");
    work.kernels.starts.run_linear(work.recorder, &[work.globals, &group], count);
}

/// Marks all cells of a list that was replaced as changed.
pub(super) fn renew(work: &mut Work<'_, '_>, replaced: &VoxelList, changed: &Buffer) {
    let group = BindGroupBuilder::new(&work.kernels.layouts.renew)
        .buffer(&replaced.occupancy)
        .buffer(changed)
        .build(work.memory.device(), "voxelize::renew");
    let words = level_first_word(work.grid, work.grid.levels);
    work.kernels.renew.run_linear(work.recorder, &[work.globals, &group], words);
}
