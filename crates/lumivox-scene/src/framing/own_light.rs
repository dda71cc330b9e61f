//! The scene's own light, measured where the camera sees it.
//!
//! A picture needs light on what it shows. So rays go out from the eye, and the light from the
//! scene's lamps, surroundings and emission is measured where they hit. A helmet with a glowing
//! visor gets almost none of its own light, and is dark; a room with a small lamp gets little, but
//! everywhere.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::directions;
use super::emission::{Emission, Emitter, luminance};
use super::rays::{Hit, Rays};
use super::soup::Unit;
use super::survey::Patch;
use crate::{Camera, Light, Scene};

/// Rays from the eye, across and down the picture.
const LOOKS: [usize; 2] = [24, 14];
/// Emitting pieces that each point samples.
const EMITTERS: usize = 48;
/// Directions in which each point samples the surroundings.
const OPENINGS: usize = 16;
/// The most lamps that are sampled, the strongest first.
const LAMPS: usize = 64;

/// The least illuminance of things seen from outside, about that of a full moon (Kyba, Mohar and
/// Posch 2017, "How bright is moonlight?", Astronomy and Geophysics 58 (1)).
const MOONLIGHT_LUX: f32 = 0.25;
/// The least illuminance in a place whose own lamps shine: a grey surface then has the 0.002 cd/m²
/// of EV100 -6, which a camera still shows.
const STARLIGHT_LUX: f32 = 0.01;
/// A point counts as lit if it has at least this share of the mean.
const LIT: f32 = 0.125;
/// The share of the visible points that lamps and surroundings must light; the rest is their
/// shadow.
const LAMPS_REACH: f32 = 0.3;
/// The share of what is seen that light must reach if emission contributes, which lights only its
/// vicinity: most of a place, nearly all of a thing.
const EMISSION_REACHES_PLACE: f32 = 0.6;
const EMISSION_REACHES_THING: f32 = 0.9;

/// The standpoint of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standpoint {
    /// Inside a closed room: light stays there.
    ClosedRoom,
    /// Inside a place with gaps.
    OpenPlace,
    Outside,
}

/// Illuminance of the visible points, lx.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct OwnLight {
    /// By lamps and surroundings.
    lamps: Vec<f32>,
    /// By emission.
    emission: Vec<f32>,
    /// Flux over area.
    emission_mean_lux: f32,
}

impl OwnLight {
    /// Measures at some points.
    pub(super) fn at(points: &[Patch], scene: &Scene, rays: &Rays, unit: Unit) -> Self {
        let emission = Emission::of(scene, unit);
        let mut lights: Vec<&Light> = scene.lights.iter().collect();
        lights.sort_by(|a, b| b.intensity.total_cmp(&a.intensity));
        lights.truncate(LAMPS);
        let environment = &scene.environment;
        let map = environment.map.as_ref().map_or(Vec3::ONE, |map| map.mean_radiance());
        let sky_lux = PI * luminance(environment.radiance * map);
        let step = emission.emitters.len().div_ceil(EMITTERS).max(1);
        let mut own = Self { emission_mean_lux: emission.mean_lux(), ..Self::default() };
        for (number, point) in points.iter().enumerate() {
            let by_lamps: f32 = lights.iter().map(|light| lux(rays, unit, light, point)).sum();
            let by_sky = if sky_lux > 0.0 { sky_lux * openness(rays, point) } else { 0.0 };
            own.lamps.push(by_lamps + by_sky);
            // Each point samples different pieces and directions from its neighbours.
            let looked_at = emission.emitters.iter().skip(number % step).step_by(step);
            let (mut sum, mut count) = (0.0, 0);
            for emitter in looked_at {
                sum += lux_of(rays, unit, emitter, point);
                count += 1;
            }
            own.emission.push(sum * emission.emitters.len() as f32 / count.max(1) as f32);
        }
        own
    }

    /// Whether the light is enough to see the scene.
    pub(super) fn is_enough(&self, from: Standpoint) -> bool {
        let is_lit_by = |lux: &[f32], least, reach| mean(lux) >= least && share(lux) >= reach;
        match from {
            Standpoint::ClosedRoom => self.lux(from) >= STARLIGHT_LUX,
            Standpoint::OpenPlace => {
                mean(&self.lamps) >= STARLIGHT_LUX
                    || is_lit_by(&self.all(), STARLIGHT_LUX, EMISSION_REACHES_PLACE)
            }
            Standpoint::Outside => {
                is_lit_by(&self.lamps, MOONLIGHT_LUX, LAMPS_REACH)
                    || is_lit_by(&self.all(), MOONLIGHT_LUX, EMISSION_REACHES_THING)
            }
        }
    }

    /// Mean illuminance of the visible points, lx; in a closed room all emission counts, wherever
    /// it arrives.
    pub(super) fn lux(&self, from: Standpoint) -> f32 {
        match from {
            Standpoint::ClosedRoom => mean(&self.lamps) + self.emission_mean_lux,
            Standpoint::OpenPlace | Standpoint::Outside => mean(&self.all()),
        }
    }

    fn all(&self) -> Vec<f32> {
        self.lamps.iter().zip(&self.emission).map(|(a, b)| a + b).collect()
    }
}

fn mean(lux: &[f32]) -> f32 {
    lux.iter().sum::<f32>() / lux.len().max(1) as f32
}

/// The share of the points that count as lit.
fn share(lux: &[f32]) -> f32 {
    let least = LIT * mean(lux);
    lux.iter().filter(|&&lux| lux >= least).count() as f32 / lux.len().max(1) as f32
}

/// The points visible in a picture, except those on emissive surfaces, which are bright themselves.
pub(super) fn seen(
    scene: &Scene,
    rays: &Rays,
    unit: Unit,
    camera: &Camera,
    aspect: f32,
) -> Vec<Patch> {
    let emits: Vec<bool> = scene
        .subjects()
        .filter(|instance| scene.meshes.get(instance.mesh).is_some())
        .map(|instance| scene.materials.get(instance.material))
        .map(|material| material.is_some_and(|m| m.emissive.max_element() > 0.0))
        .collect();
    let is_dark = |hit: &&Hit| !emits.get(hit.part as usize).is_some_and(|&emits| emits);
    let eye = unit.unit_from_world(camera.position);
    let [across, down] = LOOKS;
    let size = glam::UVec2::new((1e3 * aspect) as u32 + 1, 1000);
    let mut hits = Vec::new();
    for number in 0..across * down {
        let place = Vec2::new((number % across) as f32 + 0.5, (number / across) as f32 + 0.5);
        let pixel = place / Vec2::new(across as f32, down as f32) * size.as_vec2();
        let (_, way) = camera.ray(pixel, size);
        hits.extend(rays.cast_visible(eye, way));
    }
    let dark: Vec<Patch> = hits.iter().filter(is_dark).map(Patch::of).collect();
    // If all visible surfaces may emit, all points count: a texture decides which surfaces do.
    if dark.is_empty() { hits.iter().map(Patch::of).collect() } else { dark }
}

/// The illuminance of a point by a lamp.
fn lux(rays: &Rays, unit: Unit, light: &Light, point: &Patch) -> f32 {
    let strength = light.intensity * luminance(light.color);
    if light.kind.is_parallel() {
        let towards = -light.direction;
        let cosine = towards.dot(point.normal);
        let arrives = cosine > 0.0 && rays.is_free(point.position, towards, f32::INFINITY);
        return if arrives { strength * cosine } else { 0.0 };
    }
    let way = unit.unit_from_world(light.position) - point.position;
    let distance = way.length();
    let towards = way / distance;
    let cosine = towards.dot(point.normal);
    let is_in_cone =
        light.cone_rad().is_none_or(|[_, outer]| light.direction.dot(-towards) >= outer.cos());
    if cosine > 0.0 && is_in_cone && rays.is_free(point.position, way, 1.0) {
        strength * cosine / (distance * unit.scale_m).powi(2)
    } else {
        0.0
    }
}

/// The illuminance of a point by an emitting piece.
fn lux_of(rays: &Rays, unit: Unit, emitter: &Emitter, point: &Patch) -> f32 {
    let from = point.position;
    let way = emitter.position - from;
    let squared = way.length_squared();
    let cosine = way.dot(point.normal);
    let sent = -way.dot(emitter.normal);
    let sent = if emitter.is_double_sided { sent.abs() } else { sent };
    // Stops just before the emitter, which would block itself.
    if cosine <= 0.0 || sent <= 0.0 || !rays.is_free(from, way, 0.999) {
        return 0.0;
    }
    emitter.intensity_cd * cosine * sent / (squared * squared * unit.scale_m * unit.scale_m)
}

/// The cosine-weighted share of the hemisphere over a point that is unblocked.
fn openness(rays: &Rays, point: &Patch) -> f32 {
    // Points of the sphere around the tip of the normal have the cosine's density.
    let ways = directions::sphere(OPENINGS).map(|way| point.normal * 1.0001 + way);
    let free = ways.filter(|&way| rays.is_free(point.position, way, f32::INFINITY)).count();
    free as f32 / OPENINGS as f32
}
