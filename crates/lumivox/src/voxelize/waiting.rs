//! Voxelization that waits: it reads counts back, and allocates before it continues.

use super::input::{self, ShareInput, ShareKey};
use super::room::{new_list, resized_list};
use super::scene::{Fixed, Taken, VoxelizedScene, with_spare};
use super::share::{Share, ShareCounts, Work};
use super::union::{Union, Verdict};
use super::{VoxelizeStats, Voxelizer};
use crate::cascades::Walked;
use crate::gpu::{
    Buffer, Memory, Recorder, StageTime, Timing, read_buffer, storage_buffer, uniform_buffer,
};
use crate::voxels::VoxelList;
use crate::{Geometry, GiError};

impl Voxelizer {
    /// Voxelizes triangles into the scene's list of voxels. Returns statistics, and the time of
    /// each pass if requested. Static draws are walked only if they have changed: their transforms,
    /// materials or buffers. The caller guarantees that the contents of those buffers have not
    /// changed.
    ///
    /// Coordinates are computed in `f32` in units of a voxel: triangles that extend more than about
    /// 10⁵ voxels beyond the grid may touch voxels that they miss by a fraction of a voxel.
    ///
    /// # Errors
    /// [`GiError::Geometry`] if draws and buffers contradict each other,
    /// [`GiError::NothingToVoxelize`] if no voxel is touched, [`GiError::Limit`] if something does
    /// not fit the device. The list is then unchanged.
    pub async fn voxelize(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
        timing: Timing,
    ) -> Result<(VoxelizeStats, Vec<StageTime>), GiError> {
        let mut recorder = Recorder::with_timing(device, queue, timing);
        let nobody = &mut |_: &mut Recorder<'_>, _: Taken<'_>| {};
        let stats = self.voxelize_into(&mut recorder, scene, geometry, nobody).await?;
        Ok((stats, recorder.finish().await?))
    }

    /// Like [`Self::voxelize`], with a recorder that it submits in between; `follow` is called
    /// before a list is committed.
    pub(crate) async fn voxelize_into(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
        follow: &mut dyn FnMut(&mut Recorder<'_>, Taken<'_>),
    ) -> Result<VoxelizeStats, GiError> {
        input::check_materials(geometry)?;
        let device = recorder.device().clone();
        let placed = scene.wanted.map(|grid| self.placed(&device, grid));
        let (grid, globals) = match &placed {
            Some(placed) => (placed.grid, placed.globals.clone()),
            None => (scene.grid, scene.globals.clone()),
        };
        let limits = device.limits();
        let is_reused = grid == scene.grid && scene.has_fixed(self.method, geometry);
        let walked = Walked::all(&grid);
        // Reused draws are not checked again.
        let fixed_input = if is_reused {
            ShareInput::default()
        } else {
            ShareInput::new(geometry, true, (&grid, &walked), &limits)?
        };
        let moving_input = ShareInput::new(geometry, false, (&grid, &walked), &limits)?;
        if self.walker.is_none() {
            self.kernels.make(fixed_input.details().chain(moving_input.details())).await;
        }
        // Cancels a rebuild in progress.
        (scene.rebuild, scene.late, scene.lacks_room) = (None, None, false);

        recorder.stage("voxelize");
        let mut work = self.work(recorder, &device, &grid, &globals);
        let work = &mut work;

        // Find the touched voxels.
        let mut fixed = None;
        if !fixed_input.is_empty() {
            let mut share = Share::new(work)?;
            share.bind(work, &scene.fallbacks, &fixed_input, geometry)?;
            share.mark(work, fixed_input.draws(), None);
            fixed = Some(share);
        }
        Self::mark_moving(work, scene, &moving_input, geometry)?;
        let replaces = scene.list.is_none()
            || scene.union.is_none()
            || (!is_reused && (fixed.is_some() || scene.fixed.is_some()));
        // If anything fails, the scene has no union, and the list is rebuilt the next time.
        let mut union = match scene.union.take() {
            Some(union) if !replaces => union,
            _ => Union::new(work)?,
        };
        scene.is_bound &= !replaces;
        let kept = scene.fixed.as_ref().filter(|_| is_reused);
        let kept = kept.and_then(|kept| kept.share.as_ref());
        if !scene.is_bound {
            union.bind_shares(work, [fixed.as_ref().or(kept), scene.moving.as_ref()]);
        }
        union.merge(work);
        let of_fixed = fixed.iter().flat_map(Share::marked_counts).collect::<Vec<_>>();
        let of_moving = scene.moving.iter().flat_map(Share::marked_counts).collect::<Vec<_>>();
        let split = [of_fixed.len(), of_fixed.len() + of_moving.len()].map(|sources| {
            let all = of_fixed.iter().chain(&of_moving);
            all.take(sources).map(|source| source.2 as usize / 4).sum::<usize>()
        });
        let starts = union.level_starts(&grid);
        let words = read(work, &[of_fixed, of_moving, starts].concat()).await?;
        let voxels = fixed.as_mut().map(|share| share.take_marked(&words[..split[0]]));
        let voxels = voxels.transpose()?.unwrap_or(0);
        let moved = &words[split[0]..split[1]];
        let moving = scene.moving.as_mut().map(|share| share.take_marked(moved)).transpose()?;
        let moving_voxels = moving.unwrap_or(0);
        let level_starts = words[split[1]..].to_vec();
        let nodes = level_starts.last().copied().map_or(0, u64::from);
        let kept_counts = scene.fixed.as_ref().filter(|_| is_reused).map(|kept| kept.counts);
        if nodes == 0 {
            let counts = fixed.iter().chain(&scene.moving).map(|share| &share.counts);
            let skipped = counts.chain(&kept_counts).map(|counts| counts.degenerate).sum();
            return Err(GiError::NothingToVoxelize {
                triangles: geometry.triangle_count(),
                skipped,
            });
        }

        if let Some(placed) = placed {
            scene.place(placed);
        }

        // Find their planes and the area of their surface.
        if let Some(fixed) = &mut fixed {
            fixed.make_room(work, voxels)?;
            fixed.collect_planes(work, None);
        }
        if let Some(moving) = &mut scene.moving {
            if moving.capacity()[0] < moving_voxels.max(1) {
                moving.make_room(work, with_spare(moving_voxels))?;
                scene.is_bound = false;
            }
            moving.collect_planes(work, None);
        }
        let kept = scene.fixed.as_ref().filter(|_| is_reused);
        let kept = kept.and_then(|kept| kept.share.as_ref());
        if !scene.is_bound {
            union.bind_voxels(work, [fixed.as_ref().or(kept), scene.moving.as_ref()])?;
        }
        union.unite(work);
        let of_fixed = fixed.as_ref().map_or_else(Vec::new, |fixed| fixed.face_counts(voxels));
        let of_moving = scene.moving.as_ref();
        let of_moving = of_moving.map_or_else(Vec::new, |share| share.face_counts(moving_voxels));
        let split =
            [of_fixed.is_empty(), of_moving.is_empty()].map(|none| if none { 0 } else { 3 });
        let united = union.united_count(moving_voxels).into_iter().collect();
        let words = read(work, &[of_fixed, of_moving, united].concat()).await?;
        let (of_fixed, rest) = words.split_at(split[0]);
        let (of_moving, united) = rest.split_at(split[1]);
        let united = united.first().copied().map_or(0, u64::from);

        // Sum up their faces.
        let emission_scale = input::emission_scale(geometry);
        let mut faces = scene.fixed.as_ref().filter(|_| is_reused).map_or(0, |kept| kept.faces);
        if let Some(fixed) = &mut fixed {
            faces = fixed.take_faces(of_fixed);
            let verdict = uniform_buffer(&device, "verdict", &Verdict::of_voxels(voxels));
            fixed.make_room_for_sums(work, faces, &verdict)?;
            fixed.sum_up(work, None);
        }
        if let Some(moving) = &mut scene.moving {
            let needed = moving.take_faces(of_moving);
            if moving.capacity()[1] < needed.max(1) || replaces {
                moving.make_room_for_sums(work, with_spare(needed), union.verdict())?;
                scene.is_bound = false;
            }
        }
        let room = match scene.moving {
            Some(_) => [with_spare(nodes), faces + with_spare(united)],
            None => [nodes, faces],
        };
        let fits = |list: &VoxelList| {
            list.node_capacity() >= nodes && list.face_capacity() >= faces + united
        };
        let mut new_list_or = None;
        if replaces {
            new_list_or = Some(new_list(work, room[0], room[1])?);
        } else if let Some(list) = scene.list.as_ref().filter(|list| !fits(list)) {
            new_list_or = Some(resized_list(work, list, room[0], room[1])?);
        }
        match new_list_or {
            Some(list) if replaces => scene.replace_list(list),
            Some(list) => (scene.list, scene.is_bound) = (Some(list), false),
            None => {}
        }
        if let Some(share) = fixed {
            let (key, counts) = (ShareKey::new(self.method, geometry, &grid), share.counts);
            scene.fixed = Some(Fixed { key, share: Some(share), faces, counts });
        } else if !is_reused {
            scene.fixed = None;
        }
        scene.union = Some(union);
        Self::take(work, scene, emission_scale, follow)?;
        let Some(list) = &mut scene.list else {
            return Ok(VoxelizeStats::default());
        };
        list.level_starts = level_starts;
        list.face_count = (faces + united) as u32;

        let counts = scene.fixed.iter().map(|fixed| &fixed.counts);
        let counts: Vec<&ShareCounts> =
            counts.chain(scene.moving.iter().map(|share| &share.counts)).collect();
        let sum = |count: fn(&ShareCounts) -> u64| counts.iter().copied().map(count).sum();
        let stats = VoxelizeStats {
            triangles: geometry.triangle_count(),
            walked: moving_input.triangle_count() + fixed_input.triangle_count(),
            static_reused: is_reused,
            skipped: sum(|counts| counts.degenerate),
            outside: sum(|counts| counts.outside) + fixed_input.left_out,
            work_items: sum(|counts| counts.items),
            fragments: sum(|counts| counts.pieces),
            voxels: list.voxel_count(),
            faces: list.face_count,
            bytes: std::mem::replace(&mut work.memory, Memory::new(&device)).into_bytes(),
        };
        if scene.moving.is_none() {
            scene.forget_static();
            scene.union = None;
        }
        Ok(stats)
    }
}

/// Submits the recorded work and reads parts of buffers back: buffer, byte offset and number of
/// bytes each.
async fn read(
    work: &mut Work<'_, '_>,
    sources: &[(&Buffer, u64, u64)],
) -> Result<Vec<u32>, GiError> {
    let bytes = sources.iter().map(|source| source.2).sum();
    let counts = storage_buffer(work.memory.device(), "counts", bytes);
    let mut place = 0;
    for (buffer, from, bytes) in sources {
        work.recorder.copy((*buffer, *from), (&counts, place), *bytes);
        place += bytes;
    }
    work.recorder.flush();
    let queue = work.recorder.queue().clone();
    read_buffer(work.memory.device(), &queue, &counts, 0..bytes).await
}
