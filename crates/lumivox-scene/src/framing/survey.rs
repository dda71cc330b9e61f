//! Decides by rays whether a scene is a place to stand in or a thing to look at.
//!
//! Points all over the bounds look around. A point that sees fronts of surfaces is in the air; one
//! that sees backs is inside something solid: that distinguishes a room from a ball. A place has
//! many points from which hardly any direction leads out, and below them a nearly level floor.
//!
//! Walls that show their backs outside were made to be seen from inside. If the outside is modelled
//! as well, hollow things (a helmet, a cup, a car, a gear box) must be distinguished from houses:
//! cups are open, helmets are mostly filled, things without an entrance are viewed from outside,
//! and a car's inside is round where a house has floors and walls.

use std::ops::Range;

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::directions;
use super::rays::{Hit, Patch, Rays};

const PROBES: usize = 2000;
/// Directions in which each point looks.
const LOOKS: usize = 64;
/// Surface points that represent the inside.
const PATCHES: usize = 600;
/// Rays that look at the scene from outside.
const OUTSIDE: usize = 4096;
/// The most points from which floors and walls are searched.
const STANDS: usize = 200;

/// A point is in the air if at least this share of the surfaces that it sees are fronts.
const IN_AIR: f32 = 0.75;
/// `IN_AIR` for files that wind half of their walls the wrong way round, if the point also has a
/// distance of `FREE` from all surfaces.
const MUDDLED: f32 = 0.35;
/// In unit space; a point in a bush of double-sided leaves is not free.
const FREE: f32 = 0.03;
/// The least share of directions in which a roughly surrounded point sees a surface.
const SURROUNDED: f32 = 0.7;
/// That share in a room without one wall.
const WALLED: f32 = 0.85;
/// That share under a roof with a window.
const ROOFED: f32 = 0.95;
/// The least extent of a place along an axis, in unit space: 0.6 in Sponza, 0.3 in a helmet on a
/// stand, about 0.35 in a car.
const LONG: f32 = 0.45;
/// The share of roofed points without any gap if the outside is modelled: 0.4 in Sponza, hardly any
/// in a cup, all in a thing without an entrance.
const DEEP: Range<f32> = 0.1..0.9;
/// The share of the view that furniture takes in a room; in a car it is more.
const FURNITURE: Range<f32> = 0.02..0.2;
/// A furnished shell, unlike a lorry, shows less than this share of its surface outside.
const DETAIL: f32 = 0.4;
/// The steepest floor: the cosine of 37 degrees.
const LEVEL: f32 = 0.8;
/// The share of the points of a place that must have a floor below them, if its walls were made to
/// be seen from inside, and if not: 0.49 in a ball.
const FLOORED: [f32; 2] = [0.65, 0.75];
/// Floors, ceilings and walls are tilted by less than 20 degrees: sine and cosine.
const UPRIGHT: [f32; 2] = [0.34, 0.94];
/// The least share of floors, ceilings and walls among the visible surfaces if the outside is
/// modelled: 0.4 in a ball.
const BUILT: f32 = 0.65;

/// The result of the survey.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Survey {
    /// The points of the place at which one can stand; empty for a thing.
    pub(super) interior: Vec<Vec3>,
    /// The patches visible from `interior`; their weights sum to one. The weight of an instance
    /// with n patches is proportional to the root of n, so that furniture counts beside walls.
    pub(super) patches: Vec<Patch>,
    /// Whether walls show their backs outside: they were made to be seen from inside.
    pub(super) is_made_for_inside: bool,
    /// The mean share of the directions that lead out of the place.
    pub(super) sky: f32,
    /// The points in the air, or in shells, for a view inside a thing.
    hollow: Vec<Vec3>,
}

impl Survey {
    pub(super) fn of(rays: &Rays) -> Self {
        let half = rays.unit.half;
        let (mut air, mut shell, mut roofed) = (Vec::new(), Vec::new(), Vec::new());
        let (mut air_hits, mut shell_hits) = (0.0, 0.0);
        let [mut body, mut walled, mut sealed, mut furnished] = [0.0; 4];
        for place in directions::cube(PROBES) {
            let position = (place * 2.0 - 1.0) * half;
            let seen: Vec<Hit> = around(rays, position).collect();
            let hits = seen.len() as f32 / LOOKS as f32;
            let fronts = share(&seen, |hit| hit.is_front);
            let is_free = seen.iter().all(|hit| hit.distance >= FREE);
            let is_in_air = seen.is_empty() || fronts >= IN_AIR || (fronts >= MUDDLED && is_free);
            // A point outside a convex body sees it in less than half of all directions.
            body += f32::from(u8::from(!is_in_air || hits > 0.5));
            if is_in_air && hits >= SURROUNDED {
                air.push(position);
                air_hits += hits;
                walled += f32::from(u8::from(hits >= WALLED));
                sealed += f32::from(u8::from(hits >= 1.0));
                roofed.extend((hits >= ROOFED).then_some(position));
            }
            // The inside of a shell without thickness whose front faces outwards, as sketching
            // programs write.
            let is_shell = share(&seen, |hit| hit.is_double_sided) >= 0.9 && fronts < MUDDLED;
            if !is_in_air && hits >= ROOFED && is_shell {
                shell.push(position);
                shell_hits += hits;
                furnished += f32::from(u8::from(FURNITURE.contains(&fronts)));
            }
        }
        let outside: Vec<Hit> = directions::sphere(OUTSIDE)
            .zip(directions::cube(OUTSIDE))
            .filter_map(|(way, place)| rays.cast(2.0 * way, (place * 2.0 - 1.0) * half - 2.0 * way))
            .collect();
        let is_made_for_inside = share(&outside, |hit| !hit.is_front) > 0.5;
        let is_place = if is_made_for_inside {
            walled >= 0.2 * body
        } else {
            let sealed = sealed / roofed.len().max(1) as f32;
            roofed.len() as f32 >= 0.1 * body && DEEP.contains(&sealed) && span(&roofed) >= LONG
        };
        let is_furnished = furnished >= 0.4 * body.max(1.0) && detail_outside(rays) < DETAIL;
        let (interior, hits) = if is_furnished { (&shell, shell_hits) } else { (&air, air_hits) };
        let sky = 1.0 - hits / interior.len().max(1) as f32;
        let can_stand = (is_furnished || is_place) && can_stand(rays, interior, is_made_for_inside);
        let interior = if can_stand { interior.clone() } else { Vec::new() };
        let patches = patches(rays, &interior);
        let hollow = if air.is_empty() { shell } else { air };
        Self { interior, patches, is_made_for_inside, sky, hollow }
    }

    pub(super) fn is_place(&self) -> bool {
        !self.patches.is_empty()
    }

    /// The points from which an inside is viewed, if there is any, and the patches that they see.
    pub(super) fn within(&self, rays: &Rays) -> (Vec<Vec3>, Vec<Patch>) {
        if self.is_place() {
            return (self.interior.clone(), self.patches.clone());
        }
        (self.hollow.clone(), patches(rays, &self.hollow))
    }
}

/// All surfaces around a point.
fn around(rays: &Rays, point: Vec3) -> impl Iterator<Item = Hit> {
    directions::sphere(LOOKS).filter_map(move |way| rays.cast(point, way))
}

fn share<T>(all: &[T], counts: impl Fn(&T) -> bool) -> f32 {
    all.iter().filter(|one| counts(one)).count() as f32 / all.len().max(1) as f32
}

/// At most `most` of the points, in even steps.
pub(super) fn few(points: &[Vec3], most: usize) -> impl Iterator<Item = Vec3> + Clone {
    points.iter().step_by(points.len().div_ceil(most).max(1)).copied()
}

/// Whether one can stand in a place: on a floor and, if its outside is modelled, between walls.
fn can_stand(rays: &Rays, interior: &[Vec3], is_made_for_inside: bool) -> bool {
    let stands: Vec<Vec3> = few(interior, STANDS).collect();
    let floored = share(&stands, |&point| {
        rays.cast(point, Vec3::NEG_Y).is_some_and(|floor| floor.normal.y >= LEVEL)
    });
    let seen: Vec<Hit> = stands.iter().flat_map(|&point| around(rays, point)).collect();
    let [sine, cosine] = UPRIGHT;
    let built = share(&seen, |hit| !(sine..cosine).contains(&hit.normal.y.abs()));
    if is_made_for_inside { floored >= FLOORED[0] } else { floored >= FLOORED[1] && built >= BUILT }
}

/// The surfaces visible from all over a place.
fn patches(rays: &Rays, interior: &[Vec3]) -> Vec<Patch> {
    let points = few(interior, PATCHES);
    let looks = PATCHES.div_ceil(points.clone().count().max(1));
    // All points share one set of directions; each point continues in it where the previous one
    // stopped.
    let hits: Vec<Hit> = points
        .flat_map(|position| std::iter::repeat_n(position, looks))
        .zip(directions::sphere(PATCHES).cycle())
        .filter_map(|(position, way)| rays.cast_visible(position, way))
        .collect();
    let mut of_instance: FxHashMap<u32, f32> = FxHashMap::default();
    for hit in &hits {
        *of_instance.entry(hit.instance).or_default() += 1.0;
    }
    let total: f32 = of_instance.values().map(|count| count.sqrt()).sum();
    let weight = |hit: &Hit| of_instance[&hit.instance].sqrt().recip() / total;
    hits.iter().map(|hit| Patch { weight: weight(hit), ..hit.patch() }).collect()
}

/// The share of the surface that is visible from outside, from either side.
fn detail_outside(rays: &Rays) -> f32 {
    let few: Vec<_> = rays.triangles.iter().step_by(rays.triangles.len().div_ceil(300)).collect();
    share(&few, |triangle| {
        let [a, b, c] = rays.corners(triangle);
        directions::sphere(LOOKS).any(|way| {
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let above = normal * normal.dot(way).signum() * super::rays::LIFT;
            let middle = (a + b + c) / 3.0;
            normal.dot(way).abs() > 0.1 && rays.is_free(middle + above, way, f32::INFINITY)
        })
    })
}

/// The longest stretch along an axis that holds nine tenths of the points.
fn span(points: &[Vec3]) -> f32 {
    let along = |axis: usize| {
        let mut values: Vec<f32> = points.iter().map(|point| point[axis]).collect();
        values.sort_by(f32::total_cmp);
        let (least, most) = (values.len() / 20, (values.len() * 19) / 20);
        values.get(most).zip(values.get(least)).map_or(0.0, |(most, least)| most - least)
    };
    (0..3).map(along).fold(0.0, f32::max)
}
