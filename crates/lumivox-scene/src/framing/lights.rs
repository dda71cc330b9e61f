//! Lights for scenes that have too little: lamps in closed rooms, a sun in open places.
//!
//! A lamp is placed where it sees most of the points that no lamp sees yet, below the ceiling and
//! away from the walls; lamps are added until nearly everything is lit. In a closed room all flux
//! of a lamp reaches the surfaces that it sees, 4 pi I on the area A, so an intensity of `I = E A /
//! (4 pi)` gives them the mean illuminance E. The area comes from rays: each of n rays represents
//! `4 pi / n` of solid angle, and so `4 pi / n * d^2 / cos` of surface, hence I is E times the mean
//! of `d^2 / cos`.

use std::f32::consts::TAU;

use glam::Vec3;

use super::directions;
use super::rays::{Patch, Rays};
use super::survey::few;
use crate::Light;

/// The target mean illuminance: that of a living room or an office.
const MEAN_LUX: f32 = 300.0;
const MOST_LAMPS: usize = 8;
/// The height of a lamp, as a share of the free height.
const HEIGHT: f32 = 0.8;
/// Candidate positions of lamps.
const PLACES: usize = 100;
/// Points to be lit by lamps.
const POINTS: usize = 400;
/// No more lamps are added below this share of dark points.
const DARK: f32 = 0.05;
/// Rays that measure a room from a lamp.
const LOOKS: usize = 2048;
/// The least cosine of a ray: the few rays at grazing angles would dominate the area's error. The
/// bias is less than a hundredth for a cube.
const GRAZING: f32 = 0.02;
/// The radius of a lamp, as a share of the distance to the nearest surface: shadows are soft, and
/// the lamp touches nothing.
const RADIUS: f32 = 0.1;

/// The direction of the key light of things: to the left of the camera, and above.
const KEY_AZIMUTH_RAD: f32 = 0.87;
const KEY_ELEVATION_RAD: f32 = 0.87;
/// Candidate sun directions for places.
const AZIMUTHS: usize = 16;
const ELEVATIONS_RAD: [f32; 5] = [0.35, 0.6, 0.85, 1.1, 1.3];
/// Directions in which the eye looks for surfaces to be lit by the sun.
const SUN_LOOKS: usize = 600;

/// Lamps for the interior of a place.
pub(super) fn lamps(rays: &Rays, interior: &[Vec3]) -> Vec<Light> {
    let places = few(interior, PLACES).filter_map(|point| below_ceiling(rays, point));
    let places: Vec<(Vec3, f32)> = places.collect();
    let widest = places.iter().map(|place| place.1).fold(f32::MIN_POSITIVE, f32::max);
    let mut dark: Vec<Vec3> = few(interior, POINTS).collect();
    let most_dark = (dark.len() as f32 * DARK) as usize;
    let lights =
        |place: Vec3, point: Vec3| place == point || rays.is_free(place, point - place, 1.0);
    let mut lamps = Vec::new();
    while lamps.len() < MOST_LAMPS && dark.len() > most_dark {
        let worth = |&(place, clearance): &(Vec3, f32)| {
            let lit = dark.iter().filter(|&&point| lights(place, point)).count();
            (lit as f32 * (0.5 + clearance / widest), place)
        };
        let best = places.iter().map(worth).reduce(|a, b| if b.0 > a.0 { b } else { a });
        let Some((_, place)) = best.filter(|best| best.0 > 0.0) else { break };
        dark.retain(|&point| !lights(place, point));
        lamps.extend(lamp(rays, place));
    }
    lamps
}

/// A point below the ceiling, vertically above or below `point`, and the distance to the nearest
/// wall.
fn below_ceiling(rays: &Rays, point: Vec3) -> Option<(Vec3, f32)> {
    let ceiling = rays.cast(point, Vec3::Y)?.position.y;
    let floor = rays.cast(point, Vec3::NEG_Y)?.position.y;
    let place = Vec3::new(point.x, floor + (ceiling - floor) * HEIGHT, point.z);
    let walls = (0..16).filter_map(|step| {
        let (sin, cos) = (step as f32 / 16.0 * TAU).sin_cos();
        Some(rays.cast(place, Vec3::new(sin, 0.0, cos))?.distance)
    });
    Some((place, walls.fold(f32::INFINITY, f32::min).min(1.0)))
}

pub(super) fn lamp(rays: &Rays, position: Vec3) -> Option<Light> {
    let (mut hits, mut nearest, mut area) = (0, f32::INFINITY, 0.0);
    for way in directions::sphere(LOOKS) {
        let Some(hit) = rays.cast(position, way) else { continue };
        hits += 1;
        nearest = nearest.min(hit.distance);
        area += hit.distance * hit.distance / hit.normal.dot(-way).max(GRAZING);
    }
    // Only the rays that hit count: the flux of the others is lost through gaps.
    let intensity = MEAN_LUX * area / hits.max(1) as f32 * rays.unit.scale_m * rays.unit.scale_m;
    (hits > 0).then(|| Light {
        name: "default lamp".to_owned(),
        intensity: intensity.clamp(f32::MIN_POSITIVE, f32::MAX),
        position: rays.unit.world_from_unit(position),
        radius_m: RADIUS * nearest * rays.unit.scale_m,
        ..Light::default()
    })
}

/// The direction to the sun: the one that lights most of a place, or else above and to the left of
/// the camera.
pub(super) fn towards_sun(rays: &Rays, patches: &[Patch], eye: Vec3, forward: Vec3) -> Vec3 {
    entering(rays, patches, eye).unwrap_or_else(|| key(forward))
}

fn key(forward: Vec3) -> Vec3 {
    // If the camera looks straight down, "left" is -x.
    let level = Vec3::new(forward.x, 0.0, forward.z).try_normalize().unwrap_or(Vec3::NEG_Z);
    let right = level.cross(Vec3::Y);
    let (left, back) = KEY_AZIMUTH_RAD.sin_cos();
    let (up, along) = KEY_ELEVATION_RAD.sin_cos();
    (-level * back - right * left) * along + Vec3::Y * up
}

/// The direction of the sun that lights the most surfaces of a place; `None` if none lights any.
///
/// Surfaces are those visible from all over the place, and, about half, those visible from the eye,
/// since sunlight matters most in the picture.
fn entering(rays: &Rays, patches: &[Patch], eye: Vec3) -> Option<Vec3> {
    let mut surfaces = patches.to_vec();
    if !surfaces.is_empty() {
        let seen = directions::sphere(SUN_LOOKS).filter_map(|way| rays.cast_visible(eye, way));
        surfaces.extend(seen.map(|hit| hit.patch()));
    }
    let mut best = (0, None);
    for elevation in ELEVATIONS_RAD {
        let (up, level) = f32::sin_cos(elevation);
        for azimuth in 0..AZIMUTHS {
            let turn = TAU * (azimuth as f32 + 0.5) / AZIMUTHS as f32;
            let towards_sun = Vec3::new(turn.sin() * level, up, turn.cos() * level);
            let is_lit = |patch: &&Patch| {
                patch.normal.dot(towards_sun) > 0.0
                    && rays.is_free(patch.position, towards_sun, f32::INFINITY)
            };
            let lit = surfaces.iter().filter(is_lit).count();
            if lit > best.0 {
                best = (lit, Some(towards_sun));
            }
        }
    }
    best.1
}
