//! Comparison of a picture with a reference: error figures, and an error for each pixel.
//!
//! Both pictures are linear RGB ([`LinearPicture`]), from a file or from a renderer. With `x` a
//! picture, `r` its reference and `Y` luminance (ITU-R BT.709):
//!
//! | figure | is |
//! | --- | --- |
//! | bias | `(mean x - mean r) / mean r`: whether there is too much light or too little in all |
//! | RMSE | `sqrt(mean (x - r)²) / mean r`: how much is wrong, no matter where |
//! | p95 | of the pixels' relative errors, the one that 95 % do not exceed: how bad bad places are |
//! | FLIP | what a viewer sees who flips between the two on a screen |
//! | noise | what of the RMSE is the reference's own |
//!
//! A pixel's relative error is `(Y x - Y r) / max(Y r, mean Y r / 10)`: without the tenth of the
//! mean, black corners would dominate.
//!
//! All pixels count, background included. A mask would be one more convention, and where both
//! pictures are black the background only dilutes: compare pictures that a scene fills.

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
