//! Sums over samples in f64, and what they amount to.

use bytemuck::{Pod, Zeroable};
use glam::UVec2;

use super::records::PixelRecord;

/// Numbers that a pixel sums up.
const SUMS: usize = 26;

/// One pixel's sums: radiances in multiples of the unit, their squares of luminances.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct Sums {
    pub(super) picture: [f64; 3],
    pub(super) picture_square: f64,
    pub(super) direct: [f64; 3],
    pub(super) direct_square: f64,
    pub(super) one_bounce: [f64; 3],
    pub(super) one_bounce_square: f64,
    pub(super) full: [f64; 3],
    pub(super) full_square: f64,
    pub(super) albedo: [f64; 3],
    pub(super) coverage: f64,
    pub(super) normal: [f64; 3],
    pub(super) depth_m: f64,
    pub(super) openness: f64,
    pub(super) openness_square: f64,
}

/// The sums of all pixels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Film {
    pub(super) size: UVec2,
    pub(super) samples: u32,
    pub(super) sums: Vec<Sums>,
}

impl Film {
    pub(super) fn new(size: UVec2) -> Self {
        let pixels = size.x as usize * size.y as usize;
        Self { size, samples: 0, sums: vec![Sums::zeroed(); pixels] }
    }

    /// Adds what the GPU summed up over a few samples, for the rows from `first_row` on.
    pub(super) fn add(&mut self, first_row: u32, pixels: &[PixelRecord]) {
        let first = first_row as usize * self.size.x as usize;
        for (sums, pixel) in self.sums[first..].iter_mut().zip(pixels) {
            let sums: &mut [f64; SUMS] = bytemuck::cast_mut(sums);
            let numbers: &[f32; SUMS + 2] = bytemuck::cast_ref(pixel);
            for (sum, number) in sums.iter_mut().zip(numbers) {
                *sum += f64::from(*number);
            }
        }
    }

    /// The mean of a colour, times a factor.
    pub(super) fn mean(&self, factor: f64, of: impl Fn(&Sums) -> [f64; 3]) -> Vec<[f32; 3]> {
        let scale = factor / f64::from(self.samples.max(1));
        self.sums.iter().map(|sums| of(sums).map(|sum| (sum * scale) as f32)).collect()
    }

    /// The variance of the mean of a luminance, from the sums of its values and squares: the unbiased estimate.
    /// Infinite below two samples.
    pub(super) fn variance(&self, factor: f64, of: impl Fn(&Sums) -> (f64, f64)) -> Vec<f32> {
        let n = f64::from(self.samples);
        self.sums
            .iter()
            .map(|sums| {
                let (sum, square) = of(sums);
                if self.samples < 2 {
                    return f32::INFINITY;
                }
                let spread = (square - sum * sum / n).max(0.0) / (n - 1.0);
                (factor * factor * spread / n) as f32
            })
            .collect()
    }
}

/// Luminance: ITU-R BT.709-6, section 3.2.
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_of_the_mean_is_that_of_textbooks() {
        let mut film = Film::new(UVec2::ONE);
        for value in [1.0_f32, 2.0, 4.0, 5.0] {
            let grey = PixelRecord {
                full: [value; 3],
                full_square: value * value,
                ..PixelRecord::default()
            };
            film.add(0, &[grey]);
            film.samples += 1;
        }
        assert_eq!(film.mean(2.0, |sums| sums.full), [[6.0; 3]]);
        let variance = film.variance(2.0, |sums| (luminance(sums.full), sums.full_square));
        // The mean is 3, the deviations -2, -1, 1, 2: 10 / 3 for a sample, a fourth of it for the mean.
        assert!((variance[0] - 4.0 * 10.0 / 3.0 / 4.0).abs() < 1e-5, "{variance:?}");
    }
}
