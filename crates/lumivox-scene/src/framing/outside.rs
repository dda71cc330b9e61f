//! The view from outside: all of a scene, as large as it fits.
//!
//! The best of some eighty directions is the one that shows most of the surface: points all over it
//! are tested, and each visible one counts by the root of the cosine at which it is seen. So a
//! board is viewed along its thin axis, a thing in front of a wall from the other side, and an open
//! box through its opening.
//!
//! A chair on a ground of a hundred metres, or under a dome of sky, would be a speck in a picture
//! of everything. So connected pieces are separated; if a ground, or a dome seen from inside, makes
//! the scene at least twice as large as the rest, the picture is fitted to the rest.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{Mat3, Vec3};
use rustc_hash::FxHashMap;

use super::rays::{Patch, Rays, Triangle};
use crate::{Bounds, Camera};

/// The angle between the bottom and the top of the picture.
const VERTICAL_FOV_RAD: f32 = FRAC_PI_4;
/// Share of the picture's half width and height that the scene may fill.
const FILL: f32 = 0.92;
/// The usual side: the front (+z, as in glTF), a little from the right (+x) and from above.
const AZIMUTH_RAD: f32 = 0.645;
const ELEVATION_RAD: f32 = 0.412;
/// Elevations that are tried.
const ELEVATIONS_RAD: [f32; 7] =
    [ELEVATION_RAD, 0.17, 0.87, 0.0, -ELEVATION_RAD, FRAC_PI_2, -FRAC_PI_2];
/// The penalties of the elevations for a thing, as a share of the greatest visibility.
const THING: [f32; 7] = [0.0, 0.05, 0.1, 0.05, 0.2, 0.35, 0.5];
/// The penalties for a view into an opening: level views are best.
const OPENING: [f32; 7] = [0.15, 0.12, 0.2, 0.0, 0.35, 0.35, 0.5];
/// Azimuths that are tried, starting at the usual one; the four along the axes are added.
const AZIMUTHS: usize = 12;
/// The penalty of the azimuth opposite the usual one.
const BEHIND: f32 = 0.1;
/// A thing thinner along an axis than this share of its length is a board.
const THIN: f32 = 0.05;
/// The factor of the penalty of views along a board's thin axis.
const ALONG_THIN: f32 = 0.1;
/// The number of points of the surface that are tested for each view.
const POINTS: usize = 512;

/// Without ground and dome, the rest must not exceed this share of the scene.
const SMALL: f32 = 0.5;
/// The least share of the scene that a ground or a dome spans.
const SPANS: f32 = 0.6;
/// The greatest thickness of a ground, as a share of its width.
const FLAT: f32 = 0.05;
/// The least height of the rest, as a share of its width: flat parts of a circuit board need the
/// board.
const STANDS: f32 = 0.2;
/// The share of a dome's area that faces inwards, and no other side.
const INWARD: f32 = 0.9;

/// The subject of a view: the corners of its triangles, and points of its surface.
pub(super) struct Subject {
    corners: Vec<Vec3>,
    pub(super) patches: Vec<Patch>,
    /// Whether a ground or a dome was left out.
    pub(super) is_part: bool,
}

impl Subject {
    /// All of a place; a thing without a ground or dome that would make it a speck.
    pub(super) fn of(rays: &Rays, is_place: bool) -> Self {
        let mut meant: Vec<&Triangle> = rays.triangles.iter().collect();
        if !is_place {
            leave_out_surroundings(rays, &mut meant);
        }
        let mut patches = Vec::new();
        for (triangle, _, mut patch) in rays.spread(&meant, POINTS) {
            if triangle.is_double_sided() {
                patch.weight *= 0.5;
                patches.push(patch.other_side());
            }
            patches.push(patch);
        }
        Self {
            corners: meant.iter().flat_map(|triangle| rays.corners(triangle)).collect(),
            patches,
            is_part: meant.len() < rays.triangles.len(),
        }
    }

    /// The view that shows most of the subject.
    pub(super) fn view(&self, rays: &Rays, aspect: f32) -> Camera {
        self.best(&THING, aspect, |eye| visible(rays, &self.patches, eye, f32::sqrt))
    }

    /// The view from outside that shows most of a place.
    pub(super) fn view_into(&self, rays: &Rays, place: &[Patch], aspect: f32) -> Camera {
        self.best(&OPENING, aspect, |eye| share(rays, place, eye))
    }

    fn best(&self, penalties: &[f32; 7], aspect: f32, seen: impl Fn(Vec3) -> f32) -> Camera {
        // Fitted to the box first, which is fast; only the final view is fitted to all corners.
        let bounds = Bounds::from_points(self.corners.iter().copied());
        let corners = if bounds.is_empty() { Vec::new() } else { bounds.corners().to_vec() };
        let size = bounds.size();
        let thin = Vec3::AXES.into_iter().find(|axis| size.dot(*axis) <= THIN * size.max_element());
        let axes = [0.0, 0.5, 1.0, 1.5].map(|azimuth| azimuth - AZIMUTH_RAD / PI);
        let turns = (0..AZIMUTHS).map(|step| step as f32 / AZIMUTHS as f32 * 2.0).chain(axes);
        let mut judged = Vec::new();
        for turn in turns {
            // The azimuth from the usual side in half turns, -1 to 1.
            let turn = (turn + 1.0).rem_euclid(2.0) - 1.0;
            for (elevation_rad, penalty) in ELEVATIONS_RAD.into_iter().zip(penalties) {
                let is_vertical = elevation_rad.abs() >= FRAC_PI_2;
                if is_vertical && turn != 0.0 {
                    continue;
                }
                let towards_eye = if is_vertical {
                    Vec3::Y * elevation_rad.signum()
                } else {
                    let (sin, cos) = (AZIMUTH_RAD + turn * PI).sin_cos();
                    let (y, level) = elevation_rad.sin_cos();
                    Vec3::new(sin * level, y, cos * level)
                };
                let is_along_thin = thin.is_some_and(|axis| axis.dot(towards_eye).abs() > 0.9999);
                let penalty = if is_along_thin { ALONG_THIN * penalty } else { *penalty };
                let share = seen(fit(&corners, towards_eye, aspect).position);
                judged.push((share, penalty + BEHIND * turn.abs(), towards_eye));
            }
        }
        let most = judged.iter().map(|(share, ..)| *share).fold(f32::MIN_POSITIVE, f32::max);
        let worth = |(share, penalty, _): &(f32, f32, Vec3)| share / most - penalty;
        // `>`, so that the first of equal views wins.
        let best = judged.iter().reduce(|a, b| if worth(b) > worth(a) { b } else { a });
        fit(&self.corners, best.map_or(Vec3::Z, |best| best.2), aspect)
    }
}

/// The share of points that an eye sees.
pub(super) fn share(rays: &Rays, patches: &[Patch], eye: Vec3) -> f32 {
    visible(rays, patches, eye, |_| 1.0)
}

/// The visibility of points from an eye: their weights, times a function of the cosine.
fn visible(rays: &Rays, patches: &[Patch], eye: Vec3, worth: impl Fn(f32) -> f32) -> f32 {
    let seen = patches.iter().filter_map(|patch| {
        let way = eye - patch.position;
        let cosine = way.normalize().dot(patch.normal);
        let is_seen = cosine > 0.0 && rays.is_free(patch.position, way, 1.0);
        is_seen.then(|| patch.weight * worth(cosine))
    });
    seen.sum()
}

/// The nearest eye in a direction that sees every corner.
///
/// In the camera's axes (x right, y up, z backwards) a point p lies left of the frustum's right
/// plane when `p.x + t * p.z <= eye.x + t * eye.z`, with t the tangent of half the field of view,
/// and so on for the other planes. The largest left sides of all points thus bound the eye, and
/// solving the two equations of opposite planes puts the scene in the middle between them.
fn fit(corners: &[Vec3], towards_eye: Vec3, aspect: f32) -> Camera {
    let camera = Camera::look_at(towards_eye, Vec3::ZERO, VERTICAL_FOV_RAD);
    let world_from_camera = Mat3::from_mat4(camera.world_from_camera());
    let tan_y = (VERTICAL_FOV_RAD * 0.5).tan() * FILL;
    let tan_x = tan_y * aspect;
    let [mut right, mut left, mut top, mut bottom, mut nearest] = [f32::NEG_INFINITY; 5];
    let mut farthest = f32::INFINITY;
    // An empty scene is a point.
    let corners = if corners.is_empty() { &[Vec3::ZERO] } else { corners };
    for &corner in corners {
        let p = world_from_camera.transpose() * corner;
        right = right.max(p.x + tan_x * p.z);
        left = left.max(-p.x + tan_x * p.z);
        top = top.max(p.y + tan_y * p.z);
        bottom = bottom.max(-p.y + tan_y * p.z);
        nearest = nearest.max(p.z);
        farthest = farthest.min(p.z);
    }
    let away_x = (right + left) * 0.5 / tan_x;
    let away_y = (top + bottom) * 0.5 / tan_y;
    // Keeps a tenth of the size away, even from a line seen along its axis, which has no width.
    let size = (right + left).max(top + bottom).max(nearest - farthest).max(1e-3);
    let away = away_x.max(away_y).max(nearest + 0.1 * size.min(1.0));
    let eye = Vec3::new((right - left) * 0.5, (top - bottom) * 0.5, away);
    Camera {
        position: world_from_camera * eye,
        forward: -towards_eye,
        near_m: 0.1 * (away - nearest),
        ..camera
    }
}

/// Removes the triangles of a ground or a dome if the rest of the scene is small.
fn leave_out_surroundings(rays: &Rays, triangles: &mut Vec<&Triangle>) {
    // Connected pieces, by union-find with path halving (Tarjan and van Leeuwen 1984).
    let mut parent: Vec<u32> = (0..rays.positions.len() as u32).collect();
    let find = |parent: &mut Vec<u32>, mut at: u32| {
        while parent[at as usize] != at {
            parent[at as usize] = parent[parent[at as usize] as usize];
            at = parent[at as usize];
        }
        at
    };
    for triangle in &rays.triangles {
        let roots = triangle.corners.map(|corner| find(&mut parent, corner));
        let least = roots[0].min(roots[1]).min(roots[2]);
        for root in roots {
            parent[root as usize] = least;
        }
    }
    let mut piece = |triangle: &Triangle| find(&mut parent, triangle.corners[0]);
    let mut boxes: FxHashMap<u32, Bounds> = FxHashMap::default();
    for triangle in &rays.triangles {
        let bounds = Bounds::from_points(rays.corners(triangle));
        let own = boxes.entry(piece(triangle)).or_default();
        *own = own.union(bounds);
    }
    let mut areas: FxHashMap<u32, [f32; 2]> = FxHashMap::default();
    for triangle in &rays.triangles {
        let [a, b, c] = rays.corners(triangle);
        let towards_middle = boxes[&piece(triangle)].center() - a;
        let is_inward =
            !triangle.is_double_sided() && (b - a).cross(c - a).dot(towards_middle) > 0.0;
        let [inward, all] = areas.entry(piece(triangle)).or_default();
        *all += rays.area(triangle);
        *inward += if is_inward { rays.area(triangle) } else { 0.0 };
    }
    let all = 2.0 * rays.unit.half;
    let width = |size: Vec3| size.x.max(size.z);
    boxes.retain(|piece, bounds| {
        let own = bounds.size();
        let [inward, area] = areas[piece];
        let is_ground = own.y <= FLAT * width(own) && width(own) >= SPANS * width(all);
        let is_dome = inward > INWARD * area && own.cmpge(all * SPANS).all();
        !is_ground && !is_dome
    });
    let rest = boxes.values().fold(Bounds::EMPTY, |rest, own| rest.union(*own)).size();
    let is_small = rest.max_element() <= SMALL * all.max_element();
    if rest.max_element() > 0.0 && is_small && rest.y >= STANDS * width(rest) {
        triangles.retain(|triangle| boxes.contains_key(&piece(triangle)));
    }
}
