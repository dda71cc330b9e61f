//! Charts, as SVG.

mod cost;
mod memory;
mod steps;

use plotters::style::RGBColor;

pub use cost::{Point, error_against_cost};
pub use memory::{MemoryPoint, memory_against_resolution};
pub use steps::{StepPanel, error_by_step};

const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(38, 38, 42);
const DIM: RGBColor = RGBColor(110, 110, 118);

/// Colours that colour-blind readers can tell apart (Okabe and Ito 2008, "Color universal design").
const SERIES: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
