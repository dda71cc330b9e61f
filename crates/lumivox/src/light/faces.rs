//! The light of a voxel list's faces.

use super::kernels::{FarKernels, LightKernels};
use super::turns::MOVED_BOXES;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, Recorder, Texture, counted_buffer, storage_buffer,
    texel_bytes, texels,
};
use crate::volume::Surface;
use crate::volume::changes::Shown;
use crate::voxelize::{Collected, Moving};
use crate::voxels::{FACE_ARGUMENTS, LIST_COUNT_BYTES, VoxelList};

/// Words per face in `hits`: the hits of its rays, its adjacent faces, its irradiance from
/// emitters, and the step of its last gather.
pub(crate) const HIT_WORDS: u32 = 24;
const HIT_BYTES: u64 = 4 * HIT_WORDS as u64;

/// Cells of the hemisphere for a face's far light, a word each.
pub(super) const FAR_CELLS: u32 = 16;
/// Texels of a face's far light: the cells, and what mirrors need (`volume/face_light.wgsl`).
pub(crate) const FAR_TEXELS: u32 = FAR_CELLS / 4 + 1;

/// Per-face light buffers of a voxel list.
#[derive(Debug)]
pub(super) struct Faces {
    /// The bound buffers, to detect changes: the list's faces, and the moving faces that the list
    /// will get.
    list: [Buffer; 2],
    pub(super) counts: Buffer,
    pub(super) capacity: u64,
    pub(super) moving_voxels: u64,
    pub(super) moving_capacity: u64,
    /// Radiance without bounces (`array<vec4f>`).
    direct: Buffer,
    /// Irradiance gathered (`array<vec4f>`).
    irradiance: Buffer,
    /// Radiance with the bounces so far (`array<vec4f>`).
    radiance: Buffer,
    /// Radiance that the cells currently store. Empty without cells.
    held: Buffer,
    /// The hits of the faces' rays, the adjacent faces, irradiance from emitters, and last steps
    /// (`turn.wgsl`).
    hits: Buffer,
    boxes: Buffer,
    /// `None` if cones march, and until [`Self::bind_far`].
    pub(super) far: Option<Far>,
    direct_group: BindGroup,
    pub(super) box_moved: BindGroup,
    pub(super) bounce: BindGroup,
    pub(super) reflect: BindGroup,
    pub(super) move_light: BindGroup,
    pub(super) settle: BindGroup,
    /// Bindings to copy light from a replaced list, used once.
    pub(super) replaced: Option<BindGroup>,
}

/// Far light.
#[derive(Debug)]
pub(super) struct Far {
    /// Far light: first of single faces, finally of 7 x 7.
    pub(super) light: Texture,
    pub(super) collect: BindGroup,
    pub(super) rows: BindGroup,
    pub(super) columns: BindGroup,
}

impl Far {
    /// Far light is shared by way of the place in `surface` where rays will read it.
    fn new(
        device: &wgpu::Device,
        kernels: &FarKernels,
        [settings, boxes, irradiance, hits, direct]: [&Buffer; 5],
        surface: &Surface,
        list: &VoxelList,
    ) -> Self {
        let light = texels(device, "far light", list.face_capacity() * u64::from(FAR_TEXELS));
        let (light_view, read_view) = (light.view(), surface.texture().view());
        let collect = BindGroupBuilder::new(&kernels.collect_layout)
            .buffer(settings)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(boxes)
            .buffer(&list.faces)
            .buffer(irradiance)
            .buffer(hits)
            .buffer(direct)
            .view(&light_view)
            .build(device, "far light");
        let views = [&light_view, &read_view];
        let [rows, columns] = [views, [views[1], views[0]]].map(|[from, to]| {
            BindGroupBuilder::new(&kernels.share_layout)
                .slice(&list.counts, 0, LIST_COUNT_BYTES)
                .buffer(hits)
                .buffer(surface.parts())
                .view(from)
                .view(to)
                .build(device, "share far light")
        });
        Self { light, collect, rows, columns }
    }
}

impl Faces {
    /// Buffers for the light of a list; light of `earlier` is kept.
    pub fn new(
        recorder: &mut Recorder<'_>,
        kernels: &LightKernels,
        settings: &Buffer,
        Collected { list, replaced, moving, .. }: Collected<'_>,
        earlier: Option<Self>,
    ) -> Self {
        let device = recorder.device().clone();
        let faces = Self::bound(&device, kernels, settings, list, moving);
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
        list: &VoxelList,
        moving: Moving<'_>,
    ) -> Self {
        let buffer = |label, faces| storage_buffer(device, label, faces * 16);
        let capacity = list.face_capacity();
        let [direct, irradiance, radiance] = ["direct radiance", "gathered irradiance", "radiance"]
            .map(|label| buffer(label, capacity));
        let in_cells = |faces| if kernels.has_cells { faces } else { 0 };
        let held = buffer("held radiance", in_cells(capacity));
        let hits = storage_buffer(device, "hits", capacity * HIT_BYTES);
        // Two vectors of four words for each box.
        let boxes = counted_buffer(device, "boxes of moved surface", 32 * u64::from(MOVED_BOXES));
        let moving_count = moving.faces.size() / size_of::<crate::voxels::FaceRecord>() as u64;
        let moving_irradiance = buffer("moving irradiance", moving_count);
        let moving_held = buffer("moving held radiance", in_cells(moving_count));
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
            capacity,
            moving_voxels: moving.voxels,
            moving_capacity: moving_count,
            direct,
            irradiance,
            radiance,
            held,
            hits,
            boxes,
            far: None,
            direct_group,
            box_moved,
            bounce,
            reflect,
            move_light,
            settle,
            replaced: None,
        }
    }

    /// Binds the surface that rays meet, with its far light.
    pub fn bind_far(
        &mut self,
        device: &wgpu::Device,
        kernels: &LightKernels,
        (settings, surface): (&Buffer, &Surface),
        list: &VoxelList,
    ) {
        let buffers = [settings, &self.boxes, &self.irradiance, &self.hits, &self.direct];
        let far = kernels.far.as_ref();
        self.far = far.map(|far| Far::new(device, far, buffers, surface, list));
    }

    /// `true` if bound to the buffers of a list that is about to be committed.
    pub fn is_of(&self, next: &Collected<'_>) -> bool {
        self.list.each_ref() == [&next.list.faces, next.moving.faces]
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

    /// The radiance, and that stored in cells.
    pub fn shown(&self) -> Shown<'_> {
        Shown { now: &self.radiance, held: &self.held }
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
    pub fn run(
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
            ("light: radiance of the faces in cells", self.held.size()),
            ("light: what the faces' rays meet", self.hits.size()),
            ("light: from afar", self.far.iter().map(|far| texel_bytes(&far.light)).sum()),
        ]
    }
}
