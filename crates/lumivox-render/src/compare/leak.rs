//! Light that passes through walls.

use super::figures::check_pair;
use super::{CompareError, LinearPicture};

/// Light that leaks into a dark room through its walls, in percent of the light in the adjacent
/// room.
///
/// It is the mean over the dark room's pixels of the excess luminance, `max(0, Y ours - Y
/// reference)`, divided by the mean luminance of the reference in the lit room. Pixels of the dark
/// reference that are too low because of noise count as leaks, so let the reference converge.
///
/// # Errors
/// [`CompareError`] when the two dark pictures differ in size, a value is not finite, or the lit
/// room is black. The dark reference may be black.
pub fn leak_percent(
    dark_reference: &LinearPicture,
    dark_ours: &LinearPicture,
    lit_reference: &LinearPicture,
) -> Result<f64, CompareError> {
    check_pair(dark_reference, dark_ours)?;
    lit_reference.check_reference()?;
    let excess = dark_reference.luminances().zip(dark_ours.luminances());
    let excess: f64 = excess.map(|(reference, ours)| (ours - reference).max(0.0)).sum();
    let mean = excess / dark_reference.rgb.len() as f64;
    Ok(100.0 * mean / lit_reference.mean_luminance())
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    fn grey<const N: usize>(values: [f32; N]) -> LinearPicture {
        LinearPicture { size: UVec2::new(N as u32, 1), rgb: values.map(|v| [v; 3]).into() }
    }

    #[test]
    fn leak_counts_only_pixels_that_are_too_bright() {
        let lit = grey([5.0, 15.0, 10.0]);
        // One of four pixels is 0.4 too bright: 0.1 on average, against a mean of 10 in the lit
        // room.
        let (reference, ours) = (grey([0.0, 0.0, 0.5, 1.0]), grey([0.0, 0.4, 0.5, 0.2]));
        let percent = leak_percent(&reference, &ours, &lit);
        let percent = percent.expect("a share");
        assert!((percent - 1.0).abs() < 1e-6, "{percent}");
        let dark = grey([0.0, 0.0]);
        assert_eq!(leak_percent(&dark, &dark, &lit).expect("a share"), 0.0);
    }

    #[test]
    fn leak_needs_a_lit_reference_room() {
        let dark = grey([0.0]);
        let error = leak_percent(&dark, &dark, &dark).expect_err("no light to leak");
        assert!(matches!(error, CompareError::Black { .. }), "{error}");
        let error = leak_percent(&dark, &grey([0.0, 0.0]), &grey([1.0])).expect_err("other sizes");
        assert!(matches!(error, CompareError::Size { .. }), "{error}");
    }
}
