//! The histogram of a picture's luminance.

use super::MIDDLE_GREY;

/// Pixels counted by luminance in steps of a quarter of a stop, from 2^-14 cd/m² (a moonless night)
/// to 2^22 (an incandescent filament). Darker pixels, including black, are in the first bin,
/// brighter ones in the last.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Histogram {
    /// The number of pixels in each bin.
    pub bins: [u32; Histogram::BINS],
}

impl Histogram {
    /// Bins per stop, which is a factor of two.
    pub const BINS_PER_STOP: usize = 4;
    /// The start of the first bin: the logarithm to base 2 of its luminance in cd/m².
    pub const FIRST_STOP: i32 = -14;
    /// The number of bins: 36 stops.
    pub const BINS: usize = 36 * Self::BINS_PER_STOP;

    /// The histogram of luminances in cd/m².
    pub(crate) fn of(luminances: impl Iterator<Item = f64>) -> Self {
        let mut bins = [0; Self::BINS];
        for luminance in luminances {
            // The logarithm of black is minus infinity; the cast clamps it.
            let place = Self::place(luminance.max(0.0).log2()) as usize;
            bins[place.min(Self::BINS - 1)] += 1;
        }
        Self { bins }
    }

    /// The position of a luminance, given its base-2 logarithm, in bins from the start of the first
    /// bin.
    fn place(log2_luminance: f64) -> f64 {
        (log2_luminance - f64::from(Self::FIRST_STOP)) * Self::BINS_PER_STOP as f64
    }

    /// The position of middle grey at an exposure in stops, in bins from the start of the first
    /// bin.
    pub fn middle_grey(stops: f32) -> f32 {
        Self::place(MIDDLE_GREY.log2() - f64::from(stops)) as f32
    }

    /// The position of white, the end of the screen's range, at an exposure in stops, before a
    /// curve is applied; in bins from the start of the first bin.
    pub fn white(stops: f32) -> f32 {
        Self::place(-f64::from(stops)) as f32
    }

    /// The share of the pixels that are brighter than white at an exposure in stops, accurate to a
    /// bin.
    pub fn share_above_white(&self, stops: f32) -> f32 {
        let first = (Self::white(stops).max(0.0) as usize).min(Self::BINS);
        let sum = |bins: &[u32]| bins.iter().map(|count| u64::from(*count)).sum::<u64>();
        sum(&self.bins[first..]) as f32 / sum(&self.bins).max(1) as f32
    }
}

impl std::fmt::Debug for Histogram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let filled = self.bins.iter().enumerate().filter(|(_, count)| **count > 0);
        f.debug_map().entries(filled).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Exposure;

    #[test]
    fn histogram_bins_are_quarter_stops() {
        let histogram = Histogram::of([1.0, 1.18, 1.2, 2.0, 0.0, -1.0, f64::NAN, 1e30].into_iter());
        let at = |place: usize| histogram.bins[place];
        let one = 14 * Histogram::BINS_PER_STOP;
        assert_eq!((at(one), at(one + 1), at(one + 4)), (2, 1, 1), "{histogram:?}");
        assert_eq!((at(0), at(Histogram::BINS - 1)), (3, 1), "{histogram:?}");
        assert_eq!(histogram.bins.iter().sum::<u32>(), 8);
    }

    /// The marks of grey and white follow from the exposure.
    #[test]
    fn white_and_grey_marks_follow_the_exposure() {
        let one = 14.0 * Histogram::BINS_PER_STOP as f32;
        assert!((Histogram::white(0.0) - one).abs() < 1e-4);
        assert!((Histogram::white(3.0) - (one - 12.0)).abs() < 1e-4);
        let apart = Histogram::white(-5.0) - Histogram::middle_grey(-5.0);
        assert!((apart - 4.0 * (1.0 / 0.18_f32).log2()).abs() < 1e-4, "{apart}");
        let picture = [[300.0, 300.0, 300.0, 1.0]; 3].into_iter().chain([[1.0, 1.0, 1.0, 1.0]; 7]);
        let picture: Vec<[f32; 4]> = picture.collect();
        let metering = Exposure::Stops(-4.0).meter(&picture);
        let histogram = metering.histogram.unwrap();
        assert!((histogram.share_above_white(metering.stops) - 0.3).abs() < 1e-6);
        assert!(histogram.share_above_white(-20.0) < 1e-6);
        assert!((histogram.share_above_white(60.0) - 1.0).abs() < 1e-6);
    }
}
