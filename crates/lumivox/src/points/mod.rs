//! Irradiance at arbitrary points: for lux meters, probes and baking.
//!
//! A point gathers like a pixel, without a G-buffer. Cone directions differ from frame to frame;
//! the result is the mean over the frames. The result buffer stores the mean and the number of
//! frames, so later gathers continue from there.

#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::cones::{ConeSettings, TraceSettings};
use crate::emitters::SAMPLES_EMITTERS;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, BufferHandle, Kept, KernelVariants, LayoutBuilder,
    Pipelines, Recorder, ShaderError, ShaderLibrary, Slot, Slots, storage_buffer, uniform_buffer,
    upload,
};

/// Directions of a probe in the kernels of `probes.wgsl`, which callers link as `points::probes`:
/// +x, -x, +y, -y, +z, -z.
pub const PROBE_SIDES: u32 = 6;

pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library.constant_u32("PROBE_SIDES", PROBE_SIDES);
}

/// How irradiance at points is gathered.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GatherSettings {
    /// The cones. Their settings for glossy cones and for the screen's resolution are ignored.
    pub cones: TraceSettings,
    /// Frames to gather, 1 to 65 536; default 16. Higher values reduce noise; the cost is
    /// proportional.
    pub frames: u32,
    /// `true` to also compute direct light of lamps and suns, each with its own kind of shadow;
    /// default `true`.
    pub direct: bool,
}

impl Default for GatherSettings {
    fn default() -> Self {
        Self { cones: TraceSettings::default(), frames: 16, direct: true }
    }
}

/// The irradiance at a point, in the unit of the lights: lux if they are in lux and candela.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Irradiance {
    /// Light from surfaces and the environment, RGB.
    pub indirect: Vec3,
    /// Direct light from lamps and suns, RGB; zero unless [`GatherSettings::direct`] is set.
    pub direct: Vec3,
    /// The open share of the hemisphere, weighted by the cosine, 0 to 1.
    pub openness: f32,
}

impl Irradiance {
    /// Sum of direct and indirect light, RGB.
    pub fn total(&self) -> Vec3 {
        self.direct + self.indirect
    }
}

/// `GatheredPoint` of `gather.wgsl`: an element of [`GatherPoints::gathered`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct GatheredPoint {
    /// Mean irradiance from surfaces and the environment over the frames so far, RGB. The sum over
    /// the cones of a few frames may be slightly negative.
    pub indirect: [f32; 3],
    /// The open share of the hemisphere, as in [`Irradiance`].
    pub openness: f32,
    /// Irradiance from lamps and suns, RGB.
    pub direct: [f32; 3],
    /// Number of frames gathered so far.
    pub frames: u32,
}

impl From<GatheredPoint> for Irradiance {
    fn from(point: GatheredPoint) -> Self {
        Self {
            indirect: Vec3::from(point.indirect).max(Vec3::ZERO),
            direct: point.direct.into(),
            openness: point.openness,
        }
    }
}

/// `PointSettings` of `gather.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct PointSettings {
    pub(crate) cones: ConeSettings,
    pub(crate) cone_count: u32,
    pub(crate) point_count: u32,
    pub(crate) frames: u32,
    pub(crate) has_direct: u32,
}

/// Points on the GPU, with the light gathered there.
#[derive(Debug)]
pub struct GatherPoints {
    positions: Given,
    normals: Given,
    gathered: Buffer,
    count: u32,
    slots: Slots<PointSlot>,
}

/// A buffer owned by Lumivox or by the caller.
#[derive(Clone, Debug)]
enum Given {
    Own(Buffer),
    Callers(wgpu::Buffer),
}

impl BufferHandle for Given {
    fn raw(&self) -> &wgpu::Buffer {
        match self {
            Self::Own(buffer) => buffer,
            Self::Callers(buffer) => buffer,
        }
    }

    fn kept(&self) -> Option<Kept> {
        match self {
            Self::Own(buffer) => buffer.kept(),
            Self::Callers(_) => None,
        }
    }
}

impl GatherPoints {
    /// Points in the caller's buffers, which need `BufferUsages::STORAGE`: `count` positions (m)
    /// and normals (of any nonzero length), four `f32` each; the fourth is not read.
    pub fn new(
        device: &wgpu::Device,
        positions: &wgpu::Buffer,
        normals: &wgpu::Buffer,
        count: u32,
    ) -> Self {
        let given = [positions, normals].map(|buffer| Given::Callers(buffer.clone()));
        Self::of(device, given, count)
    }

    pub(crate) fn upload(device: &wgpu::Device, positions: &[Vec3], normals: &[Vec3]) -> Self {
        let given = [("positions", positions), ("normals", normals)].map(|(label, vectors)| {
            let padded: Vec<[f32; 4]> =
                vectors.iter().map(|vector| vector.extend(0.0).to_array()).collect();
            Given::Own(upload(device, label, &padded))
        });
        Self::of(device, given, positions.len() as u32)
    }

    fn of(device: &wgpu::Device, [positions, normals]: [Given; 2], count: u32) -> Self {
        let bytes = u64::from(count) * size_of::<GatheredPoint>() as u64;
        let gathered = storage_buffer(device, "gathered", bytes);
        Self { positions, normals, gathered, count, slots: Slots::default() }
    }

    /// The results: a [`GatheredPoint`] for each point.
    pub fn gathered(&self) -> &Buffer {
        &self.gathered
    }

    /// Number of points.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Discards the results. Call it after the light or the points have changed.
    pub fn restart(&self, recorder: &mut Recorder) {
        recorder.clear(&self.gathered);
    }
}

/// The settings of one pass, with their bind group.
#[derive(Debug)]
struct PointSlot {
    settings: Buffer,
    group: BindGroup,
}

impl Slot for PointSlot {
    fn is_free(&self) -> bool {
        !self.group.is_held()
    }
}

/// Maximum gathers per pass: they take a GPU milliseconds, and two CPU cores a few seconds, less
/// than any system's hang timeout.
const GATHERS_A_PASS: u64 = 1 << 16;

/// Maximum frames per pass. Mesa's software driver silently ends all loops of a thread after 65 535
/// iterations in total (`LP_MAX_TGSI_LOOP_ITERATIONS` in `lp_bld_limits.h`), and a frame needs a
/// thousand or more: of 256 frames in one pass only the first 60 to 110 were gathered.
const FRAMES_A_PASS: u64 = 4;

/// Gathers light at points.
#[derive(Debug)]
pub(crate) struct PointGatherer {
    layout: wgpu::BindGroupLayout,
    kernel: KernelVariants,
}

impl PointGatherer {
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        [globals, lights]: [&wgpu::BindGroupLayout; 2],
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage()
            .storage_mut()
            .build(device, "points");
        let layouts = [globals, &layout, lights];
        let kernel = KernelVariants::new(
            device,
            shaders,
            SAMPLES_EMITTERS,
            "points::gather",
            "main",
            &layouts,
        )?;
        Ok(Self { layout, kernel })
    }

    /// Queues the kernel for compilation.
    pub(crate) fn expect(&self, device: &Pipelines, has_emitters: bool) {
        self.kernel.expect(device, has_emitters);
    }

    /// Adds frames to the points, a few in each pass.
    pub(crate) fn run(
        &self,
        recorder: &mut Recorder,
        (bound, has_emitters): ([&BindGroup; 2], bool),
        points: &GatherPoints,
        settings: &GatherSettings,
        cones: ConeSettings,
    ) {
        recorder.stage("points");
        let count = u64::from(points.count);
        let most = (GATHERS_A_PASS / count.max(1)).clamp(1, FRAMES_A_PASS) as u32;
        let mut left = settings.frames;
        while left > 0 && count > 0 {
            let frames = left.min(most);
            left -= frames;
            let uniform = PointSettings {
                cones,
                cone_count: settings.cones.diffuse_cones,
                point_count: points.count,
                frames,
                // Computed only once, since direct light is the same in each frame.
                has_direct: u32::from(settings.direct && left == 0),
            };
            self.pass(recorder, (bound, has_emitters), points, &uniform);
        }
    }

    fn pass(
        &self,
        recorder: &mut Recorder,
        ([globals, lights], has_emitters): ([&BindGroup; 2], bool),
        points: &GatherPoints,
        uniform: &PointSettings,
    ) {
        let device = recorder.device().clone();
        let make = || {
            let settings = uniform_buffer(&device, "point settings", uniform);
            let group = BindGroupBuilder::new(&self.layout)
                .buffer(&settings)
                .buffer(&points.positions)
                .buffer(&points.normals)
                .buffer(&points.gathered)
                .build(&device, "points");
            PointSlot { settings, group }
        };
        points.slots.with_free(make, |slot| {
            recorder.queue().write_buffer(&slot.settings, 0, bytemuck::bytes_of(uniform));
            let groups = [globals, &slot.group, lights];
            self.kernel.variant(has_emitters).run_linear(
                recorder,
                &groups,
                u64::from(points.count),
            );
        });
    }
}
