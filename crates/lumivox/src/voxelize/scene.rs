//! The voxels of a scene, as its triangles change.
//!
//! Static surface is collected once, in buffers that are as large as needed. What moves is collected again at each change,
//! in buffers with room to spare, and the list is changed in place. [`Voxelizer::voxelize`] waits for counts and makes
//! room before it goes on. [`Voxelizer::record`] only records, hears of the counts a few frames late, and makes room
//! then; until there is room, the list stays what it was.

use super::batch::Fallbacks;
use super::input::{self, ShareInput, ShareKey};
use super::room::{new_list, resized_list};
use super::share::{Share, ShareCounts, Work};
use super::union::{Moving, Union, Verdict, renew, resolve_fixed};
use super::{FRONT_WORDS, VoxelizeStats, Voxelizer};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LateReads, Memory, Pipelines, Recorder, StageTime, Timing,
    read_buffer, storage_buffer, uniform_buffer,
};
use crate::voxels::{FaceRecord, VoxelList, level_first_word};
use crate::{Geometry, GiError, Grid};

/// The voxels of a scene, and what is kept to make them again when some of its triangles have moved.
#[derive(Debug)]
pub struct VoxelizedScene {
    pub(super) grid: Grid,
    /// Group 0.
    pub(super) globals: BindGroup,
    pub(super) fallbacks: Fallbacks,
    pub(super) fixed: Option<Fixed>,
    pub(super) moving: Option<Share>,
    pub(super) union: Option<Union>,
    /// Whether the union is bound to the shares and the list as they are.
    pub(super) is_bound: bool,
    pub(super) list: Option<VoxelList>,
    /// The list is new: static surface is not in it yet.
    pub(super) is_list_new: bool,
    /// The last list that was taken, which the new one comes in the place of.
    pub(super) replaced: Option<VoxelList>,
    /// A bit per cell, laid out as the list's occupancy: cells of another surface than before. Whoever follows the list
    /// clears them.
    pub(super) changed: Buffer,
    /// The verdicts and counts of recorded voxelizations.
    pub(super) late: Option<LateReads>,
    /// The last verdict that was heard of is that there is no room, or none was heard yet.
    pub(super) lacks_room: bool,
    pub(super) rebuild: Option<Rebuild>,
    /// The grid to go on with: a clipmap whose boxes have moved.
    pub(super) wanted: Option<Grid>,
    /// That of what is on its way.
    pub(super) next: Option<PlacedGrid>,
}

/// A grid, and group 0 with it.
#[derive(Clone, Debug)]
pub(super) struct PlacedGrid {
    pub(super) grid: Grid,
    pub(super) globals: BindGroup,
}

/// Static surface.
#[derive(Debug)]
pub(super) struct Fixed {
    pub(super) key: ShareKey,
    /// Nothing where nothing moves: then nobody would ask for it.
    pub(super) share: Option<Share>,
    pub(super) faces: u64,
    pub(super) counts: ShareCounts,
}

/// Static surface that is on its way, a step at a time, while the list stays what it was.
#[derive(Debug)]
pub(super) struct Rebuild {
    pub(super) key: ShareKey,
    pub(super) share: Share,
    /// Once its voxels are counted.
    pub(super) voxels: Option<u64>,
    pub(super) reads: LateReads,
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
    /// Its grid.
    pub grid: &'a Grid,
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
            is_list_new: false,
            replaced: None,
            changed: storage_buffer(device, "changed", words * 4),
            late: None,
            lacks_room: true,
            rebuild: None,
            wanted: None,
            next: None,
        }
    }

    /// The grid of the list, and of the next one until it is taken.
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Lets the next voxelization go on with a grid whose boxes have moved. Whether it differs from the present one is
    /// returned.
    pub(crate) fn move_to(&mut self, grid: Grid) -> bool {
        self.wanted = (grid != self.grid).then_some(grid);
        self.wanted.is_some()
    }

    /// Goes on with another grid.
    pub(super) fn place(&mut self, placed: PlacedGrid) {
        self.wanted = self.wanted.filter(|wanted| *wanted != placed.grid);
        (self.grid, self.globals, self.next) = (placed.grid, placed.globals, None);
    }

    /// The list of voxels, once there is one.
    pub fn list(&self) -> Option<&VoxelList> {
        self.list.as_ref()
    }

    /// Whether anything ever moved.
    pub(crate) fn has_moving(&self) -> bool {
        self.moving.is_some()
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

    /// Puts a list without voxels in the place of that so far, until it is taken.
    pub(super) fn replace_list(&mut self, list: VoxelList) {
        let before = self.list.replace(list);
        // One that was never taken has never been lit.
        if !self.is_list_new {
            self.replaced = before;
        }
        (self.is_list_new, self.is_bound) = (true, false);
    }

    /// How it stands.
    pub(super) fn frame(&self, is_late: bool) -> FrameVoxels {
        let list = self.list.as_ref();
        FrameVoxels {
            is_late,
            voxels: list.map_or(0, VoxelList::voxel_count),
            faces: list.map_or(0, |list| list.face_count),
        }
    }

    /// The shares: static and dynamic.
    pub(super) fn shares(&self) -> [Option<&Share>; 2] {
        [self.fixed.as_ref().and_then(|fixed| fixed.share.as_ref()), self.moving.as_ref()]
    }

    /// Whether static draws are what they were, and what was found of them is there.
    pub(super) fn has_fixed(&self, method: &str, geometry: &Geometry) -> bool {
        self.fixed.as_ref().is_some_and(|fixed| {
            fixed.share.is_some() && fixed.key.is_of(method, geometry, &self.grid)
        })
    }
}

/// Room for a number that grows: a quarter to spare, and a thousand, so that little things need no more when they turn.
pub(super) fn with_spare(count: u64) -> u64 {
    count + count / 4 + 1024
}

/// Room for the sums of faces with their fronts, in faces, as `verdict.wgsl` counts it.
pub(super) fn sums_for(faces: u64, fronts: u64) -> u64 {
    faces + (fronts * u64::from(FRONT_WORDS) * 4).div_ceil(size_of::<FaceRecord>() as u64)
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

    /// The grid to go on with.
    pub(super) fn wanted_grid(&self, device: &wgpu::Device, scene: &VoxelizedScene) -> PlacedGrid {
        let Some(grid) = scene.wanted else {
            return PlacedGrid { grid: scene.grid, globals: scene.globals.clone() };
        };
        let globals = BindGroupBuilder::new(&self.kernels.layouts.grid);
        PlacedGrid { grid, globals: globals.buffer(&grid.uniform(device)).build(device, "grid") }
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
        let device = recorder.device().clone();
        let placed = self.wanted_grid(&device, scene);
        let PlacedGrid { grid, globals } = placed.clone();
        let limits = device.limits();
        let is_reused = grid == scene.grid && scene.has_fixed(self.method, geometry);
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
        Self::mark_moving(work, scene, &moving_input, geometry)?;
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

        scene.place(placed);

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

    pub(super) fn work<'a, 'r>(
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
    pub(super) fn mark_moving(
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
    pub(super) fn take(
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        emission_scale: f32,
        follow: &mut dyn FnMut(&mut Recorder<'_>, Taken<'_>),
    ) -> Result<(), GiError> {
        let (is_new, replaced) = (scene.is_list_new, scene.replaced.as_ref());
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
            follow(work.recorder, Taken { list, replaced, moving, grid: work.grid });
        }
        union.take(work);
        if is_new {
            renew(work, (replaced, list), union.nothing(), &scene.changed);
        }
        scene.union = Some(union);
        scene.is_bound = true;
        (scene.is_list_new, scene.replaced) = (false, None);
        Ok(())
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
