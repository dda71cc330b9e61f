//! Environment maps as light from outside the voxels, and sunlight's transmittance through air.
//!
//! The map of a camera ([`EnvironmentMapLight`]: given, generated, or the atmosphere's) is copied
//! on the GPU into Lumivox's form. Bevy's own light from environment maps, reflection probes and
//! irradiance volumes, which walls do not block, is disabled while the voxels are shown.

use bevy::light::atmosphere::ScatteringMedium;
use bevy::light::{
    Atmosphere, EnvironmentMapLight, GeneratedEnvironmentMapLight, IrradianceVolume,
};
use bevy::pbr::RenderViewLightProbes;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy::render::render_asset::RenderAssets;
use bevy::render::texture::GpuImage;
use lumivox::CubeUse;
use lumivox::wgpu;

use crate::light::irradiance::{ARE_USABLE, ShownVolumes};
use crate::screen::views::{GiViews, Method};
use crate::volumes::Volumes;

/// Texels along an edge of a face of Lumivox's copy: 0.7 degrees.
pub(crate) const EDGE: u32 = 128;
/// Interval, in frames, at which a map that Bevy recomputes every frame is copied again.
const FRAMES_OF_GENERATED: u32 = 32;
/// Integration steps along a sun ray through the air.
const AIR_STEPS: u32 = 40;

/// The environment map of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surroundings {
    image: AssetId<Image>,
    /// cd/m² of the map's values.
    intensity: f32,
    cube_from_world: Mat3,
    /// Whether Bevy recomputes the map every frame.
    is_generated: bool,
}

impl Surroundings {
    /// Whether the map is one of `images`.
    pub(crate) fn is_of(&self, images: &HashSet<AssetId<Image>>) -> bool {
        images.contains(&self.image)
    }

    pub(crate) fn new(
        map: &EnvironmentMapLight,
        generated: Option<&GeneratedEnvironmentMapLight>,
    ) -> Option<Self> {
        if !(map.intensity > 0.0 && map.intensity.is_finite()) {
            return None;
        }
        // Cube textures are left-handed, as in Bevy's shader.
        let mirror = Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0));
        Some(Self {
            // The unfiltered map if Bevy filters one; otherwise the specular map, whose first mip
            // is sharp.
            image: generated.map_or(map.specular_map.id(), |source| source.environment_map.id()),
            intensity: map.intensity,
            cube_from_world: mirror * Mat3::from_quat(map.rotation.inverse()),
            is_generated: generated.is_some(),
        })
    }

    /// The cube texture; `None` until it is loaded, `Err` if its kind is not supported.
    pub(crate) fn cube(
        &self,
        images: &RenderAssets<GpuImage>,
    ) -> Result<Option<wgpu::TextureView>, &'static str> {
        let Some(image) = images.get(self.image) else { return Ok(None) };
        let texture = &image.texture;
        let is_cube = texture.depth_or_array_layers() == 6
            && texture.dimension() == wgpu::TextureDimension::D2;
        if !is_cube {
            return Err("an environment map is no cube texture of six layers");
        }
        let filterable = wgpu::TextureSampleType::Float { filterable: true };
        if texture.format().sample_type(None, None) != Some(filterable) {
            return Err(
                "an environment map is of a format that cannot be filtered; give it as Rgba16Float",
            );
        }
        Ok(Some((*image.texture_view).clone()))
    }

    /// Settings for reading the map; `share` is 1 cd/m² in the unit of radiance.
    pub(crate) fn cube_use(&self, share: f32, added: Vec3) -> CubeUse {
        CubeUse { cube_from_world: self.cube_from_world, factor: self.intensity * share, added }
    }

    /// Whether to copy the map again, `frames` after the first copy: Bevy filters a map only once
    /// its pipelines are compiled, and sends no event then.
    pub(crate) fn is_due(&self, frames: u32) -> bool {
        let is_new = frames < FRAMES_OF_GENERATED && frames.is_power_of_two();
        self.is_generated && (is_new || frames % FRAMES_OF_GENERATED == 0)
    }
}

/// Removes Bevy's environment maps, reflection probes and irradiance volumes from views whose
/// voxels are ready. Bevy collects them again every frame, so they return by themselves.
pub(crate) fn take_maps_over(
    mut commands: Commands,
    gi_views: Res<GiViews>,
    (volumes, own, method): (Res<Volumes>, Res<ShownVolumes>, Res<Method>),
) {
    for view in &gi_views.views {
        let Some(voxels) = volumes.shown(&view.key) else { continue };
        let Ok(mut entity) = commands.get_entity(view.entity) else { continue };
        if !ARE_USABLE {
            entity.try_remove::<RenderViewLightProbes<IrradianceVolume>>();
        } else if !own.has(&view.key) {
            // Remove both in the same frame, so that Bevy's pipelines change only once.
            continue;
        }
        // A map that is not loaded or not supported stays with Bevy. In forward mode glossy
        // surfaces reflect it, and irradiance volumes replace only its diffuse light.
        if method.is_forward {
            continue;
        }
        if view.surroundings.is_none() || voxels.holds_map() {
            entity.try_remove::<RenderViewLightProbes<EnvironmentMapLight>>();
        }
    }
}

/// The share of sunlight that reaches a position through the air: Beer's law (1852), integrated
/// along the ray; Bevy's shaders read it from a table. `towards` is a unit vector.
pub(crate) fn transmittance(
    (atmosphere, planet): (&Atmosphere, &GlobalTransform),
    medium: &ScatteringMedium,
    position: Vec3,
    towards: Vec3,
) -> Vec3 {
    let scale = planet.scale().max_element().max(1e-9);
    let (inner, outer) = (atmosphere.inner_radius, atmosphere.outer_radius);
    // Relative to the planet's centre, in the planet's scale; in f64, since radii are large.
    let offset = ((position - planet.translation()) / scale).as_dvec3();
    let radius = offset.length().max(f64::from(inner));
    let cosine = offset.normalize_or(bevy::math::DVec3::Y).dot(towards.as_dvec3());
    let across = radius * (1.0 - cosine * cosine).max(0.0).sqrt();
    if cosine < 0.0 && across < f64::from(inner) {
        // The planet hides the sun.
        return Vec3::ZERO;
    }
    let reach = (f64::from(outer).powi(2) - across * across).max(0.0).sqrt() - radius * cosine;
    let mut depth = Vec3::ZERO;
    let mut from = 0.0;
    for step in 1..=AIR_STEPS {
        // Finer where the air is denser.
        let share = f64::from(step) / f64::from(AIR_STEPS);
        let to = reach.max(0.0) * share * share;
        let along = 0.5 * (from + to);
        let height = (radius * radius + along * along + 2.0 * radius * along * cosine).sqrt();
        let falloff = 1.0 - (height as f32 - inner) / (outer - inner).max(1e-3);
        let density: Vec3 = medium
            .terms
            .iter()
            .map(|term| {
                (term.absorption + term.scattering) * term.falloff.sample(falloff.clamp(0.0, 1.0))
            })
            .sum();
        depth += density * (to - from) as f32;
        from = to;
    }
    (-depth).exp()
}

#[cfg(test)]
mod tests {
    use bevy::light::atmosphere::{Falloff, PhaseFunction, ScatteringTerm};

    use super::*;

    /// Air whose density falls linearly to zero has half the optical depth of uniform air.
    #[test]
    fn the_atmosphere_attenuates_sunlight() {
        let term = ScatteringTerm {
            absorption: Vec3::new(0.0, 4e-6, 0.0),
            scattering: Vec3::new(1e-5, 6e-6, 0.0),
            falloff: Falloff::Linear,
            phase: PhaseFunction::Isotropic,
        };
        let medium = ScatteringMedium::new(64, 64, [term]);
        let atmosphere = Atmosphere::earth(Handle::default());
        let planet = GlobalTransform::from_translation(-atmosphere.inner_radius * Vec3::Y);
        let left = |towards: Vec3| {
            transmittance((&atmosphere, &planet), &medium, Vec3::ZERO, towards.normalize())
        };
        let up = left(Vec3::Y);
        // 100 km of air.
        let expected = (-Vec3::new(1e-5, 1e-5, 0.0) * 50e3).exp();
        assert!((up - expected).abs().max_element() < 2e-3, "{up}, not {expected}");
        // At 60 degrees from the zenith the path is nearly twice as long.
        let aslant = left(Vec3::new(3.0_f32.sqrt(), 1.0, 0.0));
        assert!((aslant.x / expected.x.powi(2) - 1.0).abs() < 0.03, "{aslant}");
        assert!(left(Vec3::new(1.0, 0.01, 0.0)).x < 0.05);
        assert_eq!(left(Vec3::new(1.0, -0.01, 0.0)), Vec3::ZERO);
        assert!((left(Vec3::Y).z - 1.0).abs() < 1e-6);
    }
}
