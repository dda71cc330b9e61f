//! The stand-in for a missing image.

use super::Pixels;
use crate::{Filter, Sampler, Texture};

/// The edge of the stand-in, in texels.
pub(in crate::load) const BOARD_EDGE: u32 = 8;

/// Texels in place of a missing image: squares of magenta and black, which are hard to overlook.
pub(in crate::load) fn board() -> Pixels {
    let texel = |i: u32| {
        let is_even = (i % BOARD_EDGE + i / BOARD_EDGE).is_multiple_of(2);
        if is_even { [255, 0, 255, 255] } else { [0, 0, 0, 255] }
    };
    let rgba8 = (0..BOARD_EDGE * BOARD_EDGE).flat_map(texel).collect();
    Pixels { width: BOARD_EDGE, height: BOARD_EDGE, rgba8 }
}

/// A texture with the texels of [`board`].
pub(in crate::load) fn checker(name: &str) -> Texture {
    let Pixels { width, height, rgba8 } = board();
    let sampler =
        Sampler { magnify: Filter::Nearest, minify: Filter::Nearest, ..Sampler::default() };
    Texture { name: format!("stand-in for {name}"), width, height, rgba8, sampler }
}
