use glam::UVec2;
use proptest::prelude::*;

use super::*;

fn picture<const N: usize>(rgb: [[f32; 3]; N]) -> LinearPicture {
    LinearPicture { size: UVec2::new(N as u32, 1), rgb: rgb.into() }
}

fn grey<const N: usize>(values: [f32; N]) -> LinearPicture {
    picture(values.map(|value| [value; 3]))
}

fn scaled(picture: &LinearPicture, factor: f32) -> LinearPicture {
    let rgb = picture.rgb.iter().map(|rgb| rgb.map(|value| value * factor)).collect();
    LinearPicture { size: picture.size, rgb }
}

/// Compares up to rounding in f64, or in the pixels' f32.
#[track_caller]
fn assert_close(actual: f64, expected: f64) {
    let tolerance = 1e-5 * expected.abs().max(1.0);
    assert!((actual - expected).abs() < tolerance, "{actual}, not {expected}");
}

#[test]
fn figures_match_a_hand_calculation() {
    // Means 2 and 2.5; squared differences 1, 0, 0, 1.
    let (reference, ours) = (grey([1.0, 2.0, 2.0, 3.0]), grey([2.0, 2.0, 2.0, 4.0]));
    let figures = ErrorFigures::new(&reference, None, &ours).expect("figures");
    assert_close(figures.bias_percent, 25.0);
    assert_close(figures.rmse_percent, 100.0 * 0.5_f64.sqrt() / 2.0);
    // Rank 4 of 4 is the first pixel, whose error is its whole luminance.
    assert_close(figures.p95_percent, 100.0);
    assert_eq!(figures.noise_percent, None);
    assert_eq!(figures.rmse_with_noise_percent, figures.rmse_percent);
    assert_eq!(figures.flip.is_some(), cfg!(feature = "flip"));
}

#[test]
fn bias_and_rmse_use_channels_and_p95_luminance() {
    let reference = picture([[1.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
    let ours = picture([[1.0, 1.0, 1.6], [1.0, 1.0, 1.0]]);
    let figures = ErrorFigures::new(&reference, None, &ours).expect("figures");
    assert_close(figures.bias_percent, 10.0);
    assert_close(figures.rmse_percent, 100.0 * (0.36_f64 / 6.0).sqrt());
    assert_close(figures.p95_percent, 60.0 * 0.0722);
}

#[test]
fn dark_pixel_errors_use_a_tenth_of_the_mean() {
    // The mean is 10, so the first pixel's divisor is 1; the second's is its own luminance, 2.
    let (reference, ours) = (grey([0.5, 2.0, 27.5]), grey([0.25, 3.0, 27.5]));
    let errors = relative_errors(&reference, &ours).expect("errors");
    for (error, expected) in errors.iter().zip([-0.25, 0.5, 0.0]) {
        assert_close(*error, expected);
    }
}

#[test]
fn the_percentile_is_one_of_the_values() {
    let percentile = |count: u32| percentile_95((1..=count).rev().map(f64::from).collect());
    for (count, expected) in [(1, 1.0), (19, 19.0), (20, 19.0), (21, 20.0), (100, 95.0)] {
        assert_eq!(percentile(count), expected, "of {count}");
    }
    assert_eq!(percentile_95(vec![-3.0, 1.0]), 3.0);
}

#[test]
fn reference_noise_is_subtracted_from_the_rmse() {
    let (reference, ours) = (grey([4.0, 4.0]), grey([5.0, 3.0]));
    let with = |variance: [f32; 2]| {
        ErrorFigures::new(&reference, Some(&variance), &ours).expect("figures")
    };
    // The mean squared error is 1, the mean variance 0.36: an error of 0.8 remains, of a mean of 4.
    let figures = with([0.6, 0.12]);
    assert_close(figures.noise_percent.expect("noise"), 15.0);
    assert_close(figures.rmse_percent, 20.0);
    assert_close(figures.rmse_with_noise_percent, 25.0);
    // A difference no larger than the noise is not an error.
    assert_eq!(with([1.0, 2.0]).rmse_percent, 0.0);
}

#[test]
fn incomparable_pictures_are_refused_with_the_reason() {
    let good = grey([1.0, 2.0]);
    let message = |reference: &LinearPicture, variance: Option<&[f32]>, ours: &LinearPicture| {
        ErrorFigures::new(reference, variance, ours).expect_err("refused").to_string()
    };
    let says = |message: String, needles: &[&str]| {
        for needle in needles {
            assert!(message.contains(needle), "no \"{needle}\" in: {message}");
        }
    };
    let tall = LinearPicture { size: UVec2::new(1, 2), ..good.clone() };
    says(message(&good, None, &tall), &["2x1", "1x2", "same size"]);
    let short = LinearPicture { size: UVec2::new(2, 1), ..grey([1.0]) };
    says(message(&good, None, &short), &["the other picture has 1 pixels", "2x1"]);
    let nothing = LinearPicture { size: UVec2::ZERO, rgb: Vec::new() };
    says(message(&nothing, None, &nothing), &["the reference has 0 pixels"]);
    let nan = LinearPicture {
        size: UVec2::new(2, 2),
        rgb: vec![[0.0; 3], [0.0; 3], [0.0; 3], [1.0, f32::NAN, 0.0]],
    };
    says(message(&nan, None, &nan), &["the reference is [1.0, NaN, 0.0]", "pixel 1,1"]);
    says(message(&good, None, &grey([f32::INFINITY, 1.0])), &["the other picture", "pixel 0,0"]);
    says(message(&good, Some(&[0.0]), &good), &["the variance has 1 pixels"]);
    says(message(&good, Some(&[0.0, -1.0]), &good), &["the variance is -1.0 at pixel 1,0"]);
    says(message(&grey([0.0, 0.0]), None, &good), &["black", "give a reference that shows light"]);
    says(message(&grey([-3.0, 1.0]), None, &good), &["its mean is -1"]);
    // The compared picture, unlike the reference, may be black.
    let figures = ErrorFigures::new(&good, None, &grey([0.0, 0.0])).expect("figures");
    assert_close(figures.bias_percent, -100.0);
}

#[cfg(feature = "flip")]
#[test]
fn flip_grows_with_the_difference() {
    let size = UVec2::new(64, 32);
    let checker = |gain: f32| {
        let value =
            |i: u32| if (i % size.x / 8 + i / size.x / 8).is_multiple_of(2) { gain } else { 0.3 };
        let rgb = (0..size.x * size.y).map(|i| [value(i), 0.4, 0.5]).collect();
        LinearPicture { size, rgb }
    };
    let flip = |gain| {
        let figures = ErrorFigures::new(&checker(0.5), None, &checker(gain)).expect("figures");
        figures.flip.expect("the feature is on")
    };
    assert_eq!(flip(0.5), 0.0);
    let (small, large) = (flip(0.55), flip(0.8));
    // FLIP is from 0 to 1; a tenth more red in half of the pixels is just visible.
    assert!(0.005 < small && 2.0 * small < large && large < 0.3, "{small} {large}");
    // A brighter picture is shown with the reference's exposure, so it looks different.
    let brighter = scaled(&checker(0.5), 4.0);
    let figures = ErrorFigures::new(&checker(0.5), None, &brighter).expect("figures");
    assert!(figures.flip > Some(0.1), "{figures:?}");
}

fn pictures() -> impl Strategy<Value = (LinearPicture, LinearPicture)> {
    (1_u32..6, 1_u32..6).prop_flat_map(|(width, height)| {
        let rgb = || {
            let pixel = [0.01_f32..100.0, 0.01_f32..100.0, 0.01_f32..100.0];
            proptest::collection::vec(pixel, (width * height) as usize)
        };
        let size = UVec2::new(width, height);
        let picture = move |rgb| LinearPicture { size, rgb };
        (rgb(), rgb()).prop_map(move |(one, other)| (picture(one), picture(other)))
    })
}

proptest! {
    #[test]
    fn a_picture_has_no_error_against_itself((reference, _) in pictures()) {
        let figures = ErrorFigures::new(&reference, None, &reference).expect("figures");
        prop_assert_eq!(figures.bias_percent, 0.0);
        prop_assert_eq!(figures.rmse_percent, 0.0);
        prop_assert_eq!(figures.p95_percent, 0.0);
        prop_assert_eq!(figures.flip.unwrap_or(0.0), 0.0);
    }

    /// Powers of two scale floats exactly, and exposure cancels the scale.
    #[test]
    fn scaling_both_pictures_does_not_change_errors((reference, ours) in pictures(), stops in -20_i32..20) {
        let factor = (stops as f32).exp2();
        let variance: Vec<f32> = reference.rgb.iter().map(|rgb| rgb[0]).collect();
        let scaled_variance: Vec<f32> = variance.iter().map(|v| v * factor * factor).collect();
        let plain = ErrorFigures::new(&reference, Some(&variance), &ours).expect("figures");
        let [r, x] = [&reference, &ours].map(|picture| scaled(picture, factor));
        let other = ErrorFigures::new(&r, Some(&scaled_variance), &x).expect("figures");
        prop_assert_eq!(plain.bias_percent, other.bias_percent);
        prop_assert_eq!(plain.rmse_percent, other.rmse_percent);
        prop_assert_eq!(plain.p95_percent, other.p95_percent);
        prop_assert_eq!(plain.noise_percent, other.noise_percent);
        prop_assert_eq!(plain.rmse_with_noise_percent, other.rmse_with_noise_percent);
        // Stops are rounded, so an 8-bit code may change.
        let change = plain.flip.unwrap_or(0.0) - other.flip.unwrap_or(0.0);
        prop_assert!(change.abs() < 0.02, "{plain:?} {other:?}");
    }

    #[test]
    fn scaling_a_picture_gives_that_much_bias((reference, _) in pictures(), factor in 0.1_f32..3.0) {
        let figures = ErrorFigures::new(&reference, None, &scaled(&reference, factor));
        let figures = figures.expect("figures");
        let expected = 100.0 * (f64::from(factor) - 1.0);
        prop_assert!((figures.bias_percent - expected).abs() < 1e-3);
        // Dark pixels have a smaller error, all others this one.
        prop_assert!(figures.p95_percent <= expected.abs() + 1e-3);
        prop_assert!(figures.rmse_percent >= figures.bias_percent.abs() - 1e-3);
    }
}
