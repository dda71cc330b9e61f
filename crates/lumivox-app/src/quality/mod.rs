//! The quality of pictures: reports of comparisons, strips of pictures, and charts of error against
//! cost.

mod canvas;
mod chart;
mod measure;
mod memory_chart;
mod strip;

pub use canvas::{Align, Canvas};
pub use chart::{Point, error_against_cost};
pub use measure::{Leak, Measured, Subject, Truth, check_wish, reference};
pub use memory_chart::{MemoryPoint, memory_against_resolution};
pub use strip::{Row, strip};
