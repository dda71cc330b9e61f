//! Irradiance probes on a grid, gathered from the voxels: a batch of probes per frame, and only
//! while something is drawn forward. `irradiance.rs` passes the light to Bevy.

use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::tasks::Task;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Recorder, storage_buffer,
    uniform_buffer,
};
use lumivox::{
    GatherPoints, GatherSettings, Gi, GiError, Lights, PROBE_SIDES, TraceSettings, wgpu,
};

use crate::settings::{GiVolume, LumivoxGi};
use crate::volumes::voxels::beside_frames;

/// Voxels along the edge of a probe's cell: in a box, and in the outermost cascade.
const VOXELS_A_CELL: [u32; 2] = [4, 2];
/// Frames that a probe gathers per turn.
const FRAMES_A_TURN: u32 = 2;
/// One probe gathers per this many voxel faces of the frame's budget.
const FACES_A_PROBE: u32 = 16;
/// Frames that probes are kept after the last forward draw.
const FRAMES_TO_KEEP: u32 = 120;
/// Bytes of `Probe` of `probes.wgsl`.
const PROBE_BYTES: u64 = 112;

/// A grid of probes at the centres of cubic cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ProbeGrid {
    /// The corner of least coordinates, m.
    pub(crate) low: Vec3,
    /// Edge of a cell, m.
    pub(crate) edge: f32,
    pub(crate) cells: UVec3,
}

impl ProbeGrid {
    /// The grid that covers the voxels.
    fn around(gi: &Gi, volume: &GiVolume) -> Self {
        let grid = gi.grid();
        let (min, max) = (grid.min_in_world(), grid.max_in_world());
        let Some(cascades) = volume.cascades() else {
            let edge = VOXELS_A_CELL[0] as f32 * grid.voxel_size_m;
            let cells = ((max - min) / edge - 1e-3).ceil().max(Vec3::ONE).as_uvec3();
            return Self { low: min, edge, cells };
        };
        // Snapped to whole cells, so that probes keep their positions while the cascades move.
        let outermost = grid.voxel_size_m * (1 << (cascades.count - 1)) as f32;
        let edge = VOXELS_A_CELL[1] as f32 * outermost;
        let low = (min / edge).floor() * edge;
        Self { low, edge, cells: UVec3::splat(cascades.resolution / VOXELS_A_CELL[1] + 1) }
    }

    pub(crate) fn size(&self) -> Vec3 {
        self.cells.as_vec3() * self.edge
    }

    fn count(&self) -> u32 {
        self.cells.element_product()
    }

    /// Offset of the `other` grid's corner in cells; `None` if cell counts or sizes differ.
    fn shift_to(&self, other: &Self) -> Option<IVec3> {
        let is_alike = self.cells == other.cells && self.edge == other.edge;
        is_alike.then(|| ((other.low - self.low) / self.edge).round().as_ivec3())
    }
}

/// `ProbeSettings` of `probes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct ProbeSettings {
    low: Vec3,
    edge: f32,
    cells: UVec3,
    first: u32,
    texture_low: Vec3,
    texture_edge: f32,
    texture_cells: UVec3,
    count: u32,
    shift: IVec3,
    padding: u32,
}

impl ProbeSettings {
    fn new(grid: &ProbeGrid, texture: &ProbeGrid) -> Self {
        Self {
            low: grid.low,
            edge: grid.edge,
            cells: grid.cells,
            first: 0,
            texture_low: texture.low,
            texture_edge: texture.edge,
            texture_cells: texture.cells,
            count: 0,
            shift: IVec3::ZERO,
            padding: 0,
        }
    }
}

/// The compute kernels of probes, linked for the volume of one `Gi`.
#[derive(Clone)]
pub(crate) struct ProbeKernels {
    place: Kernel,
    take: Kernel,
    keep: Kernel,
    move_on: Kernel,
    fill: Kernel,
    empty: Kernel,
    probes_layout: wgpu::BindGroupLayout,
    texture_layout: wgpu::BindGroupLayout,
}

impl ProbeKernels {
    /// Links the kernels; they are compiled when first needed.
    pub(crate) fn new(gi: &Gi) -> Result<Self, GiError> {
        gi.prepare_gather()?;
        let pipelines = gi.pipelines();
        let probes_layout = LayoutBuilder::compute()
            .uniform()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .build(pipelines, "probes");
        let texture_layout = LayoutBuilder::compute()
            .storage_texture(wgpu::TextureViewDimension::D3, TextureFormat::Rgba16Float)
            .build(pipelines, "texture of probes");
        let kernel = |entry: &str| {
            let layouts = [gi.globals_layout(), &probes_layout, &texture_layout];
            let layouts =
                if matches!(entry, "fill" | "empty") { &layouts[..] } else { &layouts[..2] };
            Kernel::new(pipelines, gi.shaders(), "points::probes", entry, layouts)
        };
        Ok(Self {
            place: kernel("place")?,
            take: kernel("take")?,
            keep: kernel("keep")?,
            move_on: kernel("move_on")?,
            fill: kernel("fill")?,
            empty: kernel("empty")?,
            probes_layout,
            texture_layout,
        })
    }
}

/// The probes of a volume.
pub(crate) struct Probes {
    kernels: ProbeKernels,
    compiling: Option<Task<()>>,
    pub(crate) grid: ProbeGrid,
    points: GatherPoints,
    /// Probes per turn.
    batch: u32,
    next: u32,
    /// Probes that have gathered since the grid was created or reset.
    gathered: u32,
    /// Settings to gather, to write light and to write darkness. They need three buffers, since all
    /// three may be in one submission.
    turn: [(Buffer, BindGroup); 3],
    texture: Option<(wgpu::TextureView, BindGroup)>,
    frames_unused: u32,
}

impl Probes {
    fn new(kernels: &ProbeKernels, gi: &Gi, gi_settings: &LumivoxGi) -> Self {
        let device = gi.pipelines().device();
        let grid = ProbeGrid::around(gi, &gi_settings.volume);
        let wanted = gi_settings.face_budget().map_or(grid.count(), |faces| faces / FACES_A_PROBE);
        let batch = wanted.clamp(1, grid.count());
        let points = PROBE_SIDES * batch;
        let [positions, normals] = ["positions of probes", "normals of probes"]
            .map(|label| storage_buffer(device, label, 16 * u64::from(points)));
        let points = GatherPoints::new(device, &positions, &normals, points);
        let [probes, former] = ["probes", "former probes"]
            .map(|label| storage_buffer(device, label, PROBE_BYTES * u64::from(grid.count())));
        let bind = |label: &str| {
            let settings = uniform_buffer(device, label, &ProbeSettings::new(&grid, &grid));
            let group = BindGroupBuilder::new(&kernels.probes_layout)
                .buffer(&settings)
                .buffer(&positions)
                .buffer(&normals)
                .buffer(points.gathered())
                .buffer(&probes)
                .buffer(&former)
                .build(device, label);
            (settings, group)
        };
        let turn = ["turn of probes", "light of probes", "darkness of probes"].map(bind);
        let pipelines = gi.pipelines().clone();
        // Compiles in the background. Browsers, where a task must not block, have no probes.
        let task = async move { bevy::tasks::block_on(pipelines.compile(&mut |_, _| ())) };
        let compiling = beside_frames(task);
        Self {
            kernels: kernels.clone(),
            compiling: Some(compiling),
            grid,
            points,
            batch,
            next: 0,
            gathered: 0,
            turn,
            texture: None,
            frames_unused: 0,
        }
    }

    /// Whether all probes have gathered.
    pub(crate) fn are_lit(&self) -> bool {
        self.gathered >= self.grid.count()
    }

    /// Whether the probes' light may be written: `false` in the frame in which they are dropped.
    pub(crate) fn may_light(&self) -> bool {
        self.are_lit() && self.frames_unused < FRAMES_TO_KEEP
    }

    /// Creates the probes if they are wanted and missing, gathers at one batch of them, and drops
    /// them after `FRAMES_TO_KEEP` unused frames.
    pub(crate) fn record(
        held: &mut Option<Self>,
        kernels: &ProbeKernels,
        (gi, lights): (&Gi, &Lights),
        settings: &LumivoxGi,
        is_wanted: bool,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), GiError> {
        let grid = ProbeGrid::around(gi, &settings.volume);
        let shift = held.as_ref().and_then(|probes| probes.grid.shift_to(&grid));
        match held.as_mut().filter(|_| shift.is_none()) {
            // Another cell size: all probes gather again. They are kept, since the texture that was
            // written in this frame still has to be cleared.
            Some(probes) if probes.grid.count() == grid.count() => {
                (probes.grid, probes.next, probes.gathered) = (grid, 0, 0);
            }
            Some(_) => *held = None,
            None => {}
        }
        if held.is_none() && is_wanted {
            *held = Some(Self::new(kernels, gi, settings));
        }
        let Some(probes) = held else { return Ok(()) };
        probes.frames_unused = if is_wanted { 0 } else { probes.frames_unused + 1 };
        if probes.frames_unused > FRAMES_TO_KEEP {
            *held = None;
            return Ok(());
        }
        if probes.compiling.as_ref().is_some_and(|compiling| !compiling.is_finished()) {
            return Ok(());
        }
        probes.compiling = None;
        probes.gather(gi, lights, &settings.trace_settings(), (grid, shift), recorder)
    }

    fn gather(
        &mut self,
        gi: &Gi,
        lights: &Lights,
        cones: &TraceSettings,
        (grid, shift): (ProbeGrid, Option<IVec3>),
        recorder: &mut Recorder<'_>,
    ) -> Result<(), GiError> {
        let count = self.grid.count();
        let mut uniform = ProbeSettings::new(&grid, &grid);
        (uniform.first, uniform.count) = (self.next, self.batch);
        uniform.shift = shift.unwrap_or_default();
        let (settings, group) = &self.turn[0];
        recorder.queue().write_buffer(settings, 0, bytemuck::bytes_of(&uniform));
        let groups = [gi.globals(), group];
        if uniform.shift != IVec3::ZERO {
            self.grid = grid;
            self.kernels.keep.run_linear(recorder, &groups, count.into());
            self.kernels.move_on.run_linear(recorder, &groups, count.into());
        }
        self.kernels.place.run_linear(recorder, &groups, self.batch.into());
        self.points.restart(recorder);
        let mut settings = GatherSettings::default();
        settings.cones = *cones;
        settings.frames = FRAMES_A_TURN;
        settings.direct = false;
        gi.record_gather(recorder, &self.points, lights, &settings)?;
        self.kernels.take.run_linear(recorder, &groups, self.batch.into());
        self.next = (self.next + self.batch) % count;
        self.gathered = self.gathered.saturating_add(self.batch).min(count);
        Ok(())
    }

    /// Writes the probes' light, or darkness, into the texture of a grid.
    pub(crate) fn write(
        &mut self,
        gi: &Gi,
        (view, grid): (&wgpu::TextureView, &ProbeGrid),
        is_light: bool,
        recorder: &mut Recorder<'_>,
    ) {
        if self.texture.as_ref().is_none_or(|(bound, _)| bound != view) {
            let group = BindGroupBuilder::new(&self.kernels.texture_layout)
                .view(view)
                .build(recorder.device(), "texture of probes");
            self.texture = Some((view.clone(), group));
        }
        let Some((_, texture)) = &self.texture else { return };
        let (settings, group) = &self.turn[if is_light { 1 } else { 2 }];
        let uniform = ProbeSettings::new(&self.grid, grid);
        recorder.queue().write_buffer(settings, 0, bytemuck::bytes_of(&uniform));
        let kernel = if is_light { &self.kernels.fill } else { &self.kernels.empty };
        let groups = [gi.globals(), group, texture];
        kernel.run_linear(recorder, &groups, grid.count().into());
    }
}
