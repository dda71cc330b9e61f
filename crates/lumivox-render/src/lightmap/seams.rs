//! Seams: edges whose two triangles are neighbours in space, but not in the map. Both sides are
//! filtered from other texels, so their light differs there, by the sampling and by noise.
//!
//! The texels beside seams are changed as little as possible so that both sides agree: least
//! squares, by conjugate gradients (Hestenes and Stiefel 1952, "Methods of conjugate gradients for
//! solving linear systems"), after Iwanicki 2013, "Lighting technology of The Last of Us".

use glam::{IVec3, Vec2, Vec3};

use super::LightmapPlan;
use super::charts::Triangle;
use crate::picture::tone_map::luminance;

/// Corners closer than this share of the scene's diagonal are one point.
const WELD: f32 = 1e-5;
/// The least cosine between the normals of both sides: across sharper edges light differs.
const SMOOTH: f32 = 0.985;
/// Both sides of an edge inside a chart are nearer than this in the map, in texels.
const JOINED: f32 = 0.05;
/// Samples for each texel along a seam.
const SAMPLES: f32 = 2.0;
/// The weight of a measured texel's own light, relative to a sample of a seam, and that of other
/// texels, which only serve the filter.
const KEEP_MEASURED: f32 = 0.1;
const KEEP_OTHER: f32 = 0.01;
const STEPS: usize = 100;

/// The seams of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seams {
    /// The number of edges that are seams.
    pub edges: usize,
    /// The root mean square of the difference between both sides, before they were joined, as a
    /// share of the mean light at seams; 0 without seams.
    pub before: f32,
    /// This difference after they were joined.
    pub after: f32,
}

/// A place on a seam: the difference between the filtered light of its sides.
struct Row {
    texels: [u32; 8],
    /// Weights of the second side are negative.
    weights: [f32; 8],
}

impl Row {
    fn of<T>(&self, values: &[T], zero: T) -> T
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
    {
        let pairs = self.texels.iter().zip(self.weights);
        pairs.fold(zero, |sum, (&texel, weight)| sum + values[texel as usize] * weight)
    }
}

/// Makes the light on both sides of all seams agree.
pub(super) fn join(light: &mut [Vec3], is_measured: &[bool], plan: &LightmapPlan) -> Seams {
    let pairs = pairs(&plan.triangles);
    let mut is_open = is_measured.to_vec();
    plan.samples.iter().filter(|sample| sample.is_pushed).for_each(|s| is_open[s.texel] = false);
    let (mut rows, mut edges) = (Vec::new(), 0);
    for [one, other] in pairs {
        let before = rows.len();
        sample(one, other, plan.edge, &is_open, &mut rows);
        edges += usize::from(rows.len() > before);
    }
    let before = difference(&rows, light);
    solve(&rows, light, is_measured);
    Seams { edges, before, after: difference(&rows, light) }
}

/// The places of the seams' ends in the map, for both sides.
fn pairs(triangles: &[Triangle]) -> Vec<[[Vec2; 2]; 2]> {
    let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let corners = triangles.iter().flat_map(|triangle| triangle.corners);
    let (low, high) = corners.fold(start, |(low, high), at| (low.min(at), high.max(at)));
    let cell = (WELD * low.distance(high)).max(f32::MIN_POSITIVE);
    let point = |at: Vec3| ((at - low) / cell).round().as_ivec3();
    let mut edges: Vec<([IVec3; 2], u32, u8)> = Vec::with_capacity(3 * triangles.len());
    for (number, triangle) in triangles.iter().enumerate() {
        if triangle.double_area_uv() == 0.0 {
            continue;
        }
        for side in 0..3_u8 {
            let [a, b] = ends(side).map(|corner| point(triangle.corners[corner]));
            if a != b {
                let key = if a.to_array() < b.to_array() { [a, b] } else { [b, a] };
                edges.push((key, number as u32, side));
            }
        }
    }
    let key = |edge: &([IVec3; 2], u32, u8)| (edge.0.map(|at| at.to_array()), edge.1, edge.2);
    edges.sort_unstable_by_key(key);
    let mut pairs = Vec::new();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        for two in group.windows(2) {
            // The ends of each side in the order of the key.
            let [one, other] = [0, 1].map(|i| {
                let (key, number, side) = two[i];
                let triangle = &triangles[number as usize];
                let [a, b] = ends(side);
                let turned = point(triangle.corners[a]) != key[0];
                let [a, b] = if turned { [b, a] } else { [a, b] };
                [a, b].map(|corner| (triangle.uvs[corner], triangle.normals[corner]))
            });
            let is_smooth = (0..2).all(|end| one[end].1.dot(other[end].1) > SMOOTH);
            let is_joined = (0..2).all(|end| one[end].0.distance(other[end].0) < JOINED);
            if is_smooth && !is_joined {
                pairs.push([one.map(|end| end.0), other.map(|end| end.0)]);
            }
        }
    }
    pairs
}

/// The corners at the ends of a triangle's side.
fn ends(side: u8) -> [usize; 2] {
    [usize::from(side), (usize::from(side) + 1) % 3]
}

/// Adds the samples of a seam, except under a solid, beyond which light may differ.
fn sample(one: [Vec2; 2], other: [Vec2; 2], edge: u32, is_open: &[bool], rows: &mut Vec<Row>) {
    let length = one[0].distance(one[1]).max(other[0].distance(other[1]));
    let count = (SAMPLES * length).ceil().max(1.0);
    for step in 0..count as u32 {
        let share = (step as f32 + 0.5) / count;
        let sides = [one, other].map(|[from, to]| filter(from.lerp(to, share), edge));
        let is_free = |side: &[(u32, f32); 4]| {
            let nearest = side.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            nearest.is_some_and(|&(texel, _)| is_open[texel as usize])
        };
        if !sides.iter().all(is_free) {
            continue;
        }
        let entry = |i: usize| sides[i / 4][i % 4];
        rows.push(Row {
            texels: std::array::from_fn(|i| entry(i).0),
            weights: std::array::from_fn(|i| if i < 4 { entry(i).1 } else { -entry(i).1 }),
        });
    }
}

/// The texels and weights of bilinear filtering, clamped to the map's edges.
fn filter(at: Vec2, edge: u32) -> [(u32, f32); 4] {
    let at = (at - 0.5).clamp(Vec2::ZERO, Vec2::splat(edge as f32 - 1.0));
    let low = at.floor();
    let Vec2 { x, y } = at - low;
    let low = low.as_uvec2();
    let high = (low + 1).min(glam::UVec2::splat(edge - 1));
    [
        (low.y * edge + low.x, (1.0 - x) * (1.0 - y)),
        (low.y * edge + high.x, x * (1.0 - y)),
        (high.y * edge + low.x, (1.0 - x) * y),
        (high.y * edge + high.x, x * y),
    ]
}

/// The root mean square of the sides' difference in luminance, relative to the mean.
fn difference(rows: &[Row], light: &[Vec3]) -> f32 {
    let (mut squares, mut sum) = (0.0, 0.0);
    for row in rows {
        squares += luminance(row.of(light, Vec3::ZERO).to_array()).powi(2);
        let sides: Vec3 =
            row.texels.iter().zip(row.weights).map(|(&t, w)| light[t as usize] * w.abs()).sum();
        sum += 0.5 * luminance(sides.to_array());
    }
    let count = rows.len() as f64;
    if sum > 0.0 { ((squares / count).sqrt() / (sum / count)) as f32 } else { 0.0 }
}

/// Changes the light of the rows' texels so that the rows become small.
fn solve(rows: &[Row], light: &mut [Vec3], is_measured: &[bool]) {
    // The texels of the rows, numbered.
    let mut texels: Vec<u32> = rows.iter().flat_map(|row| row.texels).collect();
    texels.sort_unstable();
    texels.dedup();
    let rows: Vec<Row> = rows
        .iter()
        .map(|row| Row {
            texels: row.texels.map(|t| texels.binary_search(&t).unwrap_or_default() as u32),
            weights: row.weights,
        })
        .collect();
    let keep: Vec<f32> = texels
        .iter()
        .map(|&texel| if is_measured[texel as usize] { KEEP_MEASURED } else { KEEP_OTHER })
        .collect();
    let now: Vec<Vec3> = texels.iter().map(|&texel| light[texel as usize]).collect();
    // The normal equations, for the change of each texel.
    let spread = |differences: &dyn Fn(&Row) -> Vec3| {
        let mut sums = vec![Vec3::ZERO; now.len()];
        for row in &rows {
            let difference = differences(row);
            for (&texel, weight) in row.texels.iter().zip(row.weights) {
                sums[texel as usize] += weight * difference;
            }
        }
        sums
    };
    let product = |change: &[Vec3]| {
        let mut sums = spread(&|row| row.of(change, Vec3::ZERO));
        for ((sum, change), keep) in sums.iter_mut().zip(change).zip(&keep) {
            *sum += keep * change;
        }
        sums
    };
    let dot = |a: &[Vec3], b: &[Vec3]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a.as_dvec3().dot(b.as_dvec3())).sum()
    };
    let mut change = vec![Vec3::ZERO; now.len()];
    let mut rest = spread(&|row| -row.of(&now, Vec3::ZERO));
    let mut way = rest.clone();
    let mut square = dot(&rest, &rest);
    let enough = 1e-8 * square;
    for _ in 0..STEPS {
        let image = product(&way);
        let curvature = dot(&way, &image);
        if square <= enough || curvature <= 0.0 {
            break;
        }
        let step = (square / curvature) as f32;
        for i in 0..now.len() {
            change[i] += step * way[i];
            rest[i] -= step * image[i];
        }
        let next = dot(&rest, &rest);
        let share = (next / square) as f32;
        for (way, rest) in way.iter_mut().zip(&rest) {
            *way = *rest + share * *way;
        }
        square = next;
    }
    for (&texel, change) in texels.iter().zip(change) {
        let light = &mut light[texel as usize];
        *light = (*light + change).max(Vec3::ZERO);
    }
}
