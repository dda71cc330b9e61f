//! The look of VXCT: Phong's light, and a few fixed cones for shadows, reflections and diffuse light
//! (docs/vxct-look.md).
//!
//! One kernel (`shade.wgsl`) takes the place of direct light, trace and composite: from the G-buffer to the picture.
//! Another one (`inject.wgsl`) lights the voxels as VXCT did. Both are compiled at their first use, so that a physical
//! rendering starts as fast as without them. A VXCT unit of length is half the longest edge of the box that the grid is
//! fitted to, since VXCT's scenes fill the cube from -1 to 1.

mod settings;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lumivox::gpu::{
    BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Recorder, ShaderError, uniform_buffer, upload,
};
use lumivox::{GBuffer, Gi, Lights};
use lumivox_scene::{Attenuation, Bounds, LightKind, Scene, Shading};

use crate::composite::PICTURE_FORMAT;
use crate::settings::MAX_STOPS;
use crate::targets::Targets;
use crate::upload::{Lighting, reference_white};
use crate::{Exposure, Gpu, RenderError, RenderSettings, ToneMap, View};
pub use settings::{Components, ConeShape, Injected, Look, VxctSettings};

/// The shader modules of this folder by their paths below `render`.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("vxct::cone", include_str!("cone.wgsl")),
    ("vxct::inject", include_str!("inject.wgsl")),
    ("vxct::leaving", include_str!("leaving.wgsl")),
    ("vxct::lights", include_str!("lights.wgsl")),
    ("vxct::material", include_str!("material.wgsl")),
    ("vxct::shade", include_str!("shade.wgsl")),
    ("vxct::uniform", include_str!("uniform.wgsl")),
];

/// Bits of `VxctUniform::terms`.
const AMBIENT: u32 = 1;
const DIFFUSE: u32 = 2;
const HIGHLIGHTS: u32 = 4;
const FRONT: u32 = 8;
const SIDES: u32 = 16;
const INTERMEDIATE: u32 = 32;
const DIFFUSE_CONES: u32 = 64;
const SPECULAR_CONES: u32 = 128;
const OCCLUSION_CONES: u32 = 256;

/// The constants that the shaders share with this folder.
pub(crate) const CONSTANTS: [(&str, u32); 14] = [
    ("VXCT_ALL", Components::All as u32),
    ("VXCT_PHONG", Components::Phong as u32),
    ("VXCT_SHADOWS", Components::Shadows as u32),
    ("VXCT_SPECULAR", Components::Specular as u32),
    ("VXCT_DIFFUSE", Components::Diffuse as u32),
    ("VXCT_TERM_AMBIENT", AMBIENT),
    ("VXCT_TERM_DIFFUSE", DIFFUSE),
    ("VXCT_TERM_HIGHLIGHTS", HIGHLIGHTS),
    ("VXCT_TERM_FRONT", FRONT),
    ("VXCT_TERM_SIDES", SIDES),
    ("VXCT_TERM_INTERMEDIATE", INTERMEDIATE),
    ("VXCT_TERM_DIFFUSE_CONES", DIFFUSE_CONES),
    ("VXCT_TERM_SPECULAR_CONES", SPECULAR_CONES),
    ("VXCT_TERM_OCCLUSION_CONES", OCCLUSION_CONES),
];

/// `VxctShape` of `uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct VxctShape {
    pub(crate) width: f32,
    pub(crate) offset: f32,
    pub(crate) step_per_diameter: f32,
    padding: u32,
}

/// `VxctUniform` of `uniform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct VxctUniform {
    pub(crate) diffuse: VxctShape,
    pub(crate) occlusion: VxctShape,
    pub(crate) specular: VxctShape,
    pub(crate) shown: u32,
    pub(crate) components: u32,
    pub(crate) terms: u32,
    pub(crate) unit_voxels: f32,
    pub(crate) origin_offset: f32,
    pub(crate) shadow_strength: f32,
    pub(crate) shininess_falloff: f32,
    pub(crate) white: f32,
}

/// `InjectSettings` of `inject.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct InjectSettings {
    pub(crate) ambient: f32,
    pub(crate) white: f32,
    padding: [u32; 2],
}

/// How a screen shows a scene in this look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VxctDisplay {
    /// The radiance that is shown as 1, in cd/m².
    pub white: f32,
    /// The exposure that makes it so.
    pub exposure: Exposure,
    /// The curve.
    pub tone_map: ToneMap,
}

/// How a screen shows a scene in this look.
///
/// Scenes for VXCT, some light of which has an [`Attenuation`] or which have a grid of their own and no lights, are in
/// display values: they are shown as they are, without exposure and encoding. Other scenes are in physical units: there white is what a white surface shows that
/// faces the strongest light, a lamp right at its place (its colour in VXCT's sense) or a sun; where nothing but
/// surfaces shines, the brightest of them. It is encoded for the screen, since the light of a real scene has more
/// contrast than display values.
pub fn vxct_display(scene: &Scene) -> VxctDisplay {
    let has_no_lights = scene.lights.is_empty() && scene.grid_bounds.is_some();
    if has_no_lights || scene.lights.iter().any(|light| light.attenuation.is_some()) {
        let (exposure, tone_map) = (Exposure::Stops(0.0), ToneMap::Raw);
        return VxctDisplay { white: 1.0, exposure, tone_map };
    }
    let bounds = scene.voxel_bounds();
    let unit_m = 0.5 * (bounds.max - bounds.min).max_element();
    let of_lights = scene.lights.iter().map(|light| {
        let strength = match light.kind {
            LightKind::Directional { illuminance_lux, .. } => illuminance_lux,
            LightKind::Point { intensity_cd, .. } | LightKind::Spot { intensity_cd, .. } => {
                intensity_cd * lamp_attenuation(unit_m)[3].abs()
            }
        };
        light.color.max_element() * strength / std::f32::consts::PI
    });
    let brightest = of_lights.filter(|white| white.is_finite()).fold(0.0, f32::max);
    let white =
        if brightest > 0.0 { brightest } else { reference_white(scene, &Lighting::of(scene)) };
    let exposure = Exposure::Stops((-white.log2()).clamp(-MAX_STOPS, MAX_STOPS));
    VxctDisplay { white, exposure, tone_map: ToneMap::Linear }
}

/// VXCT's default polynomial over units of `unit_m` for a lamp that has none, as `attenuations` of `lights.wgsl` has
/// it: at one unit it meets the inverse square.
fn lamp_attenuation(unit_m: f32) -> [f32; 4] {
    let Attenuation { constant, linear, quadratic } = Attenuation::default();
    let squared = unit_m * unit_m;
    let at_one_unit = constant + linear + quadratic;
    [constant, linear / unit_m, quadratic / squared, -at_one_unit / squared]
}

/// What the look needs of a scene, and its kernels once they are used.
#[derive(Debug)]
pub(crate) struct VxctLook {
    /// For each light, how it fades (`attenuations` of `lights.wgsl`).
    attenuations: Buffer,
    /// The mean of the ambient strengths of Phong's materials.
    ambient: f32,
    /// On the GPU, in its unit of radiance.
    white: f32,
    unit_m: f32,
    shade: Option<ShadePass>,
    inject: Option<InjectPass>,
}

#[derive(Debug)]
struct ShadePass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    settings: Buffer,
}

#[derive(Debug)]
struct InjectPass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    settings: Buffer,
}

/// What one frame of the look is made from.
pub(crate) struct VxctFrame<'a> {
    pub(crate) gi: &'a Gi,
    pub(crate) lights: &'a Lights,
    pub(crate) gbuffer: &'a GBuffer,
    pub(crate) targets: &'a Targets,
    pub(crate) view: View,
}

impl VxctLook {
    /// What the look needs of a scene within `bounds`, whose radiances are multiples of `radiance_unit` on the GPU.
    pub(crate) fn new(gpu: &Gpu, scene: &Scene, bounds: Bounds, radiance_unit: f32) -> Self {
        let mut look = Self {
            attenuations: upload(&gpu.device, "attenuations", &[[0.0_f32; 4]]),
            ambient: 0.0,
            white: 1.0,
            unit_m: 0.0,
            shade: None,
            inject: None,
        };
        look.relink(bounds);
        look.set_scene(scene, radiance_unit);
        look
    }

    /// Takes other materials and other lights.
    pub(crate) fn set_scene(&mut self, scene: &Scene, radiance_unit: f32) {
        let ambient: Vec<f32> = scene
            .materials
            .iter()
            .filter_map(|material| match &material.shading {
                // What only emits has no part in it.
                Shading::Phong(phong) if phong.diffuse != Vec3::ZERO => Some(phong.ambient),
                _ => None,
            })
            .collect();
        let count = ambient.len().max(1) as f32;
        self.ambient = ambient.iter().sum::<f32>() / count;
        self.white = vxct_display(scene).white / radiance_unit;
    }

    /// Goes on with another volume, within other bounds.
    pub(crate) fn relink(&mut self, bounds: Bounds) {
        self.unit_m = 0.5 * (bounds.max - bounds.min).max_element();
        self.unlink();
    }

    /// Gives back what belongs to the volume, or to no look that is shown; the next use makes it anew.
    pub(crate) fn unlink(&mut self) {
        (self.shade, self.inject) = (None, None);
    }

    /// Links what the look needs and is not there yet.
    ///
    /// # Errors
    /// When a shader does not link.
    pub(crate) fn prepare(&mut self, gpu: &Gpu, gi: &Gi, look: &Look) -> Result<(), ShaderError> {
        if self.shade.is_none() && matches!(look, Look::Vxct(_)) {
            self.shade = Some(ShadePass::new(gpu, gi)?);
        }
        if self.inject.is_none() && look.injected_light() != Injected::Shadowed {
            self.inject = Some(InjectPass::new(gpu, gi)?);
        }
        Ok(())
    }

    /// Takes up lights that were bound anew: first `peaks` of the surroundings, then the scene's.
    pub(crate) fn set_lights(
        &mut self,
        device: &wgpu::Device,
        peaks: usize,
        lights: &[lumivox_scene::Light],
    ) {
        let none = [0.0; 4];
        let of_scene = lights.iter().map(|light| match (light.kind, light.attenuation) {
            (LightKind::Directional { .. }, _) => none,
            (_, Some(a)) => {
                let at_one_metre = a.constant + a.linear + a.quadratic;
                [a.constant, a.linear, a.quadratic, at_one_metre]
            }
            _ => lamp_attenuation(self.unit_m),
        });
        let mut records: Vec<[f32; 4]> = std::iter::repeat_n(none, peaks).chain(of_scene).collect();
        if records.is_empty() {
            // No binding may be empty.
            records.push(none);
        }
        self.attenuations = upload(device, "attenuations", &records);
    }

    /// Lights the voxels with what the look wants them to hold.
    ///
    /// # Errors
    /// When a shader does not link, or a setting is out of range.
    pub(crate) fn light(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        gi: &mut Gi,
        lights: &Lights,
        settings: &RenderSettings,
    ) -> Result<(), RenderError> {
        let bounces = settings.voxel_bounces();
        if settings.look.injected_light() == Injected::Shadowed {
            return Ok(gi.light(recorder, lights, bounces, &settings.trace)?);
        }
        let inject = match self.inject.take() {
            Some(inject) => inject,
            None => InjectPass::new(gpu, gi)?,
        };
        let white = InjectSettings { ambient: self.ambient, white: self.white, padding: [0; 2] };
        gpu.queue.write_buffer(&inject.settings, 0, bytemuck::bytes_of(&white));
        let globals = gi.globals().clone();
        gi.light_with(recorder, lights, bounces, &settings.trace, &mut |recorder, faces| {
            let group = BindGroupBuilder::new(&inject.layout)
                .buffer(&inject.settings)
                .buffer(&self.attenuations)
                .buffer(faces.faces)
                .buffer(faces.direct)
                .buffer(faces.radiance)
                .build(recorder.device(), "VXCT's light");
            let groups = [&globals, &group, &lights.group];
            inject.kernel.run_linear(recorder, &groups, faces.count);
        })?;
        self.inject = Some(inject);
        Ok(())
    }

    /// Makes the picture. The settings take effect at the next submission: one frame per recorder.
    ///
    /// # Errors
    /// When the shader does not link.
    pub(crate) fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        frame: &VxctFrame<'_>,
        settings: &VxctSettings,
    ) -> Result<(), RenderError> {
        let pass = match self.shade.take() {
            Some(pass) => pass,
            None => ShadePass::new(gpu, frame.gi)?,
        };
        let voxel_size_m = frame.gi.grid().voxel_size_m;
        let uniform = self.uniform(settings, frame.view, self.unit_m / voxel_size_m);
        gpu.queue.write_buffer(&pass.settings, 0, bytemuck::bytes_of(&uniform));
        let group = BindGroupBuilder::new(&pass.layout)
            .buffer(&pass.settings)
            .buffer(&self.attenuations)
            .view(&frame.targets.gbuffer_textures.tint)
            .view(&frame.targets.composite.picture)
            .build(&gpu.device, "the look of VXCT");
        let gbuffer = frame.gbuffer;
        let groups = [frame.gi.globals(), &group, &frame.lights.group, &gbuffer.group];
        pass.kernel.run(recorder, &groups, [gbuffer.size.x, gbuffer.size.y, 1]);
        self.shade = Some(pass);
        Ok(())
    }

    /// The settings as the shader reads them, lengths in voxels.
    fn uniform(&self, settings: &VxctSettings, view: View, unit_voxels: f32) -> VxctUniform {
        let shape = |cone: ConeShape| VxctShape {
            width: 2.0 * (0.5 * cone.aperture_rad).tan(),
            offset: cone.offset * unit_voxels,
            step_per_diameter: cone.distance_factor,
            padding: 0,
        };
        let terms = [
            (settings.phong && settings.phong_ambient, AMBIENT),
            (settings.phong && settings.phong_diffuse, DIFFUSE),
            (settings.phong && settings.phong_specular, HIGHLIGHTS),
            (settings.front_cone, FRONT),
            (settings.side_cones, SIDES),
            (settings.intermediate_cones, INTERMEDIATE),
            (settings.diffuse, DIFFUSE_CONES),
            (settings.specular, SPECULAR_CONES),
            (settings.shadows, OCCLUSION_CONES),
        ];
        let terms = terms.iter().filter(|(is_on, _)| *is_on).fold(0, |bits, (_, bit)| bits | bit);
        VxctUniform {
            diffuse: shape(settings.diffuse_cone),
            occlusion: shape(settings.occlusion_cone),
            specular: shape(settings.specular_cone),
            shown: view as u32,
            components: settings.components as u32,
            terms,
            unit_voxels,
            origin_offset: settings.diffuse_origin_offset * unit_voxels,
            shadow_strength: settings.shadow_strength,
            shininess_falloff: settings.shininess_falloff,
            white: self.white,
        }
    }
}

impl ShadePass {
    fn new(gpu: &Gpu, gi: &Gi) -> Result<Self, ShaderError> {
        let device = &gpu.pipelines;
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .texture_2d_unfilterable()
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT)
            .build(device, "the look of VXCT");
        let groups = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let shaders = crate::shaders::library(gi.shaders());
        let kernel = Kernel::new(device, &shaders, "render::vxct::shade", "main", &groups)?;
        let settings = uniform_buffer(device, "the look of VXCT", &VxctUniform::zeroed());
        Ok(Self { kernel, layout, settings })
    }
}

impl InjectPass {
    fn new(gpu: &Gpu, gi: &Gi) -> Result<Self, ShaderError> {
        let device = &gpu.pipelines;
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "VXCT's light");
        let groups = [gi.globals_layout(), &layout, gi.lights_layout()];
        let shaders = crate::shaders::library(gi.shaders());
        let kernel = Kernel::new(device, &shaders, "render::vxct::inject", "main", &groups)?;
        let settings = uniform_buffer(device, "VXCT's light", &InjectSettings::zeroed());
        Ok(Self { kernel, layout, settings })
    }
}
