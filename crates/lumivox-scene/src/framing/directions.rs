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

/// `count` points spread evenly over triangles. `up_to` is the cumulative area of the triangles.
/// Each point is the triangle's number and the weights of its corners (Turk 1990, "Generating
/// random points in triangles").
pub(super) fn triangles(up_to: &[f64], count: usize) -> impl Iterator<Item = (usize, [f32; 3])> {
    let total = up_to.last().copied().unwrap_or_default();
    cube(count).enumerate().filter_map(move |(number, place)| {
        let at = (number as f64 + 0.5) / count as f64 * total;
        let index = up_to.partition_point(|&up_to| up_to <= at);
        let root = place.x.sqrt();
        let weights = [1.0 - root, root * (1.0 - place.y), root * place.y];
        (index < up_to.len()).then_some((index, weights))
    })
}

/// `count` points of the unit disc, each of which represents the same area: Vogel's spiral (Vogel
/// 1979, "A better way to construct the sunflower head").
pub(super) fn disc(count: usize) -> impl ExactSizeIterator<Item = glam::Vec2> + Clone {
    (0..count).map(move |i| {
        let radius = ((i as f32 + 0.5) / count as f32).sqrt();
        glam::Vec2::from_angle(GOLDEN_ANGLE_RAD * i as f32) * radius
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sphere_directions_are_unit_vectors_and_isotropic() {
        for count in [1, 48, 256] {
            assert!(sphere(count).all(|d| (d.length() - 1.0).abs() < 1e-5));
        }
        let second: Vec3 = sphere(256).map(|d| d * d).sum::<Vec3>() / 256.0;
        assert!(second.abs_diff_eq(Vec3::splat(1.0 / 3.0), 0.002), "{second}");
        let first = sphere(256).sum::<Vec3>() / 256.0;
        assert!(first.length() < 0.002, "{first}");
    }

    #[test]
    fn points_fill_cube_and_disc() {
        let mut cells = [0; 8];
        for p in cube(800) {
            let cell = p.cmpge(Vec3::splat(0.5)).bitmask() as usize;
            cells[cell] += 1;
        }
        assert!(cells.iter().all(|&n| (85..=115).contains(&n)), "{cells:?}");
        let inner = disc(400).filter(|p| p.length() < 0.5).count();
        assert_eq!(inner, 100);
        assert!(disc(400).all(|p| p.length() <= 1.0));
    }
}
