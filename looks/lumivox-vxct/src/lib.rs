//! The look of VXCT: Phong's light, and a few fixed cones for shadows, reflections and diffuse
//! light (docs/looks.md), as a [`Look`] for [`RenderSettings::look`].
//!
//! It has its own voxels, a cube around the scene in one texture with 8 bits per channel
//! (`voxels.rs`), and draws the scene's triangles with one fragment shader that does everything
//! else (`shade.wgsl`). Its resources are created when it is first used, so that a physical
//! rendering starts as fast as without it. Positions and lengths are in the cube from -1 to 1 that
//! VXCT's scenes fill.

// Tests compare floats that must be equal to the bit.
#![cfg_attr(test, allow(clippy::float_cmp))]

mod commands;
mod display;
mod passes;
mod records;
mod settings;
mod voxels;

use std::any::Any;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lumivox::gpu::{BindGroup, BindGroupBuilder, Buffer, Recorder, ShaderLibrary};
use lumivox::settings::{Choice, check};
use lumivox::{Directionality, TraceSettings};
use lumivox_render::look::{Look, LookFrame, LookParts, LookPasses, LookScene};
use lumivox_render::parameters::{Group, Parameter};
use lumivox_render::{
    AddedPreset, Companions, Exposure, Gpu, MemoryUse, PresetChoice, RenderError, RenderSettings,
    ToneMap, View,
};
use lumivox_scene::{Bounds, Scene};

pub use commands::COMMANDS;
pub use display::{VxctDisplay, vxct_display};
use passes::Passes;
use records::{OF_EMITTER, OF_OTHERS, OF_STRENGTHS, Records};
pub use settings::{ConeShape, VxctSettings};

/// The name of the look.
pub const NAME: &str = "vxct";

/// The entry of the look in the list of looks.
pub const CHOICE: Choice = Choice::new(NAME, "Phong's light and VXCT's own cones (docs/looks.md)");

/// The group of its settings.
pub const GROUP: Group = Group::Look(NAME);

/// The preset that selects the look, with the settings that go with it.
pub const PRESET: PresetChoice = PresetChoice::Added(&AddedPreset {
    name: NAME,
    summary: "VXCT's look: Phong's light and its own cones, isotropic voxels, colours as display values",
    // The look has its own cones.
    trace: TraceSettings::default,
    look: |resolution| Some(Arc::new(VxctSettings::for_resolution(resolution))),
    companions: |usual| Companions {
        directionality: Directionality::Isotropic,
        bounces: 1,
        exposure: USUAL_DISPLAY.0,
        tone_map: USUAL_DISPLAY.1,
        ..usual
    },
});

/// The look computes with display values.
const USUAL_DISPLAY: (Exposure, ToneMap) = (Exposure::Stops(0.0), ToneMap::Raw);

/// The rows of its settings, for the table of all settings.
pub fn parameters() -> impl Iterator<Item = Parameter> {
    let row = |row| {
        Parameter::of_part(GROUP, row, settings_of, |all, vxct| all.look = Some(Arc::new(vxct)))
    };
    VxctSettings::SETTINGS.into_iter().map(row)
}

/// The settings of the look, or its defaults if another look is selected.
pub fn settings_of(settings: &RenderSettings) -> VxctSettings {
    let given = settings.look.as_deref().and_then(of_look);
    given.copied().unwrap_or_else(|| VxctSettings::for_resolution(settings.resolution))
}

fn of_look(look: &dyn Look) -> Option<&VxctSettings> {
    (look as &dyn Any).downcast_ref()
}

impl Look for VxctSettings {
    fn name(&self) -> &'static str {
        NAME
    }

    fn is_same(&self, other: &dyn Look) -> bool {
        of_look(other) == Some(self)
    }

    fn validate(&self) -> Result<(), RenderError> {
        Ok(check(&Self::SETTINGS, self)?)
    }

    /// The look has neither an octree nor past frames.
    fn shows(&self, view: View) -> bool {
        !view.needs_octree() && !view.needs_past()
    }

    fn last_level(&self) -> u32 {
        LAST_LEVEL
    }

    fn display(&self, scene: Option<&Scene>) -> (Exposure, ToneMap) {
        scene.map_or(USUAL_DISPLAY, |scene| {
            let VxctDisplay { exposure, tone_map, .. } = vxct_display(scene);
            (exposure, tone_map)
        })
    }

    fn passes(&self, scene: &LookScene, grid: Bounds) -> Box<dyn LookPasses> {
        let records = Records::new(scene, grid);
        Box::new(VxctPasses { records, uploaded: None, passes: None, is_due: true })
    }
}

/// Adds this crate's modules to a library, as `package::vxct::...`.
fn library(base: &ShaderLibrary) -> ShaderLibrary {
    let mut library = base.clone();
    library
        .add("vxct::cones", include_str!("cones.wgsl"))
        .add("vxct::cubes", include_str!("cubes.wgsl"))
        .add("vxct::finish", include_str!("finish.wgsl"))
        .add("vxct::lights", include_str!("lights.wgsl"))
        .add("vxct::material", include_str!("material.wgsl"))
        .add("vxct::mip", include_str!("mip.wgsl"))
        .add("vxct::shade", include_str!("shade.wgsl"))
        .add("vxct::uniform", include_str!("uniform.wgsl"))
        .add("vxct::vertex", include_str!("vertex.wgsl"))
        .add("vxct::voxelize", include_str!("voxelize.wgsl"));
    for (name, value) in CONSTANTS {
        library.constant_u32(name, value);
    }
    library
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
const LAST_LEVEL: u32 = 6;

/// `VxctCone` of `uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct VxctCone {
    width: f32,
    offset: f32,
    step_per_diameter: f32,
    padding: u32,
}

/// `VxctUniform` of `uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct VxctUniform {
    clip_from_world: Mat4,
    camera_in_world: Vec3,
    white: f32,
    center_in_world: Vec3,
    unit_m: f32,
    background: Vec3,
    has_environment: u32,
    diffuse: VxctCone,
    occlusion: VxctCone,
    specular: VxctCone,
    shown: u32,
    terms: u32,
    light_count: u32,
    resolution: u32,
    origin_offset: f32,
    shadow_strength: f32,
    shininess_falloff: f32,
    level: f32,
}

/// The look of a scene.
#[derive(Debug)]
struct VxctPasses {
    records: Records,
    /// The uploaded draws and lights; `None` once they have changed.
    uploaded: Option<[Buffer; 2]>,
    passes: Option<Passes>,
    /// Whether the next frame renews the voxels.
    is_due: bool,
}

impl LookPasses for VxctPasses {
    fn set_scene(&mut self, scene: &LookScene) {
        self.records.set_lights(scene);
        self.uploaded = None;
    }

    fn relight(&mut self) {
        self.is_due = true;
    }

    fn prepare(&mut self, parts: &LookParts<'_>) -> Result<(), RenderError> {
        let passes = self.passes.take().filter(|p| p.voxels.resolution == parts.resolution);
        let passes = if let Some(passes) = passes {
            passes
        } else {
            self.is_due = true;
            Passes::new(parts)?
        };
        let passes = self.passes.insert(passes);
        for draw in 0..parts.scene.draws.len() {
            let sides = self.records.sides(parts.scene, draw);
            passes.prepare(&parts.gpu.pipelines, parts.scene, sides)?;
        }
        Ok(())
    }

    fn record(&mut self, gpu: &Gpu, recorder: &mut Recorder, frame: &LookFrame<'_>) {
        let Self { records, uploaded, passes: Some(passes), is_due } = self else { return };
        let Some(settings) = of_look(frame.look) else { return };
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

    fn memory(&self) -> Vec<MemoryUse> {
        let bytes = self.passes.iter().map(|passes| passes.voxels.bytes());
        bytes.map(|bytes| MemoryUse::new("VXCT's voxels", bytes)).collect()
    }
}

fn uniform(
    records: &Records,
    passes: &Passes,
    settings: &VxctSettings,
    frame: &LookFrame<'_>,
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
        clip_from_world: frame.camera.clip_from_world(),
        camera_in_world: frame.camera.camera().position,
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

#[cfg(test)]
mod layouts;
