//! The texels of each triangle: those that bilinear filtering on it reads.

use glam::{UVec2, Vec2, Vec2Swizzles as _, Vec3};

use super::charts::Triangle;
use super::{LightmapError, LightmapNode};

/// Marks a texel without a triangle.
const NONE: u32 = u32::MAX;
/// Texels whose centres are at most this far from a triangle, in texels, belong to it: bilinear
/// filtering on the triangle reads them.
const NEAR: f32 = 1.0;
/// A sample of a texel whose centre is outside is this far inside its triangle, in texels: on the
/// edge itself there may be a wall.
const INSET: f32 = 0.05;
/// Distance from a triangle's edges, in texels, from which a centre counts as inside it, so that
/// rounding makes no overlaps.
const INSIDE: f32 = 0.02;
/// The share of a node's texels that may overlap: unwrapping programs are not exact.
const TOLERATED: f64 = 0.01;

/// A texel's triangle, and the place of its sample on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Texel {
    pub(super) triangle: u32,
    /// Barycentric weights of the second and the third corner.
    weights: Vec2,
    /// The square of the distance from its centre to the triangle, in texels.
    distance: f32,
    /// Whether the centre is clearly inside.
    is_inside: bool,
    /// Whether it is clearly inside another triangle of the node, too.
    is_common: bool,
}

impl Texel {
    const EMPTY: Self = Self {
        triangle: NONE,
        weights: Vec2::ZERO,
        distance: f32::INFINITY,
        is_inside: false,
        is_common: false,
    };

    pub(super) fn is_covered(&self) -> bool {
        self.triangle != NONE
    }

    pub(super) fn node(&self, triangles: &[Triangle]) -> Option<u32> {
        triangles.get(self.triangle as usize).map(|triangle| triangle.node)
    }

    /// Barycentric weights of all corners.
    pub(super) fn weights(&self) -> Vec3 {
        Vec3::new(1.0 - self.weights.x - self.weights.y, self.weights.x, self.weights.y)
    }
}

/// Finds the triangle of each texel of a map: the nearest to its centre. Triangles without area in
/// the map have no texels.
pub(super) fn cover(
    nodes: &[LightmapNode],
    triangles: &[Triangle],
    edge: u32,
) -> Result<Vec<Texel>, LightmapError> {
    let mut texels = vec![Texel::EMPTY; edge as usize * edge as usize];
    for (number, triangle) in triangles.iter().enumerate() {
        let Some(flat) = Flat::of(triangle.uvs) else { continue };
        for at in flat.texels(edge) {
            let texel = &mut texels[(at.y * edge + at.x) as usize];
            let Some(new) = flat.nearest(at.as_vec2() + 0.5) else { continue };
            if new.is_inside && texel.is_inside {
                let other = &triangles[texel.triangle as usize];
                texel.is_common |= other.node == triangle.node
                    && !same(triangle, new.weights(), other, texel.weights());
            } else if new.distance < texel.distance {
                *texel = Texel { triangle: number as u32, ..new };
            }
        }
    }
    // For each node: the number of its texels, the number of those that several of its triangles
    // cover, and the place of the first of them.
    let mut counts = vec![(0_usize, 0_usize, UVec2::ZERO); nodes.len()];
    for (index, texel) in texels.iter().enumerate() {
        let Some(node) = texel.node(triangles) else { continue };
        let (covered, overlapping, first) = &mut counts[node as usize];
        *covered += 1;
        if texel.is_common {
            if *overlapping == 0 {
                *first = UVec2::new(index as u32 % edge, index as u32 / edge);
            }
            *overlapping += 1;
        }
    }
    for (node, (covered, overlapping, at)) in nodes.iter().zip(counts) {
        if overlapping as f64 > TOLERATED * covered as f64 {
            let corner = Vec2::from(node.corner.map(|texels| texels as f32));
            return Err(LightmapError::Overlap {
                node: node.name.clone(),
                texels: overlapping,
                covered,
                at: ((at.as_vec2() + 0.5 - corner) / node.edge as f32).to_array(),
            });
        }
        if overlapping > 0 {
            tracing::warn!(
                "node \"{}\": {overlapping} of its {covered} texels belong to several triangles",
                node.name
            );
        }
    }
    Ok(texels)
}

/// Whether two triangles have the same place and direction there, such as duplicates.
fn same(a: &Triangle, at_a: Vec3, b: &Triangle, at_b: Vec3) -> bool {
    let scale = a.corners[0].distance(a.corners[1]);
    a.at(at_a).distance(b.at(at_b)) < 1e-3 * scale && a.front().dot(b.front()) > 0.9
}

/// The share of covered texels that triangles of several nodes cover, in a common square with this
/// edge.
pub(super) fn common(triangles: &[Triangle], edge: u32) -> f64 {
    let mut owners = vec![NONE; edge as usize * edge as usize];
    let (mut covered, mut shared) = (0_usize, 0_usize);
    for triangle in triangles {
        let Some(flat) = Flat::of(triangle.uvs.map(|uv| uv * edge as f32)) else { continue };
        for at in flat.texels(edge) {
            let owner = &mut owners[(at.y * edge + at.x) as usize];
            if !flat.nearest(at.as_vec2() + 0.5).is_some_and(|texel| texel.is_inside) {
                continue;
            }
            covered += usize::from(*owner == NONE);
            shared += usize::from(*owner != NONE && *owner != triangle.node);
            if *owner == NONE {
                *owner = triangle.node;
            }
        }
    }
    shared as f64 / covered.max(1) as f64
}

/// A triangle in the plane of the map, counter-clockwise, in texels.
struct Flat {
    corners: [Vec2; 3],
    /// Twice its area.
    area: f32,
    is_turned: bool,
    /// The centre and radius of its inscribed circle.
    center: Vec2,
    radius: f32,
}

impl Flat {
    /// `None` without area.
    fn of([a, b, c]: [Vec2; 3]) -> Option<Self> {
        let area = (b - a).perp_dot(c - a);
        let is_turned = area < 0.0;
        let (b, c, area) = if is_turned { (c, b, -area) } else { (b, c, area) };
        let sides = Vec3::new(b.distance(c), c.distance(a), a.distance(b));
        let around = sides.element_sum();
        if area.is_nan() || area <= 1e-6 * around.max(1e-3) {
            return None;
        }
        let center = (sides.x * a + sides.y * b + sides.z * c) / around;
        Some(Self { corners: [a, b, c], area, is_turned, center, radius: area / around })
    }

    /// The texels of a map that may be near the triangle.
    fn texels(&self, edge: u32) -> impl Iterator<Item = UVec2> + use<> {
        let [a, b, c] = self.corners;
        let low = (a.min(b).min(c) - 1.5).floor().max(Vec2::ZERO).as_uvec2();
        let high =
            (a.max(b).max(c) + 1.5).ceil().max(Vec2::ZERO).as_uvec2().min(UVec2::splat(edge));
        (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| UVec2::new(x, y)))
    }

    /// The texel with this centre, if it is near enough.
    fn nearest(&self, center: Vec2) -> Option<Texel> {
        let [a, b, c] = self.corners;
        let sides = [(a, b), (b, c), (c, a)];
        // Distances to the lines along the sides, positive towards the inside.
        let inner = sides
            .map(|(from, to)| (to - from).perp_dot(center - from) / from.distance(to))
            .into_iter()
            .fold(f32::INFINITY, f32::min);
        if inner >= 0.0 {
            return Some(self.texel(center, 0.0, inner > INSIDE));
        }
        if inner < -NEAR {
            return None;
        }
        // The nearest point of a slightly smaller triangle.
        let scale = 1.0 - (INSET / self.radius).min(0.5);
        let mut nearest = (Vec2::ZERO, f32::INFINITY);
        for (from, to) in sides {
            let (from, to) =
                (from.lerp(self.center, 1.0 - scale), to.lerp(self.center, 1.0 - scale));
            let along = to - from;
            let share = ((center - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let point = from + share * along;
            let distance = point.distance_squared(center);
            if distance < nearest.1 {
                nearest = (point, distance);
            }
        }
        let (point, distance) = nearest;
        // The inset makes it a little farther.
        (distance <= (NEAR + INSET).powi(2)).then(|| self.texel(point, distance, false))
    }

    fn texel(&self, point: Vec2, distance: f32, is_inside: bool) -> Texel {
        let [a, b, c] = self.corners;
        let second = (c - a).perp_dot(point - a) / -self.area;
        let third = (b - a).perp_dot(point - a) / self.area;
        let weights = Vec2::new(second, third);
        let weights = if self.is_turned { weights.yx() } else { weights };
        Texel { weights, distance, is_inside, ..Texel::EMPTY }
    }
}
