//! Exact sums over samples, and their means and variances.
//!
//! Samples come in batches. Within a batch they are evenly spread and therefore not independent;
//! batches are independent. The GPU sums a batch in f32. Batches are added as integer multiples of
//! [`STEP`], so that the order of additions does not matter: batches traced on several machines add
//! up to the same bits as on one. The noise is estimated from the differences of the batches'
//! means: with means m of n samples each, M of all N, and B batches, the variance of a sample is
//! about sum(n (m - M)^2) / (B - 1), and the variance of the mean is that divided by N.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, UVec2};

use super::records::PixelRecord;

/// The step of all sums, 2^-64: every f32 of at least 2^-41 is a multiple of it; smaller values are
/// rounded to it.
const STEP: f64 = 1.0 / (1_u128 << 64) as f64;
/// The limit of a batch, 2^42, to which larger values and NaN are clamped: the sum over the most
/// batches (2^24 samples, 16 a batch) stays below 2^127 steps.
const MOST: f64 = (1_u64 << 42) as f64;

/// Converts a number to steps.
fn steps(value: f64) -> i128 {
    let value = if value.is_nan() { MOST } else { value.clamp(-MOST, MOST) };
    (value / STEP).round_ties_even() as i128
}

/// Converts steps to a number, rounded to f64.
fn number(steps: i128) -> f64 {
    steps as f64 * STEP
}

/// One pixel's sums, in steps of the unit of radiance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct Sums {
    pub(super) picture: [i128; 3],
    pub(super) direct: [i128; 3],
    pub(super) one_bounce: [i128; 3],
    pub(super) full: [i128; 3],
    pub(super) albedo: [i128; 3],
    pub(super) normal: [i128; 3],
    pub(super) coverage: i128,
    pub(super) depth_m: i128,
    pub(super) openness: i128,
    /// The sum over batches of n times the squared mean; for colours, the square is averaged over
    /// the channels.
    pub(super) picture_square: i128,
    pub(super) direct_square: i128,
    pub(super) one_bounce_square: i128,
    pub(super) full_square: i128,
    pub(super) openness_square: i128,
}

/// The sums of all pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Film {
    pub(super) size: UVec2,
    pub(super) samples: u32,
    /// The number of batches.
    pub(super) batches: u32,
    pub(super) sums: Vec<Sums>,
}

impl Film {
    pub(super) fn new(size: UVec2) -> Self {
        let pixels = size.x as usize * size.y as usize;
        Self { size, samples: 0, batches: 0, sums: vec![Sums::zeroed(); pixels] }
    }

    /// Adds a batch of `count` samples: for each band of rows, its first row and the GPU's sums.
    pub(super) fn add(&mut self, count: u32, bands: &[(u32, Vec<PixelRecord>)]) {
        for (first_row, pixels) in bands {
            let first = *first_row as usize * self.size.x as usize;
            for (sums, pixel) in self.sums[first..].iter_mut().zip(pixels) {
                sums.add(pixel, f64::from(count));
            }
        }
        self.samples += count;
        self.batches += 1;
    }

    /// Adds the batches of a film of the same size.
    pub(super) fn merge(&mut self, other: &Self) {
        let sums = bytemuck::cast_slice_mut::<Sums, i128>(&mut self.sums);
        for (sum, more) in sums.iter_mut().zip(bytemuck::cast_slice::<Sums, i128>(&other.sums)) {
            // A damaged file may contain any values; valid sums do not overflow.
            *sum = sum.wrapping_add(*more);
        }
        self.samples = self.samples.saturating_add(other.samples);
        self.batches = self.batches.saturating_add(other.batches);
    }

    /// The mean of a colour over samples, times a factor.
    pub(super) fn mean(&self, factor: f64, of: impl Fn(&Sums) -> [i128; 3]) -> Vec<[f32; 3]> {
        let scale = factor / f64::from(self.samples.max(1));
        self.sums.iter().map(|sums| of(sums).map(|sum| (number(sum) * scale) as f32)).collect()
    }

    /// The variance of the mean (for colours averaged over the channels), from a sum and its sum of
    /// squares; infinite with fewer than two batches.
    pub(super) fn variance(
        &self,
        factor: f64,
        of: impl Fn(&Sums) -> ([i128; 3], i128),
    ) -> Vec<f32> {
        if self.batches < 2 {
            return vec![f32::INFINITY; self.sums.len()];
        }
        let n = f64::from(self.samples);
        let scale = factor * factor / (n * f64::from(self.batches - 1));
        let variance = |sums| {
            let (sum, square) = of(sums);
            ((number(square) - mean_square(sum.map(number)) / n).max(0.0) * scale) as f32
        };
        self.sums.iter().map(variance).collect()
    }
}

impl Sums {
    fn add(&mut self, pixel: &PixelRecord, count: f64) {
        let add = |sum: &mut [i128; 3], colors: [f32; 3]| {
            *sum = std::array::from_fn(|i| sum[i] + steps(f64::from(colors[i])));
        };
        add(&mut self.picture, pixel.picture);
        add(&mut self.direct, pixel.direct);
        add(&mut self.one_bounce, pixel.one_bounce);
        add(&mut self.full, pixel.full);
        add(&mut self.albedo, pixel.albedo);
        add(&mut self.normal, pixel.normal);
        self.coverage += steps(f64::from(pixel.coverage));
        self.depth_m += steps(f64::from(pixel.depth_m));
        self.openness += steps(f64::from(pixel.openness));
        let square = |colors: [f32; 3]| steps(mean_square(colors.map(f64::from)) / count);
        self.picture_square += square(pixel.picture);
        self.direct_square += square(pixel.direct);
        self.one_bounce_square += square(pixel.one_bounce);
        self.full_square += square(pixel.full);
        self.openness_square += steps(f64::from(pixel.openness).powi(2) / count);
    }
}

fn mean_square(color: [f64; 3]) -> f64 {
    DVec3::from_array(color).length_squared() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_of_the_mean_matches_the_textbook_formula() {
        let grey = |value: f32| PixelRecord { full: [value; 3], ..PixelRecord::default() };
        let variance = |film: &Film| film.variance(2.0, |sums| (sums.full, sums.full_square))[0];
        let mut film = Film::new(UVec2::ONE);
        for value in [1.0_f32, 2.0, 4.0, 5.0] {
            film.add(1, &[(0, vec![grey(value)])]);
        }
        assert_eq!(film.mean(2.0, |sums| sums.full), [[6.0; 3]]);
        // The mean is 3, the deviations -2, -1, 1, 2: the variance is 10 / 3 for a sample, a fourth
        // of that for the mean.
        assert!((variance(&film) - 4.0 * 10.0 / 3.0 / 4.0).abs() < 1e-5);
        // Batches of two have means of 1.5 and 4.5: the variance of a sample is 2 (1.5^2 + 1.5^2) /
        // 1.
        let mut film = Film::new(UVec2::ONE);
        film.add(2, &[(0, vec![grey(3.0)])]);
        assert!(variance(&film).is_infinite());
        film.add(2, &[(0, vec![grey(9.0)])]);
        assert!((variance(&film) - 4.0 * 9.0 / 4.0).abs() < 1e-5);
    }

    /// Values of any size and sign have the same sums in any order and grouping.
    #[test]
    fn the_order_of_batches_does_not_matter() {
        let values =
            [1e-9_f32, 3e9, -0.1, 1.0 / 3.0, 7e-5, f32::INFINITY, f32::NAN, -3e9, 65_504.7];
        let film = |values: &mut dyn Iterator<Item = f32>| {
            let mut film = Film::new(UVec2::ONE);
            for value in values {
                let pixel =
                    PixelRecord { picture: [value, value / 7.0, 1.0], ..PixelRecord::default() };
                film.add(16, &[(0, vec![pixel])]);
            }
            film
        };
        let whole = film(&mut values.into_iter());
        assert!(whole == film(&mut values.into_iter().rev()));
        for cut in 0..=values.len() {
            let mut merged = film(&mut values[cut..].iter().copied());
            merged.merge(&film(&mut values[..cut].iter().copied()));
            assert!(whole == merged, "{cut}");
        }
    }

    /// NaN becomes the largest value, and usual pixel values are stored exactly.
    #[test]
    fn fixed_point_steps_store_floats_exactly() {
        for value in [1.0_f32, 1.0 / 3.0, 1e-6, 1e-12, 65_504.0, 1e12, -2.5] {
            assert_eq!(number(steps(f64::from(value))) as f32, value);
        }
        assert_eq!(number(steps(f64::NAN)), MOST);
        assert_eq!(number(steps(f64::NEG_INFINITY)), -MOST);
        assert!(((1_i128 << 20) - 1).checked_mul(steps(MOST)).is_some(), "2^20 batches");
    }
}
