//! Voxelization for frames: only records commands, and reads results back a few frames later.

use super::Voxelizer;
use super::input::{self, ShareInput, ShareKey};
use super::new_list::{new_list, resized_list};
use super::scene::{Fixed, Rebuild, VoxelizedScene, with_spare};
use super::share::{Share, Work};
use super::union::{Needs, OVERFLOW_VOXELS, Union};
use crate::cascades::Walked;
use crate::gpu::{LastRead, LateReads, OverflowReads, Recorder, uniform_buffer};
use crate::voxels::VoxelList;
use crate::{Geometry, GiError, Grid};

/// Initial capacity for voxels of dynamic surface, before their number is known.
const FIRST_VOXELS: u64 = 64;

/// Maximum number of nodes of all levels for `voxels` voxels.
fn most_nodes(grid: &Grid, voxels: u64) -> u64 {
    let cells = |level| grid.level_dimensions(level).as_u64vec3().element_product();
    (0..grid.levels).map(|level| voxels.min(cells(level))).sum()
}

impl Voxelizer {
    /// Records the voxelization of dynamic draws, up to the list that [`Self::commit`] commits
    /// ([`VoxelizedScene::collected`]), and returns without waiting.
    ///
    /// If a buffer overflows, the list does not change, and the buffers grow a few frames later,
    /// when the read-back arrives. Changed static draws take a few frames, too.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
    ) -> Result<(), GiError> {
        input::check_materials(geometry)?;
        let device = recorder.device().clone();
        let limits = device.limits();
        let emission_scale = input::emission_scale(geometry);
        recorder.stage("voxelize");
        // Finish one move before starting the next, or boxes that always move would never get
        // there.
        if scene.next.is_none() && scene.wanted.is_some() {
            scene.next = scene.first_step().map(|grid| self.placed(&device, grid));
            scene.rebuild = None;
        }
        let is_needed = ShareKey::is_needed(geometry);
        let mut arrived: Option<(Fixed, Option<Union>)> = None;
        if let Some(next) = scene.next.clone() {
            if is_needed {
                arrived = self.rebuild(recorder, scene, geometry, &next.grid)?;
            }
            if arrived.is_some() || !is_needed {
                scene.place(next);
            }
        } else if is_needed && !scene.has_fixed(geometry) {
            arrived = self.rebuild(recorder, scene, geometry, &scene.grid.clone())?;
        } else if is_needed {
            // Static draws match the list again: the rebuild in progress is obsolete.
            scene.rebuild = None;
        }
        let grid = scene.grid;
        let all = Walked::all(&grid);
        let moving_input = ShareInput::new(geometry, false, (&grid, &all), &limits)?;
        let has_moving = scene.moving.is_some() || !moving_input.is_empty();
        let globals = scene.globals.clone();
        let mut work = self.work(recorder, &device, &grid, &globals);
        let work = &mut work;
        Self::apply_reads(work, scene)?;
        if let Some((fixed, union)) = arrived {
            Self::replace(work, scene, Some(fixed), (union, has_moving))?;
        } else if scene.next.is_some() {
            // Until the next grid is ready, the list does not change.
        } else if !is_needed {
            scene.rebuild = None;
            if scene.fixed.is_some() {
                Self::replace(work, scene, None, (None, has_moving))?;
            }
        } else if scene.rebuild.is_some() && scene.union.is_none() {
            // Dynamic surface cannot be united with static surface that is not ready.
            return Ok(());
        }
        Self::mark_moving(work, scene, &moving_input, geometry)?;
        if scene.moving.is_none() && !scene.is_list_new {
            return Ok(());
        }
        if scene.union.is_none() || scene.list.is_none() {
            let fixed = scene.fixed.take();
            Self::replace(work, scene, fixed, (None, has_moving))?;
        }
        if let Some(moving) = &mut scene.moving
            && moving.capacity()[0] == 0
        {
            moving.reserve(work, FIRST_VOXELS)?;
            scene.is_bound = false;
        }
        let Some(mut union) = scene.union.take() else { return Ok(()) };
        if let Some(moving) = &mut scene.moving
            && (moving.capacity()[1] == 0 || scene.is_list_new)
        {
            let capacity = moving.capacity();
            let sums = capacity[1].max(with_spare(capacity[0]));
            moving.reserve_sums(work, sums, union.needs())?;
            scene.is_bound = false;
        }
        if !scene.is_bound {
            union.bind_shares(work, scene.shares());
            union.bind_voxels(work, scene.shares())?;
        }
        union.merge(work);
        if let Some(moving) = &scene.moving {
            moving.collect_planes(work, None);
        }
        union.unite(work);
        scene.union = Some(union);
        Self::collect(work, scene, emission_scale)
    }

    /// Applies finished read-backs.
    pub(crate) fn read_back(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
    ) -> Result<(), GiError> {
        let device = recorder.device().clone();
        let (grid, globals) = (scene.grid, scene.globals.clone());
        Self::apply_reads(&mut self.work(recorder, &device, &grid, &globals), scene)
    }

    /// Applies finished read-backs; grows buffers that overflowed.
    fn apply_reads(work: &mut Work<'_, '_>, scene: &mut VoxelizedScene) -> Result<(), GiError> {
        let Some(words) = scene.late.latest(work.memory.device()) else { return Ok(()) };
        let (needs, counts) = words.split_at(size_of::<Needs>() / 4);
        let needs: Needs = bytemuck::pod_read_unaligned(bytemuck::cast_slice(needs));
        if let Some(list) = &mut scene.list {
            list.know(counts);
        }
        let (Some(moving), Some(list), Some(union)) =
            (&mut scene.moving, &scene.list, &scene.union)
        else {
            return Ok(());
        };
        let [voxels, sums] = moving.capacity();
        let capacity = [list.node_capacity(), list.face_capacity()];
        let fixed = scene.fixed.as_ref().map_or(0, |fixed| fixed.faces);
        let mut needed_sums = u64::from(needs.sums);
        let mut needed_faces = u64::from(needs.moving_faces);
        if needs.overflow & OVERFLOW_VOXELS != 0 {
            let needed = u64::from(needs.moving_voxels);
            // The numbers of these voxels' faces are unknown yet.
            (needed_sums, needed_faces) = (0, 0);
            if voxels < needed {
                moving.reserve(work, with_spare(needed))?;
                scene.is_bound = false;
            }
        }
        let needed = [u64::from(needs.nodes), fixed + needed_faces];
        if capacity[0] < needed[0] || capacity[1] < needed[1] {
            let nodes = capacity[0].max(with_spare(needed[0]));
            let faces = capacity[1].max(fixed + with_spare(needed_faces));
            scene.list = Some(resized_list(work, list, nodes, faces)?);
            scene.is_bound = false;
        }
        if sums < needed_sums {
            moving.reserve_sums(work, with_spare(needed_sums), union.needs())?;
            scene.is_bound = false;
        }
        Ok(())
    }

    /// Advances the rebuild of changed static surface by one step, and returns the surface and the
    /// union of the next list once it is complete. With cascades it walks only surface that has
    /// entered their boxes, and the surroundings of added or removed draws; the rest is copied from
    /// the current share. A rebuild is finished even if draws have changed again, or draws that
    /// always change would starve it.
    fn rebuild(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
        grid: &Grid,
    ) -> Result<Option<(Fixed, Option<Union>)>, GiError> {
        let device = recorder.device().clone();
        let device = &device;
        let kept = scene.fixed.as_ref().filter(|fixed| fixed.share.is_some());
        let is_current = |rebuild: &Rebuild| rebuild.key.suits(geometry, grid);
        let Some(mut rebuild) = scene.rebuild.take().filter(is_current) else {
            let kept = kept.filter(|_| grid.cascades.is_some());
            let changes = kept.and_then(|kept| kept.key.changes(geometry));
            let keeps = changes.is_some();
            let walked = changes.map_or_else(
                || Walked::all(grid),
                |boxes| Walked::changed(grid, &scene.grid, &boxes),
            );
            let globals = self.group_of(device, &grid.uniform_of_walked(&walked, device));
            let work = &mut self.work(recorder, device, grid, &globals);
            let input = ShareInput::new(geometry, true, (grid, &walked), &device.limits())?;
            let mut share = Share::new(work)?;
            share.bind(work, &scene.fallbacks, &input, geometry)?;
            share.counts.left_out = input.left_out;
            let kept = kept.filter(|_| keeps).and_then(|kept| kept.share.as_ref());
            share.mark(work, input.draws(), kept);
            let sources = share.marked_counts();
            let mut reads = LateReads::default();
            reads.record(work.recorder, &sources);
            let key = ShareKey::new(geometry, grid);
            let (voxels, union) = (None, None);
            scene.rebuild = Some(Rebuild { key, globals, keeps, share, voxels, union, reads });
            return Ok(None);
        };
        let kept = kept.filter(|_| rebuild.keeps);
        let kept_share = kept.and_then(|kept| kept.share.as_ref());
        let globals = rebuild.globals.clone();
        let work = &mut self.work(recorder, device, grid, &globals);
        let Some(words) = rebuild.reads.latest(device) else {
            // If its encoder was dropped, the rebuild starts again.
            scene.rebuild = Some(rebuild).filter(|own| own.reads.peek().0 != LastRead::Lost);
            return Ok(None);
        };
        let share = &mut rebuild.share;
        if rebuild.voxels.is_none() {
            let voxels = share.take_marked(&words)?;
            share.reserve(work, voxels)?;
            share.collect_planes(work, kept_share);
            let mut union = Union::new(work)?;
            union.bind_shares(work, [Some(share), None]);
            union.merge(work);
            let mut sources = share.face_counts(voxels);
            sources.push(union.node_count(grid));
            rebuild.reads = LateReads::default();
            rebuild.reads.record(work.recorder, &sources);
            (rebuild.voxels, rebuild.union) = (Some(voxels), Some(union));
            scene.rebuild = Some(rebuild);
            return Ok(None);
        }
        let (faces, nodes) = (share.take_faces(&words), u64::from(words[3]));
        let needs = Needs::of_voxels(share.capacity()[0]);
        let needs = uniform_buffer(device, "needs", &needs);
        share.reserve_sums(work, faces, &needs)?;
        share.sum_up(work, kept_share);
        let Rebuild { key, share, union, .. } = rebuild;
        let counts = kept.map_or(share.counts, |kept| kept.counts);
        Ok(Some((Fixed { key, share: Some(share), faces, nodes, counts }, union)))
    }

    /// Replaces the static surface and the list; `None` removes the static surface. Creates a union
    /// unless one is given. The list has spare capacity only for dynamic surface.
    fn replace(
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        fixed: Option<Fixed>,
        (union, has_moving): (Option<Union>, bool),
    ) -> Result<(), GiError> {
        let [faces, nodes] = fixed.as_ref().map_or([0; 2], |fixed| [fixed.faces, fixed.nodes]);
        let moving = scene.moving.as_ref().map_or(FIRST_VOXELS, |moving| moving.capacity()[0]);
        let [moving, spare] = if has_moving { [moving, with_spare(moving)] } else { [0; 2] };
        // Keep the list's current capacity for dynamic surface.
        let so_far = scene.list.as_ref().map_or(0, VoxelList::face_capacity);
        let before = scene.fixed.as_ref().map_or(0, |fixed| fixed.faces);
        let moving_faces = so_far.saturating_sub(before).max(spare);
        let union = union.map_or_else(|| Union::new(work), Ok)?;
        let nodes = nodes + most_nodes(work.grid, moving);
        let list = new_list(work, nodes, faces + moving_faces)?;
        scene.union = Some(union);
        scene.fixed = fixed;
        scene.replace_list(list);
        // Earlier read-backs belong to the old list.
        scene.late = OverflowReads::default();
        Ok(())
    }
}
