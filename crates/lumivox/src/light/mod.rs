//! Light in the voxels: direct light and emission, and bounces.
//!
//! Everything here runs only over the faces of the voxel list. A face sends out `Le + reflectance /
//! pi * E`; `E` is the irradiance from the analytic lights (`direct.wgsl`) and from other faces
//! (`bounce.wgsl`). The light of emissive surfaces and of the environment arrives by gathers: cones
//! see the environment and reflected light, emitters are sampled (`shine.wgsl`). A caller's own
//! [`Injection`] replaces the direct evaluation.
//!
//! The irradiance that faces have gathered is kept. A still image starts from darkness and gathers
//! for a number of bounces ([`Budget::Bounces`]); a frame continues from the previous frame
//! ([`Budget::Faces`]), so that light travels one bounce a frame, and converges to the same result.
//! [`Lighting::step`] does both.

mod faces;
mod injection;
mod kernels;
mod lights;
#[cfg(test)]
mod tests;
mod turns;

use bytemuck::{Pod, Zeroable};

use crate::cones::{ConeSettings, TraceSettings};
use crate::emitters::Emitters;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, KernelVariants, LayoutBuilder, Pipelines, Recorder,
    ShaderLibrary, Staged,
};
use crate::volume::changes::{Changes, Shown};
use crate::volume::{Surface, Volume};
use crate::voxelize::Collected;
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use faces::Faces;
use kernels::LightKernels;
use turns::{Shines, Turn, Turns};

pub(crate) use faces::{FAR_TEXELS, HIT_WORDS};
pub use injection::{FaceLight, Injection, InjectionParts, Injector};
pub(crate) use lights::lights_layout;
pub use lights::{
    Light, LightSource, Lights, MappedLight, Shadow, ShadowLayer, ShadowMaps, ShadowSource,
};
#[cfg(test)]
pub(crate) use lights::{LightGlobals, LightRecord, ShadowLayerRecord};

/// The constant that decides whether a kernel has the rays of [`Shadow::Cone`](crate::Shadow).
pub const TRACES_SHADOWS: &str = "TRACES_SHADOWS";

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("LIGHT_DIRECTIONAL", lights::LIGHT_DIRECTIONAL)
        .constant_u32("LIGHT_POINT", lights::LIGHT_POINT)
        .constant_u32("LIGHT_SPOT", lights::LIGHT_SPOT)
        .constant_u32("LIGHT_ENVIRONMENT", lights::LIGHT_ENVIRONMENT)
        .constant_u32("SHADOW_NONE", lights::SHADOW_NONE)
        .constant_u32("SHADOW_MAP", lights::SHADOW_MAP)
        .constant_u32("SHADOW_CONE", lights::SHADOW_CONE)
        .constant_u32(TRACES_SHADOWS, 1)
        .constant_u32("HAS_INJECTION", 0)
        .constant_u32("HIT_WORDS", HIT_WORDS)
        .constant_u32("FAR_CELLS", faces::FAR_CELLS)
        .constant_u32("FAR_TEXELS", FAR_TEXELS)
        .constant_u32("RAREST_CASCADE", turns::RAREST_CASCADE)
        .constant_u32("RAY_CLASSES", turns::RAY_CLASSES)
        .constant_u32("MOVED_BOXES", turns::MOVED_BOXES)
        .constant_f32("RELAXATION", turns::RELAXATION)
        .constant_f32("MOMENTUM", turns::MOMENTUM)
        .constant_f32("GROWTH_OF_MOMENTUM", turns::GROWTH_OF_MOMENTUM)
        .constant_f32("MOST_MOMENTUM", turns::MOST_MOMENTUM);
}

/// `BounceSettings` of `turn.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct BounceSettings {
    pub(crate) cones: ConeSettings,
    pub(crate) cone_count: u32,
    pub(crate) faces_at_a_time: u32,
    pub(crate) turn: u32,
    pub(crate) has_emitters: u32,
    pub(crate) by_cascade: u32,
    pub(crate) is_list_new: u32,
    pub(crate) rays_anew: u32,
    pub(crate) relaxes: u32,
    pub(crate) shines_on_all: u32,
    pub(crate) boxes: u32,
    pub(crate) box_written: u32,
    pub(crate) has_moved: u32,
}

/// How much light [`Lighting::step`] computes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Budget {
    /// All light, starting from darkness: direct light, then a gather for each bounce except the
    /// last, which pixels gather. From eight bounces on, fewer gathers that are accelerated.
    Bounces(u32),
    /// One gather of at most this number of faces, which continues from the current light. `None`:
    /// all faces; with cascades, those of coarse cascades less often.
    Faces(Option<u32>),
}

/// The inputs of [`Lighting::step`], and the volume that shows the light.
pub(crate) struct Lit<'a> {
    pub(crate) volume: &'a Volume,
    /// `None` without cells.
    pub(crate) changes: Option<&'a mut Changes>,
    pub(crate) lights: &'a Lights,
    pub(crate) emitters: &'a Emitters,
    /// The cones, and the values of a caller's model.
    pub(crate) cones: (&'a TraceSettings, [f32; 4]),
}

/// Lights the faces of a voxel list.
#[allow(clippy::struct_excessive_bools, reason = "independent facts about the list")]
#[derive(Debug)]
pub(crate) struct Lighting {
    direct: Direct,
    kernels: LightKernels,
    /// Only the grid.
    grid: BindGroup,
    settings: Staged,
    faces: Option<Faces>,
    turns: Turns,
    /// `true` if there ever was dynamic surface.
    has_moving: bool,
    /// `true` if the list that was collected last has emitters.
    expects_emission: bool,
    /// `true` if the bound list has emitters.
    has_emission: bool,
}

/// How the light of lamps is computed.
#[derive(Debug)]
enum Direct {
    /// Each face evaluates each light (`direct.wgsl`).
    Faces(KernelVariants),
    /// The caller's injector.
    Own(Box<dyn Injector>),
}

impl Lighting {
    /// Queues the kernels of bounces for compilation, and with `in_frames` those that only frames
    /// use.
    pub(crate) fn expect_bounces(&self, device: &Pipelines, has_emitters: bool, in_frames: bool) {
        self.kernels.expect_bounces(device, has_emitters, in_frames);
    }

    /// Queues the kernel of direct light with rays for shadows for compilation.
    pub(crate) fn expect_shadow_rays(&self, device: &Pipelines) {
        if let Direct::Faces(kernels) = &self.direct {
            kernels.expect(device, true);
        }
    }

    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        (injection, marches, has_cells): (Option<&dyn Injection>, bool, bool),
        globals: &wgpu::BindGroupLayout,
        lights: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        // Only the grid: the volume and the kernels' own buffers together exceed the limit of
        // bindings.
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let grid_group =
            BindGroupBuilder::new(&grid_layout).buffer(&grid.uniform(device)).build(device, "grid");
        let traits = (marches, has_cells);
        let kernels = LightKernels::new(device, shaders, &grid_layout, [globals, lights], traits)?;
        let direct = match injection {
            None => Direct::Faces(kernels.direct(device, shaders, [globals, lights])?),
            Some(injection) => {
                let parts = InjectionParts { device, shaders, grid, globals, lights };
                Direct::Own(injection.make(&parts)?)
            }
        };
        let bytes = size_of::<BounceSettings>() as u64;
        Ok(Self {
            direct,
            kernels,
            grid: grid_group,
            settings: Staged::new(device, "bounce settings", bytes),
            faces: None,
            turns: Turns::new(grid, marches),
            has_moving: false,
            expects_emission: false,
            has_emission: false,
        })
    }

    /// Uses the moved boxes of a clipmap for later commands.
    pub(crate) fn move_to(&mut self, device: &Pipelines, grid: &Grid) {
        let layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let uniform = grid.uniform(device);
        self.grid = BindGroupBuilder::new(&layout).buffer(&uniform).build(device, "grid");
    }

    /// Moves the light of faces to a list that is about to be committed. Returns `true` if it is
    /// bound to new buffers.
    pub(crate) fn bind(&mut self, recorder: &mut Recorder<'_>, next: Collected<'_>) -> bool {
        self.turns.surface_moved();
        self.has_moving = next.has_moving;
        if self.expects_emission && !self.has_emission {
            self.turns.disturb();
        }
        self.has_emission = self.expects_emission;
        if self.faces.as_ref().is_some_and(|faces| faces.is_of(&next)) {
            if let Some(faces) = &self.faces {
                self.kernels.move_light(recorder, &self.grid, faces);
            }
            return false;
        }
        let earlier = self.faces.take();
        let faces = Faces::new(recorder, &self.kernels, self.settings.buffer(), next, earlier);
        self.turns.replace_rays();
        self.kernels.move_light(recorder, &self.grid, &faces);
        if faces.has_replaced() {
            // Faces that were not in the previous list have not gathered yet.
            self.turns.gather_fresh();
        }
        self.faces = Some(faces);
        true
    }

    /// Binds the surface that rays meet, with its far light, of the list to be committed.
    pub(crate) fn bind_far(&mut self, device: &wgpu::Device, list: &VoxelList, surface: &Surface) {
        if let Some(faces) = &mut self.faces {
            faces.bind_far(device, &self.kernels, (self.settings.buffer(), surface), list);
        }
    }

    /// After a list was committed: copies light from the list that it replaced.
    pub(crate) fn copy_replaced(&mut self, recorder: &mut Recorder<'_>) {
        if let Some(faces) = &mut self.faces {
            self.kernels.copy_replaced(recorder, &self.grid, faces);
        }
    }

    /// Sets whether there are emitters, from the next list on.
    pub(crate) fn expect_emission(&mut self, has_emission: bool) {
        self.expects_emission = has_emission;
    }

    /// Call when a list is shown: passes it to the caller's injector, if there is one.
    pub(crate) fn set_list(&mut self, device: &Pipelines, voxels: &VoxelList) {
        if let Direct::Own(injector) = &mut self.direct {
            injector.take(device, voxels);
        }
    }

    /// The radiance of the faces, and that stored in cells.
    pub(crate) fn shown(&self) -> Option<Shown<'_>> {
        self.faces.as_ref().map(Faces::shown)
    }

    /// Records direct light and gathers within the budget; stores and filters changed light.
    /// Records nothing and returns `false` once light has converged.
    pub(crate) fn step(&mut self, recorder: &mut Recorder, lit: Lit<'_>, budget: Budget) -> bool {
        let Lit { volume, mut changes, lights, emitters, cones } = lit;
        let Some(faces) = &self.faces else { return false };
        let versions = [lights.version, emitters.version()];
        let turn = match budget {
            Budget::Bounces(bounces) => Some(self.turns.restart(versions, bounces)),
            Budget::Faces(most) => {
                // With rays, only one setting affects the faces' light: the width of samples of the
                // environment.
                let (settings, values) = cones;
                let width = settings.voxel_per_diameter;
                let rays = TraceSettings { voxel_per_diameter: width, ..TraceSettings::default() };
                let seen = if volume.is_marched() { *settings } else { rays };
                self.turns.next(versions, (seen, values), faces.capacity(), most)
            }
        };
        let Some(turn) = turn else { return false };
        let has_emission = self.has_emission;
        if has_emission {
            emitters.wake(recorder);
        }
        set_bounce(&mut self.settings, recorder, cones, turn, has_emission);
        if turn.is_from_darkness {
            recorder.clear(faces.irradiance());
            if turn.forgets_hits {
                recorder.clear(faces.hits());
            }
        }
        if turn.is_direct_new {
            self.direct(recorder, (volume, changes.as_deref_mut()), lights, faces);
            self.kernels.reflect(recorder, &self.grid, faces);
            show_light(recorder, volume, changes.as_deref_mut());
        }
        let groups = [volume.globals(), &lights.group];
        if turn.writes_box && self.has_moving {
            recorder.stage("face rays");
            self.kernels.box_moved(recorder, &self.grid, faces);
        }
        if turn.finds && (turn.gathers > 0 || turn.shows_far) {
            recorder.stage("face rays");
            self.kernels.find(recorder, volume.globals(), faces);
        }
        if has_emission && turn.shines != Shines::OnNone {
            recorder.stage("emitter rays");
            self.kernels.shine(recorder, groups, faces, turn);
        }
        for _ in 0..turn.gathers {
            recorder.stage("bounce");
            self.kernels.gather(recorder, groups, faces, turn);
            self.kernels.reflect(recorder, &self.grid, faces);
            show_light(recorder, volume, changes.as_deref_mut());
        }
        if turn.shows_far {
            self.show_far(recorder, volume, lights, faces);
        }
        if !volume.is_marched() {
            update_cells(recorder, volume, changes);
        }
        true
    }

    /// Passes the far light of faces to the volume, for pixels.
    fn show_far(
        &self,
        recorder: &mut Recorder<'_>,
        volume: &Volume,
        lights: &Lights,
        faces: &Faces,
    ) {
        recorder.stage("far light");
        let groups = [volume.globals(), &lights.group];
        let far = self.kernels.far(recorder, &self.grid, groups, faces);
        if let Some(far) = far {
            volume.show_far(recorder, far);
        }
    }

    /// Direct light and emission of the faces.
    fn direct(
        &self,
        recorder: &mut Recorder<'_>,
        (volume, changes): (&Volume, Option<&mut Changes>),
        lights: &Lights,
        faces: &Faces,
    ) {
        recorder.stage("light");
        // Cone shadows need the volume's opacities; the radiance stored with them does not matter.
        if lights.has_cone_shadows && volume.is_marched() {
            recorder.stage("filter");
            if let Some(changed) = changes.and_then(|changes| changes.surfaces(recorder)) {
                volume.update(recorder, changed);
            }
            recorder.stage("light");
        }
        let globals = volume.globals();
        match &self.direct {
            Direct::Faces(kernels) => {
                let kernel = kernels.variant(lights.has_cone_shadows);
                faces.run_direct(recorder, kernel, [globals, &lights.group]);
            }
            Direct::Own(injector) => {
                let direct = faces.direct();
                injector.run(recorder, FaceLight { globals, lights, direct });
            }
        }
    }

    /// Frames until less than a hundredth of the last change of the light is missing.
    pub(crate) fn frames_left(&self) -> u32 {
        self.turns.frames_left()
    }

    /// Makes the next call of [`Self::step`] compute direct light again, as after a change.
    pub(crate) fn disturb(&mut self) {
        self.turns.disturb();
    }

    /// Bytes on the GPU, by purpose.
    pub(crate) fn memory(&self) -> Vec<(&'static str, u64)> {
        let mut memory = self.faces.as_ref().map_or_else(Vec::new, Faces::memory);
        memory.extend(self.injector().into_iter().flat_map(Injector::memory));
        memory
    }

    /// The caller's injector, if there is one.
    pub(crate) fn injector(&self) -> Option<&dyn Injector> {
        match &self.direct {
            Direct::Faces(_) => None,
            Direct::Own(injector) => Some(injector.as_ref()),
        }
    }

    /// `hits` of `turn.wgsl`.
    #[cfg(test)]
    pub(crate) fn hits(&self) -> Option<&Buffer> {
        self.faces.as_ref().map(Faces::hits)
    }

    /// The radiance of each face (`array<vec4f>`), for tests and views.
    pub(crate) fn radiance(&self) -> Option<&Buffer> {
        self.faces.as_ref().map(Faces::radiance)
    }
}

/// Shows changed light to rays, or to marching cones.
fn show_light(recorder: &mut Recorder<'_>, volume: &Volume, changes: Option<&mut Changes>) {
    recorder.stage("filter");
    volume.show_light(recorder);
    if volume.is_marched() {
        update_cells(recorder, volume, changes);
    }
}

/// Stores changed light in the cells, if there are any.
fn update_cells(recorder: &mut Recorder<'_>, volume: &Volume, changes: Option<&mut Changes>) {
    if let Some(changed) = changes.and_then(|changes| changes.find(recorder)) {
        recorder.stage("filter");
        volume.update(recorder, changed);
    }
}

fn set_bounce(
    buffer: &mut Staged,
    recorder: &mut Recorder<'_>,
    (settings, model_values): (&TraceSettings, [f32; 4]),
    turn: Turn,
    has_emission: bool,
) {
    let settings = BounceSettings {
        // Occlusion is not read, so its distance has no unit.
        cones: settings.cones(1.0, model_values),
        cone_count: settings.diffuse_cones,
        faces_at_a_time: turn.faces,
        turn: turn.number,
        has_emitters: u32::from(has_emission),
        by_cascade: u32::from(turn.is_by_cascade),
        is_list_new: u32::from(turn.is_list_new),
        rays_anew: turn.rays_anew,
        relaxes: u32::from(turn.relaxes),
        shines_on_all: u32::from(turn.shines == Shines::OnAll),
        boxes: turn.boxes,
        box_written: turn.box_written,
        has_moved: u32::from(turn.writes_box),
    };
    buffer.set(recorder, bytemuck::bytes_of(&settings));
}
