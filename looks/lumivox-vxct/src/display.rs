//! The brightness of a scene in the look.

use glam::Vec3;
use lumivox_render::look::LookScene;
use lumivox_render::parameters::MAX_STOPS;
use lumivox_render::{Exposure, ToneMap};
use lumivox_scene::{Attenuation, Environment, Material, Scene};

/// How a screen shows a scene in this look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VxctDisplay {
    /// The radiance that is shown as 1, in cd/m².
    pub white: f32,
    /// The exposure that maps `white` to 1.
    pub exposure: Exposure,
    /// The curve.
    pub tone_map: ToneMap,
}

/// How a screen shows a scene in this look.
///
/// Scenes made for VXCT, with a light that has an [`Attenuation`] or with a grid of their own and
/// no lights, are in display values: they are shown without exposure and encoding. Other scenes are
/// in physical units: there white is the radiance of a white surface that faces the strongest
/// light, a sun or a lamp without falloff (its colour in VXCT's sense). Without lights, white is
/// the mean radiance of the surroundings, or else the strongest emission. The picture is encoded
/// for the screen, since the light of a real scene has more contrast than display values.
pub fn vxct_display(scene: &Scene) -> VxctDisplay {
    display_of(&LookScene::of(scene))
}

/// [`vxct_display`] of a prepared scene.
pub(super) fn display_of(scene: &LookScene) -> VxctDisplay {
    if scene.has_display_values {
        let (exposure, tone_map) = (Exposure::Stops(0.0), ToneMap::Raw);
        return VxctDisplay { white: 1.0, exposure, tone_map };
    }
    let bounds = scene.bounds;
    let unit_m = 0.5 * (bounds.max - bounds.min).max_element();
    let of_lights = scene.lighting.lights.iter().map(|light| {
        let share = if light.kind.is_parallel() { 1.0 } else { share_of_lamps(unit_m) };
        light.color.max_element() * (light.intensity * share) / std::f32::consts::PI
    });
    let brightest = of_lights.filter(|white| white.is_finite()).fold(0.0, f32::max);
    let white = if brightest > 0.0 {
        brightest
    } else {
        white_without_lamps(&scene.materials, &scene.lighting.environment)
    };
    let exposure = Exposure::Stops((-white.log2()).clamp(-MAX_STOPS, MAX_STOPS));
    VxctDisplay { white, exposure, tone_map: ToneMap::Linear }
}

/// The mean radiance of the surroundings; without any, the strongest emission; in a scene without
/// light 1 cd/m².
fn white_without_lamps(materials: &[Material], environment: &Environment) -> f32 {
    let emission = materials.iter().map(|material| material.emissive.max_element());
    let emission = emission.filter(|radiance| radiance.is_finite()).fold(0.0, f32::max);
    let whites = [mean_radiance(environment).max_element(), emission];
    whites.into_iter().find(|white| white.is_finite() && *white > 0.0).unwrap_or(1.0)
}

/// The mean over all directions.
pub(super) fn mean_radiance(environment: &Environment) -> Vec3 {
    environment.radiance * environment.map.as_ref().map_or(Vec3::ONE, |map| map.mean_radiance())
}

/// Factor of the intensity of a lamp without a polynomial. The lamp gets VXCT's default polynomial
/// over units of `unit_m`; with this factor it matches the physical falloff at one unit.
pub(super) fn share_of_lamps(unit_m: f32) -> f32 {
    1.0 / (unit_m * unit_m * Attenuation::default().at(1.0))
}
