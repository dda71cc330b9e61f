//! A scene as the shaders of the look read it.

use std::f32::consts::PI;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lumivox::gpu::{Buffer, upload};
use lumivox_render::look::{Attributes, LookScene};
use lumivox_render::{Gpu, GpuScene, Lighting};
use lumivox_scene::{Attenuation, Bounds, Environment, Light, Material};

use super::display::{display_of, mean_radiance, share_of_lamps};

/// `VXCT_OF_OTHERS`: a material that is not VXCT's.
pub(super) const OF_OTHERS: u32 = 0;
/// `VXCT_OF_STRENGTHS`: a material of VXCT.
pub(super) const OF_STRENGTHS: u32 = 1;
/// `VXCT_OF_EMITTER`: a material that shows its colour in any light.
pub(super) const OF_EMITTER: u32 = 2;

/// VXCT's background in display values, and its equivalent in linear light.
const BACKGROUND: [f32; 2] = [0.1, 0.01];

/// `VxctDraw` of `material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct VxctDraw {
    pub(super) color: Vec3,
    pub(super) ambient: f32,
    pub(super) diffuse: f32,
    pub(super) specular: f32,
    pub(super) shininess: f32,
    pub(super) kind: u32,
    pub(super) first_index: u32,
    pub(super) base_vertex: i32,
    pub(super) first_triangle: u32,
    pub(super) attribute_words: u32,
    pub(super) is_rounded: u32,
    pub(super) is_voxelized: u32,
    padding: [u32; 2],
}

/// `VxctLight` of `lights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct VxctLight {
    pub(super) position: Vec3,
    pub(super) is_parallel: u32,
    pub(super) color: Vec3,
    pub(super) spot_scale: f32,
    pub(super) spot_direction: Vec3,
    pub(super) spot_offset: f32,
    pub(super) attenuation: Vec3,
    padding: u32,
}

/// The look's data of a scene that are not on the GPU yet.
#[derive(Clone, Debug)]
pub(super) struct Records {
    /// The records of the scene's materials.
    materials: Vec<VxctDraw>,
    lighting: Lighting,
    has_display_values: bool,
    /// The middle of the cube, and half of its edge.
    pub(super) center: Vec3,
    pub(super) unit_m: f32,
    /// The radiance that is shown as 1, cd/m².
    pub(super) white: f32,
}

impl Records {
    /// The data of a scene within `bounds`.
    pub(super) fn new(scene: &LookScene, bounds: Bounds) -> Self {
        Self {
            materials: scene.materials.iter().map(of_material).collect(),
            lighting: scene.lighting.clone(),
            has_display_values: scene.has_display_values,
            // The cube has the middle and the longest edge of the box.
            center: 0.5 * (bounds.min + bounds.max),
            unit_m: 0.5 * bounds.size().max_element(),
            white: display_of(scene).white,
        }
    }

    /// Replaces lights and surroundings.
    pub(super) fn set_lights(&mut self, scene: &LookScene) {
        self.lighting = scene.lighting.clone();
        self.has_display_values = scene.has_display_values;
        self.white = display_of(scene).white;
    }

    pub(super) fn light_count(&self) -> u32 {
        self.lighting.lights.len() as u32 + u32::from(self.needs_sky())
    }

    /// The background, as a share of white.
    pub(super) fn background(&self) -> Vec3 {
        Vec3::splat(BACKGROUND[usize::from(!self.has_display_values)])
    }

    /// Whether the surroundings are shown.
    pub(super) fn has_environment(&self) -> bool {
        self.lighting.environment.radiance != Vec3::ZERO
    }

    /// Whether the surroundings are added as a light: cones do not see them, so a scene without
    /// lamps would be black.
    fn needs_sky(&self) -> bool {
        self.lighting.lights.is_empty() && !self.has_display_values && self.has_environment()
    }

    /// The records of a scene's draws, and of its lights.
    pub(super) fn upload(&self, gpu: &Gpu, scene: &GpuScene) -> [Buffer; 2] {
        let mut first_triangle = 0;
        let mut draws = vec![VxctDraw::zeroed(); scene.draws.len()];
        for draw in &scene.draws {
            draws[draw.record as usize] = VxctDraw {
                first_index: draw.indices.start,
                base_vertex: draw.base_vertex,
                first_triangle,
                attribute_words: match scene.batches[draw.batch].kind {
                    Attributes::Texcoords => 2,
                    Attributes::All => 6,
                },
                is_voxelized: u32::from(draw.is_voxelized),
                ..self.materials[draw.material]
            };
            first_triangle += draw.indices.len() as u32 / 3;
        }
        let of_scene = self.lighting.lights.iter().map(|light| self.of_light(light));
        let sky = self.needs_sky().then(|| self.of_sky(&self.lighting.environment));
        let lights: Vec<VxctLight> = of_scene.chain(sky).collect();
        [upload_some(gpu, "VXCT's draws", &draws), upload_some(gpu, "VXCT's lights", &lights)]
    }

    fn of_light(&self, light: &Light) -> VxctLight {
        let vector = |a: Attenuation, unit_m: f32| {
            Vec3::new(a.constant, a.linear * unit_m, a.quadratic * unit_m * unit_m)
        };
        let is_parallel = light.kind.is_parallel();
        let (strength, polynomial) = match light.attenuation {
            _ if is_parallel => (light.intensity, Vec3::X),
            Some(given) => (light.intensity / given.at(1.0), vector(given, self.unit_m)),
            None => {
                let strength = light.intensity * share_of_lamps(self.unit_m);
                (strength, vector(Attenuation::default(), 1.0))
            }
        };
        let (spot_scale, spot_offset) = light.cone_rad().map_or((0.0, 1.0), |cone_rad| {
            let [inner, outer] = cone_rad.map(f32::cos);
            let scale = 1.0 / (inner - outer).max(1e-3);
            (scale, -outer * scale)
        });
        VxctLight {
            position: if is_parallel {
                -light.direction
            } else {
                (light.position - self.center) / self.unit_m
            },
            is_parallel: u32::from(is_parallel),
            color: light.color * (strength / PI / self.white),
            spot_scale,
            spot_direction: light.direction,
            spot_offset,
            attenuation: polynomial,
            padding: 0,
        }
    }

    /// The surroundings as a light from above.
    fn of_sky(&self, environment: &Environment) -> VxctLight {
        VxctLight {
            position: Vec3::Y,
            is_parallel: 1,
            color: mean_radiance(environment) / self.white,
            spot_scale: 0.0,
            spot_direction: Vec3::NEG_Y,
            spot_offset: 1.0,
            attenuation: Vec3::X,
            padding: 0,
        }
    }
}

fn of_material(material: &Material) -> VxctDraw {
    let Some(strengths) = material.strengths else { return VxctDraw::zeroed() };
    let emits = material.emissive != Vec3::ZERO;
    VxctDraw {
        color: strengths.color,
        ambient: strengths.ambient,
        diffuse: strengths.diffuse,
        specular: strengths.specular,
        shininess: strengths.shininess,
        kind: if emits { OF_EMITTER } else { OF_STRENGTHS },
        is_rounded: u32::from(strengths.is_rounded),
        ..VxctDraw::zeroed()
    }
}

/// No binding may be empty.
fn upload_some<T: Pod>(gpu: &Gpu, label: &str, records: &[T]) -> Buffer {
    let nothing = [T::zeroed()];
    upload(&gpu.device, label, if records.is_empty() { &nothing } else { records })
}

/// Which sides of a draw are seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Sides {
    /// Sides whose corners run counter-clockwise.
    Front,
    /// Sides whose corners run clockwise.
    Back,
    /// Both.
    Both,
}

impl Records {
    /// VXCT shows one side of its materials, whatever the physical look does. It shows draws with a
    /// mirroring matrix from within.
    pub(super) fn sides(&self, scene: &GpuScene, draw: usize) -> Sides {
        let draw = &scene.draws[draw];
        let is_own = self.materials[draw.material].kind != OF_OTHERS;
        match (is_own, scene.materials[draw.material].is_double_sided) {
            (true, _) if draw.is_mirrored => Sides::Back,
            (true, _) | (false, false) => Sides::Front,
            (false, true) => Sides::Both,
        }
    }
}
