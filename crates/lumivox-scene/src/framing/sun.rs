//! Sun and sky for open scenes.

use glam::Vec3;

use super::directions;
use super::rays::Rays;
use super::survey::Patch;
use crate::sky::{Sky, SkySettings, sky};
use crate::{EnvironmentMap, Light};

/// The direction of the key light of things: to the left of the camera, and above.
const KEY_AZIMUTH_RAD: f32 = 0.87;
const KEY_ELEVATION_RAD: f32 = 0.87;

/// Candidate sun directions for places.
const AZIMUTHS: usize = 16;
const ELEVATIONS_RAD: [f32; 5] = [0.35, 0.6, 0.85, 1.1, 1.3];
/// Directions in which the eye looks.
const LOOKS: usize = 600;

/// Texels around the sky's horizon. Tests only check the sun's direction, and use a coarse sky.
fn sky_width() -> u32 {
    if cfg!(test) { 32 } else { SkySettings::default().width }
}

/// A clear day with the sun in that direction, which is above the horizon.
pub(super) fn day(towards_sun: Vec3) -> (Light, EnvironmentMap) {
    let settings =
        SkySettings { sun_direction: towards_sun, width: sky_width(), ..SkySettings::default() };
    let Ok(Sky { map, sun: Some(sun) }) = sky(&settings) else {
        unreachable!("a sun above the horizon has a sky")
    };
    (Light { name: "default sun".to_owned(), ..sun }, map)
}

/// The direction of the sun: where it lights most of a place, or else above and to the left of the
/// camera.
pub(super) fn direction(rays: &Rays, patches: &[Patch], eye: Vec3, forward: Vec3) -> Vec3 {
    entering(rays, patches, eye).unwrap_or_else(|| key(forward))
}

fn key(forward: Vec3) -> Vec3 {
    // Looking straight down, "left" is that of a camera that came from +z.
    let level = Vec3::new(forward.x, 0.0, forward.z).try_normalize().unwrap_or(Vec3::NEG_Z);
    let right = level.cross(Vec3::Y);
    let (left, back) = KEY_AZIMUTH_RAD.sin_cos();
    let (up, along) = KEY_ELEVATION_RAD.sin_cos();
    (-level * back - right * left) * along + Vec3::Y * up
}

/// The sun that reaches the most surfaces of a place; `None` if none reaches any.
///
/// Half of the surfaces are those visible from all over the place. The other half are those visible
/// from the eye, if it is inside: a patch of sunlight there makes the picture.
fn entering(rays: &Rays, patches: &[Patch], eye: Vec3) -> Option<Vec3> {
    let mut surfaces: Vec<(Vec3, Vec3)> =
        patches.iter().map(|patch| (patch.position, patch.normal)).collect();
    if !surfaces.is_empty() {
        let seen = directions::sphere(LOOKS).filter_map(|way| rays.cast_visible(eye, way));
        surfaces.extend(seen.map(|hit| (hit.lifted(), hit.normal)));
    }
    let mut best = (0, None);
    for elevation in ELEVATIONS_RAD {
        let (up, level) = f32::sin_cos(elevation);
        for azimuth in 0..AZIMUTHS {
            let turn = std::f32::consts::TAU * (azimuth as f32 + 0.5) / AZIMUTHS as f32;
            let towards_sun = Vec3::new(turn.sin() * level, up, turn.cos() * level);
            let is_lit = |&&(position, normal): &&(Vec3, Vec3)| {
                normal.dot(towards_sun) > 0.0 && rays.is_free(position, towards_sun, f32::INFINITY)
            };
            let lit = surfaces.iter().filter(is_lit).count();
            if lit > best.0 {
                best = (lit, Some(towards_sun));
            }
        }
    }
    best.1
}
