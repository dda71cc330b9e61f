//! Triangles to voxels: the exact set of voxels that they touch, and per voxel what surface is in it.
//!
//! # Stages
//! 1. `split` cuts each triangle into work items, tiles of columns along the dominant axis of its normal. A
//!    prefix sum numbers them, and the counts become the sizes of indirect dispatches: no queue that could
//!    overflow, no thread that walks a whole wall.
//! 2. `mark` walks the items and sets the bit of each voxel that its triangle touches, by separating axes
//!    (Schwarz and Seidel 2010). The pyramid of bits and its ranks are the list of voxels.
//! 3. `lobes` walks the items again. The piece of the triangle in each voxel belongs to the lobe of its
//!    normal's dominant axis and side. It sets the lobe's bit and adds up how much surface the voxel has.
//! 4. `accumulate` walks a third time and adds vector area, reflectance, emission and position to the lobe's
//!    integer sums; `resolve` turns them into faces.
//!
//! Walking three times costs less memory than storing the pieces, of which a fine mesh has millions, and every
//! buffer is sized from counts: of items on the GPU, of voxels and faces by two read-backs.
//!
//! That is [`VoxelizeMethod::Exact`]. The other methods walk over the fragments of the hardware rasterizer
//! (`raster`) instead of the items, and share all else.
//!
//! # Sums
//! All that many threads write at once is a bit set or an integer sum, so that neither scheduling nor the order
//! of the triangles shows in the result. The sums' scale is chosen voxel by voxel from the surface in it, as
//! large as cannot overflow, and parts are rounded at random (by a hash of triangle and voxel), so that a
//! million parts below the unit still add up.

mod batch;
mod input;
mod kernels;
#[cfg(test)]
mod layouts_test;
mod memory;
mod method;
mod raster;

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroupBuilder, Recorder, ShaderLibrary, StageTime, Timing, read_buffer, storage_buffer,
    uniform_buffer,
};
use crate::voxels::{FaceRecord, ListBuilder, VoxelList};
use crate::{Geometry, GiError, Grid};
use batch::{Fallbacks, SplitBatch, SplitCounts};
use kernels::Kernels;
pub(crate) use memory::{Memory, Remedy};
use method::Step;
pub use method::VoxelizeMethod;
pub(crate) use raster::MODULES as RASTER_MODULES;
use raster::Raster;

/// Columns of voxels along the side of a work item's tile.
const TILE_EDGE: u32 = 4;

/// The shader modules of this stage.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("voxelize::accumulate", include_str!("accumulate.wgsl")),
    ("voxelize::faces", include_str!("faces.wgsl")),
    ("voxelize::footprint", include_str!("footprint.wgsl")),
    ("voxelize::items", include_str!("items.wgsl")),
    ("voxelize::lobes", include_str!("lobes.wgsl")),
    ("voxelize::mark", include_str!("mark.wgsl")),
    ("voxelize::overlap", include_str!("overlap.wgsl")),
    ("voxelize::piece", include_str!("piece.wgsl")),
    ("voxelize::reproducible", include_str!("reproducible.wgsl")),
    ("voxelize::resolve", include_str!("resolve.wgsl")),
    ("voxelize::split", include_str!("split.wgsl")),
    ("voxelize::surface", include_str!("surface.wgsl")),
    ("voxelize::triangles", include_str!("triangles.wgsl")),
    ("voxelize::walk", include_str!("walk.wgsl")),
];

/// Defines the constants that Rust and the shaders of this stage share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("TILE_EDGE", TILE_EDGE)
        .constant_u32("FACE_WORDS", size_of::<FaceRecord>() as u32 / 4)
        .constant_u32("FACE_POSITION", offset_of!(FaceRecord, position_in_world) as u32 / 4)
        .constant_u32("FACE_VECTOR_AREA", offset_of!(FaceRecord, vector_area) as u32 / 4)
        .constant_u32("FACE_REFLECTANCE", offset_of!(FaceRecord, reflectance) as u32 / 4)
        .constant_u32("FACE_EMISSION", offset_of!(FaceRecord, emission) as u32 / 4)
        .constant_u32("DOUBLE_SIDED", input::DOUBLE_SIDED)
        .constant_u32("ALPHA_IS_COVERAGE", input::ALPHA_IS_COVERAGE)
        .constant_u32("HAS_COLORS", input::HAS_COLORS);
    raster::add_constants(library);
}

/// `VoxelFaces` of `faces.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct VoxelFaces {
    lobes: u32,
    area_low: u32,
    area_high: u32,
    first_face: u32,
}

/// `ResolveParams` of `resolve.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct ResolveParams {
    voxel_count: u32,
    emission_scale: f32,
}

/// What a voxelization found and took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VoxelizeStats {
    /// Triangles given.
    pub triangles: u64,
    /// Of those, the ones without an area or with coordinates that are not finite; they are left out.
    pub skipped: u64,
    /// Of those, the ones that lie wholly outside the grid.
    pub outside: u64,
    /// Tiles of triangles: the threads of each walk of [`VoxelizeMethod::Exact`].
    pub work_items: u64,
    /// Pieces of triangles in voxels; those that a rasterizer finds more than once count as often.
    pub fragments: u64,
    /// Occupied voxels.
    pub voxels: u32,
    /// Sides of voxels that have surface.
    pub faces: u32,
    /// Bytes by buffer, those that only the voxelization itself needs included.
    pub bytes: Vec<(String, u64)>,
}

/// The kernels that turn triangles into voxels.
#[derive(Debug)]
pub struct Voxelizer {
    kernels: Kernels,
    /// The pipelines that take the place of the kernels' walks.
    raster: Option<Raster>,
}

impl Voxelizer {
    /// Compiles the kernels of the exact method.
    ///
    /// # Errors
    /// [`GiError::Shader`] when a shader does not link, which is a defect of this crate.
    pub fn new(device: &wgpu::Device, shaders: &ShaderLibrary) -> Result<Self, GiError> {
        Self::with_method(device, shaders, VoxelizeMethod::Exact)
    }

    /// As [`Self::new`], with any method.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_method(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        method: VoxelizeMethod,
    ) -> Result<Self, GiError> {
        let kernels = Kernels::new(device, shaders)?;
        let raster = Raster::new(device, shaders, &kernels.layouts, method)?;
        Ok(Self { kernels, raster })
    }

    /// Voxelizes triangles: the list of voxels, what was found, and the time of each pass if asked for.
    ///
    /// Coordinates are computed in `f32` in units of a voxel: triangles that reach farther than some 10⁵
    /// voxels beyond the grid touch voxels that they miss by a share of a voxel.
    ///
    /// # Errors
    /// [`GiError::Geometry`] when draws and buffers contradict each other, [`GiError::NothingToVoxelize`] when
    /// no voxel is touched, [`GiError::Limit`] when something does not fit the device.
    pub async fn voxelize(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        grid: &Grid,
        geometry: &Geometry,
        timing: Timing,
    ) -> Result<(VoxelList, VoxelizeStats, Vec<StageTime>), GiError> {
        let kernels = &self.kernels;
        let layouts = &kernels.layouts;
        let mut memory = Memory::new(device);
        let mut recorder = Recorder::with_timing(device, queue, timing);
        recorder.stage("voxelize");

        let grid_uniform = uniform_buffer(device, "grid", &grid.to_gpu());
        let globals =
            BindGroupBuilder::new(&layouts.grid).buffer(&grid_uniform).build(device, "grid");
        let emission_scale = input::emission_scale(geometry);
        let batches = self.split(&mut recorder, &mut memory, queue, &globals, grid, geometry)?;

        // Which voxels are touched, and their list.
        let occupied = ListBuilder::begin(&mut memory, grid)?;
        let mark: Vec<_> = batches
            .iter()
            .map(|batch| {
                BindGroupBuilder::new(&layouts.mark)
                    .buffer(&batch.item_starts)
                    .buffer(&occupied.occupancy)
                    .build(device, "voxelize::mark")
            })
            .collect();
        self.walk(&mut recorder, (grid, &globals), &batches, &mark, Step::Mark);
        kernels.list.rank(&mut recorder, &kernels.scan, &globals, grid, &occupied);
        let (level_starts, splits) =
            read_marked(&mut recorder, device, queue, grid, &occupied, &batches).await?;
        let mut stats = stats_of(geometry, &splits)?;
        let voxel_count = level_starts[1];
        if voxel_count == 0 {
            return Err(GiError::NothingToVoxelize {
                triangles: stats.triangles,
                skipped: stats.skipped,
            });
        }
        let node_count = level_starts[grid.levels as usize];
        let nodes =
            kernels.list.list(&mut recorder, &mut memory, &globals, grid, &occupied, node_count)?;

        // Which lobes they have, and how much surface.
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let stride = size_of::<VoxelFaces>() as u64;
        let voxels = memory.buffer("lobes of voxels", u64::from(voxel_count), stride, remedy)?;
        let first_faces = memory.buffer("first faces", u64::from(voxel_count) + 1, 4, remedy)?;
        let pieces = storage_buffer(device, "pieces", 8);
        let lobes: Vec<_> = batches
            .iter()
            .map(|batch| {
                BindGroupBuilder::new(&layouts.lobes)
                    .buffer(&batch.item_starts)
                    .buffer(&occupied.cells)
                    .buffer(&voxels)
                    .buffer(&pieces)
                    .build(device, "voxelize::lobes")
            })
            .collect();
        self.walk(&mut recorder, (grid, &globals), &batches, &lobes, Step::Lobes);
        let faces_group = BindGroupBuilder::new(&layouts.faces)
            .buffer(&voxels)
            .buffer(&first_faces)
            .build(device, "voxelize::faces");
        let faces_groups = [&globals, &faces_group];
        kernels.count_faces.run_linear(&mut recorder, &faces_groups, u64::from(voxel_count));
        kernels.scan.run(&mut recorder, &first_faces, voxel_count + 1);
        kernels.prepare_faces.run_linear(&mut recorder, &faces_groups, u64::from(voxel_count));
        let counts = storage_buffer(device, "face counts", 12);
        let total = u64::from(voxel_count) * 4;
        recorder.encoder().copy_buffer_to_buffer(&first_faces, total, &counts, 0, 4);
        recorder.encoder().copy_buffer_to_buffer(&pieces, 0, &counts, 4, 8);
        recorder.flush();
        let counts: Vec<u32> = read_buffer(device, queue, &counts, 0..12).await?;
        let face_count = counts[0];
        stats.fragments = u64::from(counts[2]) << 32 | u64::from(counts[1]);

        // What is in them.
        let stride = size_of::<FaceRecord>() as u64;
        let faces = memory.buffer("faces", u64::from(face_count), stride, remedy)?;
        let accumulate: Vec<_> = batches
            .iter()
            .map(|batch| {
                BindGroupBuilder::new(&layouts.accumulate)
                    .buffer(&batch.item_starts)
                    .buffer(&occupied.cells)
                    .buffer(&voxels)
                    .buffer(&faces)
                    .build(device, "voxelize::accumulate")
            })
            .collect();
        self.walk(&mut recorder, (grid, &globals), &batches, &accumulate, Step::Accumulate);
        let params = ResolveParams { voxel_count, emission_scale };
        let params = uniform_buffer(device, "resolve parameters", &params);
        let resolve = BindGroupBuilder::new(&layouts.resolve)
            .buffer(&params)
            .buffer(&voxels)
            .buffer(&nodes)
            .buffer(&faces)
            .build(device, "voxelize::resolve");
        let count = u64::from(voxel_count);
        kernels.resolve.run_linear(&mut recorder, &[&globals, &resolve], count);
        kernels.list.inner_lobes(&mut recorder, &globals, grid, &occupied, &nodes, &level_starts);
        let times = recorder.finish().await?;

        stats.voxels = voxel_count;
        stats.faces = face_count;
        stats.bytes = memory.into_bytes();
        let list = VoxelList {
            level_starts,
            face_count,
            occupancy: occupied.occupancy,
            ranks: occupied.ranks,
            nodes,
            first_faces,
            faces,
        };
        Ok((list, stats, times))
    }

    /// Checks the geometry and splits the triangles of all batches into items.
    fn split(
        &self,
        recorder: &mut Recorder,
        memory: &mut Memory<'_>,
        queue: &wgpu::Queue,
        globals: &wgpu::BindGroup,
        grid: &Grid,
        geometry: &Geometry,
    ) -> Result<Vec<SplitBatch>, GiError> {
        input::check_materials(geometry)?;
        let fallbacks = Fallbacks::new(memory.device(), queue);
        let limits = memory.device().limits();
        let emission_scale = input::emission_scale(geometry);
        let mut batches = Vec::new();
        for (index, batch) in geometry.batches.iter().enumerate() {
            let Some(prepared) =
                input::prepare_batch(geometry, index, grid, emission_scale, &limits)?
            else {
                continue;
            };
            batches.push(SplitBatch::new(
                recorder,
                memory,
                &self.kernels,
                globals,
                &fallbacks,
                (batch, &prepared),
                &geometry.materials,
            )?);
        }
        Ok(batches)
    }
}

/// Submits the work so far and reads back where the levels' nodes start and how the batches were split.
async fn read_marked(
    recorder: &mut Recorder,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    grid: &Grid,
    occupied: &crate::voxels::Occupied,
    batches: &[SplitBatch],
) -> Result<(Vec<u32>, Vec<SplitCounts>), GiError> {
    let starts = grid.levels as usize + 1;
    let stride = size_of::<SplitCounts>() as u64;
    let bytes = starts as u64 * 4 + batches.len() as u64 * stride;
    let counts = storage_buffer(device, "voxel counts", bytes);
    let encoder = recorder.encoder();
    ListBuilder::copy_level_starts(encoder, grid, occupied, &counts);
    for (index, batch) in batches.iter().enumerate() {
        let place = starts as u64 * 4 + index as u64 * stride;
        encoder.copy_buffer_to_buffer(&batch.counts, 0, &counts, place, stride);
    }
    recorder.flush();
    let mut words: Vec<u32> = read_buffer(device, queue, &counts, 0..bytes).await?;
    let splits = bytemuck::pod_collect_to_vec(&words[starts..]);
    words.truncate(starts);
    Ok((words, splits))
}

/// The counts so far.
fn stats_of(geometry: &Geometry, splits: &[SplitCounts]) -> Result<VoxelizeStats, GiError> {
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
    let sum = |count: fn(&SplitCounts) -> u32| splits.iter().map(|s| u64::from(count(s))).sum();
    Ok(VoxelizeStats {
        triangles: geometry.triangle_count(),
        skipped: sum(|split| split.degenerate),
        outside: sum(|split| split.outside),
        work_items: sum(|split| split.items),
        fragments: 0,
        voxels: 0,
        faces: 0,
        bytes: Vec::new(),
    })
}
