//! Pictures for comparison.

use glam::{UVec2, Vec3};

use super::CompareError;
use crate::picture::tone_map::{luminance, middle_grey_stops};
use crate::{Picture, ToneMap};

/// A picture of linear RGB with BT.709 primaries, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPicture {
    /// Width and height in pixels.
    pub size: UVec2,
    /// Red, green and blue, in any unit that both pictures of a comparison share.
    pub rgb: Vec<[f32; 3]>,
}

impl From<&Picture> for LinearPicture {
    fn from(picture: &Picture) -> Self {
        Self {
            size: picture.size,
            rgb: picture.hdr.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
        }
    }
}

impl LinearPicture {
    /// The stops that map the geometric mean of luminance to middle grey (Reinhard et al. 2002,
    /// "Photographic tone reproduction for digital images", equation 1); every pixel counts.
    pub fn exposure_stops(&self) -> f32 {
        let opaque: Vec<_> = self.rgb.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        middle_grey_stops(&opaque).unwrap_or(0.0)
    }

    /// The sRGB codes that a screen shows with this exposure in stops and the curve
    /// [`ToneMap::Neutral`].
    pub fn to_screen(&self, stops: f32) -> Vec<[u8; 3]> {
        let code = |rgb: [f32; 3]| rgb.map(|channel| (255.0 * channel).round() as u8);
        self.to_display(stops).map(code).collect()
    }

    /// Like [`Self::to_screen`], but as display values from 0 to 1, not rounded to codes.
    pub fn to_display(&self, stops: f32) -> impl Iterator<Item = [f32; 3]> + '_ {
        let scale = stops.exp2();
        self.rgb.iter().map(move |&rgb| ToneMap::Neutral.encode(Vec3::from(rgb) * scale).to_array())
    }

    /// The luminance of each pixel (ITU-R BT.709-6, section 3.2).
    pub(super) fn luminances(&self) -> impl Iterator<Item = f64> {
        self.rgb.iter().map(|&rgb| luminance(rgb))
    }

    /// The mean luminance.
    pub(super) fn mean_luminance(&self) -> f64 {
        self.luminances().sum::<f64>() / self.rgb.len() as f64
    }

    /// The mean over pixels and channels.
    pub(super) fn mean(&self) -> f64 {
        let sum: f64 = self.rgb.as_flattened().iter().copied().map(f64::from).sum();
        sum / (3 * self.rgb.len()) as f64
    }

    /// Checks that the number of pixels matches the size, is not zero, and that all values are
    /// finite.
    pub(super) fn check(&self, picture: &'static str) -> Result<(), CompareError> {
        check_values(picture, self.size, &self.rgb, |rgb| rgb.iter().all(|value| value.is_finite()))
    }

    /// Checks that the picture can be a reference: valid, and not black.
    pub(super) fn check_reference(&self) -> Result<(), CompareError> {
        self.check("the reference")?;
        let mean = self.mean();
        // If channels are negative, only one of the two may be above 0.
        if mean > 0.0 && self.mean_luminance() > 0.0 {
            return Ok(());
        }
        Err(CompareError::Black { mean })
    }
}

/// Checks that there is a valid value for each pixel.
pub(super) fn check_values<T: std::fmt::Debug>(
    picture: &'static str,
    size: UVec2,
    values: &[T],
    is_good: impl Fn(&T) -> bool,
) -> Result<(), CompareError> {
    let wanted = u64::from(size.x) * u64::from(size.y);
    if wanted == 0 || values.len() as u64 != wanted {
        return Err(CompareError::Pixels { picture, pixels: values.len(), size });
    }
    let Some(index) = values.iter().position(|value| !is_good(value)) else { return Ok(()) };
    let (x, y) = (index as u32 % size.x, index as u32 / size.x);
    Err(CompareError::Value { picture, x, y, value: format!("{:?}", values[index]) })
}
