//! The curves and the screen's encoding on the CPU, for pictures that are not on the GPU. Tests
//! compare `tone_map.wgsl` with them.

use glam::Vec3;

use crate::ToneMap;
use crate::picture::srgb::srgb_encode;

impl ToneMap {
    /// Encodes a linear, already exposed colour for a screen: mapped by the curve, limited to 0..1,
    /// sRGB-encoded unless it is [`ToneMap::Raw`]. Negative values count as 0.
    pub fn encode(self, exposed: Vec3) -> Vec3 {
        let color = exposed.max(Vec3::ZERO);
        let bent = match self {
            Self::Neutral => neutral(color),
            Self::Aces => aces(color),
            Self::Linear | Self::Raw => color,
        };
        let bounded = bent.clamp(Vec3::ZERO, Vec3::ONE);
        if self == Self::Raw { bounded } else { bounded.map(srgb_encode) }
    }
}

/// Khronos 2024, "Khronos PBR Neutral Tone Mapper", section "Implementation".
fn neutral(color: Vec3) -> Vec3 {
    let least = color.min_element();
    let fresnel = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = color - fresnel;
    let peak = color.max_element();
    let start_compression = 0.8 - 0.04;
    if peak < start_compression {
        return color;
    }
    let headroom = 1.0 - start_compression;
    let new_peak = 1.0 - headroom * headroom / (peak + headroom - start_compression);
    let white = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}

/// Narkowicz 2015, "ACES filmic tone mapping curve".
fn aces(color: Vec3) -> Vec3 {
    color.map(|x| x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14))
}
