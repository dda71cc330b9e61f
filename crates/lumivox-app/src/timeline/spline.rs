//! A smooth curve through points with times.
//!
//! The curve is the centripetal Catmull-Rom spline (Catmull and Rom 1974, "A class of local
//! interpolating splines"): the distance of two knots is the square root of the points' distance.
//! It has neither cusps nor loops within a piece (Yuksel, Schaefer and Keyser 2011,
//! "Parameterization and applications of Catmull-Rom curves"). A monotone cubic maps times to
//! places on the curve (Fritsch and Carlson 1980, "Monotone piecewise cubic interpolation"; slopes
//! by Fritsch and Butland 1984). So the motion is smooth at the keys, too, never runs backwards,
//! and rests between two keys at the same point. It does not move before the first key or after
//! the last.

use std::ops::{Add, Mul};

use glam::DVec3;

/// A piecewise cubic, given by its values and derivatives at increasing places.
#[derive(Clone, Debug, PartialEq)]
struct Hermite<T> {
    places: Vec<f64>,
    values: Vec<T>,
    slopes: Vec<T>,
}

impl<T: Copy + Add<Output = T> + Mul<f64, Output = T>> Hermite<T> {
    /// The value at `x`; before the first place and after the last, the value at the end.
    fn at(&self, x: f64) -> T {
        let last = self.places.len() - 1;
        if last == 0 {
            return self.values[0];
        }
        let i = self.places.partition_point(|&place| place <= x).saturating_sub(1).min(last - 1);
        let width = self.places[i + 1] - self.places[i];
        let t = ((x - self.places[i]) / width).clamp(0.0, 1.0);
        let (t2, t3) = (t * t, t * t * t);
        self.values[i] * (2.0 * t3 - 3.0 * t2 + 1.0)
            + self.slopes[i] * ((t3 - 2.0 * t2 + t) * width)
            + self.values[i + 1] * (3.0 * t2 - 2.0 * t3)
            + self.slopes[i + 1] * ((t3 - t2) * width)
    }
}

/// A curve through points at times.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// Maps times to knots; knots are equal while the point rests.
    pace: MonotoneCubic,
    /// Maps strictly increasing knots to distinct points.
    curve: Hermite<DVec3>,
}

impl Spline {
    /// The curve through `points` at strictly increasing `times_s`; both have the same length, at
    /// least one.
    pub fn new(times_s: &[f64], points: &[DVec3]) -> Self {
        let mut knot = 0.0;
        let mut knots_of_keys = Vec::with_capacity(points.len());
        let (mut distinct, mut knots) = (Vec::<DVec3>::new(), Vec::new());
        for &point in points {
            let distance = distinct.last().map_or(f64::INFINITY, |last| last.distance(point));
            if distance > 0.0 {
                if !distinct.is_empty() {
                    knot += distance.sqrt();
                }
                distinct.push(point);
                knots.push(knot);
            }
            knots_of_keys.push(knot);
        }
        let slopes = tangents(&distinct, &knots);
        let curve = Hermite { places: knots, values: distinct, slopes };
        Self { pace: MonotoneCubic::new(times_s, &knots_of_keys), curve }
    }

    /// The point at a time.
    pub fn at(&self, time_s: f64) -> DVec3 {
        self.curve.at(self.pace.at(time_s))
    }
}

/// The derivatives of Barry and Goldman's (1988) non-uniform Catmull-Rom spline; at its ends the
/// curve follows the chord.
fn tangents(points: &[DVec3], knots: &[f64]) -> Vec<DVec3> {
    let chord = |i: usize, j: usize| (points[j] - points[i]) / (knots[j] - knots[i]);
    let last = points.len() - 1;
    (0..points.len())
        .map(|i| match i {
            _ if last == 0 => DVec3::ZERO,
            0 => chord(0, 1),
            i if i == last => chord(last - 1, last),
            i => chord(i - 1, i) - chord(i - 1, i + 1) + chord(i, i + 1),
        })
        .collect()
}

/// A monotone cubic through values at times: it stays between neighbouring values.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneCubic(Hermite<f64>);

impl MonotoneCubic {
    /// The cubic through `values` at strictly increasing `times_s`; both have the same length, at
    /// least one.
    pub fn new(times_s: &[f64], values: &[f64]) -> Self {
        let slope = |i: usize| (values[i + 1] - values[i]) / (times_s[i + 1] - times_s[i]);
        let last = values.len() - 1;
        let slopes = (0..values.len())
            .map(|i| match i {
                _ if last == 0 => 0.0,
                0 => slope(0),
                i if i == last => slope(last - 1),
                i => {
                    let (before, after) = (slope(i - 1), slope(i));
                    if before * after <= 0.0 {
                        return 0.0;
                    }
                    let (h0, h1) = (times_s[i] - times_s[i - 1], times_s[i + 1] - times_s[i]);
                    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
                    (w0 + w1) / (w0 / before + w1 / after)
                }
            })
            .collect();
        Self(Hermite { places: times_s.to_vec(), values: values.to_vec(), slopes })
    }

    /// The value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        self.0.at(time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn zigzag() -> (Vec<f64>, Vec<DVec3>) {
        let times = vec![0.0, 1.0, 1.5, 4.0, 4.25];
        let points = [[0, 0, 0], [4, 0, 1], [4, 1, 0], [-3, 1, 5], [0, 2, 5]];
        (times, points.map(|[x, y, z]| DVec3::new(x.into(), y.into(), z.into())).to_vec())
    }

    #[test]
    fn splines_pass_their_points_and_hold_at_the_ends() {
        let (times, points) = zigzag();
        let spline = Spline::new(&times, &points);
        for (time, point) in times.iter().zip(&points) {
            assert!(spline.at(*time).distance(*point) < 1e-12);
        }
        assert_eq!(spline.at(-5.0), points[0]);
        assert!(spline.at(100.0).distance(points[4]) < 1e-12);
    }

    #[test]
    fn position_and_velocity_have_no_jumps() {
        let (times, points) = zigzag();
        let spline = Spline::new(&times, &points);
        let velocity = |time: f64| (spline.at(time + 1e-6) - spline.at(time)) / 1e-6;
        for time in &times[1..4] {
            let (before, after) = (velocity(time - 2e-6), velocity(time + 1e-6));
            assert!(before.distance(after) < 1e-3 * (1.0 + after.length()), "{before} {after}");
        }
    }

    /// A centripetal curve through unevenly spaced keys around a corner does not loop.
    #[test]
    fn uneven_keys_make_no_loops() {
        let points = [[0.0, 0.0], [0.1, 0.0], [10.0, 0.0], [10.0, 0.1], [10.0, 10.0]];
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0));
        let spline = Spline::new(&[0.0, 1.0, 2.0, 3.0, 4.0], &points);
        let mut last = spline.at(0.0);
        for step in 1..=400 {
            let now = spline.at(f64::from(step) * 0.01);
            // A small overshoot at a corner is expected; a step back is not.
            let back = (now - last).dot(DVec3::new(1.0, 1.0, 0.0));
            assert!(back > -1e-9, "step {step}: {last} to {now}");
            last = now;
        }
    }

    /// Next to a long piece, the curve overshoots a short piece by less than the short piece's
    /// length.
    #[test]
    fn long_segments_barely_overshoot_short_ones() {
        let points = [[0.0, 0.0], [0.0, 1.0], [10.0, 1.0], [10.0, 0.0]];
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0));
        let spline = Spline::new(&[0.0, 1.0, 2.0, 3.0], &points);
        let heights = (0..=300).map(|step| spline.at(f64::from(step) * 0.01).y);
        let highest = heights.fold(0.0, f64::max);
        assert!(highest > 1.0 && highest < 2.0, "{highest}");
    }

    #[test]
    fn a_repeated_point_pauses_the_path() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::X, DVec3::new(1.0, 2.0, 0.0)];
        let spline = Spline::new(&[0.0, 1.0, 3.0, 4.0], &points);
        for time in [1.0, 1.3, 2.0, 2.9, 3.0] {
            assert!(spline.at(time).distance(DVec3::X) < 1e-12);
        }
        let still = Spline::new(&[0.0, 1.0], &[DVec3::Y; 2]);
        assert_eq!(still.at(0.5), DVec3::Y);
    }

    #[test]
    fn a_straight_even_path_has_constant_speed() {
        let points: Vec<_> = (0..4).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)).collect();
        let spline = Spline::new(&[0.0, 1.0, 2.0, 3.0], &points);
        for time in [0.25, 0.5, 1.7, 2.9] {
            assert!((spline.at(time).x - time).abs() < 1e-12);
        }
    }

    #[test]
    fn monotone_cubic_stays_between_neighbouring_values() {
        let pace = MonotoneCubic::new(&[0.0, 1.0, 2.0, 3.0], &[0.0, 0.0, 5.0, 4.0]);
        for step in 0..=300 {
            let time = f64::from(step) * 0.01;
            let (low, high) = match step {
                0..=100 => (0.0, 0.0),
                101..=200 => (0.0, 5.0),
                _ => (4.0, 5.0),
            };
            let value = pace.at(time);
            assert!((low - 1e-12..=high + 1e-12).contains(&value), "{time}: {value}");
        }
    }
}
