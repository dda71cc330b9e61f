//! Measurements of the picture's light.

use lumivox_render::{Histogram, Photometry};
use serde::Serialize;
use tsify::Tsify;

/// The light at a place of the picture, as light meters measure it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Tsify)]
pub struct LightHere {
    /// The luminance of the surface as the camera sees it, in cd/m2.
    pub luminance_cd_m2: f32,
    /// The illuminance of the surface, in lux; undefined over the background, and in other views
    /// than `final`.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub illuminance_lux: Option<f32>,
}

impl From<Photometry> for LightHere {
    fn from(light: Photometry) -> Self {
        Self { luminance_cd_m2: light.luminance_cd_m2, illuminance_lux: light.illuminance_lux }
    }
}

/// The histogram of the picture's luminance.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct HistogramInfo {
    /// The number of pixels in each bin, the darkest first.
    pub bins: Vec<u32>,
    /// The number of bins per stop, which is a factor of two.
    pub bins_per_stop: usize,
    /// The start of the first bin: the logarithm to base 2 of its luminance in cd/m2.
    pub first_stop: i32,
    /// The exposure of the picture, in stops.
    pub stops: f32,
    /// The position of middle grey, in bins.
    pub middle_grey: f32,
    /// The position of white, in bins.
    pub white: f32,
    /// The share of the pixels that are brighter than white.
    pub share_above_white: f32,
}

impl HistogramInfo {
    /// The histogram of a picture with this exposure in stops.
    pub fn new(histogram: &Histogram, stops: f32) -> Self {
        Self {
            bins: histogram.bins.to_vec(),
            bins_per_stop: Histogram::BINS_PER_STOP,
            first_stop: Histogram::FIRST_STOP,
            stops,
            middle_grey: Histogram::middle_grey(stops),
            white: Histogram::white(stops),
            share_above_white: histogram.share_above_white(stops),
        }
    }
}
