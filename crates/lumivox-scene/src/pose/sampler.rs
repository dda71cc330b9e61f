//! Values over time: key frames, and the curve between them (glTF 2.0, section 3.11 and appendix
//! C).
//!
//! With keys at `t_k` and `t_k+1`, `d = t_k+1 - t_k` and `t = (now - t_k) / d`:
//!
//! - step: the value at `t_k`;
//! - linear: `(1 - t) v_k + t v_k+1`; for rotations the shorter arc (slerp, Shoemake 1985,
//!   "Animating rotation with quaternion curves");
//! - cubic spline: Hermite's polynomial `(2t³ - 3t² + 1) v_k + d (t³ - 2t² + t) b_k + (3t² - 2t³)
//!   v_k+1 + d (t³ - t²) a_k+1`, where each key stores its in-tangent a, value v and out-tangent b;
//!   rotations are then normalised.
//!
//! Before the first key and after the last, the value is constant.

use std::sync::Arc;

use glam::{Quat, Vec3, Vec4};

/// The interpolation between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolation {
    Step,
    Linear,
    CubicSpline,
}

impl Interpolation {
    /// The number of values that each key stores.
    pub(crate) fn values_per_key(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// Key frames of one property. Channels may share the numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Track {
    /// The keys' times in seconds, at least one, in ascending order.
    pub(crate) times_s: Arc<[f32]>,
    /// `components` numbers per value, [`Interpolation::values_per_key`] values per key.
    pub(crate) values: Arc<[f32]>,
    /// Numbers in a value: 3 for translation and scale, 4 for rotation, any for weights.
    pub(crate) components: usize,
    pub(crate) interpolation: Interpolation,
}

/// The position of a time among the keys.
enum Place {
    At(usize),
    /// Between keys: the earlier one's index, the elapsed share of the interval, and its length in
    /// seconds.
    Behind(usize, f32, f32),
}

impl Track {
    fn place(&self, time_s: f32) -> Place {
        // The first later key, so that of several keys at one time the last wins.
        let next = self.times_s.partition_point(|&key| key <= time_s);
        let Some(key) = next.checked_sub(1) else { return Place::At(0) };
        if next == self.times_s.len() || self.interpolation == Interpolation::Step {
            return Place::At(key);
        }
        let length_s = self.times_s[next] - self.times_s[key];
        Place::Behind(key, (time_s - self.times_s[key]) / length_s, length_s)
    }

    /// Part 0, 1 or 2 of a key of a cubic spline; otherwise there is only part 0.
    fn part(&self, key: usize, part: usize) -> &[f32] {
        let begin = (key * self.interpolation.values_per_key() + part) * self.components;
        &self.values[begin..begin + self.components]
    }

    fn value(&self, key: usize) -> &[f32] {
        self.part(key, usize::from(self.interpolation == Interpolation::CubicSpline))
    }

    /// Writes the value at a time, number by number.
    pub(crate) fn sample(&self, time_s: f32, into: &mut [f32]) {
        let (key, t, length_s) = match self.place(time_s) {
            Place::At(key) => {
                for (out, &value) in into.iter_mut().zip(self.value(key)) {
                    *out = value;
                }
                return;
            }
            Place::Behind(key, t, length_s) => (key, t, length_s),
        };
        let (from, to) = (self.value(key), self.value(key + 1));
        if self.interpolation == Interpolation::Linear {
            for ((out, &from), &to) in into.iter_mut().zip(from).zip(to) {
                *out = from * (1.0 - t) + to * t;
            }
            return;
        }
        let (leaving, arriving) = (self.part(key, 2), self.part(key + 1, 0));
        let (t2, t3) = (t * t, t * t * t);
        let at_from = 2.0 * t3 - 3.0 * t2 + 1.0;
        let at_to = 3.0 * t2 - 2.0 * t3;
        let at_leaving = length_s * (t3 - 2.0 * t2 + t);
        let at_arriving = length_s * (t3 - t2);
        for (i, out) in into.iter_mut().enumerate().take(self.components) {
            *out = at_from * from[i]
                + at_leaving * leaving[i]
                + at_to * to[i]
                + at_arriving * arriving[i];
        }
    }

    /// The value of a track of three numbers.
    pub(crate) fn sample_vec3(&self, time_s: f32) -> Vec3 {
        let mut value = [0.0; 3];
        self.sample(time_s, &mut value);
        Vec3::from_array(value)
    }

    /// The value of a track of unit quaternions.
    pub(crate) fn sample_rotation(&self, time_s: f32) -> Quat {
        if self.interpolation == Interpolation::Linear
            && let Place::Behind(key, t, _) = self.place(time_s)
        {
            return self.rotation(key).slerp(self.rotation(key + 1), t).normalize();
        }
        let mut value = [0.0; 4];
        self.sample(time_s, &mut value);
        // A spline may pass through zero, which is no rotation; the last key's is used.
        unit(value).unwrap_or_else(|| match self.place(time_s) {
            Place::At(key) | Place::Behind(key, ..) => self.rotation(key),
        })
    }

    fn rotation(&self, key: usize) -> Quat {
        let value = self.value(key);
        unit(std::array::from_fn(|i| value[i])).unwrap_or(Quat::IDENTITY)
    }

    /// The first key whose quaternion is too short to be a rotation.
    pub(crate) fn first_zero_rotation(&self) -> Option<usize> {
        (0..self.times_s.len()).find(|&key| {
            let value = self.value(key);
            unit(std::array::from_fn(|i| value[i])).is_none()
        })
    }

    /// A lower and an upper bound of a component at all times.
    pub(crate) fn range(&self, component: usize) -> (f32, f32) {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for key in 0..self.times_s.len() {
            low = low.min(self.value(key)[component]);
            high = high.max(self.value(key)[component]);
        }
        if self.interpolation != Interpolation::CubicSpline {
            return (low, high);
        }
        // The tangents' polynomials, t³ - 2t² + t and t³ - t², reach 4/27 at most.
        let mut beyond = 0.0_f32;
        for key in 1..self.times_s.len() {
            let length_s = self.times_s[key] - self.times_s[key - 1];
            let tangents =
                self.part(key - 1, 2)[component].abs() + self.part(key, 0)[component].abs();
            beyond = beyond.max(length_s * tangents * (4.0 / 27.0));
        }
        (low - beyond, high + beyond)
    }
}

/// Normalises in f64, where the length of a finite f32 quaternion cannot overflow or underflow.
fn unit(xyzw: [f32; 4]) -> Option<Quat> {
    let v = Vec4::from_array(xyzw).as_dvec4();
    let length = v.length();
    (length.is_finite() && length > 0.0).then(|| Quat::from_vec4((v / length).as_vec4()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(
        times_s: &[f32],
        values: &[f32],
        components: usize,
        interpolation: Interpolation,
    ) -> Track {
        Track { times_s: times_s.into(), values: values.into(), components, interpolation }
    }

    fn number(track: &Track, time_s: f32) -> f32 {
        let mut value = [0.0];
        track.sample(time_s, &mut value);
        value[0]
    }

    #[test]
    fn steps_hold_until_the_next_key() {
        let track = track(&[1.0, 2.0, 4.0], &[10.0, 20.0, 40.0], 1, Interpolation::Step);
        for (time_s, value) in [
            (-1.0, 10.0),
            (0.0, 10.0),
            (1.0, 10.0),
            (1.999, 10.0),
            (2.0, 20.0),
            (3.9, 20.0),
            (4.0, 40.0),
            (99.0, 40.0),
        ] {
            assert_eq!(number(&track, time_s), value, "at {time_s} s");
        }
    }

    #[test]
    fn lines_go_from_key_to_key_and_hold_at_the_ends() {
        let track = track(&[1.0, 2.0, 4.0], &[10.0, 20.0, 40.0], 1, Interpolation::Linear);
        for (time_s, value) in
            [(0.0, 10.0), (1.0, 10.0), (1.25, 12.5), (2.0, 20.0), (3.5, 35.0), (9.0, 40.0)]
        {
            assert_eq!(number(&track, time_s), value, "at {time_s} s");
        }
    }

    #[test]
    fn of_two_keys_at_the_same_time_the_later_counts() {
        let track = track(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0], 1, Interpolation::Linear);
        assert_eq!(number(&track, 0.5), 0.5);
        assert_eq!(number(&track, 1.0), 5.0);
        assert_eq!(number(&track, 1.5), 5.5);
    }

    #[test]
    fn splines_follow_hermites_polynomial() {
        // f(x) = x³ on keys at 1 and 3: f' = 3x². A cubic is reproduced exactly.
        let values = [0.0, 1.0, 3.0, 27.0, 27.0, 0.0];
        let track = track(&[1.0, 3.0], &values, 1, Interpolation::CubicSpline);
        for x in [1.0_f32, 1.5, 2.0, 2.75, 3.0] {
            assert!((number(&track, x) - x * x * x).abs() < 1e-5, "at {x} s");
        }
        assert_eq!((number(&track, 0.0), number(&track, 7.0)), (1.0, 27.0));
    }

    #[test]
    fn splines_of_several_numbers_store_tangents_value_tangents() {
        // Two weights: w0 = x², w1 = 1 - x on keys at 0 and 2.
        let values = [
            [0.0, 0.0],  // in
            [0.0, 1.0],  // value
            [0.0, -1.0], // out: derivatives at 0
            [4.0, -1.0],
            [4.0, -1.0],
            [0.0, 0.0],
        ];
        let track = track(&[0.0, 2.0], values.as_flattened(), 2, Interpolation::CubicSpline);
        let mut weights = [0.0; 2];
        track.sample(0.5, &mut weights);
        assert!((weights[0] - 0.25).abs() < 1e-6 && (weights[1] - 0.5).abs() < 1e-6, "{weights:?}");
    }

    #[test]
    fn rotations_take_the_shorter_way_at_constant_speed() {
        let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
        // An equal rotation with the opposite sign and another length, which must not matter.
        let far = (-quarter * 3.0).to_array();
        let values = [Quat::IDENTITY.to_array(), far];
        let track = track(&[0.0, 1.0], values.as_flattened(), 4, Interpolation::Linear);
        for t in [0.0, 0.1, 1.0 / 3.0, 0.5, 0.9, 1.0] {
            let expected = Quat::from_rotation_y(t * std::f32::consts::FRAC_PI_2);
            let got = track.sample_rotation(t);
            assert!(got.dot(expected).abs() > 1.0 - 1e-6, "at {t}: {got}");
            assert!((got.length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn rotation_splines_are_brought_to_unit_length() {
        let turn = Quat::from_rotation_x(1.0).to_array();
        let zero = [0.0; 4];
        let values = [zero, Quat::IDENTITY.to_array(), zero, zero, turn, zero];
        let track = track(&[0.0, 1.0], values.as_flattened(), 4, Interpolation::CubicSpline);
        let half = track.sample_rotation(0.5);
        assert!((half.length() - 1.0).abs() < 1e-6);
        // By symmetry, the angle is halved.
        assert!(half.dot(Quat::from_rotation_x(0.5)) > 1.0 - 1e-6);
        // Between opposite quaternions the spline is zero: the last key's rotation is used.
        let opposite = [zero, Quat::IDENTITY.to_array(), zero, zero, [0.0, 0.0, 0.0, -1.0], zero];
        let through_zero = Track { values: opposite.as_flattened().into(), ..track };
        assert_eq!(through_zero.sample_rotation(0.5), Quat::IDENTITY);
    }

    #[test]
    fn value_ranges_bound_all_interpolated_values() {
        let linear = track(&[0.0, 1.0], &[-1.0, 2.0], 1, Interpolation::Linear);
        assert_eq!(linear.range(0), (-1.0, 2.0));
        // A spline that overshoots below zero between two keys at one.
        let values = [0.0, 1.0, -8.0, 8.0, 1.0, 0.0];
        let spline = track(&[0.0, 1.0], &values, 1, Interpolation::CubicSpline);
        let (low, high) = spline.range(0);
        for i in 0..=100_u8 {
            let value = number(&spline, f32::from(i) / 100.0);
            assert!((low..=high).contains(&value), "{value} not in {low}..{high}");
        }
        assert!(number(&spline, 0.5) < 0.0);
    }
}
