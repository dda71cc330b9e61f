//! How bright a scene is shown in the look.

use lumivox_scene::{Attenuation, LightKind, Scene};

use crate::parameters::MAX_STOPS;
use crate::scene::{Lighting, reference_white};
use crate::{Exposure, ToneMap};

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
/// display values: they are shown as they are, without exposure and encoding. Other scenes are in physical units: there
/// white is what a white surface shows that faces the strongest light, a lamp right at its place (its colour in VXCT's
/// sense) or a sun; where nothing but surfaces shines, the brightest of them. It is encoded for the screen, since the
/// light of a real scene has more contrast than display values.
pub fn vxct_display(scene: &Scene) -> VxctDisplay {
    if has_display_values(scene) {
        let (exposure, tone_map) = (Exposure::Stops(0.0), ToneMap::Raw);
        return VxctDisplay { white: 1.0, exposure, tone_map };
    }
    let bounds = scene.voxel_bounds();
    let unit_m = 0.5 * (bounds.max - bounds.min).max_element();
    let of_lights = scene.lights.iter().map(|light| {
        let strength = match light.kind {
            LightKind::Directional { illuminance_lux, .. } => illuminance_lux,
            LightKind::Point { intensity_cd, .. } | LightKind::Spot { intensity_cd, .. } => {
                intensity_cd * share_of_lamps(unit_m)
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

/// Whether the colours of a scene are what a screen shows: it was made for VXCT.
pub fn has_display_values(scene: &Scene) -> bool {
    let has_no_lights = scene.lights.is_empty() && scene.grid_bounds.is_some();
    has_no_lights || scene.lights.iter().any(|light| light.attenuation.is_some())
}

/// What the intensity of a lamp without a polynomial is multiplied by: it gets VXCT's default one over units of
/// `unit_m`, and at one unit the two meet.
pub(super) fn share_of_lamps(unit_m: f32) -> f32 {
    1.0 / (unit_m * unit_m * Attenuation::default().at(1.0))
}
