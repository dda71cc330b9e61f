//! Errors of comparisons.

use std::path::PathBuf;

use glam::UVec2;

/// An error of a comparison. Every message names the obstacle and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The pictures have different sizes.
    #[error(
        "the reference has {}x{} pixels, the other picture {}x{}; render both at the same size",
        reference.x, reference.y, ours.x, ours.y
    )]
    Size {
        /// Width and height of the reference.
        reference: UVec2,
        /// Width and height of the picture that is compared with it.
        ours: UVec2,
    },
    /// The number of a picture's pixels does not match its size, or is 0.
    #[error("{picture} has {pixels} pixels for a size of {}x{}; give width times height, at least one", size.x, size.y)]
    Pixels {
        /// Which picture: "the reference", "the other picture" or "the variance".
        picture: &'static str,
        /// The number of its pixels.
        pixels: usize,
        /// The expected width and height.
        size: UVec2,
    },
    /// A value is infinite or NaN, or a variance is below 0.
    #[error(
        "{picture} is {value} at pixel {x},{y} (counted from 0, from the top left), which cannot be \
         compared; find out what made it"
    )]
    Value {
        /// Which picture: "the reference", "the other picture" or "the variance".
        picture: &'static str,
        /// Column, from 0 at the left.
        x: u32,
        /// Row, from 0 at the top.
        y: u32,
        /// The offending value.
        value: String,
    },
    /// The mean of the reference is not above 0, so errors cannot be relative to it.
    #[error(
        "the reference is black (its mean is {mean}), so errors cannot be given as a share of it; \
         give a reference that shows light"
    )]
    Black {
        /// Its mean over pixels and channels.
        mean: f64,
    },
    /// A picture's file cannot be read.
    #[error("{}: cannot read the picture: {reason}; {remedy}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The fault.
        reason: String,
        /// The remedy.
        remedy: &'static str,
    },
    /// An `OpenEXR` file has no layer of the requested name.
    #[error("{}: it has no layer \"{layer}\" with red, green and blue; there are: {known}", file.display())]
    Layer {
        /// The file.
        file: PathBuf,
        /// The requested layer.
        layer: String,
        /// The names of its layers.
        known: String,
    },
}
