//! The voxels of a scene whose triangles change.
//!
//! Static surface is collected once, in buffers of the exact size. Dynamic surface is collected
//! again at each change, in buffers with spare capacity, and the list is changed in place.
//! [`Voxelizer::record`] only records, reads counts back a few frames late, and grows buffers then;
//! while a buffer is too small, the list does not change.

use super::Voxelizer;
use super::batch::Fallbacks;
use super::input::{ShareInput, ShareKey};
use super::share::{Share, ShareCounts, Work};
use super::union::{Moving, Needs, Union, renew, resolve_fixed};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LateReads, Memory, OverflowReads, Pipelines, Recorder,
    storage_buffer,
};
use crate::voxels::{VoxelList, level_first_word};
use crate::{Geometry, GiError, Grid};

/// The voxels of a scene, and the data that updates reuse.
#[derive(Debug)]
pub(crate) struct VoxelizedScene {
    pub(super) grid: Grid,
    /// Group 0.
    pub(super) globals: BindGroup,
    pub(super) fallbacks: Fallbacks,
    pub(super) fixed: Option<Fixed>,
    pub(super) moving: Option<Share>,
    pub(super) union: Option<Union>,
    /// `true` if the union is bound to the current shares and list.
    pub(super) is_bound: bool,
    pub(super) list: Option<VoxelList>,
    /// `true` if the list is new and does not contain static surface yet.
    pub(super) is_list_new: bool,
    /// The last committed list, if a new one is about to replace it.
    pub(super) replaced: Option<VoxelList>,
    /// Cells whose surface has changed, a bit each, laid out as the list's occupancy. A volume with
    /// cells reads and clears them.
    pub(super) changed: Buffer,
    /// `true` if the next list is collected, and can be committed.
    pub(super) is_collected: bool,
    /// Read-backs of [`Needs`] and the list's counts, since the list was replaced.
    pub(super) late: OverflowReads,
    pub(super) rebuild: Option<Rebuild>,
    /// The grid of a clipmap whose boxes have to move; `None` if the current one is right.
    pub(crate) wanted: Option<Grid>,
    /// Grid of the rebuild in progress.
    pub(super) next: Option<PlacedGrid>,
}

/// A grid and its bind group 0.
#[derive(Clone, Debug)]
pub(super) struct PlacedGrid {
    pub(super) grid: Grid,
    pub(super) globals: BindGroup,
}

/// Static surface.
#[derive(Debug)]
pub(super) struct Fixed {
    pub(super) key: ShareKey,
    /// `None` if there are no dynamic draws, whose updates would need it.
    pub(super) share: Option<Share>,
    pub(super) faces: u64,
    /// Nodes of all levels.
    pub(super) nodes: u64,
    pub(super) counts: ShareCounts,
}

/// Rebuild of static surface in progress, a step per frame, while the list does not change.
#[derive(Debug)]
pub(super) struct Rebuild {
    pub(super) key: ShareKey,
    /// Bind group 0 of its walks.
    pub(super) globals: BindGroup,
    /// `true` if it copies unchanged voxels from the current static surface, and walks only the
    /// changed parts.
    pub(super) keeps: bool,
    pub(super) share: Share,
    /// Number of voxels, once they are counted.
    pub(super) voxels: Option<u64>,
    /// The union of the next list, once the voxels are counted.
    pub(super) union: Option<Union>,
    pub(super) reads: LateReads,
}

/// A list that is ready to be committed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collected<'a> {
    /// The list.
    pub list: &'a VoxelList,
    /// The list that it replaces; `None` if the list itself is updated.
    pub replaced: Option<&'a VoxelList>,
    /// The faces that the list will get for dynamic surface.
    pub moving: Moving<'a>,
    /// `true` if there ever were dynamic draws.
    pub has_moving: bool,
    /// The list's grid.
    pub grid: &'a Grid,
}

/// Status of a recorded voxelization, from the results that have been read back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct FrameVoxels {
    /// `true` if the voxels are those of an earlier frame: a buffer overflowed, or static surface
    /// is still being rebuilt.
    pub is_late: bool,
    /// `true` if the last recording is not read back yet; `is_late` then describes an earlier
    /// recording.
    pub is_pending: bool,
    /// Occupied voxels.
    pub voxels: u32,
    /// Sides of voxels that have surface.
    pub faces: u32,
}

impl VoxelizedScene {
    /// A scene without voxels.
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
            is_collected: false,
            late: OverflowReads::default(),
            rebuild: None,
            wanted: None,
            next: None,
        }
    }

    /// The grid of the current list.
    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Sets a grid with moved boxes for the next voxelization. Returns `true` if it differs from
    /// the current grid.
    pub(crate) fn move_to(&mut self, grid: Grid) -> bool {
        self.wanted = (grid != self.grid).then_some(grid);
        self.wanted.is_some()
    }

    /// The next grid on the way to the wanted one.
    pub(super) fn first_step(&self) -> Option<Grid> {
        let wanted = self.wanted?;
        let cascades = self.grid.cascades.zip(wanted.cascades);
        let cascades = cascades.map(|(own, wanted)| own.step_to(&wanted));
        Some(Grid { cascades, ..wanted })
    }

    /// Switches to another grid.
    pub(super) fn place(&mut self, placed: PlacedGrid) {
        self.wanted = self.wanted.filter(|wanted| *wanted != placed.grid);
        (self.grid, self.globals, self.next) = (placed.grid, placed.globals, None);
    }

    /// The list of voxels; `None` before the first voxelization.
    pub fn list(&self) -> Option<&VoxelList> {
        self.list.as_ref()
    }

    /// `true` if there ever were dynamic draws.
    pub(crate) fn has_moving(&self) -> bool {
        self.moving.is_some()
    }

    /// Cells whose surface has changed, a bit each, laid out as the list's occupancy. A volume with
    /// cells reads and clears them.
    pub(crate) fn changed(&self) -> &Buffer {
        &self.changed
    }

    /// Discards the results for static draws, so that they are voxelized again.
    pub fn forget_static(&mut self) {
        if let Some(fixed) = &mut self.fixed {
            fixed.share = None;
        }
        self.rebuild = None;
    }

    /// Work items of the last walks over static draws.
    #[cfg(test)]
    pub(crate) fn static_items(&self) -> u64 {
        let share = self.fixed.as_ref().and_then(|fixed| fixed.share.as_ref());
        share.map_or(0, |share| share.counts.items)
    }

    /// Bytes on the GPU that are kept for static draws, and for collecting the voxels of dynamic
    /// ones.
    pub fn kept_bytes(&self) -> u64 {
        let fixed = self.fixed.iter().flat_map(|fixed| &fixed.share);
        let shares: u64 = fixed.chain(&self.moving).map(Share::bytes).sum();
        shares + self.union.as_ref().map_or(0, Union::bytes)
    }

    /// Replaces the list by an empty one, which is not committed yet.
    pub(super) fn replace_list(&mut self, list: VoxelList) {
        let before = self.list.replace(list);
        // A list that was never committed has no light.
        if !self.is_list_new {
            self.replaced = before;
        }
        (self.is_list_new, self.is_bound) = (true, false);
    }

    /// Status of the last recorded voxelization, from the results that have been read back. The
    /// caller must poll the device first.
    pub(crate) fn status(&self) -> FrameVoxels {
        let (overflowed, words) = self.late.peek();
        let list = self.list.as_ref();
        let is_rebuilt = self.rebuild.is_some() || self.next.is_some() || self.wanted.is_some();
        let mut frame = FrameVoxels {
            is_late: is_rebuilt || (overflowed.is_late && list.is_some()),
            is_pending: overflowed.is_pending,
            voxels: list.map_or(0, VoxelList::voxel_count),
            faces: list.map_or(0, |list| list.face_count),
        };
        if let Some(words) = words {
            let (level_starts, faces) = VoxelList::counted(&words[NEEDS_WORDS..]);
            (frame.voxels, frame.faces) = (level_starts[1] - level_starts[0], faces);
        }
        frame
    }

    /// The list that is ready to be committed.
    pub(crate) fn collected(&self) -> Option<Collected<'_>> {
        let list = self.list.as_ref().filter(|_| self.is_collected)?;
        let moving = self.union.as_ref()?.moving()?;
        let (replaced, has_moving) = (self.replaced.as_ref(), self.has_moving());
        Some(Collected { list, replaced, moving, has_moving, grid: &self.grid })
    }

    /// The shares: static and dynamic.
    pub(super) fn shares(&self) -> [Option<&Share>; 2] {
        [self.fixed.as_ref().and_then(|fixed| fixed.share.as_ref()), self.moving.as_ref()]
    }

    /// `true` if static draws have not changed and their share is available.
    pub(super) fn has_fixed(&self, geometry: &Geometry) -> bool {
        self.fixed
            .as_ref()
            .is_some_and(|fixed| fixed.share.is_some() && fixed.key.is_of(geometry, &self.grid))
    }
}

/// Words of the [`Needs`] at the start of each read-back of [`VoxelizedScene::late`]; the first
/// is zero if nothing overflowed.
const NEEDS_WORDS: usize = size_of::<Needs>() / 4;

/// Capacity for a count that may grow: a quarter more, plus 1024, so that small objects do not
/// overflow when they turn.
pub(super) fn with_spare(count: u64) -> u64 {
    count + count / 4 + 1024
}

impl Voxelizer {
    /// A scene without voxels.
    pub fn scene(&self, device: &Pipelines, queue: &wgpu::Queue, grid: &Grid) -> VoxelizedScene {
        VoxelizedScene::new(device, queue, self, grid)
    }

    /// A grid and its bind group 0.
    pub(super) fn placed(&self, device: &wgpu::Device, grid: Grid) -> PlacedGrid {
        PlacedGrid { grid, globals: self.group_of(device, &grid.uniform(device)) }
    }

    /// Group 0 with the uniform of a grid.
    pub(super) fn group_of(&self, device: &wgpu::Device, uniform: &Buffer) -> BindGroup {
        BindGroupBuilder::new(&self.kernels.layouts.grid).buffer(uniform).build(device, "grid")
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

    /// Marks the voxels of dynamic surface, if there ever was any.
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
            moving.mark(work, input.draws(), None);
        }
        Ok(())
    }

    /// Collects the faces of the next list from both shares, and decides whether they fit.
    pub(super) fn collect(
        work: &mut Work<'_, '_>,
        scene: &mut VoxelizedScene,
        emission_scale: f32,
    ) -> Result<(), GiError> {
        let fixed = scene.fixed.as_ref();
        let fixed_faces = fixed.map_or(0, |fixed| fixed.faces as u32);
        let Some(mut union) = scene.union.take() else { return Ok(()) };
        let Some(list) = scene.list.as_ref() else { return Ok(()) };
        if scene.is_list_new
            && let Some(share) = fixed.and_then(|fixed| fixed.share.as_ref())
        {
            resolve_fixed(work, share, list, emission_scale);
        }
        if !scene.is_bound {
            union.bind_list(work, scene.shares(), (list, fixed_faces), &scene.changed)?;
        }
        union.check_fit(work);
        if let Some(moving) = &scene.moving {
            moving.sum_up(work, None);
            union.resolve(work, emission_scale);
        }
        scene.union = Some(union);
        (scene.is_bound, scene.is_collected) = (true, true);
        Ok(())
    }

    /// Commits the collected list, unless it overflows.
    pub(crate) fn commit(&self, recorder: &mut Recorder<'_>, scene: &mut VoxelizedScene) {
        let Some((union, list)) = scene.union.as_ref().zip(scene.list.as_ref()) else { return };
        let device = recorder.device().clone();
        let work = &mut self.work(recorder, &device, &scene.grid, &scene.globals);
        union.commit(work);
        if let Some(replaced) = &scene.replaced {
            renew(work, replaced, &scene.changed);
        }
        let needs = (union.needs(), 0, size_of::<Needs>() as u64);
        scene.late.record(work.recorder, &[needs, (&list.counts, 0, list.counts.size())]);
        (scene.is_collected, scene.is_list_new, scene.replaced) = (false, false, None);
    }
}
