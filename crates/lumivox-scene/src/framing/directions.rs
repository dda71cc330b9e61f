//! Directions and points spread evenly, the same in every run.

use glam::Vec3;

/// The golden angle, `pi * (3 - sqrt 5)`.
const GOLDEN_ANGLE_RAD: f32 = 2.399_963_2;

/// `count` unit vectors over the whole sphere, each of which represents `4 pi / count` of solid
/// angle: a Fibonacci spiral (González 2010, "Measurement of areas on a sphere using Fibonacci and
/// latitude-longitude lattices", section 2).
pub(super) fn sphere(count: usize) -> impl ExactSizeIterator<Item = Vec3> + Clone {
    (0..count).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f32 / count as f32;
        let radius = (1.0 - y * y).max(0.0).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE_RAD * i as f32).sin_cos();
        Vec3::new(radius * cos, y, radius * sin)
    })
}

/// `count` points of the unit cube: the additive recurrence with the powers of the inverse of the
/// root of `x^4 = x + 1` (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
pub(super) fn cube(count: usize) -> impl ExactSizeIterator<Item = Vec3> + Clone {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let steps = glam::DVec3::new(1.0 / ROOT, 1.0 / ROOT.powi(2), 1.0 / ROOT.powi(3));
    // In f64: the fraction of a large multiple keeps its digits.
    (0..count).map(move |i| (steps * i as f64 + 0.5).fract().as_vec3())
}
