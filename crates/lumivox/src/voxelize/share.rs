//! A share of the surface, static or dynamic, on its way through the three walks.

use super::batch::{Fallbacks, SplitBatch, SplitCounts};
use super::hook::{Walk, WalkStep};
use super::input::ShareInput;
use super::kernels::Kernels;
use super::{FRONT_WORDS, VoxelFaces, Voxelizer};
use crate::gpu::{BindGroup, BindGroupBuilder, Buffer, Recorder, storage_buffer};
use crate::gpu::{Memory, Remedy};
use crate::voxels::{FaceRecord, ListBuilder, Occupied};
use crate::{Geometry, GiError, Grid};

/// What all passes of a voxelization need.
pub(super) struct Work<'a> {
    /// Who walks.
    pub voxelizer: &'a Voxelizer,
    pub kernels: &'a Kernels,
    pub device: &'a wgpu::Device,
    pub grid: &'a Grid,
    /// Group 0.
    pub globals: BindGroup,
    pub recorder: Recorder<'static>,
    pub memory: Memory<'a>,
}

impl Work<'_> {
    /// What helps where a buffer of the surface does not fit.
    pub fn remedy(&self) -> Remedy {
        Remedy::Surface(self.grid.dimensions.max_element())
    }
}

/// How many triangles and pieces a share has.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShareCounts {
    pub degenerate: u64,
    pub outside: u64,
    pub items: u64,
    pub pieces: u64,
}

/// A share whose voxels are marked and ranked.
#[derive(Debug)]
pub(super) struct MarkedShare {
    batches: Vec<SplitBatch>,
    pub occupied: Occupied,
    pub cells: Buffer,
}

/// What a share collects: nothing in it depends on the other share.
#[derive(Debug)]
pub(super) struct Share {
    pub occupied: Occupied,
    /// Bits and ranks of the finest level, side by side.
    pub cells: Buffer,
    /// Where the nodes of each level start, and last their total.
    pub level_starts: Vec<u32>,
    /// `VoxelFaces`, in the order of the share's voxels.
    pub voxels: Buffer,
    /// The index of each voxel's first face, and last the total.
    pub first_faces: Buffer,
    pub face_count: u32,
    /// The faces' sums, as `FaceSlot` of `face_sums.wgsl` has them.
    pub sums: Buffer,
    pub counts: ShareCounts,
}

/// A share whose lobes are known, before its faces are counted.
#[derive(Debug)]
pub(super) struct LobedShare {
    batches: Vec<SplitBatch>,
    pub share: Share,
    pieces: Buffer,
    /// The index of each voxel's first face with fronts among all such faces, and last the total.
    first_fronts: Buffer,
}

impl MarkedShare {
    /// Splits the triangles into items and marks the voxels that they touch.
    pub fn new(
        work: &mut Work<'_>,
        fallbacks: &Fallbacks,
        input: &ShareInput<'_>,
        geometry: &Geometry,
    ) -> Result<Self, GiError> {
        let mut batches = Vec::new();
        for (batch, prepared) in &input.batches {
            batches.push(SplitBatch::new(
                &mut work.recorder,
                &mut work.memory,
                work.kernels,
                &work.globals,
                fallbacks,
                (batch, prepared),
                &geometry.materials,
            )?);
        }
        let occupied = ListBuilder::begin(&mut work.memory, work.grid)?;
        Self::mark(work, &batches, &occupied);
        let Work { kernels, recorder, memory, globals, grid, .. } = work;
        kernels.list.pyramid.fill(recorder, globals, grid, &occupied.occupancy);
        kernels.list.rank(recorder, &kernels.scan, globals, grid, &occupied);
        let cells = kernels.list.cells(recorder, memory, globals, grid, &occupied)?;
        Ok(Self { batches, occupied, cells })
    }

    /// The first walk: which voxels are touched.
    fn mark(work: &mut Work<'_>, batches: &[SplitBatch], occupied: &Occupied) {
        let kernels = work.kernels;
        let buffers = [&occupied.occupancy];
        walk(work, batches, (&kernels.layouts.mark, &buffers), WalkStep::Mark);
    }

    /// The buffers of the batches' [`SplitCounts`].
    pub fn split_counts(&self) -> impl Iterator<Item = &Buffer> {
        self.batches.iter().map(|batch| &batch.counts)
    }

    /// Collects the lobes of the share's voxels, of which there are `level_starts[1]`, and counts their faces.
    pub fn collect_lobes(
        self,
        work: &mut Work<'_>,
        level_starts: Vec<u32>,
        splits: &[SplitCounts],
    ) -> Result<LobedShare, GiError> {
        let voxel_count = u64::from(level_starts[1]);
        let remedy = work.remedy();
        let stride = size_of::<VoxelFaces>() as u64;
        let voxels = work.memory.buffer("lobes of voxels", voxel_count, stride, remedy)?;
        let first_faces = work.memory.buffer("first faces", voxel_count + 1, 4, remedy)?;
        let first_fronts = work.memory.buffer("first fronts", voxel_count + 1, 4, remedy)?;
        let pieces = storage_buffer(work.device, "pieces", 8);
        let kernels = work.kernels;
        let Self { batches, occupied, cells } = self;
        Self::lobes(work, &batches, [&cells, &voxels, &pieces]);

        let group = BindGroupBuilder::new(&kernels.layouts.faces)
            .buffer(&voxels)
            .buffer(&first_faces)
            .buffer(&first_fronts)
            .build(work.device, "voxelize::faces");
        let groups = [&work.globals, &group];
        kernels.count_faces.run_linear(&mut work.recorder, &groups, voxel_count);
        for firsts in [&first_faces, &first_fronts] {
            kernels.scan.run(&mut work.recorder, firsts, voxel_count as u32 + 1);
        }
        kernels.prepare_faces.run_linear(&mut work.recorder, &groups, voxel_count);

        let sum = |count: fn(&SplitCounts) -> u32| splits.iter().map(|s| u64::from(count(s))).sum();
        let counts = ShareCounts {
            degenerate: sum(|split| split.degenerate),
            outside: sum(|split| split.outside),
            items: sum(|split| split.items),
            pieces: 0,
        };
        // The sums are made once the faces are counted.
        let sums = storage_buffer(work.device, "no sums", 16);
        let share = Share {
            occupied,
            cells,
            level_starts,
            voxels,
            first_faces,
            face_count: 0,
            sums,
            counts,
        };
        Ok(LobedShare { batches, share, pieces, first_fronts })
    }

    /// The second walk: which lobes the voxels have, and how much surface.
    fn lobes(work: &mut Work<'_>, batches: &[SplitBatch], buffers: [&Buffer; 3]) {
        let kernels = work.kernels;
        walk(work, batches, (&kernels.layouts.lobes, &buffers), WalkStep::Lobes);
    }
}

impl Share {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let Occupied { occupancy, ranks } = &self.occupied;
        let buffers = [occupancy, ranks, &self.cells, &self.voxels, &self.first_faces, &self.sums];
        buffers.into_iter().map(|buffer| buffer.size()).sum()
    }
}

impl LobedShare {
    /// Words that [`Self::copy_counts`] copies.
    pub const COUNT_WORDS: usize = 4;

    /// Copies the numbers of faces and of those with fronts, and the low and the high word of that of pieces, to
    /// `counts` at a byte.
    pub fn copy_counts(&self, recorder: &mut Recorder, counts: &Buffer, place: u64) {
        let total = u64::from(self.share.level_starts[1]) * 4;
        recorder.copy((&self.share.first_faces, total), (counts, place), 4);
        recorder.copy((&self.first_fronts, total), (counts, place + 4), 4);
        recorder.copy((&self.pieces, 0), (counts, place + 8), 8);
    }

    /// Sums the faces up, given what [`Self::copy_counts`] has copied.
    pub fn sum_up(self, work: &mut Work<'_>, counts: &[u32]) -> Result<Share, GiError> {
        let Self { batches, mut share, .. } = self;
        share.face_count = counts[0];
        let fronts = u64::from(counts[1]);
        share.counts.pieces = u64::from(counts[3]) << 32 | u64::from(counts[2]);
        let stride = size_of::<FaceRecord>() as u64;
        // A binding of an array has room for one element at least.
        let faces = u64::from(share.face_count).max(1);
        // A raster of fronts takes no more bytes than a face; they stand behind them all.
        const { assert!(size_of::<FaceRecord>() >= 4 * FRONT_WORDS as usize) };
        share.sums = work.memory.buffer("faces", faces + fronts, stride, work.remedy())?;
        let buffers = [&share.cells, &share.voxels, &share.sums];
        if fronts > 0 {
            Self::walk(work, &batches, &buffers, WalkStep::Fronts);
        }
        Self::walk(work, &batches, &buffers, WalkStep::Accumulate);
        Ok(share)
    }

    /// The last walks: which surface is in front, and what is in the faces.
    fn walk(work: &mut Work<'_>, batches: &[SplitBatch], buffers: &[&Buffer], step: WalkStep) {
        let kernels = work.kernels;
        walk(work, batches, (&kernels.layouts.accumulate, buffers), step);
    }
}

/// Walks over all items: bind group 2 has each batch's starts of items, and then the given buffers.
fn walk(
    work: &mut Work<'_>,
    batches: &[SplitBatch],
    (layout, buffers): (&wgpu::BindGroupLayout, &[&Buffer]),
    step: WalkStep,
) {
    let groups: Vec<_> = batches
        .iter()
        .map(|batch| {
            let group = BindGroupBuilder::new(layout).buffer(&batch.item_starts);
            let group = buffers.iter().fold(group, |group, &buffer| group.buffer(buffer));
            group.build(work.device, "voxelize::walk")
        })
        .collect();
    let Work { voxelizer, recorder, globals, grid, .. } = work;
    let walk = Walk { grid, label: step.label(), globals, batches, pass_groups: &groups };
    voxelizer.walk(recorder, step, &walk);
}
