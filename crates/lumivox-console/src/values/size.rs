//! The size of a picture.

use glam::UVec2;

use super::Refused;

/// The longest edge of a 2D texture on any GPU today, in pixels. The GPU in use may allow less.
pub const LONGEST_EDGE: u32 = 32_768;

/// `WIDTHxHEIGHT` in pixels.
pub fn size(text: &str) -> Result<UVec2, Refused> {
    let malformed =
        || Refused::Malformed("expected WIDTHxHEIGHT in pixels, such as 640x360".to_owned());
    let (width, height) = text.trim().split_once(['x', 'X']).ok_or_else(malformed)?;
    let edge = |text: &str| {
        let digits = text.strip_prefix('-').unwrap_or(text);
        if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return Err(malformed());
        }
        text.parse().ok().filter(|edge| (1..=LONGEST_EDGE).contains(edge)).ok_or_else(|| {
            Refused::OutOfRange(format!("width and height must be from 1 to {LONGEST_EDGE} pixels"))
        })
    };
    Ok(UVec2::new(edge(width)?, edge(height)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_parse_as_width_and_height() {
        assert_eq!(size("640x360"), Ok(UVec2::new(640, 360)));
        assert_eq!(size("1X32768"), Ok(UVec2::new(1, 32_768)));
        for text in ["0x0", "0x5", "5x0", "100000x100000", "99999999999999x1", "32769x1", "-1x5"] {
            assert!(matches!(size(text), Err(Refused::OutOfRange(_))), "{text}");
        }
        for text in ["", "x", "640", "640x", "-x5", "640x360x2", "1.5x2", "640 x 360", "axb"] {
            assert!(matches!(size(text), Err(Refused::Malformed(_))), "{text}");
        }
    }
}
