//! Radiance pictures (Ward 1991, "Real pixels", Graphics Gems II): three mantissas and an exponent.

use std::io::Cursor;

use image::ImageDecoder as _;
use image::codecs::hdr::HdrDecoder;

use super::load::{Fault, check_size};
use crate::EnvironmentMap;

pub(super) fn decode(bytes: &[u8]) -> Result<EnvironmentMap, Fault> {
    // The strict mode would refuse the signature `#?RGBE`, which many programs write.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(Fault::broken)?;
    let meta = decoder.metadata();
    let (width, height) = (meta.width, meta.height);
    check_size(width.into(), height.into(), bytes.len())?;

    let mut rgb = vec![[0.0_f32; 3]; width as usize * height as usize];
    let mut raw = vec![0_u8; rgb.len() * size_of::<[f32; 3]>()];
    decoder.read_image(&mut raw).map_err(Fault::broken)?;
    let channels = raw.chunks_exact(4).map(|b| f32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
    for (channel, value) in rgb.iter_mut().flatten().zip(channels) {
        *channel = value;
    }
    let mut map = EnvironmentMap { width, height, rgb, ..EnvironmentMap::default() };

    // Divides by the factors with which programs multiplied the file: the product of all EXPOSURE
    // lines.
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
