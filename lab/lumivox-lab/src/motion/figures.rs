//! The figures of moving pictures, computed only from pictures.
//!
//! Pictures are linear RGB; `x` is ours and `r` the truth, `d` a difference from one step to the
//! next.
//!
//! | figure | is |
//! | --- | --- |
//! | flicker | mean of abs(d x - d r) over pixels and channels, over the mean of r |
//! | flicker on a screen | the same for display values, 0 to 1, not divided |
//! | error on a screen | root mean square of x - r in display values |
//! | latency | share of a change of mean irradiance that has arrived |
//! | trail | least-squares share of the former picture in the present one |

use lumivox_render::compare::{ErrorFigures, LinearPicture};
use serde::{Deserialize, Serialize};

use glam::UVec2;

/// The truth at one step: a picture, and the variance of each pixel's mean, averaged over channels.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    pub picture: &'a LinearPicture,
    pub variance: &'a [f32],
}

/// The median and the worst of values over steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median; for an even number, the mean of the middle two.
    pub median: f64,
    /// The value with the largest magnitude, with its sign.
    pub worst: f64,
}

/// Median, 95th percentile and worst of the cost of steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CostSpread {
    /// The median; for an even number, the mean of the middle two.
    pub median: f64,
    /// 95th percentile (nearest rank).
    pub p95: f64,
    /// The largest.
    pub worst: f64,
}

impl Spread {
    /// The spread of values; `None` without any.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let worst = values.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
        Some(Self { median: median(values)?, worst })
    }
}

impl CostSpread {
    /// The spread of values; `None` without any.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        let p95 = *values.get((values.len() * 95).div_ceil(100).checked_sub(1)?)?;
        Some(Self { median: median(values.clone())?, p95, worst: *values.last()? })
    }
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let upper = *values.get(values.len() / 2)?;
    let lower = values[(values.len() - 1) / 2];
    Some(0.5 * (lower + upper))
}

/// The flicker from one step to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flicker {
    /// Flicker without the truth's noise: `sqrt(measured² - noise²)`, or 0 if noise explains all.
    /// Exact if differences and noise are normally distributed and alike in all pixels; too low if
    /// the noise has rare bright samples.
    pub value: f64,
    /// The measured flicker, including the truth's noise.
    pub with_noise: f64,
    /// The flicker of only the truth's noise: `sqrt(2 / pi)` times the standard deviation of its
    /// difference; 0 if both steps share one truth.
    pub noise: f64,
}

impl Flicker {
    fn new(measured: f64, noise: f64) -> Self {
        let value = (measured * measured - noise * noise).max(0.0).sqrt();
        Self { value, with_noise: measured, noise }
    }
}

/// The flicker of linear light, as a share of the truth's mean over both steps; `None` if that is
/// black. `is_same_truth` is `true` if both steps share one truth, whose noise then cancels.
pub fn flicker(
    ours: [&LinearPicture; 2],
    truth: [Known<'_>; 2],
    is_same_truth: bool,
) -> Option<Flicker> {
    let mean = 0.5 * (mean(truth[0].picture) + mean(truth[1].picture));
    if mean <= 0.0 {
        return None;
    }
    let rgb = |picture: &LinearPicture| picture.rgb.clone();
    let measured = mean_change(&ours.map(rgb), &truth.map(|truth| rgb(truth.picture)));
    let noise =
        if is_same_truth { 0.0 } else { noise_of_change(truth.map(|truth| truth.variance)) };
    Some(Flicker::new(measured / mean, noise / mean))
}

/// The flicker of display values, 0 to 1, with both steps exposed by `stops`.
pub fn flicker_on_screen(
    ours: [&LinearPicture; 2],
    truth: [Known<'_>; 2],
    is_same_truth: bool,
    stops: f32,
) -> Flicker {
    let shown = |picture: &LinearPicture| picture.to_display(stops).collect::<Vec<_>>();
    let measured = mean_change(&ours.map(shown), &truth.map(|truth| shown(truth.picture)));
    let noise = if is_same_truth {
        0.0
    } else {
        let variances = truth.map(|truth| variance_on_screen(truth, stops));
        noise_of_change(variances.each_ref().map(Vec::as_slice))
    };
    Flicker::new(measured, noise)
}

/// The error of a picture on a screen, in display values from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplayError {
    /// The root mean square over pixels and channels, without the truth's noise.
    pub rmse: f64,
    /// `rmse` including the truth's noise.
    pub rmse_with_noise: f64,
    /// Our mean minus the truth's, in percent of the truth's; 0 if that is black.
    pub bias_percent: f64,
    /// The root mean square of the change since the previous step.
    pub change_rmse: f64,
}

/// The error on a screen at an exposure in stops. `ours`: the previous step's picture, and that of
/// the truth's step.
pub fn error_on_screen(ours: [&LinearPicture; 2], truth: Known<'_>, stops: f32) -> DisplayError {
    let shown = |picture: &LinearPicture| -> Vec<f64> {
        picture.to_display(stops).flatten().map(f64::from).collect()
    };
    let [before, now] = ours.map(shown);
    let right = shown(truth.picture);
    let mean_square = |a: &[f64], b: &[f64]| {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        squares / a.len().max(1) as f64
    };
    let sum = |values: &[f64]| values.iter().sum::<f64>();
    let variances = variance_on_screen(truth, stops);
    let noise =
        variances.iter().copied().map(f64::from).sum::<f64>() / variances.len().max(1) as f64;
    let measured = mean_square(&now, &right);
    let is_lit = sum(&right) > 0.0;
    DisplayError {
        rmse: (measured - noise).max(0.0).sqrt(),
        rmse_with_noise: measured.sqrt(),
        bias_percent: if is_lit { 100.0 * (sum(&now) / sum(&right) - 1.0) } else { 0.0 },
        change_rmse: mean_square(&before, &now).sqrt(),
    }
}

/// The mean over pixels and channels of abs(change of ours - change of the truth).
fn mean_change(ours: &[Vec<[f32; 3]>; 2], truth: &[Vec<[f32; 3]>; 2]) -> f64 {
    let changes = |[before, now]: &[Vec<[f32; 3]>; 2]| -> Vec<f64> {
        let channels = now.as_flattened().iter().zip(before.as_flattened());
        channels.map(|(&now, &before)| f64::from(now) - f64::from(before)).collect()
    };
    let (ours, truth) = (changes(ours), changes(truth));
    let sum: f64 = ours.iter().zip(&truth).map(|(x, r)| (x - r).abs()).sum();
    sum / ours.len().max(1) as f64
}

/// The mean absolute value of the difference of two independent noises.
fn noise_of_change(variances: [&[f32]; 2]) -> f64 {
    let deviation = |(&a, &b): (&f32, &f32)| (f64::from(a) + f64::from(b)).sqrt();
    let sum: f64 = variances[0].iter().zip(variances[1]).map(deviation).sum();
    (2.0 / std::f64::consts::PI).sqrt() * sum / variances[0].len().max(1) as f64
}

/// The variance of display values: the square of half the difference between the pixel one standard
/// deviation brighter and one darker.
fn variance_on_screen(truth: Known<'_>, stops: f32) -> Vec<f32> {
    let shifted = |sign: f32| {
        let pixels = truth.picture.rgb.iter().zip(truth.variance);
        let rgb = pixels.map(|(rgb, variance)| rgb.map(|value| value + sign * variance.sqrt()));
        LinearPicture { size: truth.picture.size, rgb: rgb.collect() }
    };
    let (darker, brighter) = (shifted(-1.0), shifted(1.0));
    let both = darker.to_display(stops).zip(brighter.to_display(stops));
    both.map(|(a, b)| {
        let squares = (0..3).map(|channel| (0.5 * (b[channel] - a[channel])).powi(2));
        squares.sum::<f32>() / 3.0
    })
    .collect()
}

/// The mean over pixels and channels.
pub fn mean(picture: &LinearPicture) -> f64 {
    let sum: f64 = picture.rgb.as_flattened().iter().copied().map(f64::from).sum();
    sum / (3 * picture.rgb.len().max(1)) as f64
}

/// The share of the change from `before` to `after` that a value has made; `None` if nothing
/// changes.
pub fn share_of_change(before: f64, after: f64, now: f64) -> Option<f64> {
    let change = after - before;
    (change.abs() > f64::EPSILON * before.abs().max(after.abs())).then(|| (now - before) / change)
}

/// The trail: the share of the picture before a change that is left. With `s` the settled picture
/// before minus that after, it is the `t` for which `after + t s` is closest to the present
/// picture. `None` if both are equal.
///
/// Noise, whose mean is 0, hardly affects `t`; nor does light that is missing or added elsewhere,
/// unless it is distributed like `s`.
pub fn trail(now: &LinearPicture, before: &LinearPicture, after: &LinearPicture) -> Option<f64> {
    let (mut along, mut square) = (0.0, 0.0);
    let channels = now.rgb.as_flattened().iter();
    let stills = before.rgb.as_flattened().iter().zip(after.rgb.as_flattened());
    for (&now, (&before, &after)) in channels.zip(stills) {
        let pattern = f64::from(before) - f64::from(after);
        along += (f64::from(now) - f64::from(after)) * pattern;
        square += pattern * pattern;
    }
    (square > 0.0).then(|| along / square)
}

/// The errors of some pixels, pooled over steps; without FLIP, which needs neighbouring pixels.
#[derive(Clone, Debug, Default)]
pub struct Pool {
    reference: Vec<[f32; 3]>,
    variance: Vec<f32>,
    ours: Vec<[f32; 3]>,
}

impl Pool {
    /// Adds the pixels of a step that are set in `mask`.
    pub fn add(&mut self, mask: &[bool], truth: Known<'_>, ours: &LinearPicture) {
        for pixel in (0..mask.len()).filter(|&pixel| mask[pixel]) {
            self.reference.push(truth.picture.rgb[pixel]);
            self.variance.push(truth.variance[pixel]);
            self.ours.push(ours.rgb[pixel]);
        }
    }

    /// The figures of all pixels; `None` if there are none or the truth is black in them.
    pub fn figures(&self) -> Option<ErrorFigures> {
        let size = UVec2::new(self.reference.len() as u32, 1);
        let row = |rgb: &[[f32; 3]]| LinearPicture { size, rgb: rgb.to_vec() };
        let figures =
            ErrorFigures::new(&row(&self.reference), Some(&self.variance), &row(&self.ours));
        figures.ok().map(|figures| ErrorFigures { flip: None, ..figures })
    }

    /// The number of pixels.
    pub fn len(&self) -> usize {
        self.ours.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(values: &[f32]) -> LinearPicture {
        let rgb = values.iter().map(|&value| [value; 3]).collect();
        LinearPicture { size: UVec2::new(values.len() as u32, 1), rgb }
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-6, "{a} is not {b}");
    }

    /// The truth's two pixels brighten by 1 and 0, ours by 1 and 2 (in the second case -2): only
    /// the difference flickers.
    #[test]
    fn flicker_counts_only_change_absent_from_the_reference() {
        let truth = [picture(&[1.0, 3.0]), picture(&[2.0, 3.0])];
        let none = [0.0; 2];
        let known = [0, 1].map(|i| Known { picture: &truth[i], variance: &none });
        let mean = 0.5 * (2.0 + 2.5);
        for (now, expected) in [([5.0, 8.0], 1.0), ([5.0, 4.0], 1.0), ([5.0, 6.0], 0.0)] {
            let ours = [picture(&[4.0, 6.0]), picture(&now)];
            let flicker = flicker([&ours[0], &ours[1]], known, false).unwrap();
            close(flicker.value, expected / mean);
            close(flicker.noise, 0.0);
        }
        let black = [picture(&[0.0]), picture(&[0.0])];
        let known = [0, 1].map(|i| Known { picture: &black[i], variance: &none[..1] });
        assert_eq!(flicker([&black[0], &black[1]], known, false), None);
    }

    /// A still, exact picture beside a noisy truth has only the flicker of the truth's noise.
    #[test]
    fn noise_of_the_reference_does_not_count_as_flicker() {
        let (count, deviation) = (20_000_u32, 0.1_f32);
        // Twelve uniform numbers less six are nearly normal (Irwin and Hall 1927).
        let mut state = 1_u64;
        let mut normal = || {
            let sum: f32 = (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    (state >> 40) as f32 / (1_u64 << 24) as f32
                })
                .sum();
            sum - 6.0
        };
        let mut noisy = || {
            let rgb = (0..count).map(|_| [0; 3].map(|_: i32| 1.0 + deviation * normal())).collect();
            LinearPicture { size: UVec2::new(count, 1), rgb }
        };
        let truth = [noisy(), noisy()];
        let variance = vec![deviation * deviation; count as usize];
        let known = [0, 1].map(|i| Known { picture: &truth[i], variance: &variance });
        let still = picture(&vec![1.0; count as usize]);
        let flicker = flicker([&still, &still], known, false).unwrap();
        let expected = (2.0 / std::f64::consts::PI).sqrt() * f64::from(deviation) * 2_f64.sqrt();
        assert!((flicker.noise - expected).abs() < 1e-3 * expected, "{flicker:?}");
        // The remainder is the error of the estimated noise.
        assert!(flicker.value < 0.2 * flicker.noise, "{flicker:?}");
        assert!((flicker.with_noise / flicker.noise - 1.0).abs() < 0.02, "{flicker:?}");
        let on_screen = flicker_on_screen([&still, &still], known, false, -2.0);
        assert!(on_screen.value < 0.3 * on_screen.noise && on_screen.noise > 0.0, "{on_screen:?}");
    }

    #[test]
    fn flicker_on_screen_ignores_changes_above_white() {
        let truth = picture(&[1.0]);
        let known = [Known { picture: &truth, variance: &[0.0] }; 2];
        let ours = [picture(&[1e6]), picture(&[2e6])];
        let flicker = flicker_on_screen([&ours[0], &ours[1]], known, true, 0.0);
        assert!(flicker.value < 1e-3, "{flicker:?}");
        let ours = [picture(&[0.0]), picture(&[1e6])];
        let flicker = flicker_on_screen([&ours[0], &ours[1]], known, true, 0.0);
        assert!(flicker.value > 0.9, "{flicker:?}");
    }

    /// One of two pixels is black instead of white: the RMSE is the root of a half. Clipped values
    /// have no noise.
    #[test]
    fn screen_errors_compare_clipped_display_values() {
        let (black, truth) = (picture(&[0.0, 0.0]), picture(&[0.0, 1e6]));
        let known = Known { picture: &truth, variance: &[0.0, 1.0] };
        let error = error_on_screen([&truth, &black], known, 0.0);
        assert!((error.rmse - 0.5_f64.sqrt()).abs() < 1e-3, "{error:?}");
        assert!((error.rmse - error.rmse_with_noise).abs() < 1e-6, "{error:?}");
        assert!((error.change_rmse - error.rmse).abs() < 1e-6, "{error:?}");
        close(error.bias_percent, -100.0);
        // Noise as large as the difference explains all of it.
        let (ours, truth) = (picture(&[0.4]), picture(&[0.3]));
        let error =
            error_on_screen([&ours, &ours], Known { picture: &truth, variance: &[0.02] }, 0.0);
        assert!(error.rmse < 0.1 * error.rmse_with_noise && error.bias_percent > 0.0, "{error:?}");
        close(error.change_rmse, 0.0);
    }

    #[test]
    fn share_of_change_is_the_completed_part() {
        assert_eq!(share_of_change(10.0, 2.0, 4.0), Some(0.75));
        assert_eq!(share_of_change(0.0, 4.0, 5.0), Some(1.25), "an overshoot");
        assert_eq!(share_of_change(3.0, 3.0, 4.0), None);
    }

    /// An exponential average leaves half of the old picture, then a quarter; light that is added
    /// evenly does not count, since the pattern has no mean.
    #[test]
    fn trail_is_the_remaining_share_of_the_old_picture() {
        let before = picture(&[5.0, 1.0, 3.0]);
        let after = picture(&[1.0, 5.0, 3.0]);
        let mixed = |left: f32| {
            let rgb = before.rgb.iter().zip(&after.rgb);
            let values: Vec<f32> =
                rgb.map(|(b, a)| left * b[0] + (1.0 - left) * a[0] + 0.5).collect();
            picture(&values)
        };
        for left in [1.0, 0.5, 0.25, 0.0] {
            close(trail(&mixed(left), &before, &after).unwrap(), left.into());
        }
        assert_eq!(trail(&after, &after, &after), None);
    }

    #[test]
    fn spreads_have_the_median_and_the_worst() {
        let spread = Spread::of([1.0, -9.0, 2.0, 3.0]).unwrap();
        assert_eq!(spread, Spread { median: 1.5, worst: -9.0 });
        assert_eq!(Spread::of([]), None);
        let cost = CostSpread::of((1..=40).rev().map(f64::from)).unwrap();
        assert_eq!(cost, CostSpread { median: 20.5, p95: 38.0, worst: 40.0 });
        assert_eq!(CostSpread::of([]), None);
    }

    #[test]
    fn pooled_errors_are_relative_to_the_pooled_mean() {
        let (truth, ours) = (picture(&[1.0, 100.0, 3.0]), picture(&[2.0, 0.0, 4.0]));
        let mut pool = Pool::default();
        let known = Known { picture: &truth, variance: &[0.0; 3] };
        assert!(pool.figures().is_none());
        pool.add(&[true, false, true], known, &ours);
        let figures = pool.figures().unwrap();
        assert_eq!(pool.len(), 2);
        close(figures.bias_percent, 50.0);
        close(figures.rmse_percent, 50.0);
    }
}
