//! From shares to the list of voxels: merged where there are two, and resolved from sums to faces.

use bytemuck::{Pod, Zeroable};

use super::ResolveParams;
use super::share::{Share, Work};
use crate::GiError;
use crate::gpu::{BindGroupBuilder, Buffer, Recorder, uniform_buffer};
use crate::voxels::{FaceRecord, ListBuilder, Occupied, VoxelList, level_first_word};

/// `UnitedVoxel` of `unite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct UnitedVoxel {
    pub lobes: u32,
    padding_0: u32,
    pub first_sums: [u32; 2],
    pub scales: [f32; 2],
}

/// The occupied cells of two shares together, ranked.
pub(super) fn merge_bits(work: &mut Work<'_>, shares: [&Occupied; 2]) -> Result<Occupied, GiError> {
    let merged = ListBuilder::begin(&mut work.memory, work.grid)?;
    let kernels = work.kernels;
    let group = BindGroupBuilder::new(&kernels.layouts.merge_bits)
        .buffer(&shares[0].occupancy)
        .buffer(&shares[1].occupancy)
        .buffer(&merged.occupancy)
        .build(work.device, "voxelize::merge_bits");
    let words = level_first_word(work.grid, work.grid.levels);
    let (recorder, globals) = (&mut work.recorder, &work.globals);
    kernels.merge_bits.run_linear(recorder, &[globals, &group], words);
    kernels.list.rank(recorder, &kernels.scan, globals, work.grid, &merged);
    Ok(merged)
}

/// Two shares' voxels in one list, before their faces are counted.
#[derive(Debug)]
pub(super) struct United {
    occupied: Occupied,
    level_starts: Vec<u32>,
    nodes: Buffer,
    voxels: Buffer,
    first_faces: Buffer,
}

impl United {
    /// Unites the lobes of two shares.
    pub fn new(
        work: &mut Work<'_>,
        occupied: Occupied,
        level_starts: Vec<u32>,
        shares: [&Share; 2],
    ) -> Result<Self, GiError> {
        let nodes = list_nodes(work, &occupied, &level_starts)?;
        let voxel_count = u64::from(level_starts[1]);
        let remedy = work.remedy();
        let stride = size_of::<UnitedVoxel>() as u64;
        let voxels = work.memory.buffer("united voxels", voxel_count, stride, remedy)?;
        let first_faces = work.memory.buffer("first faces", voxel_count + 1, 4, remedy)?;
        let kernels = work.kernels;
        let [first, second] = shares;
        let group = BindGroupBuilder::new(&kernels.layouts.unite)
            .buffer(&nodes)
            .buffer(&first.cells)
            .buffer(&first.voxels)
            .buffer(&second.cells)
            .buffer(&second.voxels)
            .buffer(&voxels)
            .buffer(&first_faces)
            .build(work.device, "voxelize::unite");
        kernels.unite.run_linear(&mut work.recorder, &[&work.globals, &group], voxel_count);
        kernels.scan.run(&mut work.recorder, &first_faces, voxel_count as u32 + 1);
        Ok(Self { occupied, level_starts, nodes, voxels, first_faces })
    }

    /// Copies the number of faces to `counts` at a byte.
    pub fn copy_face_count(&self, recorder: &mut Recorder, counts: &Buffer, place: u64) {
        let total = u64::from(self.level_starts[1]) * 4;
        recorder.copy((&self.first_faces, total), (counts, place), 4);
    }

    /// The list, from the sums of both shares.
    pub fn resolve(
        self,
        work: &mut Work<'_>,
        sums: [&Buffer; 2],
        face_count: u32,
        emission_scale: f32,
    ) -> Result<VoxelList, GiError> {
        let stride = size_of::<FaceRecord>() as u64;
        let count = u64::from(face_count).max(1);
        let faces = work.memory.buffer("faces", count, stride, work.remedy())?;
        let voxel_count = self.level_starts[1];
        let params = ResolveParams { voxel_count, emission_scale };
        let params = uniform_buffer(work.device, "resolve parameters", &params);
        let kernels = work.kernels;
        let group = BindGroupBuilder::new(&kernels.layouts.resolve_shares)
            .buffer(&params)
            .buffer(&self.voxels)
            .buffer(&self.first_faces)
            .buffer(sums[0])
            .buffer(sums[1])
            .buffer(&self.nodes)
            .buffer(&faces)
            .build(work.device, "voxelize::resolve_shares");
        let groups = [&work.globals, &group];
        kernels.resolve_shares.run_linear(&mut work.recorder, &groups, u64::from(voxel_count));
        let Self { occupied, level_starts, nodes, first_faces, .. } = self;
        Ok(finish(work, &occupied, level_starts, (nodes, first_faces), (faces, face_count)))
    }
}

/// The list of a share that is alone. Its sums become the faces; if they are kept, a copy does.
pub(super) fn list_of_one(
    work: &mut Work<'_>,
    share: &Share,
    keeps_sums: bool,
    emission_scale: f32,
) -> Result<VoxelList, GiError> {
    let nodes = list_nodes(work, &share.occupied, &share.level_starts)?;
    let faces = if keeps_sums {
        let stride = size_of::<FaceRecord>() as u64;
        let count = u64::from(share.face_count).max(1);
        let copy = work.memory.buffer("faces", count, stride, work.remedy())?;
        work.recorder.copy((&share.sums, 0), (&copy, 0), count * stride);
        copy
    } else {
        share.sums.clone()
    };
    let voxel_count = share.level_starts[1];
    let params = ResolveParams { voxel_count, emission_scale };
    let params = uniform_buffer(work.device, "resolve parameters", &params);
    let kernels = work.kernels;
    let resolve = BindGroupBuilder::new(&kernels.layouts.resolve)
        .buffer(&params)
        .buffer(&share.voxels)
        .buffer(&nodes)
        .buffer(&faces)
        .build(work.device, "voxelize::resolve");
    let groups = [&work.globals, &resolve];
    kernels.resolve.run_linear(&mut work.recorder, &groups, u64::from(voxel_count));
    let (starts, firsts) = (share.level_starts.clone(), share.first_faces.clone());
    Ok(finish(work, &share.occupied, starts, (nodes, firsts), (faces, share.face_count)))
}

/// The nodes of all levels, still without lobes.
fn list_nodes(
    work: &mut Work<'_>,
    occupied: &Occupied,
    level_starts: &[u32],
) -> Result<Buffer, GiError> {
    let node_count = level_starts[work.grid.levels as usize];
    let Work { kernels, recorder, memory, globals, grid, .. } = work;
    kernels.list.list(recorder, memory, globals, grid, occupied, node_count)
}

/// The list, once its finest nodes have their lobes.
fn finish(
    work: &mut Work<'_>,
    occupied: &Occupied,
    level_starts: Vec<u32>,
    (nodes, first_faces): (Buffer, Buffer),
    (faces, face_count): (Buffer, u32),
) -> VoxelList {
    let Work { kernels, recorder, globals, grid, .. } = work;
    kernels.list.inner_lobes(recorder, globals, grid, occupied, &nodes, &level_starts);
    VoxelList {
        level_starts,
        face_count,
        occupancy: occupied.occupancy.clone(),
        ranks: occupied.ranks.clone(),
        nodes,
        first_faces,
        faces,
    }
}
