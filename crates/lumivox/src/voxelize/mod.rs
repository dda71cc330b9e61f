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
//! 4. Where a voxel has more surface than one layer, `fronts` walks to find out which of them is in front.
//! 5. `accumulate` walks once more and adds vector area, reflectance, emission and position to the lobe's
//!    integer sums, all but the first of what is not hidden; `resolve` turns them into faces.
//!
//! # Parts
//! What is static and what moves ([`Draw::is_static`](crate::Draw)) are two shares of the surface, each with its own
//! voxels, lobes and sums (`share.rs`). Nothing in a share depends on the other one: not its bits, and not the scale of
//! its sums. So when only dynamic draws changed, the static share is what it was, and the walks are over the dynamic
//! triangles alone. `whole.rs` makes one list of both, the same way whether a share is new or kept: to the bit what
//! a voxelization of everything gives. Where all is static, or nothing, there is one share and no merging.
//!
//! Walking again costs less memory than storing the pieces, of which a fine mesh has millions, and every
//! buffer is sized from counts: of items on the GPU, of voxels and faces by two read-backs.
//!
//! A caller's own [`Voxelization`] may walk in another way than over the items, and shares all else.
//!
//! # Sums
//! All that many threads write at once is a bit set or an integer sum, so that neither scheduling nor the order
//! of the triangles shows in the result. The sums' scale is chosen voxel by voxel from the surface in it, as
//! large as cannot overflow, and shares are rounded at random (by a hash of triangle and voxel), so that a
//! million shares below the unit still add up.

mod batch;
mod hook;
mod input;
mod kernels;
#[cfg(test)]
mod layouts_test;
mod share;
mod walk;
mod whole;

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroupBuilder, Memory, Pipelines, Recorder, ShaderLibrary, StageTime, Timing, read_buffer,
    storage_buffer,
};
use crate::voxels::{FaceRecord, ListBuilder, Occupied, VoxelList};
use crate::{Geometry, GiError, Grid};
use batch::{Fallbacks, SplitCounts};
pub use hook::{Detail, Voxelization, VoxelizationShares, Walk, WalkRun, WalkStep, Walker};
use input::{ShareInput, ShareKey};
use kernels::Kernels;
use share::{LobedShare, MarkedShare, Share, ShareCounts, Work};
use whole::United;

/// Columns of voxels along the side of a work item's tile.
const TILE_EDGE: u32 = 4;

/// Points along the side of a face's raster, where layers of surface may hide each other (`fronts.wgsl`).
const FRONT_SAMPLES: u32 = 4;

/// Words of a face's raster.
const FRONT_WORDS: u32 = FRONT_SAMPLES * FRONT_SAMPLES;

/// The shader modules of this stage.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("voxelize::accumulate", include_str!("accumulate.wgsl")),
    ("voxelize::face_sums", include_str!("face_sums.wgsl")),
    ("voxelize::faces", include_str!("faces.wgsl")),
    ("voxelize::fronts", include_str!("fronts.wgsl")),
    ("voxelize::footprint", include_str!("footprint.wgsl")),
    ("voxelize::items", include_str!("items.wgsl")),
    ("voxelize::lobes", include_str!("lobes.wgsl")),
    ("voxelize::mark", include_str!("mark.wgsl")),
    ("voxelize::merge_bits", include_str!("merge_bits.wgsl")),
    ("voxelize::overlap", include_str!("overlap.wgsl")),
    ("voxelize::piece", include_str!("piece.wgsl")),
    ("voxelize::reproducible", include_str!("reproducible.wgsl")),
    ("voxelize::resolve", include_str!("resolve.wgsl")),
    ("voxelize::resolve_shares", include_str!("resolve_shares.wgsl")),
    ("voxelize::split", include_str!("split.wgsl")),
    ("voxelize::surface", include_str!("surface.wgsl")),
    ("voxelize::triangles", include_str!("triangles.wgsl")),
    ("voxelize::unite", include_str!("unite.wgsl")),
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
        .constant_u32("FACE_GLOSS", offset_of!(FaceRecord, gloss) as u32 / 4)
        .constant_u32("FACE_VISIBLE_AREA", offset_of!(FaceRecord, visible_area) as u32 / 4)
        .constant_u32("FRONT_SAMPLES", FRONT_SAMPLES)
        .constant_u32("FRONT_WORDS", FRONT_WORDS)
        .constant_u32("DOUBLE_SIDED", input::DOUBLE_SIDED)
        .constant_u32("ALPHA_IS_COVERAGE", input::ALPHA_IS_COVERAGE)
        .constant_u32("HAS_COLORS", input::HAS_COLORS)
        .constant_u32("HAS_SHORT_INDICES", input::HAS_SHORT_INDICES);
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
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VoxelizeStats {
    /// Triangles given.
    pub triangles: u64,
    /// Of those, the ones that were walked over: all, or the dynamic ones alone if the static ones were kept.
    pub walked: u64,
    /// Whether what an earlier voxelization found of the static triangles was used again. All that is counted
    /// here is counted with them.
    pub static_reused: bool,
    /// Of the triangles given, the ones without an area or with coordinates that are not finite; they are left out.
    pub skipped: u64,
    /// Of the triangles given, the ones that lie wholly outside the grid.
    pub outside: u64,
    /// Tiles of triangles: the threads of each exact walk.
    pub work_items: u64,
    /// Pieces of triangles in voxels; those that a walk finds more than once count as often.
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
    /// The name of the way to find voxels.
    method: &'static str,
    kernels: Kernels,
    /// The caller's way, which takes the place of the kernels' walks.
    walker: Option<Box<dyn Walker>>,
}

impl Voxelizer {
    /// Links the kernels, which walk exactly.
    ///
    /// # Errors
    /// [`GiError::Shader`] when a shader does not link, which is a defect of this crate.
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary) -> Result<Self, GiError> {
        Self::with(device, shaders, None)
    }

    /// As [`Self::new`], with the caller's own way to find voxels, if there is one.
    ///
    /// # Errors
    /// As [`Self::new`], and those of that way.
    pub fn with(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        voxelization: Option<&dyn Voxelization>,
    ) -> Result<Self, GiError> {
        let kernels = Kernels::new(device, shaders, voxelization)?;
        let shares = VoxelizationShares { device, shaders, layouts: &kernels.layouts };
        let walker = voxelization.map(|own| own.make(&shares)).transpose()?;
        let method = voxelization.map_or("exact", Voxelization::name);
        Ok(Self { method, kernels, walker })
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
        let mut nothing = KeptStatic::default();
        self.voxelize_dynamic(device, queue, grid, geometry, timing, &mut nothing).await
    }

    /// As [`Self::voxelize`], but what `kept` has of static draws is used again instead of walking them, if they
    /// are the same: the same transforms, materials and buffers. That those buffers' content is the same, too,
    /// is the caller's promise. Then `kept` has what is to be kept for the next time.
    ///
    /// The list is that of [`Self::voxelize`] to the bit.
    ///
    /// # Errors
    /// As [`Self::voxelize`]. What is kept then, if anything, is still right.
    pub async fn voxelize_dynamic(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        grid: &Grid,
        geometry: &Geometry,
        timing: Timing,
        kept: &mut KeptStatic,
    ) -> Result<(VoxelList, VoxelizeStats, Vec<StageTime>), GiError> {
        input::check_materials(geometry)?;
        let limits = device.limits();
        let earlier = kept.0.take().filter(|kept| kept.key.is_of(self.method, geometry, grid));
        let (key, earlier) = earlier.map(|kept| (kept.key, kept.share)).unzip();
        let is_reused = earlier.is_some();
        // What is used again is not looked at.
        let fixed = if is_reused {
            ShareInput::default()
        } else {
            ShareInput::new(geometry, true, grid, &limits)?
        };
        let moving = ShareInput::new(geometry, false, grid, &limits)?;

        let mut recorder = Recorder::with_timing(device, queue, timing);
        recorder.stage("voxelize");
        let grid_uniform = grid.uniform(device);
        let globals = BindGroupBuilder::new(&self.kernels.layouts.grid);
        let mut work = Work {
            voxelizer: self,
            kernels: &self.kernels,
            device,
            grid,
            globals: globals.buffer(&grid_uniform).build(device, "grid"),
            recorder,
            memory: Memory::new(device),
        };
        let fallbacks = Fallbacks::new(device, queue);

        // Which voxels are touched.
        let mut mark = |input: &ShareInput<'_>| {
            (!input.is_empty())
                .then(|| MarkedShare::new(&mut work, &fallbacks, input, geometry))
                .transpose()
        };
        let marked = [mark(&fixed)?, mark(&moving)?];
        let occupied = |share: usize| {
            let earlier = earlier.as_ref().filter(|_| share == 0).map(|share| &share.occupied);
            marked[share].as_ref().map(|marked| &marked.occupied).or(earlier)
        };
        let merged = match (occupied(0), occupied(1)) {
            (Some(first), Some(second)) => Some(whole::merge_bits(&mut work, [first, second])?),
            _ => None,
        };
        let counted = read_marked(&mut work, queue, &marked, merged.as_ref()).await?;

        // Which lobes they have, and how much surface.
        let mut lobed = [None, None];
        for (share, marked) in marked.into_iter().enumerate() {
            let Some(marked) = marked else { continue };
            let (starts, splits) = (&counted.starts[share], &counted.splits[share]);
            check_numbering(splits)?;
            lobed[share] = Some(marked.collect_lobes(&mut work, starts.clone(), splits)?);
        }
        let shares: Vec<&Share> =
            earlier.iter().chain(lobed.iter().flatten().map(|l| &l.share)).collect();
        let stats = stats_of(geometry, &shares);
        let is_nothing = shares.iter().all(|share| share.level_starts[1] == 0);
        if is_nothing {
            let VoxelizeStats { triangles, skipped, .. } = stats;
            return Err(GiError::NothingToVoxelize { triangles, skipped });
        }
        let united = match (merged, shares.as_slice()) {
            (Some(merged), &[first, second]) => {
                let starts = counted.starts[2].clone();
                Some(United::new(&mut work, merged, starts, [first, second])?)
            }
            _ => None,
        };
        let (face_counts, united_faces) =
            read_lobed(&mut work, queue, &lobed, united.as_ref()).await?;

        // What is in them.
        let mut shares: Vec<Share> = earlier.into_iter().collect();
        for (lobed, counts) in lobed.into_iter().flatten().zip(&face_counts) {
            shares.push(lobed.sum_up(&mut work, counts)?);
        }
        let emission_scale = input::emission_scale(geometry);
        let list = match (united, shares.as_slice()) {
            (Some(united), [first, second]) => {
                let sums = [&first.sums, &second.sums];
                united.resolve(&mut work, sums, united_faces, emission_scale)?
            }
            (_, shares) => whole::list_of_one(&mut work, &shares[0], is_reused, emission_scale)?,
        };

        let parts_now: Vec<&Share> = shares.iter().collect();
        let walked = moving.triangle_count() + fixed.triangle_count();
        let mut stats = VoxelizeStats {
            walked,
            static_reused: is_reused,
            voxels: list.voxel_count(),
            faces: list.face_count,
            ..stats_of(geometry, &parts_now)
        };
        // A static share that stood alone has become the list.
        if is_reused || !(fixed.is_empty() || moving.is_empty()) {
            let share = shares.swap_remove(0);
            let key = key.unwrap_or_else(|| ShareKey::new(self.method, geometry, grid));
            kept.0 = Some(Kept { key, share });
        }
        let Work { recorder, memory, .. } = work;
        stats.bytes = memory.into_bytes();
        Ok((list, stats, recorder.finish().await?))
    }
}

/// What a voxelization keeps of static draws, so that the next one need not walk them again. Empty at first.
#[derive(Debug, Default)]
pub struct KeptStatic(Option<Kept>);

#[derive(Debug)]
struct Kept {
    key: ShareKey,
    share: Share,
}

impl KeptStatic {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.0.as_ref().map_or(0, |kept| kept.share.bytes())
    }
}

/// What is known once the voxels are marked.
struct Counted {
    /// Where the levels' nodes start: of the two shares and of both together, empty for what is not there.
    starts: [Vec<u32>; 3],
    /// How the shares' batches were split.
    splits: [Vec<SplitCounts>; 2],
}

/// Submits the work so far and reads back where the levels' nodes start and how the batches were split.
async fn read_marked(
    work: &mut Work<'_>,
    queue: &wgpu::Queue,
    marked: &[Option<MarkedShare>; 2],
    merged: Option<&Occupied>,
) -> Result<Counted, GiError> {
    let [fixed, moving] = marked;
    let lists = [fixed, moving].map(|share| share.as_ref().map(|share| &share.occupied));
    let lists = [lists[0], lists[1], merged];
    let splits = marked
        .each_ref()
        .map(|share| share.iter().flat_map(MarkedShare::split_counts).collect::<Vec<_>>());
    let start_bytes = 4 * (u64::from(work.grid.levels) + 1);
    let stride = size_of::<SplitCounts>() as u64;
    let list_count = lists.iter().flatten().count() as u64;
    let split_count = splits.iter().flatten().count() as u64;
    let bytes = list_count * start_bytes + split_count * stride;
    if bytes == 0 {
        return Ok(Counted { starts: Default::default(), splits: Default::default() });
    }
    let counts = storage_buffer(work.device, "voxel counts", bytes);
    let recorder = &mut work.recorder;
    let mut place = 0;
    for list in lists.into_iter().flatten() {
        ListBuilder::copy_level_starts(recorder, work.grid, list, (&counts, place));
        place += start_bytes;
    }
    for &split in splits.iter().flatten() {
        recorder.copy((split, 0), (&counts, place), stride);
        place += stride;
    }
    work.recorder.flush();
    let words: Vec<u32> = read_buffer(work.device, queue, &counts, 0..bytes).await?;
    let (starts, rest) = words.split_at((list_count * start_bytes / 4) as usize);
    let mut starts = starts.chunks_exact(start_bytes as usize / 4).map(<[u32]>::to_vec);
    let mut rest = rest.chunks_exact(stride as usize / 4);
    Ok(Counted {
        starts: lists.map(|list| list.and_then(|_| starts.next()).unwrap_or_default()),
        splits: splits
            .map(|buffers| rest.by_ref().take(buffers.len()).map(split_from_words).collect()),
    })
}

fn split_from_words(words: &[u32]) -> SplitCounts {
    bytemuck::pod_read_unaligned(bytemuck::cast_slice(words))
}

/// Submits the work so far and reads back the counts of each share that was walked
/// ([`LobedShare::copy_counts`]), and the number of faces of both together.
async fn read_lobed(
    work: &mut Work<'_>,
    queue: &wgpu::Queue,
    lobed: &[Option<LobedShare>; 2],
    united: Option<&United>,
) -> Result<(Vec<Vec<u32>>, u32), GiError> {
    let shares: Vec<&LobedShare> = lobed.iter().flatten().collect();
    let words = shares.len() * LobedShare::COUNT_WORDS + usize::from(united.is_some());
    if words == 0 {
        return Ok((Vec::new(), 0));
    }
    let bytes = words as u64 * 4;
    let counts = storage_buffer(work.device, "face counts", bytes);
    let recorder = &mut work.recorder;
    for (index, share) in shares.iter().enumerate() {
        share.copy_counts(recorder, &counts, (index * LobedShare::COUNT_WORDS) as u64 * 4);
    }
    if let Some(united) = united {
        united.copy_face_count(recorder, &counts, bytes - 4);
    }
    work.recorder.flush();
    let words: Vec<u32> = read_buffer(work.device, queue, &counts, 0..bytes).await?;
    let of_parts = words.chunks_exact(LobedShare::COUNT_WORDS).take(shares.len());
    let united_faces = words.last().copied().unwrap_or(0);
    Ok((of_parts.map(<[u32]>::to_vec).collect(), united_faces))
}

/// Refuses batches that have more items than can be numbered.
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

/// The counts of all shares together.
fn stats_of(geometry: &Geometry, shares: &[&Share]) -> VoxelizeStats {
    let sum =
        |count: fn(&ShareCounts) -> u64| shares.iter().map(|share| count(&share.counts)).sum();
    VoxelizeStats {
        triangles: geometry.triangle_count(),
        walked: 0,
        static_reused: false,
        skipped: sum(|counts| counts.degenerate),
        outside: sum(|counts| counts.outside),
        work_items: sum(|counts| counts.items),
        fragments: sum(|counts| counts.pieces),
        voxels: 0,
        faces: 0,
        bytes: Vec::new(),
    }
}
