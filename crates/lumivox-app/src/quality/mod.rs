//! The quality of pictures: measurements, strips of pictures, and light in false colours.

mod canvas;
mod false_color;
mod measure;
mod strip;

pub use canvas::{Align, Canvas};
pub use false_color::{FalseColor, false_color_png};
pub use measure::{Leak, Measured, Subject, Truth, check_wish, reference};
pub use strip::{Row, strip, write_strip};
