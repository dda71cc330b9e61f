//! How bright the picture is.

use lumivox_render::{Histogram, Photometry};
use serde::Serialize;
use tsify::Tsify;

/// The light at a place of the picture, as meters measure it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Tsify)]
pub struct LightHere {
    /// The luminance that a camera sees there, in cd/m2.
    pub luminance_cd_m2: f32,
    /// The illuminance of the surface there, in lux; none over the background, and in other views
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

/// The picture's pixels by their luminance.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct HistogramInfo {
    /// How many pixels are in each bin, the darkest first.
    pub bins: Vec<u32>,
    /// Bins to a stop, a factor of two.
    pub bins_per_stop: usize,
    /// Where the first bin begins: the logarithm to base 2 of its luminance in cd/m2.
    pub first_stop: i32,
    /// Stops by which the picture is exposed.
    pub stops: f32,
    /// Where the exposure puts a middle grey, in bins.
    pub middle_grey: f32,
    /// Where it puts white, in bins.
    pub white: f32,
    /// The share of the pixels that are brighter.
    pub share_above_white: f32,
}

impl HistogramInfo {
    /// The figures of a picture that is exposed by so many stops.
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
