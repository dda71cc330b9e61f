//! Checks whether voxels and shadow maps are fine enough for what a camera sees.
//!
//! Light between surfaces that are only a few voxels apart is inaccurate, since the voxels' faces
//! are as large as the distance. So rays go from the visible points in all directions and measure
//! how far light comes from. A shadow map loses the shadows of occluders less than two texels above
//! a surface. So rays also go to the lights and measure how close the occluders are.

use glam::Vec3;

use super::directions;
use super::rays::{Patch, Rays};
use super::sight::{Note, three_digits};
use crate::{Bounds, Light};

/// Rays from each visible point.
const DIRECTIONS: usize = 16;
/// The fewest voxels over which light should travel.
const NEAR_VOXELS: f32 = 2.0;
/// The largest acceptable share of rays that end within `NEAR_VOXELS`.
const MOST_NEAR: f32 = 1.0 / 3.0;
/// The least share of rays that must hit anything: under the open sky little light goes from
/// surface to surface.
const LEAST_MET: f32 = 0.02;
/// A map loses the shadows of occluders within this many texels of a surface: receivers are offset
/// by that much.
const LOST_TEXELS: f32 = 2.0;
/// The largest acceptable share of points in shadow whose shadow is lost.
const MOST_LOST: f32 = 1.0 / 3.0;
/// The most lights that are tested, in their order.
const MOST_LIGHTS: usize = 64;
/// The fewest points that must be in shadow.
const LEAST_SHADED: usize = 3;

/// The resolution of the voxels and shadow maps. Default: unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fineness {
    /// The edge of a voxel, m, if all voxels have the same size.
    pub voxel_m: Option<f32>,
    /// The shadow maps.
    pub shadow_maps: Option<ShadowMapFineness>,
}

/// The resolution of shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowMapFineness {
    /// Texels along the edge of a map.
    pub resolution: u32,
    /// Maps of a directional light around the camera, in addition to the one of the whole scene.
    pub squares: u32,
    /// Ratio of a map's edge to that of the next smaller one.
    pub step: f32,
    /// Half the edge of the largest of these maps, m. `None`: one step smaller than the map of the
    /// whole scene.
    pub reach_m: Option<f32>,
}

impl ShadowMapFineness {
    /// The shadow of a light at a surface that faces it; `None` if there is no shadow. `bounds` is
    /// the scene's box. `distance(height, direction)` gives the distance, m, to the first surface,
    /// from a point `height` metres above the surface.
    pub fn shade(
        &self,
        light: &Light,
        (position, normal): (Vec3, Vec3),
        (bounds, camera): (Bounds, Vec3),
        distance: impl Fn(f32, Vec3) -> Option<f32>,
    ) -> Option<Shade> {
        let to_light = light.position - position;
        let (way, reach_m) = if light.kind.is_parallel() {
            (-light.direction, f32::INFINITY)
        } else {
            (to_light.normalize_or_zero(), to_light.length())
        };
        let half_m = if light.kind.is_parallel() {
            let whole_m = bounds.radius_m();
            let half_m = |square: u32| match (square.checked_sub(1), self.reach_m) {
                (None, _) => whole_m,
                (Some(below), Some(reach_m)) => reach_m / self.step.powi(below as i32),
                (_, None) => whole_m / self.step.powi(square as i32),
            };
            let reaches = |square: &u32| position.distance(camera) < half_m(*square);
            half_m((1..=self.squares).rev().find(reaches).unwrap_or(0)).min(whole_m)
        } else if let Some([_, outer_angle_rad]) = light.cone_rad() {
            if light.direction.dot(-way) < outer_angle_rad.cos() {
                return None;
            }
            reach_m * outer_angle_rad.min(1.3).tan()
        } else {
            reach_m
        };
        let is_shaded =
            |above_m| distance(above_m, way).is_some_and(|blocked_m| blocked_m < reach_m);
        if way.dot(normal) <= 0.0 || !is_shaded(0.0) {
            return None;
        }
        let texel_m = 2.0 * half_m / self.resolution as f32;
        Some(Shade { texel_m, is_lost: !is_shaded(LOST_TEXELS * texel_m) })
    }
}

/// A light's shadow on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shade {
    /// Edge of a texel of the light's shadow map at the surface, m.
    pub texel_m: f32,
    /// `true` if the map loses this shadow: the shadow does not reach up to the offset point at
    /// which the map is sampled.
    pub is_lost: bool,
}

/// Points that a camera sees, and the triangles that rays from them can hit.
pub(super) struct Seen<'a> {
    pub(super) patches: &'a [Patch],
    pub(super) rays: &'a Rays,
}

impl Seen<'_> {
    /// A note if voxels are coarse compared with the distances from the visible surfaces to the
    /// surfaces that light them.
    pub(super) fn coarse_voxels(&self, voxel_m: f32) -> Option<Note> {
        let (mut cast, mut met, mut near) = (0, 0, 0);
        for patch in self.patches {
            for way in directions::sphere(2 * DIRECTIONS).filter(|way| way.dot(patch.normal) > 0.0)
            {
                cast += 1;
                if let Some(hit) = self.rays.cast(patch.position, way) {
                    met += 1;
                    near +=
                        i32::from(hit.distance * self.rays.unit.scale_m < NEAR_VOXELS * voxel_m);
                }
            }
        }
        let share = near as f32 / (met as f32).max(1.0);
        if share <= MOST_NEAR || (met as f32) < LEAST_MET * cast as f32 {
            return None;
        }
        let text = format!(
            "voxels of {} m are coarse here: {:.0} % of the light between surfaces comes from nearer than two of them",
            three_digits(voxel_m),
            100.0 * share
        );
        let option = "--volume cascades has finer ones around the camera";
        Some(Note { about: "grid", text, option })
    }

    /// A note if shadow maps lose the shadows of occluders near the visible surfaces. `place` is
    /// the scene's box and the camera's position.
    pub(super) fn coarse_shadows<'l>(
        &self,
        lights: impl Iterator<Item = &'l Light>,
        maps: &ShadowMapFineness,
        place: (Bounds, Vec3),
    ) -> Option<Note> {
        let (mut shaded, mut lost, mut largest_m) = (0_usize, 0_usize, 0.0_f32);
        for light in lights.take(MOST_LIGHTS) {
            for Patch { position, normal, .. } in self.patches {
                let distance = |above_m: f32, way: Vec3| {
                    let above = *position + above_m / self.rays.unit.scale_m * *normal;
                    Some(self.rays.cast(above, way)?.distance * self.rays.unit.scale_m)
                };
                let at = (self.rays.unit.world_from_unit(*position), *normal);
                let Some(shade) = maps.shade(light, at, place, distance) else { continue };
                shaded += 1;
                if shade.is_lost {
                    lost += 1;
                    largest_m = largest_m.max(shade.texel_m);
                }
            }
        }
        let share = lost as f32 / (shaded as f32).max(1.0);
        if shaded < LEAST_SHADED || share <= MOST_LOST {
            return None;
        }
        let text = format!(
            "shadow maps are coarse here: texels are up to {} m wide, and {:.0} % of the shade is lost",
            three_digits(largest_m),
            100.0 * share
        );
        let option = "--shadow-resolution makes them finer, --shadows cone needs none";
        Some(Note { about: "shadows", text, option })
    }
}
