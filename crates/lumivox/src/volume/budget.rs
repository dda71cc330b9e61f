//! How much a volume may take.

use crate::{GiError, Grid};

/// Refuses a number of bytes above a budget. `growth` is the power of the resolution by which the
/// bytes grow.
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
