//! Lamps for closed rooms.
//!
//! A lamp is placed where it sees the most points that no lamp sees yet, below the ceiling and away
//! from the walls; lamps are added until nearly all points are lit. In a closed room all flux of a
//! lamp reaches the surfaces that it sees, 4 pi I on the area A, so an intensity of `I = E A / (4
//! pi)` gives them the mean illuminance E. The area comes from rays: each of n rays represents `4
//! pi / n` of solid angle, and so `4 pi / n * d^2 / cos` of surface, hence I is E times the mean of
//! `d^2 / cos`.

use std::f32::consts::TAU;

use glam::Vec3;

use super::directions;
use super::rays::Rays;
use super::soup::Unit;
use super::survey::Probe;
use crate::Light;

/// The target mean illuminance: that of a living room or an office.
const MEAN_LUX: f32 = 300.0;
const MOST_LAMPS: usize = 8;
/// The height of a lamp, as a share of the free height.
const HEIGHT: f32 = 0.8;
/// Candidate positions of lamps, and points to be lit.
const PLACES: usize = 100;
const POINTS: usize = 400;
/// No more lamps are added below this share of dark points.
const DARK: f32 = 0.05;
/// Rays that measure a room from a lamp.
const LOOKS: usize = 2048;
/// The least cosine of a ray: the few at grazing angles would dominate the area's error. The bias
/// is less than a hundredth for a cube.
const GRAZING: f32 = 0.02;
/// The radius of a lamp, as a share of the distance to the nearest surface: soft shadows, and far
/// from touching anything.
const RADIUS: f32 = 0.1;

/// A lamp in unit space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lamp {
    position: Vec3,
    radius: f32,
    /// Luminous intensity if unit space is in metres.
    intensity: f32,
}

impl Lamp {
    pub(super) fn light(self, unit: Unit) -> Light {
        let intensity_cd = self.intensity * unit.scale_m * unit.scale_m;
        Light {
            name: "default lamp".to_owned(),
            intensity: intensity_cd.clamp(f32::MIN_POSITIVE, f32::MAX),
            position: unit.world_from_unit(self.position),
            radius_m: self.radius * unit.scale_m,
            ..Light::default()
        }
    }
}

pub(super) fn lamps(rays: &Rays, interior: &[Probe]) -> Vec<Lamp> {
    let every = |most: usize| interior.iter().step_by(interior.len().div_ceil(most).max(1));
    let places: Vec<(Vec3, f32)> =
        every(PLACES).filter_map(|probe| below_ceiling(rays, probe.position)).collect();
    let widest = places.iter().map(|place| place.1).fold(f32::MIN_POSITIVE, f32::max);
    let mut dark: Vec<Vec3> = every(POINTS).map(|probe| probe.position).collect();
    let few = (dark.len() as f32 * DARK) as usize;
    let mut lamps = Vec::new();
    while lamps.len() < MOST_LAMPS && dark.len() > few {
        let mut best = (0.0, None);
        for &(place, clearance) in &places {
            let lit = dark.iter().filter(|&&point| sees(rays, place, point)).count();
            let worth = lit as f32 * (0.5 + clearance / widest);
            if worth > best.0 {
                best = (worth, Some(place));
            }
        }
        let Some(place) = best.1 else { break };
        dark.retain(|&point| !sees(rays, place, point));
        lamps.extend(lamp(rays, place));
    }
    lamps
}

fn sees(rays: &Rays, from: Vec3, to: Vec3) -> bool {
    from == to || rays.is_free(from, to - from, 1.0)
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

pub(super) fn lamp(rays: &Rays, position: Vec3) -> Option<Lamp> {
    let (mut hits, mut nearest, mut area) = (0, f32::INFINITY, 0.0);
    for way in directions::sphere(LOOKS) {
        let Some(hit) = rays.cast(position, way) else { continue };
        hits += 1;
        nearest = nearest.min(hit.distance);
        area += hit.distance * hit.distance / hit.normal.dot(-way).max(GRAZING);
    }
    // Flux is lost through gaps: only the rays that hit stay inside.
    let intensity = MEAN_LUX * area / hits.max(1) as f32;
    (hits > 0).then_some(Lamp { position, radius: RADIUS * nearest, intensity })
}
