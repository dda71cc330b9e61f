//! What the commands do, a file for each group.

pub mod parameters;
pub mod program;
