//! The view of a thing: all of it from outside, as large as it fits.
//!
//! The best of some eighty directions is the one that shows most of the surface: points all over it
//! are tested, and each visible one counts by the root of the cosine at which it is seen. So a
//! board is viewed along its thin axis, a cube from over a corner, a thing in front of a wall from
//! the other side, and an open box through its opening.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{Mat3, Vec3};

use super::rays::Rays;
use super::subject::Subject;
use super::survey::Patch;
use crate::Camera;

/// The angle between the bottom and the top of the picture.
const VERTICAL_FOV_RAD: f32 = FRAC_PI_4;
/// Share of the picture's half width and height that the scene may fill.
const FILL: f32 = 0.92;
/// The usual side: the front (+z, as in glTF), a little from the right (+x) and from above.
const AZIMUTH_RAD: f32 = 0.645;
const ELEVATION_RAD: f32 = 0.412;
/// Other elevations, and their penalties as a share of the greatest visibility.
const ELEVATIONS_RAD: [(f32, f32); 5] =
    [(ELEVATION_RAD, 0.0), (0.17, 0.05), (0.87, 0.1), (0.0, 0.05), (-ELEVATION_RAD, 0.2)];
/// Elevations and penalties for a view into an opening, which is level.
const LEVEL_RAD: [(f32, f32); 5] =
    [(0.0, 0.0), (0.17, 0.12), (ELEVATION_RAD, 0.15), (0.87, 0.2), (-ELEVATION_RAD, 0.35)];
/// Straight from above and from below.
const VERTICALS_RAD: [(f32, f32); 2] = [(FRAC_PI_2, 0.35), (-FRAC_PI_2, 0.5)];
/// Azimuths around the usual one; the four along the axes are added.
const AZIMUTHS: usize = 12;
/// The penalty of the opposite side.
const BEHIND: f32 = 0.1;
/// A thing thinner along an axis than this share of its length is a board; views along that axis
/// have this penalty.
const THIN: f32 = 0.05;
const ALONG_THIN: f32 = 0.1;

/// An eye in unit space.
pub(super) struct Viewpoint {
    pub(super) position: Vec3,
    pub(super) forward: Vec3,
    pub(super) vertical_fov_rad: f32,
    pub(super) near: f32,
}

/// A direction towards the eye, and its penalty.
struct Candidate {
    towards_eye: Vec3,
    less: f32,
}

/// The view that shows most of a subject.
pub(super) fn view(rays: &Rays, subject: &Subject, aspect: f32) -> Viewpoint {
    let seen = |view: &Viewpoint| visible(rays, &subject.patches, view.position, f32::sqrt);
    best(subject, &ELEVATIONS_RAD, aspect, seen)
}

/// The view from outside that shows most of a place, and the visible share of it.
pub(super) fn into(
    rays: &Rays,
    subject: &Subject,
    place: &[Patch],
    aspect: f32,
) -> (Viewpoint, f32) {
    let seen = |view: &Viewpoint| share(rays, place, view.position);
    let view = best(subject, &LEVEL_RAD, aspect, seen);
    let share = seen(&view);
    (view, share)
}

fn best(
    subject: &Subject,
    elevations_rad: &[(f32, f32); 5],
    aspect: f32,
    seen: impl Fn(&Viewpoint) -> f32,
) -> Viewpoint {
    // Fitted to the box first, which is fast; only the final view is fitted to all corners.
    let corners = subject.bounds.corners();
    let near_corners = if subject.bounds.is_empty() { &corners[..0] } else { &corners[..] };
    let judged: Vec<(Candidate, f32)> = candidates(elevations_rad, subject.bounds.size())
        .map(|candidate| {
            let share = seen(&fit(near_corners, candidate.towards_eye, aspect));
            (candidate, share)
        })
        .collect();
    let most = judged.iter().map(|(_, share)| *share).fold(f32::MIN_POSITIVE, f32::max);
    let mut best = (usual(), f32::NEG_INFINITY);
    for (candidate, share) in &judged {
        let worth = share / most - candidate.less;
        // Strictly better: the first of equals wins.
        if worth > best.1 {
            best = (candidate.towards_eye, worth);
        }
    }
    fit(&subject.corners, best.0, aspect)
}

fn candidates(elevations_rad: &[(f32, f32); 5], size: Vec3) -> impl Iterator<Item = Candidate> {
    let turns = (0..AZIMUTHS).map(|step| step as f32 / AZIMUTHS as f32 * 2.0);
    let axes = [0.0, 0.5, 1.0, 1.5].map(|azimuth| azimuth - AZIMUTH_RAD / PI);
    let level = turns.chain(axes).flat_map(move |turn| {
        // From -1 to 1, in half turns from the usual side.
        let turn = (turn + 1.0).rem_euclid(2.0) - 1.0;
        elevations_rad.map(|(elevation, less)| {
            (polar(AZIMUTH_RAD + turn * PI, elevation), less, BEHIND * turn.abs())
        })
    });
    let vertical = VERTICALS_RAD.map(|(elevation, less)| (Vec3::Y * elevation.signum(), less, 0.0));
    let thin = Vec3::AXES.into_iter().find(|axis| size.dot(*axis) <= THIN * size.max_element());
    level.chain(vertical).map(move |(towards_eye, less, behind)| {
        let is_along_thin = thin.is_some_and(|axis| axis.dot(towards_eye).abs() > 0.9999);
        let less = if is_along_thin { ALONG_THIN * less } else { less };
        Candidate { towards_eye, less: less + behind }
    })
}

fn usual() -> Vec3 {
    polar(AZIMUTH_RAD, ELEVATION_RAD)
}

fn polar(azimuth_rad: f32, elevation_rad: f32) -> Vec3 {
    let (sin, cos) = azimuth_rad.sin_cos();
    let (y, level) = elevation_rad.sin_cos();
    Vec3::new(sin * level, y, cos * level)
}

/// The share of points that an eye sees.
pub(super) fn share(rays: &Rays, patches: &[Patch], eye: Vec3) -> f32 {
    visible(rays, patches, eye, |_| 1.0)
}

/// The visibility of points from an eye: their weights, times a function of the cosine.
fn visible(rays: &Rays, patches: &[Patch], eye: Vec3, worth: impl Fn(f32) -> f32) -> f32 {
    let seen = patches.iter().map(|patch| {
        let way = eye - patch.position;
        let cosine = way.normalize().dot(patch.normal);
        if cosine > 0.0 && rays.is_free(patch.position, way, 1.0) {
            patch.weight * worth(cosine)
        } else {
            0.0
        }
    });
    seen.sum()
}

/// The nearest eye in a direction that sees every corner.
///
/// In the camera's axes (x right, y up, z backwards) a point p lies left of the frustum's right
/// plane when `p.x + t * p.z <= eye.x + t * eye.z`, with t the tangent of half the field of view,
/// and so on for the other planes. The largest left sides of all points thus bound the eye, and
/// solving the two equations of opposite planes puts the scene in the middle between them.
fn fit(corners: &[Vec3], towards_eye: Vec3, aspect: f32) -> Viewpoint {
    let camera = Camera::look_at(towards_eye, Vec3::ZERO, VERTICAL_FOV_RAD);
    let world_from_camera = Mat3::from_mat4(camera.world_from_camera());
    let camera_from_world = world_from_camera.transpose();
    let tan_y = (VERTICAL_FOV_RAD * 0.5).tan() * FILL;
    let tan_x = tan_y * aspect;
    let [mut right, mut left, mut top, mut bottom, mut nearest] = [f32::NEG_INFINITY; 5];
    let mut farthest = f32::INFINITY;
    for &corner in corners {
        let p = camera_from_world * corner;
        right = right.max(p.x + tan_x * p.z);
        left = left.max(-p.x + tan_x * p.z);
        top = top.max(p.y + tan_y * p.z);
        bottom = bottom.max(-p.y + tan_y * p.z);
        nearest = nearest.max(p.z);
        farthest = farthest.min(p.z);
    }
    if !nearest.is_finite() {
        [right, left, top, bottom, nearest, farthest] = [tan_x, tan_x, tan_y, tan_y, 0.0, 0.0];
    }
    let away_x = (right + left) * 0.5 / tan_x;
    let away_y = (top + bottom) * 0.5 / tan_y;
    // A line seen along its axis has no width; keep a tenth of its size away nevertheless.
    let size = (right + left).max(top + bottom).max(nearest - farthest).max(f32::MIN_POSITIVE);
    let away = away_x.max(away_y).max(nearest + 0.1 * size.min(1.0));
    let eye = Vec3::new((right - left) * 0.5, (top - bottom) * 0.5, away);
    Viewpoint {
        position: world_from_camera * eye,
        forward: -towards_eye,
        vertical_fov_rad: VERTICAL_FOV_RAD,
        near: 0.1 * (away - nearest),
    }
}
