//! The scene's own light, measured where the camera sees it.
//!
//! A picture needs light on what it shows. So rays go out from the eye, and the light from the
//! scene's lamps and emission is measured where they hit. A helmet with a glowing visor gets almost
//! none of its own light, and is dark; a room with a small lamp gets little, but everywhere.
//!
//! The emissive factor of a material is not enough: exporters switch emission on and keep the dark
//! parts black by a texture. So emission is sampled at points spread evenly over the area of all
//! surfaces whose material emits.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::rays::{Hit, Patch, Rays, Triangle};
use crate::load::color::linear_from_srgb;
use crate::{Camera, EnvironmentMap, Light, Material, Scene, Shading, Texture, TextureRef, Wrap};

/// Rays from the eye, across and down the picture.
const LOOKS: [usize; 2] = [24, 14];
/// Points at which emission is sampled: a lit window of a thousandth of the emitting area gets
/// four.
const SAMPLES: usize = 4096;
/// Emitting pieces that each point samples.
const EMITTERS: usize = 48;
/// The most lamps that are sampled, the strongest first.
const LAMPS: usize = 64;
/// Texels up to this code (of 255) count as black: compression makes black images a little grey.
const BLACK: u8 = 8;

/// The least illuminance of things seen from outside, about that of a full moon (Kyba, Mohar and
/// Posch 2017, "How bright is moonlight?", Astronomy and Geophysics 58 (1)).
const MOONLIGHT_LUX: f32 = 0.25;
/// The least illuminance in a place whose own lamps shine: a grey surface then has the 0.002 cd/m²
/// of EV100 -6, which a camera still shows.
const STARLIGHT_LUX: f32 = 0.01;
/// A point counts as lit if it has at least this share of the mean.
const LIT: f32 = 0.125;
/// The share of the visible points of a thing that lamps must light; the rest is their shadow.
const LAMPS_REACH: f32 = 0.3;
/// The share of the visible points of a place that must be lit if emission contributes: it only
/// lights its vicinity.
const EMISSION_REACHES_PLACE: f32 = 0.6;
/// As `EMISSION_REACHES_PLACE`, for a thing.
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

/// The emission of a scene's surfaces.
pub(super) struct Emission {
    /// Points on emitting surfaces that are not black, their luminance in cd/m², and whether both
    /// sides emit. The weights are areas in unit space.
    emitters: Vec<(Patch, f32, bool)>,
    /// The mean luminance of the emitting area, cd/m²; 0 if there is none.
    pub(super) luminance: f32,
    /// The mean illuminance of all surfaces if the flux stayed in the scene, lx: a diffuse emitter
    /// of luminance L and area A has the flux `pi L A`.
    pub(super) mean_lux: f32,
}

impl Emission {
    pub(super) const NONE: Self = Self { emitters: Vec::new(), luminance: 0.0, mean_lux: 0.0 };

    pub(super) fn of(scene: &Scene, rays: &Rays) -> Self {
        let emits = |triangle: &&Triangle| {
            material(scene, triangle.instance).is_some_and(|m| m.emissive.max_element() > 0.0)
        };
        let candidates: Vec<&Triangle> = rays.triangles.iter().filter(emits).collect();
        let mut emission = Self::NONE;
        let (mut area, mut power) = (0.0, 0.0);
        for (triangle, weights, patch) in rays.spread(&candidates, SAMPLES) {
            let luminance = emitted(scene, triangle, weights).map_or(0.0, luminance);
            let is_double = triangle.is_double_sided();
            if luminance > 0.0 {
                let sides = if is_double { 2.0 } else { 1.0 };
                area += sides * patch.weight;
                power += sides * patch.weight * luminance;
                emission.emitters.push((patch, luminance, is_double));
            }
        }
        let all: f32 = rays
            .triangles
            .iter()
            .map(|triangle| {
                rays.area(triangle) * if triangle.is_double_sided() { 2.0 } else { 1.0 }
            })
            .sum();
        emission.luminance = power / area.max(f32::MIN_POSITIVE);
        emission.mean_lux = PI * power / all.max(f32::MIN_POSITIVE);
        emission
    }
}

fn material(scene: &Scene, instance: u32) -> Option<&Material> {
    scene.materials.get(scene.instances.get(instance as usize)?.material)
}

/// The emitted radiance at a point between the corners of a triangle.
fn emitted(scene: &Scene, triangle: &Triangle, weights: [f32; 3]) -> Option<Vec3> {
    let material = material(scene, triangle.instance)?;
    let Some(reference) = material.emissive_texture else { return Some(material.emissive) };
    let mesh = scene.meshes.get(scene.instances[triangle.instance as usize].mesh)?;
    let second = Some(&mesh.uvs1).filter(|uvs| reference.uv_set == 1 && !uvs.is_empty());
    let uvs = second.unwrap_or(&mesh.uvs);
    let corners = mesh.indices.chunks_exact(3).nth(triangle.number as usize)?.iter().zip(weights);
    let uv: Option<Vec2> = corners.map(|(&at, weight)| Some(*uvs.get(at as usize)? * weight)).sum();
    Some(material.emissive * texel(scene.textures.get(reference.texture)?, reference, uv?)?)
}

/// The linear colour of the nearest texel; `None` if it counts as black.
fn texel(texture: &Texture, reference: TextureRef, uv: Vec2) -> Option<Vec3> {
    let uv = reference.transform.transform_point2(uv);
    let place = |at: f32, wrap: Wrap, size: u32| {
        let at = match wrap {
            Wrap::Repeat => at.rem_euclid(1.0),
            Wrap::MirroredRepeat => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
            Wrap::ClampToEdge => at,
        };
        ((at * size as f32) as usize).min(size as usize - 1)
    };
    let x = place(uv.x, texture.sampler.wrap_u, texture.width);
    let y = place(uv.y, texture.sampler.wrap_v, texture.height);
    let start = 4 * (y * texture.width as usize + x);
    let &[r, g, b] = texture.rgba8.get(start..)?.first_chunk()?;
    let linear = [r, g, b].map(|code| linear_from_srgb(f32::from(code) / 255.0));
    (r.max(g).max(b) > BLACK).then_some(linear.into())
}

/// Luminance of a linear colour (ITU-R BT.709-6, section 3.2).
fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Illuminance of points by the scene's own light, lx.
pub(super) struct OwnLight {
    by_lamps: Vec<f32>,
    by_all: Vec<f32>,
    /// The mean illuminance by lamps, plus the flux of all emission divided by the scene's area,
    /// lx.
    enclosed_lux: f32,
}

impl OwnLight {
    pub(super) fn at(points: &[Patch], scene: &Scene, rays: &Rays, emission: &Emission) -> Self {
        let mut lights: Vec<&Light> = scene.lights.iter().collect();
        lights.sort_by(|a, b| b.intensity.total_cmp(&a.intensity));
        lights.truncate(LAMPS);
        let step = emission.emitters.len().div_ceil(EMITTERS).max(1);
        let (mut by_lamps, mut by_all) = (Vec::new(), Vec::new());
        for (number, point) in points.iter().enumerate() {
            let lamps: f32 = lights.iter().map(|light| lux(rays, light, point)).sum();
            // Each point samples different pieces from its neighbours.
            let emitters = emission.emitters.iter().skip(number % step).step_by(step);
            let emitted: f32 = emitters.map(|emitter| lux_of(rays, emitter, point)).sum();
            by_lamps.push(lamps);
            by_all.push(lamps + emitted * step as f32);
        }
        let enclosed_lux = mean(&by_lamps) + emission.mean_lux;
        Self { by_lamps, by_all, enclosed_lux }
    }

    /// Whether the light is enough to see the scene.
    pub(super) fn is_enough(&self, from: Standpoint) -> bool {
        let is_lit_by = |lux: &[f32], least, reach| mean(lux) >= least && share(lux) >= reach;
        match from {
            Standpoint::ClosedRoom => self.enclosed_lux >= STARLIGHT_LUX,
            Standpoint::OpenPlace => {
                mean(&self.by_lamps) >= STARLIGHT_LUX
                    || is_lit_by(&self.by_all, STARLIGHT_LUX, EMISSION_REACHES_PLACE)
            }
            Standpoint::Outside => {
                is_lit_by(&self.by_lamps, MOONLIGHT_LUX, LAMPS_REACH)
                    || is_lit_by(&self.by_all, MOONLIGHT_LUX, EMISSION_REACHES_THING)
            }
        }
    }

    /// Mean illuminance, lx; in a closed room all emission counts, wherever it arrives.
    pub(super) fn lux(&self, from: Standpoint) -> f32 {
        if from == Standpoint::ClosedRoom { self.enclosed_lux } else { mean(&self.by_all) }
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
pub(super) fn seen(scene: &Scene, rays: &Rays, camera: &Camera, aspect: f32) -> Vec<Patch> {
    let eye = rays.unit.unit_from_world(camera.position);
    let [across, down] = LOOKS;
    let size = glam::UVec2::new((1e3 * aspect) as u32 + 1, 1000);
    let look = |number: usize| {
        let place = Vec2::new((number % across) as f32 + 0.5, (number / across) as f32 + 0.5);
        let pixel = place / Vec2::new(across as f32, down as f32) * size.as_vec2();
        rays.cast_visible(eye, camera.ray(pixel, size).1)
    };
    let is_dark =
        |hit: &&Hit| !material(scene, hit.instance).is_some_and(|m| m.emissive.max_element() > 0.0);
    let hits: Vec<Hit> = (0..across * down).filter_map(look).collect();
    let dark: Vec<Patch> = hits.iter().filter(is_dark).map(Hit::patch).collect();
    // If all visible surfaces may emit, all points count: a texture decides which surfaces do.
    if dark.is_empty() { hits.iter().map(Hit::patch).collect() } else { dark }
}

/// The illuminance of a point by a lamp.
fn lux(rays: &Rays, light: &Light, point: &Patch) -> f32 {
    let is_parallel = light.kind.is_parallel();
    let to_light = rays.unit.unit_from_world(light.position) - point.position;
    let way = if is_parallel { -light.direction } else { to_light };
    let limit = if is_parallel { f32::INFINITY } else { 1.0 };
    let towards = way.normalize_or_zero();
    let cosine = towards.dot(point.normal);
    let is_in_cone =
        light.cone_rad().is_none_or(|[_, outer]| light.direction.dot(-towards) >= outer.cos());
    if cosine <= 0.0 || !is_in_cone || !rays.is_free(point.position, way, limit) {
        return 0.0;
    }
    cosine * luminance(light.color) * light.illuminance_at(way.length() * rays.unit.scale_m)
}

/// The illuminance of a point by an emitting piece.
fn lux_of(rays: &Rays, (piece, luminance, is_double): &(Patch, f32, bool), point: &Patch) -> f32 {
    let way = piece.position - point.position;
    let cosine = way.dot(point.normal);
    let sent = -way.dot(piece.normal);
    let sent = if *is_double { sent.abs() } else { sent };
    // Stops just before the emitter, which would block itself.
    if cosine <= 0.0 || sent <= 0.0 || !rays.is_free(point.position, way, 0.999) {
        return 0.0;
    }
    piece.weight * luminance * cosine * sent / way.length_squared().powi(2)
}

/// Whether all surfaces are unlit.
pub(super) fn is_unlit(scene: &Scene) -> bool {
    let mut unlit = used(scene).map(|material| matches!(material.shading, Shading::Unlit(_)));
    scene.triangle_count() > 0 && unlit.all(|is_unlit| is_unlit)
}

pub(super) fn surroundings_shine(scene: &Scene) -> bool {
    let is_black =
        |map: &EnvironmentMap| map.rgb.as_flattened().iter().all(|&channel| channel <= 0.0);
    let environment = &scene.environment;
    environment.radiance.max_element() > 0.0 && !environment.map.as_deref().is_some_and(is_black)
}

fn used(scene: &Scene) -> impl Iterator<Item = &Material> {
    scene.shown().filter_map(|instance| scene.materials.get(instance.material))
}

impl Scene {
    /// Whether there is any light: a lamp, an environment, or a visible surface that emits; also if
    /// all surfaces are unlit.
    pub fn shines(&self) -> bool {
        self.shines_without_emission() || self.emits()
    }

    /// Whether the scene's own emission is its only light: there is no lamp, and no surroundings.
    pub fn is_lit_by_emission_alone(&self) -> bool {
        !self.shines_without_emission() && self.emits()
    }

    fn shines_without_emission(&self) -> bool {
        let shines = |light: &Light| light.intensity * light.color.max_element() > 0.0;
        self.lights.iter().any(shines) || surroundings_shine(self) || is_unlit(self)
    }

    fn emits(&self) -> bool {
        let is_lit = |texel: &[u8]| texel[..3].iter().any(|&channel| channel > BLACK);
        used(self).any(|material| {
            let texture = material.emissive_texture;
            let texture = texture.and_then(|reference| self.textures.get(reference.texture));
            material.emissive.max_element() > 0.0
                && texture.is_none_or(|texture| texture.rgba8.chunks_exact(4).any(is_lit))
        })
    }
}
