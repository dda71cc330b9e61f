//! The light of a voxel list's faces, and the kernels that compute it.

use super::turns::{MOVED_BOXES, Turn};
use crate::GiError;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, counted_buffer, storage_buffer,
};
use crate::volume::changes::Shown;
use crate::voxelize::{Collected, Moving};
use crate::voxels::{FACE_ARGUMENTS, LIST_COUNT_BYTES, VoxelList};

/// Words per face in `hits`: the hits of its rays, its adjacent faces, its irradiance from
/// emitters, and the step of its last gather.
pub(crate) const HIT_WORDS: u32 = 24;
const HIT_BYTES: u64 = 4 * HIT_WORDS as u64;

/// Cells of the hemisphere for a face's far light, a word each.
pub(super) const FAR_CELLS: u32 = 16;
pub(crate) const FAR_BYTES: u64 = 4 * FAR_CELLS as u64;

/// The kernels.
#[derive(Debug)]
pub(super) struct LightKernels {
    direct_layout: wgpu::BindGroupLayout,
    bounce_layout: wgpu::BindGroupLayout,
    box_layout: wgpu::BindGroupLayout,
    reflect_layout: wgpu::BindGroupLayout,
    show_layout: wgpu::BindGroupLayout,
    move_light_layout: wgpu::BindGroupLayout,
    settle_layout: wgpu::BindGroupLayout,
    copy_layout: wgpu::BindGroupLayout,
    /// `None` if cones march.
    find: Option<[Kernel; 2]>,
    far: Option<FarKernels>,
    box_moved: [Kernel; 2],
    bounce: [Kernel; 2],
    shine: [Kernel; 2],
    reflect: Kernel,
    show: Kernel,
    show_without_emission: Kernel,
    move_light: Kernel,
    settle: Kernel,
    copy_replaced: Kernel,
}

/// The kernels of far light.
#[derive(Debug)]
struct FarKernels {
    share_layout: wgpu::BindGroupLayout,
    collect: Kernel,
    rows: Kernel,
    columns: Kernel,
}

impl LightKernels {
    /// Queues the kernels of bounces for compilation, and with `in_frames` those that only frames
    /// use.
    pub(super) fn expect_bounces(&self, device: &Pipelines, has_emitters: bool, in_frames: bool) {
        if in_frames {
            self.box_moved.iter().for_each(|kernel| kernel.expect(device));
        }
        let far = self.far.iter().flat_map(|far| [&far.collect, &far.rows, &far.columns]);
        for kernel in self.find.iter().flatten().chain(far) {
            kernel.expect(device);
        }
        let shine = has_emitters.then_some(&self.shine);
        for [in_turn, fresh] in [&self.bounce].into_iter().chain(shine) {
            in_turn.expect(device);
            if in_frames {
                fresh.expect(device);
            }
        }
    }

    /// Queues for compilation the kernel that only geometry with emitters needs.
    pub(super) fn expect_emitters(&self, device: &Pipelines) {
        self.show_without_emission.expect(device);
    }

    /// Links the kernels; `grid` is the layout of only the grid, the others are those of groups 0
    /// and 2. Marching cones do not need hits, so `find` is `None` then.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &wgpu::BindGroupLayout,
        [globals, lights]: [&wgpu::BindGroupLayout; 2],
        marches: bool,
    ) -> Result<Self, GiError> {
        let layout = |uniforms: u32, read: u32, written: u32, label: &str| {
            let layout = (0..uniforms).fold(LayoutBuilder::compute(), |layout, _| layout.uniform());
            let layout = (0..read).fold(layout, |layout, _| layout.storage());
            (0..written).fold(layout, |layout, _| layout.storage_mut()).build(device, label)
        };
        let bounce_layout = layout(3, 1, 2, "bounce");
        let box_layout = layout(2, 1, 1, "box of moved surface");
        let reflect_layout = layout(1, 3, 1, "reflect");
        let show_layout = layout(1, 2, 1, "show");
        let move_light_layout = layout(1, 6, 2, "move light");
        let settle_layout = layout(2, 2, 2, "settle");
        let copy_layout = layout(0, 6, 1, "copy replaced light");
        let kernel = |module, layout| Kernel::new(device, shaders, module, "main", &[grid, layout]);
        // One kernel for the faces whose turn it is, and one for those that have never gathered.
        let gather = |module| {
            let groups = [globals, &bounce_layout, lights];
            let kernel = |entry| Kernel::deferred(device, shaders, module, entry, &groups);
            Ok::<_, ShaderError>([kernel("main")?, kernel("fresh")?])
        };
        let find = || {
            let groups = [globals, &bounce_layout];
            let find = |entry| Kernel::deferred(device, shaders, "light::find", entry, &groups);
            Ok::<_, ShaderError>([find("main")?, find("beside")?])
        };
        let far = || {
            let share_layout = layout(1, 2, 1, "share far light");
            let share = |entry| {
                let groups = [globals, &share_layout];
                Kernel::deferred(device, shaders, "light::share_far", entry, &groups)
            };
            let [rows, columns] = [share("rows")?, share("columns")?];
            let groups = [globals, &bounce_layout, lights];
            let collect = Kernel::deferred(device, shaders, "light::far", "main", &groups)?;
            Ok::<_, ShaderError>(FarKernels { share_layout, collect, rows, columns })
        };
        let box_moved = ["empty", "main"].map(|entry| {
            let groups = [grid, &box_layout];
            Kernel::deferred(device, shaders, "light::box_moved", entry, &groups)
        });
        let [empty, main] = box_moved;
        let show =
            |entry| Kernel::deferred(device, shaders, "light::show", entry, &[grid, &show_layout]);
        let [bounce, shine] = [gather("light::bounce")?, gather("light::shine")?];
        let [show, show_without_emission] = [show("main")?, show("without_emission")?];
        show.expect(device);
        Ok(Self {
            direct_layout: layout(1, 1, 1, "direct light"),
            find: (!marches).then(find).transpose()?,
            far: (!marches).then(far).transpose()?,
            box_moved: [empty?, main?],
            bounce,
            shine,
            reflect: kernel("light::reflect", &reflect_layout)?,
            show,
            show_without_emission,
            move_light: kernel("light::move_light", &move_light_layout)?,
            settle: kernel("light::settle", &settle_layout)?,
            copy_replaced: kernel("light::copy_replaced", &copy_layout)?,
            bounce_layout,
            box_layout,
            reflect_layout,
            show_layout,
            move_light_layout,
            settle_layout,
            copy_layout,
        })
    }

    /// The kernel of direct light; the layouts are those of groups 0 and 2.
    pub fn direct(
        &self,
        device: &Pipelines,
        shaders: &ShaderLibrary,
        [globals, lights]: [&wgpu::BindGroupLayout; 2],
    ) -> Result<Kernel, ShaderError> {
        let groups = [globals, &self.direct_layout, lights];
        Kernel::new(device, shaders, "light::direct", "main", &groups)
    }

    /// Finds the hits of the faces' rays and the adjacent faces, unless they are already known.
    pub fn find(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, faces: &Faces) {
        for find in self.find.iter().flatten() {
            faces.run(recorder, "light::find", find, &[globals, &faces.bounce]);
        }
    }

    /// Finds the box around the voxels that dynamic surface touches.
    pub fn box_moved(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        let [empty, main] = &self.box_moved;
        let groups = [grid, &faces.box_moved];
        recorder.compute("light::box_moved", |pass| {
            empty.dispatch_linear(pass, &groups, 1);
            main.dispatch_linear(pass, &groups, faces.moving_capacity);
        });
    }

    /// Computes the far light of all faces, shared among neighbours. `None` if cones march.
    pub fn far<'f>(
        &self,
        recorder: &mut Recorder<'_>,
        [globals, lights]: [&BindGroup; 2],
        faces: &'f Faces,
    ) -> Option<&'f Buffer> {
        let (kernels, far) = (self.far.as_ref()?, faces.far.as_ref()?);
        let count = &faces.counts;
        recorder.compute("light::far", |pass| {
            kernels.collect.dispatch_indirect(
                pass,
                &[globals, &far.collect, lights],
                count,
                FACE_ARGUMENTS,
            );
            kernels.rows.dispatch_indirect(pass, &[globals, &far.rows], count, FACE_ARGUMENTS);
            kernels.columns.dispatch_indirect(
                pass,
                &[globals, &far.columns],
                count,
                FACE_ARGUMENTS,
            );
        });
        Some(&far.light[0])
    }

    /// Gathers for the faces whose turn it is, and for those that have never gathered.
    pub fn gather(
        &self,
        recorder: &mut Recorder<'_>,
        [globals, lights]: [&BindGroup; 2],
        faces: &Faces,
        turn: Turn,
    ) {
        run_turn(recorder, "light::bounce", &self.bounce, [globals, lights], faces, turn);
    }

    /// Computes the irradiance straight from emitters, if there are any, for the faces whose turn
    /// it is and for those that have never gathered.
    pub fn shine(
        &self,
        recorder: &mut Recorder<'_>,
        groups: [&BindGroup; 2],
        faces: &Faces,
        turn: Turn,
    ) {
        if faces.has_emission {
            run_turn(recorder, "light::shine", &self.shine, groups, faces, turn);
        }
    }

    /// Computes the radiance that faces send out, and its part that the volume shows: all light, or
    /// only reflected light if there are emitters.
    pub fn reflect(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        faces.run(recorder, "light::reflect", &self.reflect, &[grid, &faces.reflect]);
        let show = if faces.has_emission { &self.show_without_emission } else { &self.show };
        faces.run(recorder, "light::show", show, &[grid, &faces.show]);
    }

    /// Computes the radiance that the volume shows with emission, and saves that without.
    pub fn emit(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        recorder.copy((&faces.shown, 0), (&faces.reflected, 0), faces.shown.size());
        faces.run(recorder, "light::show", &self.show, &[grid, &faces.show]);
    }

    /// Before a list is committed: moves the light of faces whose place in the list changes.
    pub fn move_light(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &Faces) {
        recorder.compute("light::move_light", |pass| {
            let voxels = faces.moving_voxels;
            self.move_light.dispatch_linear(pass, &[grid, &faces.move_light], voxels);
            self.settle.dispatch_linear(pass, &[grid, &faces.settle], faces.moving_capacity);
        });
    }

    /// After a list was committed: copies light from the faces of the list that it replaced.
    pub fn copy_replaced(&self, recorder: &mut Recorder<'_>, grid: &BindGroup, faces: &mut Faces) {
        if let Some(group) = faces.replaced.take() {
            self.copy_replaced.run_linear(recorder, &[grid, &group], faces.capacity);
        }
    }
}

/// Runs kernels for the faces whose turn it is, and for those that have never gathered.
fn run_turn(
    recorder: &mut Recorder<'_>,
    label: &str,
    [in_turn, fresh]: &[Kernel; 2],
    [globals, lights]: [&BindGroup; 2],
    faces: &Faces,
    turn: Turn,
) {
    let groups = [globals, &faces.bounce, lights];
    let count = faces.capacity.min(turn.faces.into());
    let fresh_count = if turn.is_list_new { faces.capacity } else { faces.moving_capacity };
    recorder.compute(label, |pass| {
        in_turn.dispatch_linear(pass, &groups, count);
        if count < faces.capacity || turn.is_by_cascade {
            fresh.dispatch_linear(pass, &groups, fresh_count);
        }
    });
}

/// Per-face light buffers of a voxel list.
#[derive(Debug)]
pub(super) struct Faces {
    /// The bound buffers, to detect changes: the list's faces, and the moving faces that the list
    /// will get.
    list: [Buffer; 2],
    counts: Buffer,
    capacity: u64,
    moving_voxels: u64,
    moving_capacity: u64,
    /// Radiance without bounces (`array<vec4f>`).
    direct: Buffer,
    /// Irradiance gathered (`array<vec4f>`).
    irradiance: Buffer,
    /// Radiance with the bounces so far (`array<vec4f>`).
    radiance: Buffer,
    /// Radiance that cones see (`show.wgsl`).
    shown: Buffer,
    /// Radiance that the volume currently stores.
    held: Buffer,
    /// `true` if there are emitters. If `false`, `reflected` is empty.
    has_emission: bool,
    /// The hits of the faces' rays, the adjacent faces, irradiance from emitters, and last steps
    /// (`turn.wgsl`).
    hits: Buffer,
    /// `None` if cones march.
    far: Option<Far>,
    /// Radiance that the volume shows without emission.
    reflected: Buffer,
    direct_group: BindGroup,
    box_moved: BindGroup,
    bounce: BindGroup,
    reflect: BindGroup,
    show: BindGroup,
    move_light: BindGroup,
    settle: BindGroup,
    /// Bindings to copy light from a replaced list, used once.
    replaced: Option<BindGroup>,
}

/// Far light.
#[derive(Debug)]
struct Far {
    /// Far light: first of single faces, finally of 7 x 7; the second buffer is for rows of 7.
    light: [Buffer; 2],
    collect: BindGroup,
    rows: BindGroup,
    columns: BindGroup,
}

impl Far {
    fn new(
        device: &wgpu::Device,
        kernels: &LightKernels,
        [settings, boxes, hits]: [&Buffer; 3],
        list: &VoxelList,
    ) -> Option<Self> {
        let far = kernels.far.as_ref()?;
        let light = ["far light", "far light of rows"]
            .map(|label| storage_buffer(device, label, list.face_capacity() * FAR_BYTES));
        let collect = BindGroupBuilder::new(&kernels.bounce_layout)
            .buffer(settings)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(boxes)
            .buffer(&list.faces)
            .buffer(&light[0])
            .buffer(hits)
            .build(device, "far light");
        let [rows, columns] = [[&light[0], &light[1]], [&light[1], &light[0]]].map(|[from, to]| {
            BindGroupBuilder::new(&far.share_layout)
                .slice(&list.counts, 0, LIST_COUNT_BYTES)
                .buffer(hits)
                .buffer(from)
                .buffer(to)
                .build(device, "share far light")
        });
        Some(Self { light, collect, rows, columns })
    }
}

impl Faces {
    /// Buffers for the light of a list; light of `earlier` is kept.
    pub fn new(
        recorder: &mut Recorder<'_>,
        kernels: &LightKernels,
        settings: &Buffer,
        (Collected { list, replaced, moving, .. }, has_emission): (Collected<'_>, bool),
        earlier: Option<Self>,
    ) -> Self {
        let device = recorder.device().clone();
        let faces = Self::bound(&device, kernels, settings, (list, moving), has_emission);
        let Some(earlier) = earlier else { return faces };
        let Some(old) = replaced else {
            // The list was only reallocated.
            for (from, to) in
                [(&earlier.irradiance, &faces.irradiance), (&earlier.held, &faces.held)]
            {
                recorder.copy((from, 0), (to, 0), from.size().min(to.size()));
            }
            return faces;
        };
        let group = BindGroupBuilder::new(&kernels.copy_layout)
            .buffer(&list.faces)
            .buffer(&old.occupancy)
            .buffer(&old.ranks)
            .buffer(&old.first_faces)
            .buffer(&old.faces)
            .buffer(&earlier.irradiance)
            .buffer(&faces.irradiance)
            .build(&device, "copy replaced light");
        Self { replaced: Some(group), ..faces }
    }

    fn bound(
        device: &wgpu::Device,
        kernels: &LightKernels,
        settings: &Buffer,
        (list, moving): (&VoxelList, Moving<'_>),
        has_emission: bool,
    ) -> Self {
        let buffer = |label| storage_buffer(device, label, list.face_capacity() * 16);
        let direct = buffer("direct radiance");
        let irradiance = buffer("gathered irradiance");
        let radiance = buffer("radiance");
        let shown = buffer("shown radiance");
        let held = buffer("held radiance");
        let hits = storage_buffer(device, "hits", list.face_capacity() * HIT_BYTES);
        // Two vectors of four words for each box.
        let boxes = counted_buffer(device, "boxes of moved surface", 32 * u64::from(MOVED_BOXES));
        let far = Far::new(device, kernels, [settings, &boxes, &hits], list);
        let reflected = if has_emission { list.face_capacity() * 16 } else { 0 };
        let reflected = storage_buffer(device, "reflected radiance", reflected);
        let moving_count = moving.faces.size() / size_of::<crate::voxels::FaceRecord>() as u64;
        let [moving_irradiance, moving_held] = ["moving irradiance", "moving held radiance"]
            .map(|label| storage_buffer(device, label, moving_count * 16));
        let direct_group = BindGroupBuilder::new(&kernels.direct_layout)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&list.faces)
            .buffer(&direct)
            .build(device, "direct light");
        let box_moved = BindGroupBuilder::new(&kernels.box_layout)
            .buffer(settings)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&list.faces)
            .buffer(&boxes)
            .build(device, "box of moved surface");
        let bounce = BindGroupBuilder::new(&kernels.bounce_layout)
            .buffer(settings)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&boxes)
            .buffer(&list.faces)
            .buffer(&irradiance)
            .buffer(&hits)
            .build(device, "bounce");
        let reflect = BindGroupBuilder::new(&kernels.reflect_layout)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&list.faces)
            .buffer(&direct)
            .buffer(&irradiance)
            .buffer(&radiance)
            .build(device, "reflect");
        let show = BindGroupBuilder::new(&kernels.show_layout)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&list.faces)
            .buffer(&radiance)
            .buffer(&shown)
            .build(device, "show");
        let move_light = BindGroupBuilder::new(&kernels.move_light_layout)
            .buffer(moving.needs)
            .buffer(moving.united_faces)
            .buffer(moving.faces)
            .buffer(moving.former)
            .buffer(&list.faces)
            .buffer(&irradiance)
            .buffer(&held)
            .buffer(&moving_irradiance)
            .buffer(&moving_held)
            .build(device, "move light");
        let settle = BindGroupBuilder::new(&kernels.settle_layout)
            .buffer(moving.needs)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&moving_irradiance)
            .buffer(&moving_held)
            .buffer(&irradiance)
            .buffer(&held)
            .build(device, "settle");
        Self {
            list: [&list.faces, moving.faces].map(Buffer::clone),
            counts: list.counts.clone(),
            capacity: list.face_capacity(),
            moving_voxels: moving.voxels,
            moving_capacity: moving_count,
            direct,
            irradiance,
            radiance,
            shown,
            held,
            has_emission,
            hits,
            far,
            reflected,
            direct_group,
            box_moved,
            bounce,
            reflect,
            show,
            move_light,
            settle,
            replaced: None,
        }
    }

    /// `true` if bound to the buffers of a list that is about to be committed, with buffers for
    /// emission if there are emitters.
    pub fn is_of(&self, next: &Collected<'_>, has_emission: bool) -> bool {
        self.list.each_ref() == [&next.list.faces, next.moving.faces]
            && self.has_emission == has_emission
    }

    /// `true` if there are emitters.
    pub fn has_emission(&self) -> bool {
        self.has_emission
    }

    /// Makes the volume's next update show only reflected light, or all light again.
    pub fn hide_emission(&self, recorder: &mut Recorder<'_>, hides: bool) {
        let from = if hides { &self.reflected } else { &self.held };
        recorder.copy((from, 0), (&self.shown, 0), self.shown.size());
    }

    /// `true` if light has to be copied from a list that was replaced.
    pub fn has_replaced(&self) -> bool {
        self.replaced.is_some()
    }

    /// Maximum number of faces.
    pub fn capacity(&self) -> u64 {
        self.capacity
    }

    /// Irradiance gathered.
    pub fn irradiance(&self) -> &Buffer {
        &self.irradiance
    }

    /// The hits of the faces' rays, and irradiance straight from emitters.
    pub fn hits(&self) -> &Buffer {
        &self.hits
    }

    /// Radiance without bounces.
    pub fn direct(&self) -> &Buffer {
        &self.direct
    }

    /// Radiance with the bounces so far.
    pub fn radiance(&self) -> &Buffer {
        &self.radiance
    }

    /// Radiance to be shown by the volume, and radiance that it stores.
    pub fn shown(&self) -> Shown<'_> {
        Shown { now: &self.shown, held: &self.held }
    }

    /// Copies `shown` to `held`: the volume now stores it.
    pub fn hold(&self, recorder: &mut Recorder<'_>) {
        recorder.copy((&self.shown, 0), (&self.held, 0), self.shown.size());
    }

    /// Runs the kernel of direct light with groups 0 and 2.
    pub fn run_direct(
        &self,
        recorder: &mut Recorder<'_>,
        kernel: &Kernel,
        [globals, lights]: [&BindGroup; 2],
    ) {
        self.run(recorder, "light::direct", kernel, &[globals, &self.direct_group, lights]);
    }

    /// Runs a kernel over all faces.
    fn run(
        &self,
        recorder: &mut Recorder<'_>,
        label: &str,
        kernel: &Kernel,
        groups: &[&BindGroup],
    ) {
        recorder.compute(label, |pass| {
            kernel.dispatch_indirect(pass, groups, &self.counts, FACE_ARGUMENTS);
        });
    }

    /// Bytes on the GPU, by purpose.
    pub fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![
            ("light: direct radiance of the faces", self.direct.size()),
            ("light: irradiance of the faces", self.irradiance.size()),
            ("light: radiance of the faces", self.radiance.size()),
            ("light: shown radiance of the faces", self.shown.size()),
            ("light: held radiance of the faces", self.held.size()),
            ("light: what the faces' rays meet", self.hits.size()),
            (
                "light: from afar",
                self.far.iter().flat_map(|far| &far.light).map(|light| light.size()).sum(),
            ),
            ("light: reflected radiance of the faces", self.reflected.size()),
        ]
    }
}
