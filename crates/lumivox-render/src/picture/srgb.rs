//! The encoding of screens and of their pictures: sRGB, IEC 61966-2-1:1999, section 5.2.

/// The linear value of a code, both from 0 to 1.
pub(crate) fn srgb_decode(code: f32) -> f32 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// The code of a linear value, both from 0 to 1.
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
