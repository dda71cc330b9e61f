//! The view of a place, from a free spot at eye height that shows as much of it as possible.
//!
//! Spots are points of the survey, moved to eye height above the floor that they see. The value of
//! a view is the share of the place's [patches](super::survey::Survey::patches) that it shows,
//! which is greatest at the end of a hall with all of the hall ahead. It is reduced in narrow
//! spots, where things are close to the eye, and upstairs.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::directions;
use super::rays::{Hit, Patch, Rays};
use super::survey::few;
use crate::Camera;

/// The angle between the bottom and the top of the picture: wide, as rooms are photographed.
const VERTICAL_FOV_RAD: f32 = 1.05;
/// The widest horizontal field of view that does not look distorted.
const WIDEST_FOV_RAD: f32 = 1.75;
/// The height of the eye above the floor, as shares of the free height and width: that of a
/// standing person in a living room, and a little higher in a hall. Metres are not used, since
/// files seldom state their unit.
const EYE_OF_HEIGHT: f32 = 0.53;
const EYE_OF_WIDTH: f32 = 0.4;
/// The steepest tilt up or down.
const STEEPEST_RAD: f32 = 0.12;

/// The most spots that are tried.
const SPOTS: usize = 250;
/// Azimuths that are tried at each spot.
const AZIMUTHS: usize = 32;
/// The most views whose picture is rated.
const FINALISTS: usize = 200;
/// Directions in which a spot looks around.
const LOOKS: usize = 96;
/// The positions in a picture at which it is rated, across and up.
const PICTURE: usize = 9;
/// A surface at this distance, in unit space, counts half.
const CLOSE: f32 = 0.15;
/// The value of a picture position that shows the sky.
const SKY: f32 = 0.5;
/// The penalty of the highest floor: places are entered at the ground.
const UPSTAIRS: f32 = 0.3;
/// Patches are counted within this share of the picture's half width and height.
const FILL: f32 = 0.9;

/// A possible spot for the eye.
struct Spot {
    eye: Vec3,
    /// Distance to the nearest surface.
    clearance: f32,
    /// Indices of the visible patches.
    seen: Vec<usize>,
}

/// The spots at eye height above, below or at some points.
fn spots(rays: &Rays, points: &[Vec3], patches: &[Patch]) -> Vec<Spot> {
    let spot = |point: Vec3| {
        let eye = eye(rays, point)?;
        let around = directions::sphere(LOOKS).chain((0..AZIMUTHS).map(azimuth));
        let distances = around.filter_map(|way| Some(rays.cast(eye, way)?.distance));
        let clearance = distances.fold(f32::INFINITY, f32::min);
        let is_seen = |&patch: &usize| {
            let way = patches[patch].position - eye;
            way.dot(patches[patch].normal) < 0.0 && rays.is_free(eye, way, 1.0)
        };
        let seen = (0..patches.len()).filter(is_seen).collect();
        clearance.is_finite().then_some(Spot { eye, clearance, seen })
    };
    few(points, SPOTS).filter_map(spot).collect()
}

/// The best view from one of the points, and the share of the patches that it shows; `None` if all
/// points are too close to a surface.
pub(super) fn view(
    rays: &Rays,
    points: &[Vec3],
    patches: &[Patch],
    aspect: f32,
) -> Option<(Camera, f32)> {
    let spots = spots(rays, points, patches);
    let widest_rad = 2.0 * ((WIDEST_FOV_RAD * 0.5).tan() / aspect).atan();
    let vertical_fov_rad = VERTICAL_FOV_RAD.min(widest_rad);
    let half_height = FILL * (vertical_fov_rad * 0.5).tan();
    let half = Vec2::new(half_height * aspect, half_height);

    let widest = spots.iter().map(|spot| spot.clearance).fold(0.0, f32::max);
    let heights = || spots.iter().map(|spot| spot.eye.y);
    let (lowest, highest) = (heights().fold(1.0, f32::min), heights().fold(-1.0, f32::max));
    let mut views = Vec::new();
    for spot in &spots {
        // Half the clearance of the freest spot is enough.
        let room = (spot.clearance / (0.5 * widest)).min(1.0);
        let level = (spot.eye.y - lowest) / (highest - lowest).max(CLOSE);
        let room = room * (1.0 - UPSTAIRS * level);
        for forward in (0..AZIMUTHS).map(azimuth) {
            let right = forward.cross(Vec3::Y);
            let weight = |&patch: &usize| {
                let way = patches[patch].position - spot.eye;
                let reach = half * way.dot(forward);
                let is_framed = way.dot(right).abs() <= reach.x && way.y.abs() <= reach.y;
                if is_framed { patches[patch].weight } else { 0.0 }
            };
            let share: f32 = spot.seen.iter().map(weight).sum();
            views.push((share * room, share, spot, forward));
        }
    }
    views.sort_by(|a, b| b.0.total_cmp(&a.0));
    views.truncate(FINALISTS);
    for (worth, _, spot, forward) in &mut views {
        *worth *= openness(rays, spot.eye, *forward, half);
    }
    let (_, share, spot, level) = views.into_iter().reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    // Tilts the view a little towards the middle of the visible surfaces.
    let reach = |way: Vec3| rays.cast_visible(spot.eye, way).map_or(0.0, |hit| hit.distance);
    let rise = (reach(Vec3::Y) - reach(Vec3::NEG_Y)) * 0.5;
    let pitch = (rise / reach(level).max(1e-3)).atan().clamp(-STEEPEST_RAD, STEEPEST_RAD);
    let forward = level * pitch.cos() + Vec3::Y * pitch.sin();
    // The rays of `clearance` may miss thin things that are closer.
    let near_m = 0.05 * spot.clearance;
    let view = Camera::look_at(spot.eye, spot.eye + forward, vertical_fov_rad);
    Some((Camera { forward, near_m, ..view }, share))
}

/// The share of a picture that is free of things close to the eye: 1 if everything is far away.
fn openness(rays: &Rays, eye: Vec3, forward: Vec3, half: Vec2) -> f32 {
    let places = (0..PICTURE * PICTURE).map(|number| {
        let at = |step: usize| 2.0 * step as f32 / (PICTURE - 1) as f32 - 1.0;
        let place = half * Vec2::new(at(number / PICTURE), at(number % PICTURE));
        let way = forward + forward.cross(Vec3::Y) * place.x + Vec3::Y * place.y;
        let hit = rays.cast_visible(eye, way.normalize());
        hit.map_or(SKY, |hit| hit.distance / (hit.distance + CLOSE))
    });
    places.sum::<f32>() / (PICTURE * PICTURE) as f32
}

fn azimuth(step: usize) -> Vec3 {
    let (sin, cos) = (step as f32 / AZIMUTHS as f32 * TAU).sin_cos();
    Vec3::new(sin, 0.0, cos)
}

fn median(mut values: Vec<f32>) -> Option<f32> {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}

/// The eye on the vertical through a point, at a height above the floor that suits the free height
/// and width.
fn eye(rays: &Rays, point: Vec3) -> Option<Vec3> {
    let seen = |way: Vec3| rays.cast_visible(point, way);
    let around: Vec<Hit> = directions::sphere(LOOKS).filter_map(seen).collect();
    // The floor around, not the table or the step below: the median of the downward views.
    let is_floor =
        |hit: &&Hit| hit.position.y < point.y - 0.35 * hit.distance && hit.normal.y > 0.5;
    let floors = around.iter().filter(is_floor).map(|hit| hit.position.y).collect();
    let below = seen(Vec3::NEG_Y)?.position.y;
    let floor = median(floors).map_or(below, |floor| floor.min(below));
    // Under the open sky, the visible extent counts as the height.
    let highest = || around.iter().map(|hit| hit.position.y).fold(point.y, f32::max);
    let top = seen(Vec3::Y).map_or_else(highest, |hit| hit.position.y);
    // Near a corner, the least width is not that of the room.
    let across = |way: Vec3| Some(seen(way)?.distance + seen(-way)?.distance);
    let width = median((0..AZIMUTHS / 2).map(azimuth).filter_map(across).collect());
    let over_floor = (EYE_OF_HEIGHT * (top - floor)).min(EYE_OF_WIDTH * width.unwrap_or(1.0));
    let eye = Vec3::new(point.x, floor + over_floor, point.z);
    let is_reached = eye == point || rays.is_free(point, eye - point, 1.0);
    // The eye must be neither just above a table nor just below a ceiling.
    let is_free = eye.y - below > 0.4 * over_floor && top - eye.y > 0.1 * over_floor;
    (is_reached && is_free).then_some(eye)
}
