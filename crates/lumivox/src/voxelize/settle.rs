//! Voxelization that waits: it records frames until nothing is late.

use super::input::{self, ShareInput};
use super::scene::{FrameVoxels, VoxelizedScene};
use super::share::ShareCounts;
use super::{VoxelizeStats, Voxelizer};
use crate::cascades::Walked;
use crate::gpu::{Recorder, read_buffer, storage_buffer};
use crate::voxels::VoxelList;
use crate::{Geometry, GiError};

impl Voxelizer {
    /// Compiles the kernels, and cancels a rebuild in progress. Returns `true` if static surface is
    /// kept.
    pub(crate) async fn begin(
        &self,
        device: &wgpu::Device,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
    ) -> Result<bool, GiError> {
        input::check_materials(geometry)?;
        let triangles = geometry.triangle_count();
        if triangles == 0 {
            return Err(GiError::NothingToVoxelize { triangles, skipped: 0 });
        }
        scene.rebuild = None;
        scene.next = scene.wanted.map(|grid| self.placed(device, grid));
        let is_reused = scene.next.is_none() && scene.has_fixed(geometry);
        if !is_reused {
            scene.forget_static();
        }
        if self.walker.is_none() {
            let grid = scene.next.as_ref().map_or(&scene.grid, |next| &next.grid);
            let (limits, all) = (device.limits(), Walked::all(grid));
            let share = |is_static| ShareInput::new(geometry, is_static, (grid, &all), &limits);
            let fixed = if is_reused { ShareInput::default() } else { share(true)? };
            self.kernels.make(fixed.details().chain(share(false)?.details())).await;
        }
        Ok(is_reused)
    }

    /// Reads the counts of a finished voxelization, and frees data that no update needs.
    pub(crate) async fn complete(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
        is_reused: bool,
    ) -> Result<VoxelizeStats, GiError> {
        self.read_back(recorder, scene)?;
        if let Some(moving) = &mut scene.moving {
            // Uses only the number of pieces of the faces' counts.
            let sources = [moving.marked_counts(), moving.face_counts(0)];
            let bytes = sources[0].iter().map(|source| source.2 as usize).sum::<usize>();
            let words = read(recorder, &sources.concat()).await?;
            let (marked, faces) = words.split_at(bytes / 4);
            moving.take_marked(marked)?;
            moving.take_faces(faces);
        }
        let counts = scene.fixed.iter().map(|fixed| &fixed.counts);
        let counts: Vec<&ShareCounts> =
            counts.chain(scene.moving.iter().map(|share| &share.counts)).collect();
        let sum = |count: fn(&ShareCounts) -> u64| counts.iter().copied().map(count).sum();
        let walked = counts.iter().skip(usize::from(is_reused));
        let stats = VoxelizeStats {
            triangles: geometry.triangle_count(),
            walked: walked.map(|counts| counts.triangles).sum(),
            static_reused: is_reused,
            skipped: sum(|counts| counts.degenerate),
            outside: sum(|counts| counts.outside + counts.left_out),
            work_items: sum(|counts| counts.items),
            fragments: sum(|counts| counts.pieces),
            voxels: scene.list().map_or(0, VoxelList::voxel_count),
            faces: scene.list().map_or(0, |list| list.face_count),
        };
        if scene.moving.is_none() {
            scene.forget_static();
            scene.union = None;
        }
        if stats.voxels == 0 {
            let (triangles, skipped) = (stats.triangles, stats.skipped);
            return Err(GiError::NothingToVoxelize { triangles, skipped });
        }
        Ok(stats)
    }
}

impl VoxelizedScene {
    /// Cancels the rebuild of static surface if that touches no voxel and there is no dynamic
    /// surface.
    ///
    /// # Errors
    /// [`GiError::NothingToVoxelize`] if so.
    pub(crate) fn refuse_nothing(&mut self, geometry: &Geometry) -> Result<(), GiError> {
        let skipped = match &self.rebuild {
            Some(rebuild) if rebuild.voxels == Some(0) => rebuild.share.counts.degenerate,
            _ => return Ok(()),
        };
        let draws = || geometry.batches.iter().flat_map(|batch| &batch.draws);
        if draws().any(|draw| !draw.is_static && draw.index_count > 0) {
            return Ok(());
        }
        (self.rebuild, self.next) = (None, None);
        Err(GiError::NothingToVoxelize { triangles: geometry.triangle_count(), skipped })
    }
}

/// Submits the recorded commands, and waits until their results are known.
///
/// # Errors
/// [`GiError::Device`] if the device is lost.
pub(crate) async fn known(
    recorder: &mut Recorder<'_>,
    scene: &VoxelizedScene,
    status: impl Fn() -> FrameVoxels,
) -> Result<FrameVoxels, GiError> {
    loop {
        recorder.flush();
        let (device, queue) = (recorder.device(), recorder.queue());
        read_buffer::<u32>(device, queue, scene.changed(), 0..4).await?;
        let frame = status();
        if !frame.is_pending {
            return Ok(frame);
        }
        // Another thread that polls the device may be about to deliver the results.
        std::thread::yield_now();
    }
}

/// Submits the recorded work and reads parts of buffers back: buffer, byte offset and number of
/// bytes each.
async fn read(
    recorder: &mut Recorder<'_>,
    sources: &[(&crate::gpu::Buffer, u64, u64)],
) -> Result<Vec<u32>, GiError> {
    let bytes = sources.iter().map(|source| source.2).sum();
    let (device, queue) = (recorder.device().clone(), recorder.queue().clone());
    let counts = storage_buffer(&device, "counts", bytes);
    let mut place = 0;
    for (buffer, from, bytes) in sources {
        recorder.copy((*buffer, *from), (&counts, place), *bytes);
        place += bytes;
    }
    recorder.flush();
    read_buffer(&device, &queue, &counts, 0..bytes).await
}
