//! When a picture that gets better is exposed anew: measuring reads all of it back.

use std::time::Duration;

use web_time::Instant;

/// The least time between two measurements while everything moves.
const MEASURE_EVERY: Duration = Duration::from_millis(250);

/// The stops that pictures are shown with, and when they were found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Exposing {
    stops: f32,
    measured: Option<Instant>,
    /// A picture of the present state was measured.
    is_current: bool,
}

impl Exposing {
    /// Something has changed.
    pub fn start_again(&mut self) {
        self.is_current = false;
    }

    /// Whether a picture of so many frames is measured: at 1, 2, 4, 8, ... frames and at the last; while everything moves
    /// there is never more than one, and time decides.
    pub fn is_due(&self, frames: u32, is_last: bool) -> bool {
        let Some(measured) = self.measured else { return true };
        let is_step =
            frames.is_power_of_two() && (frames > 1 || measured.elapsed() >= MEASURE_EVERY);
        is_step || (is_last && !self.is_current)
    }

    /// Takes what was measured.
    pub fn measured(&mut self, stops: f32) {
        (self.stops, self.measured, self.is_current) = (stops, Some(Instant::now()), true);
    }

    /// Those of now.
    pub fn stops(&self) -> f32 {
        self.stops
    }
}
