//! The voxels of a scene, as its triangles change.
//!
//! Static surface is collected once, in buffers that are as large as needed. What moves is collected again at each change,
//! in buffers with room to spare, and the list is changed in place. [`Voxelizer::voxelize`] waits for counts and makes
//! room before it goes on. [`Voxelizer::record`] only records, hears of the counts a few frames late, and makes room
//! then; until there is room, the list stays what it was.

use super::batch::Fallbacks;
use super::input::{self, ShareInput, ShareKey};
use super::share::{Share, ShareCounts, Work};
use super::union::{
    Moving, NO_ROOM_FOR_VOXELS, Union, Verdict, new_list, renew, resized_list, resolve_fixed,
};
use super::{FRONT_WORDS, VoxelizeStats, Voxelizer};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LateReads, Memory, Pipelines, Recorder, StageTime, Timing,
    read_buffer, storage_buffer, uniform_buffer,
};
use crate::voxels::{FaceRecord, VoxelList, count_bytes, level_first_word};
use crate::{Geometry, GiError, Grid};

/// Voxels that dynamic surface is given room for before it is known how many it touches.
const FIRST_VOXELS: u64 = 4096;

/// The voxels of a scene, and what is kept to make them again when some of its triangles have moved.
#[derive(Debug)]
pub struct VoxelizedScene {
    grid: Grid,
    /// Group 0.
    globals: BindGroup,
    fallbacks: Fallbacks,
    fixed: Option<Fixed>,
    moving: Option<Share>,
    union: Option<Union>,
    /// Whether the union is bound to the shares and the list as they are.
    is_bound: bool,
    list: Option<VoxelList>,
    /// A bit per cell, laid out as the list's occupancy: cells of another surface than before. Whoever follows the list
    /// clears them.
    changed: Buffer,
    /// The verdicts and counts of recorded voxelizations.
    late: Option<LateReads>,
    /// The last verdict that was heard of: there was no room.
    lacks_room: bool,
    rebuild: Option<Rebuild>,
}

/// Static surface.
#[derive(Debug)]
struct Fixed {
    key: ShareKey,
    /// Nothing where nothing moves: then nobody would ask for it.
    share: Option<Share>,
    faces: u64,
    counts: ShareCounts,
}

/// Static surface that is on its way, a step at a time, while the list stays what it was.
#[derive(Debug)]
struct Rebuild {
    key: ShareKey,
    share: Share,
    /// Once its voxels are counted.
    voxels: Option<u64>,
    reads: LateReads,
}

/// A list that is about to be taken.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taken<'a> {
    /// The list.
    pub list: &'a VoxelList,
    /// The one that it comes in the place of, unless it is that one itself.
    pub replaced: Option<&'a VoxelList>,
    /// The faces that it will take.
    pub moving: Moving<'a>,
}

/// How a recorded voxelization stands, as far as the GPU has told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameVoxels {
    /// The voxels are those of an earlier frame: there was no room for all that was found, or static surface is on its way.
    pub is_late: bool,
    /// Occupied voxels.
    pub voxels: u32,
    /// Sides of voxels that have surface.
    pub faces: u32,
}

impl VoxelizedScene {
    /// No voxels yet.
    fn new(device: &Pipelines, queue: &wgpu::Queue, voxelizer: &Voxelizer, grid: &Grid) -> Self {
        let globals = BindGroupBuilder::new(&voxelizer.kernels.layouts.grid);
        let words = level_first_word(grid, grid.levels);
        Self {
            grid: *grid,
            globals: globals.buffer(&grid.uniform(device)).build(device, "grid"),
            fallbacks: Fallbacks::new(device, queue),
            fixed: None,
            moving: None,
            union: None,
            is_bound: false,
            list: None,
            changed: storage_buffer(device, "changed", words * 4),
            late: None,
            lacks_room: false,
            rebuild: None,
        }
    }

    /// The list of voxels, once there is one.
    pub fn list(&self) -> Option<&VoxelList> {
        self.list.as_ref()
    }

    /// A bit per cell, laid out as the list's occupancy: cells of another surface than before. Who follows the list
    /// clears them.
    pub(crate) fn changed(&self) -> &Buffer {
        &self.changed
    }

    /// Forgets what is kept of static draws, so that they are voxelized again.
    pub fn forget_static(&mut self) {
        if let Some(fixed) = &mut self.fixed {
            fixed.share = None;
        }
    }

    /// Bytes on the GPU of what is kept of static draws, and of what the voxels of dynamic ones are collected in.
    pub fn kept_bytes(&self) -> u64 {
        let fixed = self.fixed.iter().flat_map(|fixed| &fixed.share);
        let shares: u64 = fixed.chain(&self.moving).map(Share::bytes).sum();
        shares + self.union.as_ref().map_or(0, Union::bytes)
    }

    /// How it stands.
    fn frame(&self, is_late: bool) -> FrameVoxels {
        let list = self.list.as_ref();
        FrameVoxels {
            is_late,
            voxels: list.map_or(0, VoxelList::voxel_count),
            faces: list.map_or(0, |list| list.face_count),
        }
    }

    /// The shares: static and dynamic.
    fn shares(&self) -> [Option<&Share>; 2] {
        [self.fixed.as_ref().and_then(|fixed| fixed.share.as_ref()), self.moving.as_ref()]
    }

    /// Whether static draws are what they were, and what was found of them is there.
    fn has_fixed(&self, method: &str, geometry: &Geometry) -> bool {
        self.fixed.as_ref().is_some_and(|fixed| {
            fixed.share.is_some() && fixed.key.is_of(method, geometry, &self.grid)
        })
    }
}

/// Room for a number that grows: a quarter to spare.
fn with_spare(count: u64) -> u64 {
    count + count / 4 + 64
}

/// Room for the sums of faces with their fronts, in faces, as `verdict.wgsl` counts it.
fn sums_for(faces: u64, fronts: u64) -> u64 {
    faces + (fronts * u64::from(FRONT_WORDS) * 4).div_ceil(size_of::<FaceRecord>() as u64)
}

/// The most nodes that so many voxels can have in all levels.
fn most_nodes(grid: &Grid, voxels: u64) -> u64 {
    let cells = |level| grid.level_dimensions(level).as_u64vec3().element_product();
    (0..grid.levels).map(|level| voxels.min(cells(level))).sum()
}

impl Voxelizer {
    /// A scene without voxels.
    pub fn scene(&self, device: &Pipelines, queue: &wgpu::Queue, grid: &Grid) -> VoxelizedScene {
        VoxelizedScene::new(device, queue, self, grid)
    }

    /// Voxelizes triangles: the list of voxels is in the scene then. What was found, and the time of each pass if asked
    /// for, are returned. Static draws are walked only if they are not what they were: the same transforms,
    /// materials and buffers. That those buffers' content is the same, too, is the caller's promise.
    ///
    /// Coordinates are computed in `f32` in units of a voxel: triangles that reach farther than some 10⁵
    /// voxels beyond the grid touch voxels that they miss by a share of a voxel.
    ///
    /// # Errors
    /// [`GiError::Geometry`] when draws and buffers contradict each other, [`GiError::NothingToVoxelize`] when
    /// no voxel is touched, [`GiError::Limit`] when something does not fit the device. The list is what it was then.
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

    /// As [`Self::voxelize`], with a recorder that it submits in between, and somebody who follows the list.
    pub(crate) async fn voxelize_into(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
        follow: &mut dyn FnMut(&mut Recorder<'_>, Taken<'_>),
    ) -> Result<VoxelizeStats, GiError> {
        input::check_materials(geometry)?;
        let (device, grid) = (recorder.device().clone(), scene.grid);
        let limits = device.limits();
        let is_reused = scene.has_fixed(self.method, geometry);
        // What is used again is not looked at.
        let fixed_input = if is_reused {
            ShareInput::default()
        } else {
            ShareInput::new(geometry, true, &grid, &limits)?
        };
        let moving_input = ShareInput::new(geometry, false, &grid, &limits)?;
        // Whatever was on its way comes too late.
        (scene.rebuild, scene.late, scene.lacks_room) = (None, None, false);

        recorder.stage("voxelize");
        let globals = scene.globals.clone();
        let mut work = self.work(recorder, &device, &grid, &globals);
        let work = &mut work;

        // Which voxels are touched.
        let mut fixed = None;
        if !fixed_input.is_empty() {
            let mut share = Share::new(work)?;
            share.bind(work, &scene.fallbacks, &fixed_input, geometry)?;
            share.mark(work, fixed_input.draws());
            fixed = Some(share);
        }
        self.mark_moving(work, scene, &moving_input, geometry)?;
        let replaces = scene.list.is_none()
            || scene.union.is_none()
            || (!is_reused && (fixed.is_some() || scene.fixed.is_some()));
        // Without the union, should anything fail, all is made anew the next time.
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

        // Which lobes they have, and how much surface.
        if let Some(fixed) = &mut fixed {
            fixed.make_room(work, voxels)?;
            fixed.collect_lobes(work);
        }
        if let Some(moving) = &mut scene.moving {
            if moving.capacity()[0] < moving_voxels.max(1) {
                moving.make_room(work, with_spare(moving_voxels))?;
                scene.is_bound = false;
            }
            moving.collect_lobes(work);
        }
        let kept = scene.fixed.as_ref().filter(|_| is_reused);
        let kept = kept.and_then(|kept| kept.share.as_ref());
        if !scene.is_bound {
            union.bind_voxels(work, [fixed.as_ref().or(kept), scene.moving.as_ref()])?;
        }
        union.unite(work);
        let of_fixed = fixed.as_ref().map_or_else(Vec::new, |fixed| fixed.lobed_counts(voxels));
        let of_moving = scene.moving.as_ref();
        let of_moving = of_moving.map_or_else(Vec::new, |share| share.lobed_counts(moving_voxels));
        let split =
            [of_fixed.is_empty(), of_moving.is_empty()].map(|none| if none { 0 } else { 4 });
        let united = union.united_count(moving_voxels).into_iter().collect();
        let words = read(work, &[of_fixed, of_moving, united].concat()).await?;
        let (of_fixed, rest) = words.split_at(split[0]);
        let (of_moving, united) = rest.split_at(split[1]);
        let united = united.first().copied().map_or(0, u64::from);

        // What is in them.
        let emission_scale = input::emission_scale(geometry);
        let mut faces = scene.fixed.as_ref().filter(|_| is_reused).map_or(0, |kept| kept.faces);
        if let Some(fixed) = &mut fixed {
            let [count, fronts] = fixed.take_lobed(of_fixed);
            faces = count;
            let verdict = Verdict::of_fronts(fronts);
            let verdict = uniform_buffer(&device, "verdict", &verdict);
            fixed.make_room_for_sums(work, sums_for(count, fronts), &verdict)?;
            fixed.sum_up(work);
        }
        if let Some(moving) = &mut scene.moving {
            let [count, fronts] = moving.take_lobed(of_moving);
            let needed = sums_for(count, fronts);
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
        scene.is_bound &= new_list_or.is_none();
        let replaced = new_list_or.and_then(|list| scene.list.replace(list)).filter(|_| replaces);
        if let Some(share) = fixed {
            let (key, counts) = (ShareKey::new(self.method, geometry, &grid), share.counts);
            scene.fixed = Some(Fixed { key, share: Some(share), faces, counts });
        } else if !is_reused {
            scene.fixed = None;
        }
        scene.union = Some(union);
        self.take(work, scene, (replaces, replaced.as_ref()), emission_scale, follow)?;
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
            outside: sum(|counts| counts.outside),
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

    /// Records the voxelization of what moves, and returns without waiting.
    ///
    /// The list is the same as that of [`Self::voxelize`], unless there is no room for it: then it stays what it was, and a
    /// few frames later, when that is known here, there is. Static draws that are not what they were take a few frames, too.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder<'_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
        follow: &mut dyn FnMut(&mut Recorder<'_>, Taken<'_>),
    ) -> Result<FrameVoxels, GiError> {
        input::check_materials(geometry)?;
        let (device, grid) = (recorder.device().clone(), scene.grid);
        let limits = device.limits();
        let moving_input = ShareInput::new(geometry, false, &grid, &limits)?;
        let emission_scale = input::emission_scale(geometry);
        recorder.stage("voxelize");
        let globals = scene.globals.clone();
        let mut work = self.work(recorder, &device, &grid, &globals);
        let work = &mut work;
        let mut is_late = self.hear(work, scene)?;
        let mut replaced = (false, None);
        if !scene.has_fixed(self.method, geometry) {
            is_late = true;
            if let Some(fixed) = self.rebuild(work, scene, geometry)? {
                replaced = self.replace(work, scene, fixed)?;
                is_late = false;
            }
        }
        self.mark_moving(work, scene, &moving_input, geometry)?;
        if scene.moving.is_none() && !replaced.0 {
            return Ok(scene.frame(is_late));
        }
        if scene.union.is_none() || scene.list.is_none() {
            let fixed = scene.fixed.take();
            replaced = self.replace(work, scene, fixed)?;
        }
        if let Some(moving) = &mut scene.moving
            && moving.capacity()[0] == 0
        {
            moving.make_room(work, FIRST_VOXELS)?;
            scene.is_bound = false;
        }
        let Some(mut union) = scene.union.take() else { return Ok(scene.frame(is_late)) };
        if let Some(moving) = &mut scene.moving
            && (moving.capacity()[1] == 0 || replaced.0)
        {
            let capacity = moving.capacity();
            let sums = capacity[1].max(2 * capacity[0]);
            moving.make_room_for_sums(work, sums, union.verdict())?;
            scene.is_bound = false;
        }
        if !scene.is_bound {
            union.bind_shares(work, scene.shares());
            union.bind_voxels(work, scene.shares())?;
        }
        union.merge(work);
        if let Some(moving) = &scene.moving {
            moving.collect_lobes(work);
        }
        union.unite(work);
        scene.union = Some(union);
        let (is_new, replaced) = replaced;
        self.take(work, scene, (is_new, replaced.as_ref()), emission_scale, follow)?;
        let bytes = size_of::<Verdict>() as u64 + count_bytes(grid.levels);
        let late = scene.late.get_or_insert_with(|| LateReads::new(&device, bytes));
        if let Some((union, list)) = scene.union.as_ref().zip(scene.list.as_ref()) {
            let verdict = (union.verdict(), 0, size_of::<Verdict>() as u64);
            late.record(work.recorder, &[verdict, (&list.counts, 0, list.counts.size())]);
        }
        Ok(scene.frame(is_late))
    }

    fn work<'a, 'r>(
        &'a self,
        recorder: &'a mut Recorder<'r>,
        device: &'a wgpu::Device,
        grid: &'a Grid,
        globals: &'a BindGroup,
    ) -> Work<'a, 'r> {
        let memory = Memory::new(device);
        Work { voxelizer: self, kernels: &self.kernels, grid, globals, recorder, memory }
    }

    /// Marks the voxels of what moves, if anything ever did.
    fn mark_moving(
        &self,
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        input: &ShareInput<'_>,
        geometry: &Geometry,
    ) -> Result<(), GiError> {
        if scene.moving.is_none() && !input.is_empty() {
            scene.moving = Some(Share::new(work)?);
            scene.is_bound = false;
        }
        if let Some(moving) = &mut scene.moving {
            moving.bind(work, &scene.fallbacks, input, geometry)?;
            moving.mark(work, input.draws());
        }
        Ok(())
    }

    /// The list from what was collected, if there is room.
    fn take(
        &self,
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        (is_new, replaced): (bool, Option<&VoxelList>),
        emission_scale: f32,
        follow: &mut dyn FnMut(&mut Recorder<'_>, Taken<'_>),
    ) -> Result<(), GiError> {
        let fixed = scene.fixed.as_ref();
        let fixed_faces = fixed.map_or(0, |fixed| fixed.faces as u32);
        let Some(mut union) = scene.union.take() else { return Ok(()) };
        let Some(list) = scene.list.as_ref() else { return Ok(()) };
        if is_new && let Some(share) = fixed.and_then(|fixed| fixed.share.as_ref()) {
            resolve_fixed(work, share, list, emission_scale);
        }
        if !scene.is_bound {
            union.bind_list(work, scene.shares(), (list, fixed_faces), &scene.changed)?;
        }
        union.judge(work);
        if let Some(moving) = &scene.moving {
            moving.sum_up(work);
            union.resolve(work, emission_scale);
        }
        if let Some(moving) = union.moving() {
            follow(work.recorder, Taken { list, replaced, moving });
        }
        union.take(work);
        if is_new {
            renew(work, (replaced, list), union.nothing(), &scene.changed);
        }
        scene.union = Some(union);
        scene.is_bound = true;
        Ok(())
    }

    /// Takes what the GPU has told of earlier recordings, and makes the room that lacked. Whether any did is returned.
    fn hear(&self, work: &mut Work<'_, '_>, scene: &mut VoxelizedScene) -> Result<bool, GiError> {
        let device = work.memory.device();
        let Some(words) = scene.late.as_mut().and_then(|late| late.latest(device)) else {
            return Ok(scene.lacks_room);
        };
        let (verdict, counts) = words.split_at(size_of::<Verdict>() / 4);
        let verdict: Verdict = bytemuck::pod_read_unaligned(bytemuck::cast_slice(verdict));
        if let Some(list) = &mut scene.list {
            list.know(counts);
        }
        scene.lacks_room = verdict.no_room != 0;
        let (Some(moving), Some(list), Some(union)) =
            (&mut scene.moving, &scene.list, &scene.union)
        else {
            return Ok(scene.lacks_room);
        };
        let [voxels, sums] = moving.capacity();
        let room = [list.node_capacity(), list.face_capacity()];
        let fixed = scene.fixed.as_ref().map_or(0, |fixed| fixed.faces);
        let mut needed_sums = u64::from(verdict.sums);
        let mut needed_faces = u64::from(verdict.moving_faces);
        if verdict.no_room & NO_ROOM_FOR_VOXELS != 0 {
            let needed = u64::from(verdict.moving_voxels);
            // Of what is in them nothing is known yet.
            (needed_sums, needed_faces) = (2 * needed, 2 * needed);
            if voxels < needed {
                moving.make_room(work, with_spare(needed))?;
                scene.is_bound = false;
            }
        }
        if sums < needed_sums {
            moving.make_room_for_sums(work, with_spare(needed_sums), union.verdict())?;
            scene.is_bound = false;
        }
        let needed = [u64::from(verdict.nodes), fixed + needed_faces];
        if room[0] < needed[0] || room[1] < needed[1] {
            let nodes = room[0].max(with_spare(needed[0]));
            let faces = room[1].max(fixed + with_spare(needed_faces));
            scene.list = Some(resized_list(work, list, nodes, faces)?);
            scene.is_bound = false;
        }
        Ok(scene.lacks_room)
    }

    /// Goes on with static surface that is not what it was, a step a call. Once it is there, it is returned.
    fn rebuild(
        &self,
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        geometry: &Geometry,
    ) -> Result<Option<Option<Fixed>>, GiError> {
        let (device, grid) = (work.memory.device(), work.grid);
        let is_current = |rebuild: &Rebuild| rebuild.key.is_of(self.method, geometry, grid);
        let Some(mut rebuild) = scene.rebuild.take().filter(is_current) else {
            let input = ShareInput::new(geometry, true, grid, &device.limits())?;
            if input.is_empty() {
                let had = scene.fixed.take().is_some();
                return Ok(had.then_some(None));
            }
            let mut share = Share::new(work)?;
            share.bind(work, &scene.fallbacks, &input, geometry)?;
            share.mark(work, input.draws());
            let sources = share.marked_counts();
            let mut reads = LateReads::new(device, sources.iter().map(|source| source.2).sum());
            reads.record(work.recorder, &sources);
            let key = ShareKey::new(self.method, geometry, grid);
            scene.rebuild = Some(Rebuild { key, share, voxels: None, reads });
            return Ok(None);
        };
        let Some(words) = rebuild.reads.latest(device) else {
            scene.rebuild = Some(rebuild);
            return Ok(None);
        };
        let share = &mut rebuild.share;
        if rebuild.voxels.is_none() {
            let voxels = share.take_marked(&words)?;
            share.make_room(work, voxels)?;
            share.collect_lobes(work);
            let sources = share.lobed_counts(voxels);
            rebuild.reads = LateReads::new(device, sources.iter().map(|source| source.2).sum());
            rebuild.reads.record(work.recorder, &sources);
            rebuild.voxels = Some(voxels);
            scene.rebuild = Some(rebuild);
            return Ok(None);
        }
        let [faces, fronts] = share.take_lobed(&words);
        let verdict = Verdict::of_fronts(fronts);
        let verdict = uniform_buffer(device, "verdict", &verdict);
        share.make_room_for_sums(work, sums_for(faces, fronts), &verdict)?;
        share.sum_up(work);
        let Rebuild { key, share, .. } = rebuild;
        let counts = share.counts;
        Ok(Some(Some(Fixed { key, share: Some(share), faces, counts })))
    }

    /// Puts other static surface, or none, in the place of that so far, with a list of its own. That it is new, and the
    /// list so far, are returned.
    fn replace(
        &self,
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        fixed: Option<Fixed>,
    ) -> Result<(bool, Option<VoxelList>), GiError> {
        let share = fixed.as_ref().and_then(|fixed| fixed.share.as_ref());
        let voxels = share.map_or(0, |share| share.capacity()[0]);
        let faces = fixed.as_ref().map_or(0, |fixed| fixed.faces);
        let moving = scene.moving.as_ref().map_or(FIRST_VOXELS, |moving| moving.capacity()[0]);
        // What moves has had room so far.
        let so_far = scene.list.as_ref().map_or(0, VoxelList::face_capacity);
        let before = scene.fixed.as_ref().map_or(0, |fixed| fixed.faces);
        let moving_faces = so_far.saturating_sub(before).max(2 * moving);
        let union = Union::new(work)?;
        let nodes = most_nodes(work.grid, voxels + moving);
        let list = new_list(work, nodes, faces + moving_faces)?;
        scene.union = Some(union);
        scene.fixed = fixed;
        scene.is_bound = false;
        Ok((true, scene.list.replace(list)))
    }
}

/// Submits the work so far and reads parts of buffers back: a buffer, a byte and a number of bytes each.
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
