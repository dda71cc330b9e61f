//! The view of a thing: from outside, all of it, as large as it fits.

use std::f32::consts::{FRAC_PI_4, PI};

use glam::{Mat3, Vec3};

use super::directions;
use super::rays::Rays;
use super::soup::Soup;
use crate::Camera;

/// The angle between the bottom and the top of the picture.
const VERTICAL_FOV_RAD: f32 = FRAC_PI_4;
/// Share of the picture's half width and height that the scene may fill.
const FILL: f32 = 0.92;
/// The side that is looked at where nothing speaks against it: the front (+z, as glTF has it), a
/// little from the right (+x) and from above.
const AZIMUTH_RAD: f32 = 0.645;
const ELEVATION_RAD: f32 = 0.412;
/// Other heights, and what they are thought less of.
const ELEVATIONS_RAD: [(f32, f32); 4] =
    [(ELEVATION_RAD, 0.0), (0.17, 0.05), (0.87, 0.1), (-ELEVATION_RAD, 0.2)];
const AZIMUTHS: usize = 12;
/// What the opposite side is thought less of.
const BEHIND: f32 = 0.1;
/// Rays that judge a direction.
const LOOKS: usize = 196;

/// An eye in unit space.
pub(super) struct View {
    pub(super) position: Vec3,
    pub(super) forward: Vec3,
    pub(super) vertical_fov_rad: f32,
    pub(super) near: f32,
}

pub(super) fn view(rays: &Rays, soup: &Soup, half: Vec3, aspect: f32) -> View {
    fit(soup, towards_eye(rays, half), aspect)
}

/// A direction from which fronts are seen, not the backs of surfaces that are shown from one side
/// only: an open box from where it is open, a picture from its front.
fn towards_eye(rays: &Rays, half: Vec3) -> Vec3 {
    let radius = half.length();
    let mut judged = Vec::new();
    for (elevation, less) in ELEVATIONS_RAD {
        for step in 0..AZIMUTHS {
            let turn = (step as f32 / AZIMUTHS as f32 * 2.0 + 1.0).rem_euclid(2.0) - 1.0;
            let direction = polar(AZIMUTH_RAD + turn * PI, elevation);
            let (u, v) = direction.any_orthonormal_pair();
            let (mut fronts, mut backs) = (0.0, 0.0);
            for place in directions::disc(LOOKS) {
                let origin = (u * place.x + v * place.y + 2.0 * direction) * radius;
                match rays.cast(origin, -direction) {
                    Some(hit) if hit.is_visible() => fronts += 1.0,
                    Some(_) => backs += 1.0,
                    None => {}
                }
            }
            judged.push((direction, fronts, backs, less + BEHIND * turn.abs()));
        }
    }
    // Facing counts, size only where it nearly vanishes: seen from the edge, a sheet of paper is a
    // line.
    let most: f32 = judged.iter().map(|(_, fronts, backs, _)| fronts + backs).fold(1.0, f32::max);
    let worth = |&(_, fronts, backs, less): &(Vec3, f32, f32, f32)| {
        let seen: f32 = fronts + backs;
        (fronts - backs) / seen.max(1.0) * (4.0 * seen / most).min(1.0) - less
    };
    let mut best = (Vec3::ZERO, f32::NEG_INFINITY);
    for candidate in &judged {
        // Strictly better: of equals, the first.
        if worth(candidate) > best.1 {
            best = (candidate.0, worth(candidate));
        }
    }
    best.0
}

fn polar(azimuth_rad: f32, elevation_rad: f32) -> Vec3 {
    let (sin, cos) = azimuth_rad.sin_cos();
    let (y, level) = elevation_rad.sin_cos();
    Vec3::new(sin * level, y, cos * level)
}

/// The nearest eye in a direction that sees every triangle.
///
/// In the camera's axes (x right, y up, z backwards) a point p lies left of the frustum's right plane
/// when `p.x + t * p.z <= eye.x + t * eye.z`, with t the tangent of half the field of view, and so on
/// for the other planes. The largest left sides of all points thus bound the eye, and solving the two
/// equations of opposite planes puts the scene in the middle between them.
fn fit(soup: &Soup, towards_eye: Vec3, aspect: f32) -> View {
    let camera = Camera::look_at(towards_eye, Vec3::ZERO, VERTICAL_FOV_RAD);
    let world_from_camera = Mat3::from_mat4(camera.world_from_camera());
    let camera_from_world = world_from_camera.transpose();
    let tan_y = (VERTICAL_FOV_RAD * 0.5).tan() * FILL;
    let tan_x = tan_y * aspect;
    let [mut right, mut left, mut top, mut bottom, mut nearest] = [f32::NEG_INFINITY; 5];
    for corner in soup.corners() {
        let p = camera_from_world * corner;
        right = right.max(p.x + tan_x * p.z);
        left = left.max(-p.x + tan_x * p.z);
        top = top.max(p.y + tan_y * p.z);
        bottom = bottom.max(-p.y + tan_y * p.z);
        nearest = nearest.max(p.z);
    }
    if !nearest.is_finite() {
        [right, left, top, bottom, nearest] = [tan_x, tan_x, tan_y, tan_y, 0.0];
    }
    let away_x = (right + left) * 0.5 / tan_x;
    let away_y = (top + bottom) * 0.5 / tan_y;
    // A line that is looked along has no width; keep a tenth of the scene's size away all the same.
    let away = away_x.max(away_y).max(nearest + 0.1);
    let eye = Vec3::new((right - left) * 0.5, (top - bottom) * 0.5, away);
    View {
        position: world_from_camera * eye,
        forward: -towards_eye,
        vertical_fov_rad: VERTICAL_FOV_RAD,
        near: 0.1 * (away - nearest),
    }
}
