//! The view of a place: from a free spot at eye height that shows as much of the place as possible.
//!
//! Spots are points of the survey, moved to eye height above the floor that they see. The value of
//! a view is the share of the place's [patches](super::survey::Patch) that it shows, which is
//! greatest at the end of a hall with all of the hall ahead. It is reduced in narrow spots, where
//! things are close to the eye, and upstairs.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::directions;
use super::outside::Viewpoint;
use super::rays::Rays;
use super::survey::{Patch, Survey};

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

/// The most spots that are tried, and the azimuths for each.
const SPOTS: usize = 250;
const AZIMUTHS: usize = 32;
/// The number of views that are rated by their picture.
const FINALISTS: usize = 200;
/// The positions in the picture at which it is rated, across and up.
const PICTURE: [f32; 9] = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];
/// The distance, in unit space, at which a surface counts half.
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
    /// The visible patches: the vector from the eye, and the weight.
    sights: Vec<(Vec3, f32)>,
}

/// A view, and the share of the place that it shows.
pub(super) struct Inside {
    pub(super) view: Viewpoint,
    pub(super) share: f32,
}

/// The best view from one of the points; `None` if all are too close to something.
pub(super) fn view(rays: &Rays, survey: &Survey, aspect: f32) -> Option<Inside> {
    let widest_rad = 2.0 * ((WIDEST_FOV_RAD * 0.5).tan() / aspect).atan();
    let vertical_fov_rad = VERTICAL_FOV_RAD.min(widest_rad);
    let half_height = FILL * (vertical_fov_rad * 0.5).tan();
    let half = Vec2::new(half_height * aspect, half_height);

    let step = survey.interior.len().div_ceil(SPOTS).max(1);
    let points = survey.interior.iter().step_by(step).map(|probe| probe.position);
    let spots: Vec<Spot> = points.filter_map(|point| spot(rays, &survey.patches, point)).collect();
    let widest = spots.iter().map(|spot| spot.clearance).fold(0.0, f32::max);
    let heights = || spots.iter().map(|spot| spot.eye.y);
    let (lowest, highest) = (heights().fold(1.0, f32::min), heights().fold(-1.0, f32::max));
    let mut views = Vec::new();
    for spot in &spots {
        // Half the clearance of the freest spot is enough.
        let room = (spot.clearance / (0.5 * widest)).min(1.0);
        let level = (spot.eye.y - lowest) / (highest - lowest).max(CLOSE);
        let room = room * (1.0 - UPSTAIRS * level);
        for azimuth in 0..AZIMUTHS {
            let forward = direction(azimuth);
            let framed = spot.sights.iter().filter(|(way, _)| is_framed(*way, forward, half));
            let share: f32 = framed.map(|(_, weight)| weight).sum();
            // Rays may miss thin things that are closer.
            let near = 0.05 * spot.clearance;
            let view = Viewpoint { position: spot.eye, forward, vertical_fov_rad, near };
            views.push((share * room, Inside { view, share }));
        }
    }
    views.sort_by(|a, b| b.0.total_cmp(&a.0));
    views.truncate(FINALISTS);
    for (worth, inside) in &mut views {
        *worth *= openness(rays, &inside.view, half);
    }
    let mut best = views.into_iter().reduce(|a, b| if b.0 > a.0 { b } else { a })?.1;
    best.view.forward = tilted(rays, best.view.position, best.view.forward);
    Some(best)
}

/// The share of a picture that is free of things close to the eye: 1 if everything is far away.
fn openness(rays: &Rays, view: &Viewpoint, half: Vec2) -> f32 {
    let right = view.forward.cross(Vec3::Y);
    let mut sum = 0.0;
    for point in PICTURE {
        for y in PICTURE {
            let way = view.forward + right * (point * half.x) + Vec3::Y * (y * half.y);
            sum += match rays.cast_visible(view.position, way.normalize()) {
                Some(hit) => hit.distance / (hit.distance + CLOSE),
                None => SKY,
            };
        }
    }
    sum / (PICTURE.len() * PICTURE.len()) as f32
}

/// Whether a direction is within a picture of that half size at distance 1.
fn is_framed(way: Vec3, forward: Vec3, half: Vec2) -> bool {
    let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(forward);
    let depth = way.dot(forward);
    way.dot(right).abs() <= half.x * depth && way.dot(up).abs() <= half.y * depth
}

/// Tilts a level view a little towards the middle of what is ahead.
fn tilted(rays: &Rays, eye: Vec3, level: Vec3) -> Vec3 {
    let reach = |way: Vec3| rays.cast_visible(eye, way).map_or(0.0, |hit| hit.distance);
    let rise = (reach(Vec3::Y) - reach(Vec3::NEG_Y)) * 0.5;
    let pitch = (rise / reach(level).max(1e-3)).atan().clamp(-STEEPEST_RAD, STEEPEST_RAD);
    level * pitch.cos() + Vec3::Y * pitch.sin()
}

fn direction(azimuth: usize) -> Vec3 {
    let (sin, cos) = (azimuth as f32 / AZIMUTHS as f32 * TAU).sin_cos();
    Vec3::new(sin, 0.0, cos)
}

/// A spot above, below or at a point, unless something is in between.
fn spot(rays: &Rays, patches: &[Patch], point: Vec3) -> Option<Spot> {
    let eye = eye(rays, point)?;
    let around = directions::sphere(96).chain((0..AZIMUTHS).map(direction));
    let distances = around.filter_map(|way| Some(rays.cast(eye, way)?.distance));
    let clearance = distances.fold(f32::INFINITY, f32::min);
    let sights = patches.iter().filter_map(|patch| {
        let way = patch.position - eye;
        let is_seen = way.dot(patch.normal) < 0.0 && rays.is_free(eye, way, 1.0);
        is_seen.then_some((way, patch.weight))
    });
    clearance.is_finite().then(|| Spot { eye, clearance, sights: sights.collect() })
}

/// The eye on the vertical through a point, at a height above the floor that suits the free height
/// and width.
fn eye(rays: &Rays, point: Vec3) -> Option<Vec3> {
    // The floor around, not the table or the step below: the median of the downward views.
    let mut floors: Vec<f32> = directions::sphere(96)
        .filter(|way| way.y < -0.35)
        .filter_map(|way| rays.cast_visible(point, way))
        .filter(|hit| hit.normal.y > 0.5)
        .map(|hit| hit.position.y)
        .collect();
    floors.sort_by(f32::total_cmp);
    let below = rays.cast_visible(point, Vec3::NEG_Y)?.position.y;
    let floor = floors.get(floors.len() / 2).map_or(below, |&floor| floor.min(below));
    // Under the open sky, the visible extent counts as the height.
    let above = rays.cast_visible(point, Vec3::Y).map(|hit| hit.position.y);
    let top = above.unwrap_or_else(|| {
        let seen = directions::sphere(96).filter_map(|way| rays.cast_visible(point, way));
        seen.map(|hit| hit.position.y).fold(point.y, f32::max)
    });
    let height = top - floor;
    let across = |azimuth: usize| {
        let reach = |way: Vec3| rays.cast_visible(point, way).map(|hit| hit.distance);
        let way = direction(azimuth);
        Some(reach(way)? + reach(-way)?)
    };
    // The median: near a corner the least distance says little about the room.
    let mut widths: Vec<f32> = (0..AZIMUTHS / 2).filter_map(across).collect();
    widths.sort_by(f32::total_cmp);
    let width = widths.get(widths.len() / 2).copied().unwrap_or(f32::INFINITY);
    let over_floor = (EYE_OF_HEIGHT * height).min(EYE_OF_WIDTH * width);
    let eye = Vec3::new(point.x, floor + over_floor, point.z);
    let way = eye - point;
    let is_reached = way == Vec3::ZERO || rays.is_free(point, way, 1.0);
    // Neither just above a table nor just below a ceiling.
    let is_free = eye.y - below > 0.4 * over_floor && top - eye.y > 0.1 * over_floor;
    (is_reached && is_free).then_some(eye)
}
