//! Conversion of colours in files to linear light: sRGB (IEC 61966-2-1:1999).

/// Converts an sRGB-encoded value to a linear one, both from 0 to 1.
pub(crate) fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The inverse of [`linear_from_srgb`].
pub(super) fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Converts from CIE 1931 XYZ to linear sRGB.
#[cfg(any(feature = "obj", feature = "panoramas"))]
pub(crate) fn rgb_from_xyz(xyz: glam::Vec3) -> glam::Vec3 {
    glam::Mat3::from_cols(
        glam::Vec3::new(3.2406, -0.9689, 0.0557),
        glam::Vec3::new(-1.5372, 1.8758, -0.2040),
        glam::Vec3::new(-0.4986, 0.0415, 1.0570),
    ) * xyz
}

/// Converts the numbers of a file to linear channels.
pub(super) enum Decoder {
    /// Floats are linear.
    Float,
    /// Bytes are sRGB-encoded if they are colours; the table has the linear value of each.
    Bytes(Box<[f32; 256]>),
    /// Larger integers are shares of this largest value; colours are sRGB-encoded.
    Integers(u32),
}

impl Decoder {
    /// A decoder for integers up to `full`.
    pub(super) fn integers(full: u32) -> Self {
        if full != 255 {
            return Self::Integers(full);
        }
        let mut table = Box::new([0.0; 256]);
        for (i, linear) in table.iter_mut().enumerate() {
            *linear = linear_from_srgb(i as f32 / 255.0);
        }
        Self::Bytes(table)
    }

    /// Converts a channel that is not a colour, such as alpha.
    pub(super) fn linear(&self, value: f64) -> f32 {
        let full = match self {
            Self::Float => 1.0,
            Self::Bytes(_) => 255.0,
            Self::Integers(full) => f64::from(*full),
        };
        (value / full) as f32
    }

    /// Converts a channel of a colour.
    pub(super) fn color(&self, value: f64) -> f32 {
        match self {
            Self::Float => self.linear(value),
            // The cast saturates.
            Self::Bytes(table) => table[usize::from(value as u8)],
            Self::Integers(_) => linear_from_srgb(self.linear(value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_decoding_follows_iec_61966() {
        // IEC 61966-2-1: the code 0.5 is about a fifth of the light.
        assert!((linear_from_srgb(0.5) - 0.214_04).abs() < 1e-4);
        assert_eq!(linear_from_srgb(0.0), 0.0);
        assert!((linear_from_srgb(1.0) - 1.0).abs() < 1e-6);
        // The two pieces of the curve meet.
        assert!((linear_from_srgb(0.04045) - linear_from_srgb(0.040_451)).abs() < 1e-6);
    }

    #[test]
    fn channel_types_decide_colour_decoding() {
        let byte = Decoder::integers(255);
        assert!((byte.color(255.0) - 1.0).abs() < 1e-6);
        assert!((byte.color(128.0) - 0.2159).abs() < 1e-4);
        assert!((byte.linear(128.0) - 0.50196).abs() < 1e-4);
        let short = Decoder::integers(65535);
        assert!((short.color(32768.0) - 0.2140).abs() < 1e-4);
        let float = Decoder::Float;
        assert_eq!(float.color(0.5), 0.5);
        assert!(float.color(f64::NAN).is_nan());
    }
}
