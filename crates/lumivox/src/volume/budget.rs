//! Memory budget of a volume.

use crate::{GiError, Grid};

/// Returns an error if a number of bytes exceeds the budget. The bytes are proportional to the
/// resolution to the power `growth`.
pub(super) fn check(
    what: &str,
    needed: u64,
    budget: Option<u64>,
    grid: &Grid,
    growth: f64,
) -> Result<(), GiError> {
    let Some(budget) = budget.filter(|budget| needed > *budget) else {
        return Ok(());
    };
    let resolution = grid.dimensions.max_element();
    let share = (budget as f64 / needed as f64).powf(1.0 / growth);
    let fitting = (f64::from(resolution) * share) as u32 / 8 * 8;
    let remedy = if fitting >= crate::MIN_RESOLUTION {
        format!("allow more, or set the resolution to about {fitting}")
    } else {
        "allow more".to_owned()
    };
    Err(GiError::Budget { what: what.to_owned(), needed, budget, remedy })
}
