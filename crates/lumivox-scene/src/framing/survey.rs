//! Decides by rays whether a scene is a place to stand in or a thing to look at.
//!
//! Points all over the bounds look around. A point that sees fronts of surfaces is in the air; one
//! that sees backs is inside something solid: that distinguishes a room from a ball. Directions
//! without a surface are gaps, through which a point looks out of the scene; a place to stand in
//! has few of them. The share of such *roofed* points in the scene's body then decides. The body
//! consists of the points with surfaces all around: outside a convex body, a point sees it in less
//! than half of all directions.
//!
//! The required share depends on the scene's outside. Walls that are modelled only from the inside
//! show their backs there, and were made to be seen from inside. If the outside is modelled as
//! well, hollow things (a helmet, a cup, a car, a gear box) must be distinguished from houses: cups
//! are open, helmets are mostly filled, things without an entrance are viewed from outside, and a
//! car's inside is round where a house has floors and walls.
//!
//! In every case it must be possible to stand in it: below most points of a place is a floor,
//! nearly level. Neither a teapot nor a robot has one.

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::directions;
use super::rays::{Hit, LIFT, Rays};
use super::soup::Soup;

const PROBES: usize = 2000;
/// Directions in which each point looks.
const LOOKS: usize = 64;
/// Surface points that represent the inside.
const PATCHES: usize = 600;
/// Directions from which the outside is seen, and rays in each.
const OUTSIDE: [usize; 2] = [64, 64];

/// A point is in the air if more than this share of the surfaces it sees are fronts.
const IN_AIR: f32 = 0.75;
/// `IN_AIR` for files that wind half of their walls the wrong way round. Fronts must then only be
/// more than a solid would show, but the air must be free up to this distance, in unit space: a
/// bush of double-sided leaves is not a hall.
const MUDDLED: f32 = 0.35;
const FREE: f32 = 0.03;
/// Share of the directions in which a roughly surrounded point sees a surface.
const SURROUNDED: f32 = 0.7;
/// `SURROUNDED` for a point under a roof with a window.
const ROOFED: f32 = 0.95;
/// `SURROUNDED` for a point in a room that lacks a wall.
const WALLED: f32 = 0.85;

/// The least extent of a place along an axis, in unit space: 0.6 in Sponza, 0.3 in a helmet on a
/// stand, about 0.35 in a car.
const LONG: f32 = 0.45;
/// Share of the roofed points that must see no gap at all: 0.4 in Sponza, hardly any in a cup.
const DEEP: f32 = 0.1;
/// The share of the view that furniture takes in a room; in a car it is more.
const FURNITURE: std::ops::Range<f32> = 0.02..0.2;
/// The steepest floor: the cosine of 37 degrees.
const LEVEL: f32 = 0.8;
/// Share of the points of a place that must have a floor below them: first if its walls were made
/// to be seen from inside, then if not. For points inside a ball it is 0.49.
const FLOORED: [f32; 2] = [0.65, 0.75];
/// Floors, ceilings and walls are tilted by less than 20 degrees: sine and cosine.
const UPRIGHT: [f32; 2] = [0.34, 0.94];
/// The share of the visible surfaces that must be floors, ceilings or walls if the outside is
/// modelled as well: inside a ball it is 0.4.
const BUILT: f32 = 0.65;
/// A furnished shell shows less than this share of its triangles outside.
const DETAIL: f32 = 0.4;
/// The number of triangles that are tested for that.
const DETAILS: usize = 300;
/// Points from which floors and walls are searched.
const STANDS: usize = 200;

/// A point of the air with surfaces around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Probe {
    pub(super) position: Vec3,
    /// Share of the directions in which there is no surface.
    pub(super) sky: f32,
}

/// A point on a surface that is visible from inside a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// Just above the surface.
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    /// Its weight in the visibility. All weights sum to one; each patch of a large instance has
    /// less weight, so that furniture counts beside walls: an instance with n patches has the root
    /// of n.
    pub(super) weight: f32,
}

impl Patch {
    /// The point at which a ray landed, with weight one.
    pub(super) fn of(hit: &Hit) -> Self {
        Self { position: hit.lifted(), normal: hit.normal, weight: 1.0 }
    }
}

/// The result of the rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Survey {
    /// Whether the scene is a place to stand in.
    pub(super) is_place: bool,
    /// The points of the place at which one can stand; empty for a thing.
    pub(super) interior: Vec<Probe>,
    /// The patches visible from there.
    pub(super) patches: Vec<Patch>,
    /// Whether walls show their backs outside: they were made to be seen from inside.
    pub(super) is_made_for_inside: bool,
    /// The points in the air and in shells, for a view inside a thing.
    hollow: Vec<Probe>,
}

/// Counts of points by what they see.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    /// Points with surfaces all around.
    body: usize,
    /// Points in the air with few gaps around them; `roofed` counts those with fewer.
    walled: usize,
    roofed: usize,
    /// Roofed points without any gap.
    sealed: usize,
    /// Points surrounded by double-sided backs, but with something else in view.
    furnished: usize,
    /// Share of the outside that shows backs.
    outside_backs: f32,
    /// The extent of the roofed points along an axis, in unit space.
    span: f32,
}

impl Survey {
    pub(super) fn new(rays: &Rays, soup: &Soup, half: Vec3) -> Self {
        let (shares, air, shell) = look_around(rays, half);
        tracing::debug!("survey of the scene: {shares:?}");
        // A scene that shows most of its detail outside, such as a lorry, was not made to be
        // entered.
        let is_furnished = shares.is_furnished_shell() && detail_outside(rays, soup) < DETAIL;
        let interior = [(is_furnished, &shell), (shares.is_place(), &air)];
        let interior = interior.into_iter().find(|(is_meant, _)| *is_meant);
        let interior = interior.map(|(_, probes)| probes.clone()).unwrap_or_default();
        let standing = Standing::of(rays, &interior);
        tracing::debug!("standing in it: {standing:?}");
        let is_made_for_inside = shares.outside_backs > 0.5;
        let can_stand = if is_made_for_inside {
            standing.floored >= FLOORED[0]
        } else {
            standing.floored >= FLOORED[1] && standing.built >= BUILT
        };
        let interior = if can_stand { interior } else { Vec::new() };
        let patches = patches(rays, &interior);
        let hollow = if air.is_empty() { shell } else { air };
        Self { is_place: !patches.is_empty(), interior, patches, is_made_for_inside, hollow }
    }

    /// Treats the scene as a place, if it has any free space inside.
    pub(super) fn seen_from_within(&self, rays: &Rays) -> Self {
        if self.is_place {
            return self.clone();
        }
        let interior = self.hollow.clone();
        let patches = patches(rays, &interior);
        Self { is_place: !patches.is_empty(), interior, patches, ..self.clone() }
    }

    /// Mean share of the directions that lead out of the place.
    pub(super) fn sky(&self) -> f32 {
        let sum: f32 = self.interior.iter().map(|probe| probe.sky).sum();
        sum / self.interior.len().max(1) as f32
    }
}

impl Shares {
    fn is_place(self) -> bool {
        let of_body = |count: usize| count as f32 / self.body.max(1) as f32;
        if self.outside_backs > 0.5 {
            return of_body(self.walled) >= 0.2;
        }
        // A scene without an entrance was not made to be entered.
        if self.sealed as f32 > 0.9 * self.roofed as f32 {
            return false;
        }
        let is_deep = self.sealed as f32 >= DEEP * self.roofed as f32;
        of_body(self.roofed) >= 0.1 && self.span >= LONG && is_deep
    }

    fn is_furnished_shell(self) -> bool {
        self.furnished as f32 >= 0.4 * self.body.max(1) as f32
    }
}

/// Whether one can stand in a place.
#[derive(Clone, Copy, Debug, Default)]
struct Standing {
    /// Share of the points with a nearly level floor below them.
    floored: f32,
    /// Share of floors, ceilings and upright walls in the visible surfaces.
    built: f32,
}

impl Standing {
    fn of(rays: &Rays, interior: &[Probe]) -> Self {
        let (mut floors, mut built, mut seen, mut count) = (0, 0, 0, 0);
        for probe in interior.iter().step_by(interior.len().div_ceil(STANDS).max(1)) {
            count += 1;
            let floor = rays.cast(probe.position, Vec3::NEG_Y);
            floors += usize::from(floor.is_some_and(|hit| hit.normal.y >= LEVEL));
            for hit in directions::sphere(LOOKS).filter_map(|way| rays.cast(probe.position, way)) {
                let [sine, cosine] = UPRIGHT;
                let rise = hit.normal.y.abs();
                seen += 1;
                built += usize::from(rise <= sine || rise >= cosine);
            }
        }
        let share = |part: usize, whole: usize| part as f32 / whole.max(1) as f32;
        Self { floored: share(floors, count), built: share(built, seen) }
    }
}

/// Shares of what a point sees.
struct Seen {
    /// Directions with a surface.
    hits: f32,
    /// Fronts among the surfaces.
    fronts: f32,
    /// Double-sided ones among the surfaces.
    double_sided: f32,
    /// The least distance to a surface.
    clearance: f32,
}

impl Seen {
    fn is_in_air(&self) -> bool {
        self.fronts >= IN_AIR || (self.fronts >= MUDDLED && self.clearance >= FREE)
    }

    fn from(rays: &Rays, position: Vec3) -> Self {
        let (mut hits, mut fronts, mut double_sided, mut clearance) = (0, 0, 0, f32::INFINITY);
        for hit in directions::sphere(LOOKS).filter_map(|way| rays.cast(position, way)) {
            hits += 1;
            clearance = clearance.min(hit.distance);
            fronts += usize::from(hit.is_front);
            double_sided += usize::from(hit.is_double_sided);
        }
        let of_hits = |count: usize| if hits == 0 { 1.0 } else { count as f32 / hits as f32 };
        Self {
            hits: hits as f32 / LOOKS as f32,
            fronts: of_hits(fronts),
            double_sided: of_hits(double_sided),
            clearance,
        }
    }
}

/// The sums over all points, and the points of the air and of shells.
fn look_around(rays: &Rays, half: Vec3) -> (Shares, Vec<Probe>, Vec<Probe>) {
    let mut shares = Shares { outside_backs: outside_backs(rays, half), ..Shares::default() };
    let (mut air, mut shell, mut roofed) = (Vec::new(), Vec::new(), Vec::new());
    for point in directions::cube(PROBES) {
        let position = (point * 2.0 - 1.0) * half;
        let seen = Seen::from(rays, position);
        let (hits, sky) = (seen.hits, 1.0 - seen.hits);
        if seen.is_in_air() {
            shares.body += usize::from(hits > 0.5);
            shares.walled += usize::from(hits >= WALLED);
            if hits >= ROOFED {
                roofed.push(position);
            }
            shares.sealed += usize::from(hits >= 1.0);
            if hits >= SURROUNDED {
                air.push(Probe { position, sky });
            }
        } else {
            shares.body += 1;
            // A shell without thickness whose front faces outwards, as sketching programs make it.
            if seen.double_sided >= 0.9 && hits >= ROOFED && seen.fronts < MUDDLED {
                shares.furnished += usize::from(FURNITURE.contains(&seen.fronts));
                shell.push(Probe { position, sky });
            }
        }
    }
    shares.roofed = roofed.len();
    shares.span = span(&roofed);
    (shares, air, shell)
}

/// The surfaces visible from all over a place.
fn patches(rays: &Rays, interior: &[Probe]) -> Vec<Patch> {
    let points = interior.iter().step_by(interior.len().div_ceil(PATCHES).max(1));
    let looks = PATCHES.div_ceil(points.len().max(1));
    // All points share one set of directions; each point continues in it where the previous one
    // stopped.
    let hits: Vec<Hit> = points
        .flat_map(|probe| std::iter::repeat_n(probe.position, looks))
        .zip(directions::sphere(PATCHES).cycle())
        .filter_map(|(position, way)| rays.cast_visible(position, way))
        .collect();
    let mut of_part: FxHashMap<u32, f32> = FxHashMap::default();
    for hit in &hits {
        *of_part.entry(hit.part).or_default() += 1.0;
    }
    let total: f32 = hits.iter().map(|hit| of_part[&hit.part].sqrt().recip()).sum();
    let patch = |hit: &Hit| Patch {
        position: hit.lifted(),
        normal: hit.normal,
        weight: of_part[&hit.part].sqrt().recip() / total,
    };
    hits.iter().map(patch).collect()
}

/// The share of the triangles that are visible from outside, from either side.
fn detail_outside(rays: &Rays, soup: &Soup) -> f32 {
    let count = soup.triangles.len();
    let (mut seen, mut all) = (0, 0);
    for triangle in (0..count).step_by(count.div_ceil(DETAILS).max(1)) {
        let [a, b, c] = soup.corners_of(triangle);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let middle = (a + b + c) / 3.0;
        all += 1;
        let is_seen = directions::sphere(LOOKS).any(|way| {
            let above = normal * normal.dot(way).signum() * LIFT;
            normal.dot(way).abs() > 0.1 && rays.is_free(middle + above, way, f32::INFINITY)
        });
        seen += usize::from(is_seen);
    }
    seen as f32 / all.max(1) as f32
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

/// The share of backs among the first hits of parallel rays from all sides.
fn outside_backs(rays: &Rays, half: Vec3) -> f32 {
    let radius = half.length();
    let (mut hits, mut backs) = (0, 0);
    for way in directions::sphere(OUTSIDE[0]) {
        let (u, v) = way.any_orthonormal_pair();
        for place in directions::disc(OUTSIDE[1]) {
            let origin = (u * place.x + v * place.y - 2.0 * way) * radius;
            let Some(hit) = rays.cast(origin, way) else { continue };
            hits += 1;
            backs += usize::from(!hit.is_front);
        }
    }
    backs as f32 / hits.max(1) as f32
}
