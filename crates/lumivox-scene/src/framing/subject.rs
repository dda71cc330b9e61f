//! The subject of a view from outside.
//!
//! A chair on a ground of a hundred metres, or under a dome of sky, would be a speck in a picture
//! of everything. So connected pieces are separated; if a ground, or a dome seen from inside, makes
//! the scene at least twice as large as the rest, the picture is fitted to the rest. The points by
//! which a view is judged are spread over the subject's surface, evenly by area.

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::directions;
use super::rays::LIFT;
use super::soup::{Sides, Soup};
use super::survey::Patch;
use crate::Bounds;

/// A ground is left out only if the rest is smaller than this share of the scene.
const SMALL: f32 = 0.5;
/// The greatest thickness of a ground, as a share of its width.
const FLAT: f32 = 0.05;
/// The share of the scene that a ground or a dome spans.
const SPANS: f32 = 0.6;
/// The least height of a thing on a ground, as a share of its width.
const STANDS: f32 = 0.2;
/// The share of a dome's area that faces inwards.
const INWARD: f32 = 0.9;
/// The number of points by which a view is judged.
const POINTS: usize = 512;

/// The subject of a view.
pub(super) struct Subject {
    /// The corners of its triangles.
    pub(super) corners: Vec<Vec3>,
    pub(super) bounds: Bounds,
    /// Points of its surface; their weights sum up to one.
    pub(super) patches: Vec<Patch>,
    /// Whether a ground or a dome was left out.
    pub(super) is_part: bool,
}

impl Subject {
    /// The subject of a thing: without a ground or dome that would make it a speck.
    pub(super) fn of_thing(soup: &Soup) -> Self {
        let pieces = Pieces::of(soup);
        let left_out = pieces.surroundings();
        let is_meant = |triangle: usize| !left_out[pieces.of_triangle[triangle] as usize];
        Self::of(soup, &(0..soup.triangles.len()).filter(|&i| is_meant(i)).collect::<Vec<_>>())
    }

    /// The subject of a place: everything.
    pub(super) fn of_place(soup: &Soup) -> Self {
        Self::of(soup, &(0..soup.triangles.len()).collect::<Vec<_>>())
    }

    fn of(soup: &Soup, meant: &[usize]) -> Self {
        let corners: Vec<Vec3> = meant.iter().flat_map(|&i| soup.corners_of(i)).collect();
        Self {
            bounds: Bounds::from_points(corners.iter().copied()),
            patches: patches(soup, meant),
            is_part: meant.len() < soup.triangles.len(),
            corners,
        }
    }
}

/// Connected triangles: those that share positions of corners.
struct Pieces {
    of_triangle: Vec<u32>,
    bounds: Vec<Bounds>,
    /// For each piece, the share of its area whose front, and no other side, faces the middle of
    /// its bounds.
    inward: Vec<f32>,
}

impl Pieces {
    fn of(soup: &Soup) -> Self {
        // Union-find with path halving (Tarjan and van Leeuwen 1984).
        let mut parent: Vec<u32> = (0..soup.positions.len() as u32).collect();
        let find = |parent: &mut Vec<u32>, mut at: u32| {
            while parent[at as usize] != at {
                parent[at as usize] = parent[parent[at as usize] as usize];
                at = parent[at as usize];
            }
            at
        };
        let mut first_at: FxHashMap<[u32; 3], u32> = FxHashMap::default();
        for (index, position) in (0..).zip(&soup.positions) {
            // Makes -0 equal to 0.
            let place = (*position + 0.0).to_array().map(f32::to_bits);
            let first = *first_at.entry(place).or_insert(index);
            parent[index as usize] = first;
        }
        for triangle in &soup.triangles {
            let roots = triangle.map(|corner| find(&mut parent, corner));
            let least = roots[0].min(roots[1]).min(roots[2]);
            for root in roots {
                parent[root as usize] = least;
            }
        }
        let mut number_of: FxHashMap<u32, u32> = FxHashMap::default();
        let (mut of_triangle, mut bounds) = (Vec::new(), Vec::new());
        for (index, triangle) in soup.triangles.iter().enumerate() {
            let root = find(&mut parent, triangle[0]);
            let number = *number_of.entry(root).or_insert_with(|| {
                bounds.push(Bounds::EMPTY);
                bounds.len() as u32 - 1
            });
            of_triangle.push(number);
            soup.corners_of(index)
                .into_iter()
                .for_each(|corner| bounds[number as usize].include(corner));
        }
        let mut areas = vec![[0.0_f32; 2]; bounds.len()];
        for (index, &number) in of_triangle.iter().enumerate() {
            let [a, b, c] = soup.corners_of(index);
            let normal = (b - a).cross(c - a);
            let is_single = soup.sides[soup.part[index] as usize] != Sides::Both;
            let is_inward = normal.dot(bounds[number as usize].center() - a) > 0.0;
            let [inward, all] = &mut areas[number as usize];
            *all += normal.length();
            *inward += if is_single && is_inward { normal.length() } else { 0.0 };
        }
        let inward = areas.iter().map(|[inward, all]| inward / all.max(f32::MIN_POSITIVE));
        let inward = inward.collect();
        Self { of_triangle, bounds, inward }
    }

    /// The pieces that are a ground or a dome around a small rest.
    fn surroundings(&self) -> Vec<bool> {
        let all = self.bounds.iter().copied().fold(Bounds::EMPTY, Bounds::union);
        let size = all.size();
        let width = size.x.max(size.z);
        let is_ground = |number: usize| {
            let own = self.bounds[number].size();
            let own_width = own.x.max(own.z);
            own.y <= FLAT * own_width && own_width >= SPANS * width
        };
        let is_dome = |number: usize| {
            self.inward[number] > INWARD && self.bounds[number].size().cmpge(size * SPANS).all()
        };
        let numbers = 0..self.bounds.len();
        let left_out: Vec<bool> =
            numbers.map(|number| is_ground(number) || is_dome(number)).collect();
        let kept = self.bounds.iter().zip(&left_out).filter(|(_, is_out)| !**is_out);
        let rest = kept.fold(Bounds::EMPTY, |rest, (bounds, _)| rest.union(*bounds));
        let is_small = rest.size().max_element() <= SMALL * size.max_element();
        // A flat rest, such as the parts of a circuit board, does not stand on a ground: the board
        // belongs to the thing.
        let stands = rest.size().y >= STANDS * rest.size().x.max(rest.size().z);
        if rest.size().max_element() > 0.0 && is_small && stands {
            return left_out;
        }
        vec![false; self.bounds.len()]
    }
}

/// Points spread over triangles, evenly by area, on each visible side.
fn patches(soup: &Soup, triangles: &[usize]) -> Vec<Patch> {
    let mut total = 0.0_f64;
    let up_to: Vec<f64> = triangles
        .iter()
        .map(|&index| {
            let [a, b, c] = soup.corners_of(index);
            total += f64::from((b - a).cross(c - a).length());
            total
        })
        .collect();
    let mut patches = Vec::new();
    for (number, weights) in directions::triangles(&up_to, POINTS) {
        let index = triangles[number];
        let [a, b, c] = soup.corners_of(index);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let point = a * weights[0] + b * weights[1] + c * weights[2];
        let is_both = soup.sides[soup.part[index] as usize] == Sides::Both;
        let weight = if is_both { 0.5 } else { 1.0 } / POINTS as f32;
        let patch = |normal: Vec3| Patch { position: point + normal * LIFT, normal, weight };
        patches.push(patch(normal));
        if is_both {
            patches.push(patch(-normal));
        }
    }
    patches
}
