//! Comparison of a picture with a reference: error figures, and the error of each pixel.
//!
//! Both pictures are linear RGB ([`LinearPicture`]), from a file or from a renderer. With `x` a
//! picture, `r` its reference and `Y` luminance (ITU-R BT.709):
//!
//! | figure | is |
//! | --- | --- |
//! | bias | `(mean x - mean r) / mean r`: whether the picture is too bright or too dark overall |
//! | RMSE | `sqrt(mean (x - r)²) / mean r`: the size of the error, wherever it is |
//! | p95 | the pixels' relative error that 95 % do not exceed: how bad the bad places are |
//! | FLIP | the difference seen by a viewer who flips between the two on a screen |
//! | noise | the share of the RMSE that is the reference's own noise |
//!
//! A pixel's relative error is `(Y x - Y r) / max(Y r, mean Y r / 10)`: without the lower bound of
//! a tenth of the mean, black corners would dominate.
//!
//! All pixels count, background included: a mask would be one more convention. Background that is
//! black in both pictures dilutes the figures, so compare pictures that the scene fills.

mod error;
mod figures;
#[cfg(feature = "flip")]
mod flip;
mod leak;
mod measure;
mod picture;
mod read;
pub(crate) mod voxel_sets;

pub use error::CompareError;
pub use figures::{DARKEST_SHARE, ErrorFigures, relative_errors};
#[cfg(feature = "flip")]
pub use flip::FLIP_PIXELS_PER_DEGREE;
pub use leak::leak_percent;
pub use measure::{Cost, LayerFigures, RenderedLayers, render_layers};
pub use picture::LinearPicture;
pub use read::PictureFile;
