//! FLIP, the difference that a viewer sees (Andersson et al. 2020, "FLIP: A difference evaluator
//! for alternating images", the variant for screens).

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

use super::LinearPicture;

/// Pixels per degree of the visual field: 67.02, for a screen 3840 pixels and 0.7 m wide, seen from
/// 0.7 m (Andersson et al. 2020, section 6). A lower number is stricter, as for a closer viewer.
pub const FLIP_PIXELS_PER_DEGREE: f32 = DEFAULT_PIXELS_PER_DEGREE;

/// The mean over pixels, 0 (equal) to 1. Both pictures are shown with the exposure of the
/// reference.
pub(super) fn mean_flip(reference: &LinearPicture, ours: &LinearPicture) -> f64 {
    let stops = reference.exposure_stops();
    let [reference, ours] = [reference, ours].map(|picture| {
        let screen = picture.to_screen(stops);
        FlipImageRgb8::with_data(picture.size.x, picture.size.y, screen.as_flattened())
    });
    let errors = nv_flip::flip(reference, ours, FLIP_PIXELS_PER_DEGREE);
    FlipPool::from_image(&errors).mean().into()
}
