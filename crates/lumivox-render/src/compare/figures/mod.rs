//! The figures of a comparison.

use serde::{Deserialize, Serialize};

use super::picture::check_values;
use super::{CompareError, LinearPicture};

/// The least divisor of a relative error, as a share of the reference's mean luminance: darker
/// pixels use it instead of their own luminance.
pub const DARKEST_SHARE: f64 = 0.1;

/// The errors of a picture against its reference. Percentages are of the reference's mean unless
/// stated otherwise; 0 is a perfect match.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct ErrorFigures {
    /// The mean over pixels and channels minus the reference's, in percent. Negative: too dark.
    pub bias_percent: f64,
    /// The root of the mean squared error over pixels and channels, in percent, after subtracting
    /// the reference's own noise: `sqrt(mse - mean variance)`, or 0 if the noise exceeds the error.
    /// The square of this figure is an unbiased estimate, except for the clamp at 0. Nothing is
    /// subtracted if the variance is unknown.
    pub rmse_percent: f64,
    /// The root of the mean squared difference from the reference, its noise included, in percent.
    pub rmse_with_noise_percent: f64,
    /// The 95th percentile of the pixels' absolute relative errors ([`relative_errors`]): the
    /// smallest value that at least 95 % of them do not exceed, in percent of each pixel's own
    /// luminance.
    pub p95_percent: f64,
    /// Mean FLIP error for screens, 0 to 1 (Andersson et al. 2020), at 67 pixels per degree. Both
    /// pictures are shown with the automatic exposure of the reference and the curve
    /// [`ToneMap::Neutral`](crate::ToneMap::Neutral). `None` without the feature `flip`.
    pub flip: Option<f64>,
    /// The noise of the reference itself: the root of the mean variance of its pixels, in percent.
    /// `None` if the variance is unknown.
    pub noise_percent: Option<f64>,
}

impl ErrorFigures {
    /// Compares `ours` with `reference`. `variance` is the variance of each reference pixel's mean
    /// over all samples (not of a single sample), averaged over the channels.
    ///
    /// # Errors
    /// [`CompareError`] when sizes differ, a value is not finite, or the reference is black.
    pub fn new(
        reference: &LinearPicture,
        variance: Option<&[f32]>,
        ours: &LinearPicture,
    ) -> Result<Self, CompareError> {
        check_pair(reference, ours)?;
        reference.check_reference()?;
        if let Some(variance) = variance {
            let is_good = |value: &f32| value.is_finite() && *value >= 0.0;
            check_values("the variance", reference.size, variance, is_good)?;
        }
        let percent = |value: f64, whole: f64| 100.0 * value / whole;
        let mean = reference.mean();
        let channels = reference.rgb.as_flattened().iter().zip(ours.rgb.as_flattened());
        let mse = mean_square(channels.map(|(&r, &x)| f64::from(x) - f64::from(r)));
        let noise = variance.map(|variance| {
            variance.iter().copied().map(f64::from).sum::<f64>() / variance.len() as f64
        });
        #[cfg(feature = "flip")]
        let flip = Some(super::flip::mean_flip(reference, ours));
        #[cfg(not(feature = "flip"))]
        let flip = None;
        Ok(Self {
            bias_percent: percent(ours.mean() - mean, mean),
            rmse_percent: percent((mse - noise.unwrap_or(0.0)).max(0.0).sqrt(), mean),
            rmse_with_noise_percent: percent(mse.sqrt(), mean),
            p95_percent: 100.0 * percentile_95(errors(reference, ours)),
            flip,
            noise_percent: noise.map(|noise| percent(noise.sqrt(), mean)),
        })
    }
}

impl ErrorFigures {
    /// The mean of several figures that share a reference; `None` if `figures` is empty.
    pub fn mean(figures: &[Self]) -> Option<Self> {
        let mean =
            |of: fn(&Self) -> f64| figures.iter().map(of).sum::<f64>() / figures.len() as f64;
        let known = |of: fn(&Self) -> Option<f64>| {
            let values: Option<Vec<f64>> = figures.iter().map(of).collect();
            values.map(|values| values.iter().sum::<f64>() / values.len() as f64)
        };
        (!figures.is_empty()).then(|| Self {
            bias_percent: mean(|figures| figures.bias_percent),
            rmse_percent: mean(|figures| figures.rmse_percent),
            rmse_with_noise_percent: mean(|figures| figures.rmse_with_noise_percent),
            p95_percent: mean(|figures| figures.p95_percent),
            flip: known(|figures| figures.flip),
            noise_percent: known(|figures| figures.noise_percent),
        })
    }
}

/// The signed relative error of each pixel, row by row from the top: the difference of luminance
/// divided by the reference's luminance, or by [`DARKEST_SHARE`] times its mean if that is larger.
/// Negative: too dark.
///
/// # Errors
/// As [`ErrorFigures::new`].
pub fn relative_errors(
    reference: &LinearPicture,
    ours: &LinearPicture,
) -> Result<Vec<f64>, CompareError> {
    check_pair(reference, ours)?;
    reference.check_reference()?;
    Ok(errors(reference, ours))
}

fn errors(reference: &LinearPicture, ours: &LinearPicture) -> Vec<f64> {
    let darkest = DARKEST_SHARE * reference.mean_luminance();
    let both = reference.luminances().zip(ours.luminances());
    both.map(|(reference, ours)| (ours - reference) / reference.max(darkest)).collect()
}

/// Checks that both pictures are valid and of one size.
pub(super) fn check_pair(
    reference: &LinearPicture,
    ours: &LinearPicture,
) -> Result<(), CompareError> {
    if reference.size != ours.size {
        return Err(CompareError::Size { reference: reference.size, ours: ours.size });
    }
    reference.check("the reference")?;
    ours.check("the other picture")
}

fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0_u64, 0.0), |(n, sum), value| (n + 1, sum + value * value));
    sum / count as f64
}

/// The nearest-rank percentile: of n sorted values, number ceil(0.95 n), counted from 1.
fn percentile_95(errors: Vec<f64>) -> f64 {
    let mut errors: Vec<f64> = errors.into_iter().map(f64::abs).collect();
    let rank = (errors.len() * 95).div_ceil(100);
    *errors.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}

#[cfg(test)]
mod tests;
