//! How good pictures are: what is reported of a comparison, strips of pictures to look at, and charts
//! of error against cost.

mod canvas;
#[cfg_attr(
    not(test),
    expect(dead_code, reason = "the command that measures several presets will draw them")
)]
mod chart;
mod measure;
mod report;
mod strip;

pub use measure::{Measured, Subject, reference};
pub use report::Comparison;
pub use strip::{Row, strip};
