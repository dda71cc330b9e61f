//! The look of VXCT: Phong's light, and a few fixed cones for shadows, reflections and diffuse light
//! (docs/vxct-look.md).
//!
//! It has voxels of its own, a cube of them around the scene in one texture of 8 bits a channel ([`voxels`]), and draws the
//! scene's triangles with one fragment shader that does all else (`shade.wgsl`). Nothing of it is there until it is
//! used, so that a physical rendering starts as fast as without it. Places and lengths are in the cube from -1 to 1
//! that VXCT's scenes fill.

mod display;
mod passes;
mod records;
mod settings;
mod voxels;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lumivox::gpu::{BindGroup, BindGroupBuilder, Buffer, Recorder, ShaderLibrary};
use lumivox::{GBuffer, Gi, Lights};
use lumivox_scene::{Bounds, Scene};

use crate::gpu::memory::MemoryUse;
use crate::passes::targets::Targets;
use crate::scene::GpuScene;
use crate::{Gpu, RenderError, View};
pub use display::{VxctDisplay, has_display_values, vxct_display};
use passes::Passes;
use records::{OF_EMITTER, OF_OTHERS, OF_STRENGTHS, Records};
#[cfg(test)]
pub(crate) use records::{VxctDraw, VxctLight};
pub use settings::{ConeShape, Look, VxctSettings};

/// Adds the shaders of this folder.
pub(crate) fn add_shaders(library: &mut ShaderLibrary) {
    library
        .add("render::vxct::cones", include_str!("cones.wgsl"))
        .add("render::vxct::cubes", include_str!("cubes.wgsl"))
        .add("render::vxct::finish", include_str!("finish.wgsl"))
        .add("render::vxct::lights", include_str!("lights.wgsl"))
        .add("render::vxct::material", include_str!("material.wgsl"))
        .add("render::vxct::mip", include_str!("mip.wgsl"))
        .add("render::vxct::shade", include_str!("shade.wgsl"))
        .add("render::vxct::uniform", include_str!("uniform.wgsl"))
        .add("render::vxct::vertex", include_str!("vertex.wgsl"))
        .add("render::vxct::voxelize", include_str!("voxelize.wgsl"));
    for (name, value) in CONSTANTS {
        library.constant_u32(name, value);
    }
}

/// Bits of `VxctUniform::terms`.
const INDIRECT: u32 = 1;
const PHONG: u32 = 2;
const AMBIENT: u32 = 4;
const DIFFUSE: u32 = 8;
const HIGHLIGHTS: u32 = 16;
const FRONT: u32 = 32;
const SIDES: u32 = 64;
const INTERMEDIATE: u32 = 128;
const DIFFUSE_CONES: u32 = 256;
const SPECULAR_CONES: u32 = 512;
const OCCLUSION_CONES: u32 = 1024;

/// The constants that the shaders share with this folder.
const CONSTANTS: [(&str, u32); 15] = [
    ("VXCT_LAST_LEVEL", LAST_LEVEL),
    ("VXCT_INDIRECT", INDIRECT),
    ("VXCT_PHONG", PHONG),
    ("VXCT_AMBIENT", AMBIENT),
    ("VXCT_DIFFUSE", DIFFUSE),
    ("VXCT_HIGHLIGHTS", HIGHLIGHTS),
    ("VXCT_FRONT", FRONT),
    ("VXCT_SIDES", SIDES),
    ("VXCT_INTERMEDIATE", INTERMEDIATE),
    ("VXCT_DIFFUSE_CONES", DIFFUSE_CONES),
    ("VXCT_SPECULAR_CONES", SPECULAR_CONES),
    ("VXCT_OCCLUSION_CONES", OCCLUSION_CONES),
    ("VXCT_OF_OTHERS", OF_OTHERS),
    ("VXCT_OF_STRENGTHS", OF_STRENGTHS),
    ("VXCT_OF_EMITTER", OF_EMITTER),
];

/// The coarsest level of the voxels, at any resolution.
pub(crate) const LAST_LEVEL: u32 = 6;

/// `VxctCone` of `uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct VxctCone {
    pub(crate) width: f32,
    pub(crate) offset: f32,
    pub(crate) step_per_diameter: f32,
    padding: u32,
}

/// `VxctUniform` of `uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct VxctUniform {
    pub(crate) clip_from_world: Mat4,
    pub(crate) camera_in_world: Vec3,
    pub(crate) white: f32,
    pub(crate) center_in_world: Vec3,
    pub(crate) unit_m: f32,
    pub(crate) background: Vec3,
    pub(crate) has_environment: u32,
    pub(crate) diffuse: VxctCone,
    pub(crate) occlusion: VxctCone,
    pub(crate) specular: VxctCone,
    pub(crate) shown: u32,
    pub(crate) terms: u32,
    pub(crate) light_count: u32,
    pub(crate) resolution: u32,
    pub(crate) origin_offset: f32,
    pub(crate) shadow_strength: f32,
    pub(crate) shininess_falloff: f32,
    pub(crate) level: f32,
}

/// The look of a scene.
#[derive(Debug)]
pub(crate) struct VxctLook {
    records: Records,
    /// Those of them that are on the GPU, unless they have changed.
    uploaded: Option<[Buffer; 2]>,
    passes: Option<Passes>,
    /// Whether the next frame makes the voxels anew.
    is_due: bool,
}

/// What one frame of the look is made from.
pub(crate) struct VxctFrame<'a> {
    pub(crate) scene: &'a GpuScene,
    pub(crate) lights: &'a Lights,
    pub(crate) gbuffer: &'a GBuffer,
    pub(crate) targets: &'a Targets,
    pub(crate) view: &'a lumivox::View,
    pub(crate) shown: View,
    pub(crate) level: u32,
}

impl VxctLook {
    /// Of a scene within `bounds`.
    pub(crate) fn new(scene: &Scene, bounds: Bounds) -> Self {
        Self { records: Records::new(scene, bounds), uploaded: None, passes: None, is_due: true }
    }

    /// Takes other materials and other lights.
    pub(crate) fn set_scene(&mut self, scene: &Scene, bounds: Bounds) {
        self.records = Records::new(scene, bounds);
        // Their layout may be another one, too.
        self.unlink();
    }

    /// Takes up what has moved.
    pub(crate) fn set_pose(&mut self) {
        self.uploaded = None;
    }

    /// Goes on within other bounds.
    pub(crate) fn relink(&mut self, bounds: Bounds) {
        self.records.set_bounds(bounds);
        self.unlink();
    }

    /// Takes other lights and surroundings.
    pub(crate) fn set_lights(&mut self, scene: &Scene) {
        self.records.set_lights(scene);
        self.uploaded = None;
    }

    /// Lets the next frame make the voxels anew.
    pub(crate) fn revoxelize(&mut self) {
        self.is_due = true;
    }

    /// Gives back what is on the GPU; the next use makes it anew.
    pub(crate) fn unlink(&mut self) {
        (self.passes, self.uploaded) = (None, None);
    }

    /// Links what the look needs and is not there yet.
    ///
    /// # Errors
    /// When the device has no voxels of that resolution, or a shader does not link.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        shaders: &ShaderLibrary,
        gi: &Gi,
        scene: &GpuScene,
        resolution: u32,
    ) -> Result<(), RenderError> {
        let fits =
            self.passes.as_ref().is_some_and(|passes| passes.voxels.resolution == resolution);
        if !fits {
            self.passes = None;
            self.passes = Some(Passes::new(gpu, shaders, gi, scene, resolution)?);
            self.is_due = true;
        }
        if let Some(passes) = &mut self.passes {
            for draw in 0..scene.draws.len() {
                passes.prepare(&gpu.pipelines, scene, self.records.sides(scene, draw))?;
            }
        }
        Ok(())
    }

    /// GPU memory.
    pub(crate) fn memory(&self) -> Option<MemoryUse> {
        let passes = self.passes.as_ref()?;
        Some(MemoryUse::new("VXCT's voxels", passes.voxels.bytes()))
    }

    /// Makes the picture; [`Self::prepare`] comes before. The settings take effect at the next submission: one frame per
    /// recorder.
    pub(crate) fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        frame: &VxctFrame<'_>,
        settings: &VxctSettings,
    ) {
        let Self { records, uploaded, passes: Some(passes), is_due } = self else { return };
        let scene = frame.scene;
        let [draws, lights] = uploaded.get_or_insert_with(|| records.upload(gpu, scene));
        let uniform = uniform(records, passes, settings, frame);
        gpu.queue.write_buffer(&passes.settings, 0, bytemuck::bytes_of(&uniform));
        let device = &gpu.device;
        let look = BindGroupBuilder::new(&passes.layouts.look)
            .buffer(&passes.settings)
            .buffer(&scene.draw_records)
            .buffer(draws)
            .buffer(lights)
            .build(device, "the look of VXCT");
        let batches: Vec<BindGroup> = scene
            .batches
            .iter()
            .map(|batch| {
                BindGroupBuilder::new(&passes.layouts.batch)
                    .buffer(&batch.positions)
                    .buffer(&batch.attributes)
                    .buffer(&batch.shading)
                    .buffer(&batch.indices)
                    .build(device, "triangles")
            })
            .collect();
        if std::mem::take(is_due) {
            recorder.stage("VXCT's voxels");
            passes.voxels.record(recorder, scene, &look, &batches);
        }
        recorder.stage("look of VXCT");
        if frame.shown.is_of_voxels() {
            passes.draw_cubes(recorder, frame, &look);
        } else {
            passes.draw(recorder, frame, records, (&look, &batches));
        }
    }
}

fn uniform(
    records: &Records,
    passes: &Passes,
    settings: &VxctSettings,
    frame: &VxctFrame<'_>,
) -> VxctUniform {
    let cone = |cone: ConeShape| VxctCone {
        width: 2.0 * (0.5 * cone.aperture_rad).tan(),
        offset: cone.offset,
        step_per_diameter: cone.distance_factor,
        padding: 0,
    };
    let terms = [
        (settings.indirect_light, INDIRECT),
        (settings.phong, PHONG),
        (settings.phong_ambient, AMBIENT),
        (settings.phong_diffuse, DIFFUSE),
        (settings.phong_specular, HIGHLIGHTS),
        (settings.front_cone, FRONT),
        (settings.side_cones, SIDES),
        (settings.intermediate_cones, INTERMEDIATE),
        (settings.diffuse, DIFFUSE_CONES),
        (settings.specular, SPECULAR_CONES),
        (settings.shadows, OCCLUSION_CONES),
    ];
    VxctUniform {
        clip_from_world: frame.view.clip_from_world,
        camera_in_world: frame.view.position,
        white: records.white / frame.scene.radiance_unit,
        center_in_world: records.center,
        unit_m: records.unit_m,
        background: records.background(),
        has_environment: u32::from(records.has_environment()),
        diffuse: cone(settings.diffuse_cone),
        occlusion: cone(settings.occlusion_cone),
        specular: cone(settings.specular_cone),
        shown: frame.shown as u32,
        terms: terms.iter().filter(|(is_on, _)| *is_on).map(|(_, bit)| bit).sum(),
        light_count: records.light_count(),
        resolution: passes.voxels.resolution,
        origin_offset: settings.diffuse_origin_offset,
        shadow_strength: settings.shadow_strength,
        shininess_falloff: settings.shininess_falloff,
        level: passes.voxels.level(frame.level) as f32,
    }
}
