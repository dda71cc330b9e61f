//! Radiance pictures (Ward 1991, "Real pixels", Graphics Gems II): three mantissas and an exponent.

use std::borrow::Cow;
use std::io::{Cursor, ErrorKind};

use image::ImageDecoder as _;
use image::codecs::hdr::HdrDecoder;

use super::load::{Fault, check_size};
use crate::EnvironmentMap;
use crate::load::color::rgb_from_xyz;

pub(super) fn decode(bytes: &[u8]) -> Result<EnvironmentMap, Fault> {
    let bytes = with_line_feeds(bytes)?;
    let (bytes, [is_upside_down, is_mirrored, has_columns], is_xyz) = plain(&bytes);
    let bytes = &*bytes;
    // The strict mode would refuse the signature `#?RGBE`, which many programs write.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(Fault::broken)?;
    let meta = decoder.metadata();
    let (mut width, mut height) = (meta.width, meta.height);
    check_size(width.into(), height.into(), bytes.len())?;

    let mut rgb = vec![[0.0_f32; 3]; width as usize * height as usize];
    let mut raw = vec![0_u8; rgb.len() * size_of::<[f32; 3]>()];
    decoder.read_image(&mut raw).map_err(|error| match error {
        image::ImageError::IoError(error) if error.kind() == ErrorKind::UnexpectedEof => {
            Fault::broken("it was cut off: it ends before its last row of texels")
        }
        error => Fault::broken(error),
    })?;
    let channels = raw.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
    for (channel, value) in rgb.iter_mut().flatten().zip(channels) {
        *channel = value;
    }
    if has_columns {
        let texels = std::mem::take(&mut rgb);
        let column = |x: u32| texels.iter().skip(x as usize).step_by(width as usize);
        rgb = (0..width).flat_map(column).copied().collect();
        (width, height) = (height, width);
    }
    if is_xyz {
        for texel in &mut rgb {
            *texel = rgb_from_xyz((*texel).into()).into();
        }
    }
    if is_upside_down {
        // Reverses the order of the rows, and each row; unless the picture is mirrored, too, each
        // row is reversed again below.
        rgb.reverse();
    }
    if is_upside_down != is_mirrored {
        rgb.chunks_exact_mut(width as usize).for_each(<[_]>::reverse);
    }
    let mut map = EnvironmentMap { width, height, rgb, ..EnvironmentMap::default() };

    // Divides by the factors that programs have already applied: the product of all EXPOSURE lines.
    let exposure = meta.exposure.unwrap_or(1.0);
    let (r, g, b) = meta.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let divisor = [r * exposure, g * exposure, b * exposure];
    if divisor.iter().any(|d| !d.is_normal() || *d < 0.0) {
        let told =
            "the environment map's EXPOSURE or COLORCORR is not a positive number; it was ignored";
        map.warnings.push(told.to_owned());
    } else if divisor.iter().any(|d| d.to_bits() != 1.0_f32.to_bits()) {
        for texel in &mut map.rgb {
            *texel = std::array::from_fn(|i| texel[i] / divisor[i]);
        }
    }
    if meta.custom_attributes.iter().any(|(key, _)| key == "PRIMARIES") {
        let told = "the environment map's PRIMARIES were ignored: its colours count as linear sRGB";
        map.warnings.push(told.to_owned());
    }
    Ok(map)
}

/// Changes the line endings of the header to LF.
fn with_line_feeds(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Fault> {
    let (mut head, mut rest, mut is_header, mut is_changed) = (Vec::new(), bytes, true, false);
    // The line after the header's empty line gives the size.
    loop {
        let end = rest.iter().position(|&byte| byte == b'\n').ok_or_else(|| {
            Fault::broken("it was cut off: it ends before the texels, within its header")
        })?;
        let line = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
        is_changed |= line.len() < end;
        if is_header && matches!(line, [b'-' | b'+', b'X' | b'Y', b' ', ..]) {
            let reason = "its header lacks the empty line before the size";
            return Err(Fault::broken(reason));
        }
        head.extend_from_slice(line);
        head.push(b'\n');
        rest = &rest[end + 1..];
        if !is_header {
            break;
        }
        is_header = !line.is_empty();
    }
    if !is_changed {
        return Ok(Cow::Borrowed(bytes));
    }
    head.extend_from_slice(rest);
    Ok(Cow::Owned(head))
}

/// Changes the header to the only form that the decoder reads: RGB, in rows from the top and from
/// the left. Also returns if the picture is upside down, mirrored, or in columns; and if its
/// colours are CIE XYZ.
fn plain(bytes: &[u8]) -> (Cow<'_, [u8]>, [bool; 3], bool) {
    let begin = bytes.windows(2).position(|pair| pair == b"\n\n").map_or(0, |at| at + 2);
    let line = bytes[begin..].split(|&byte| byte == b'\n').next().unwrap_or_default();
    // The line after the header has a sign before each axis.
    let axis = |letter| line.iter().position(|&byte| byte == letter)?.checked_sub(1);
    let xyze = bytes[..begin].windows(22).position(|text| text == b"FORMAT=32-bit_rle_xyze");
    let mut layout = [false; 3];
    let mut plain = Cow::Borrowed(bytes);
    if let Some(at) = xyze {
        plain.to_mut()[at + 18..at + 22].copy_from_slice(b"rgbe");
    }
    if let (Some(x), Some(y)) = (axis(b'X'), axis(b'Y')) {
        layout = [line[y] == b'+', line[x] == b'-', x < y];
        if layout.contains(&true) {
            for (at, axis) in [(x.min(y), b"-Y"), (x.max(y), b"+X")] {
                plain.to_mut()[begin + at..begin + at + 2].copy_from_slice(axis);
            }
        }
    }
    (plain, layout, xyze.is_some())
}
