//! Wall-clock times of the stages.

use std::time::Instant;

use serde::Serialize;

/// Wall-clock times of the stages.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    pub loading: f64,
    pub preparing: f64,
    pub rendering: f64,
    pub writing: f64,
    pub total: f64,
}

/// Measures [`Seconds`].
pub struct Clock {
    pub start: Instant,
    lap: Instant,
    pub seconds: Seconds,
}

impl Clock {
    /// Starts the clock.
    pub fn start() -> Self {
        let now = Instant::now();
        Self { start: now, lap: now, seconds: Seconds::default() }
    }

    /// Seconds since the last call.
    pub fn lap(&mut self) -> f64 {
        let lap = std::mem::replace(&mut self.lap, Instant::now());
        (self.lap - lap).as_secs_f64()
    }

    /// Stops the clock; the last lap counts as writing.
    pub fn stop(&mut self) -> Seconds {
        self.seconds.writing = self.lap();
        self.seconds.total = self.start.elapsed().as_secs_f64();
        self.seconds
    }
}
