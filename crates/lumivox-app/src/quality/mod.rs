//! The quality of pictures: measurements, strips of pictures, animated pictures, and charts.

mod block_noise;
mod canvas;
mod chart;
mod false_color;
mod film;
mod measure;
mod memory_chart;
mod step_chart;
mod strip;

pub use block_noise::{BLOCK, BlockNoise};
pub use canvas::{Align, Canvas};
pub use chart::{Point, error_against_cost};
pub use false_color::{FalseColor, false_color_png};
pub use film::film;
pub use measure::{Leak, Measured, Subject, Truth, check_wish, reference};
pub use memory_chart::{MemoryPoint, memory_against_resolution};
pub use step_chart::{StepPanel, error_by_step};
pub use strip::{Row, strip, write_strip};
