//! Sums over samples in f64, and their means and variances.
//!
//! Samples come in batches, within which they are evenly spread and therefore not independent;
//! batches are. The noise follows from the differences of the batches' means: with means m of n
//! samples each, M of all N, and B batches, the variance of a sample is about sum(n (m - M)^2) / (B
//! - 1), and that of the mean is an Nth of it.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, UVec2};

use super::records::PixelRecord;

/// One pixel's sums, in multiples of the unit of radiance.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Sums {
    pub(super) picture: [f64; 3],
    pub(super) direct: [f64; 3],
    pub(super) one_bounce: [f64; 3],
    pub(super) full: [f64; 3],
    pub(super) albedo: [f64; 3],
    pub(super) normal: [f64; 3],
    pub(super) coverage: f64,
    pub(super) depth_m: f64,
    pub(super) openness: f64,
    /// The sum over batches of n times the square of the mean; for colours, the mean of the
    /// channels' squares.
    pub(super) picture_square: f64,
    pub(super) direct_square: f64,
    pub(super) one_bounce_square: f64,
    pub(super) full_square: f64,
    pub(super) openness_square: f64,
}

/// The sums of all pixels.
#[derive(Clone, Debug, PartialEq)]
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

    /// The mean of a colour, times a factor.
    pub(super) fn mean(&self, factor: f64, of: impl Fn(&Sums) -> [f64; 3]) -> Vec<[f32; 3]> {
        let scale = factor / f64::from(self.samples.max(1));
        self.sums.iter().map(|sums| of(sums).map(|sum| (sum * scale) as f32)).collect()
    }

    /// The variance of the mean (for colours the mean of the channels' variances), from a sum and
    /// its sum of squares; infinite below two batches.
    pub(super) fn variance(&self, factor: f64, of: impl Fn(&Sums) -> ([f64; 3], f64)) -> Vec<f32> {
        if self.batches < 2 {
            return vec![f32::INFINITY; self.sums.len()];
        }
        let n = f64::from(self.samples);
        let scale = factor * factor / (n * f64::from(self.batches - 1));
        let variance = |sums| {
            let (sum, square) = of(sums);
            ((square - mean_square(sum) / n).max(0.0) * scale) as f32
        };
        self.sums.iter().map(variance).collect()
    }
}

impl Sums {
    fn add(&mut self, pixel: &PixelRecord, count: f64) {
        let add = |sum: &mut [f64; 3], colors: [f32; 3]| {
            *sum = std::array::from_fn(|i| sum[i] + f64::from(colors[i]));
        };
        add(&mut self.picture, pixel.picture);
        add(&mut self.direct, pixel.direct);
        add(&mut self.one_bounce, pixel.one_bounce);
        add(&mut self.full, pixel.full);
        add(&mut self.albedo, pixel.albedo);
        add(&mut self.normal, pixel.normal);
        self.coverage += f64::from(pixel.coverage);
        self.depth_m += f64::from(pixel.depth_m);
        self.openness += f64::from(pixel.openness);
        let square = |colors: [f32; 3]| mean_square(colors.map(f64::from)) / count;
        self.picture_square += square(pixel.picture);
        self.direct_square += square(pixel.direct);
        self.one_bounce_square += square(pixel.one_bounce);
        self.full_square += square(pixel.full);
        self.openness_square += f64::from(pixel.openness).powi(2) / count;
    }
}

fn mean_square(color: [f64; 3]) -> f64 {
    DVec3::from_array(color).length_squared() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_of_the_mean_is_that_of_textbooks() {
        let grey = |value: f32| PixelRecord { full: [value; 3], ..PixelRecord::default() };
        let variance = |film: &Film| film.variance(2.0, |sums| (sums.full, sums.full_square))[0];
        let mut film = Film::new(UVec2::ONE);
        for value in [1.0_f32, 2.0, 4.0, 5.0] {
            film.add(1, &[(0, vec![grey(value)])]);
        }
        assert_eq!(film.mean(2.0, |sums| sums.full), [[6.0; 3]]);
        // The mean is 3, the deviations -2, -1, 1, 2: 10 / 3 for a sample, a fourth of it for the
        // mean.
        assert!((variance(&film) - 4.0 * 10.0 / 3.0 / 4.0).abs() < 1e-5);
        // Batches of two have a mean of 1.5 and 4.5: 2 (1.5^2 + 1.5^2) / 1 for a sample.
        let mut film = Film::new(UVec2::ONE);
        film.add(2, &[(0, vec![grey(3.0)])]);
        assert!(variance(&film).is_infinite());
        film.add(2, &[(0, vec![grey(9.0)])]);
        assert!((variance(&film) - 4.0 * 9.0 / 4.0).abs() < 1e-5);
    }
}
