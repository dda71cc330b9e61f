//! Decides when an improving picture is metered again. Metering reads the whole picture back.

use std::mem::discriminant;
use std::time::Duration;

use lumivox_render::{ExposureWarning, Histogram, Metering, Renderer, View};
use web_time::Instant;

use crate::{Explorer, ExplorerError};

/// The least time between two measurements while the scene or the camera moves.
const MEASURE_EVERY: Duration = Duration::from_millis(250);

/// The result without a renderer.
const NOTHING: Metering = Metering { stops: 0.0, warning: None, histogram: None };

/// The exposure that pictures are shown with, and when it was measured.
#[derive(Clone, Copy, Debug)]
pub struct ExposureMeter {
    last: Metering,
    measured: Option<Instant>,
    /// Frames of the last measured picture; `None` if the present state was not measured yet.
    frames: Option<u32>,
}

impl Default for ExposureMeter {
    fn default() -> Self {
        Self { last: NOTHING, measured: None, frames: None }
    }
}

impl ExposureMeter {
    /// Call this when the picture starts again.
    pub fn start_again(&mut self) {
        self.frames = None;
    }

    /// Call this when the next picture shows something else, so that it is measured in any case.
    pub fn forget(&mut self) {
        self.measured = None;
    }

    /// The stops that the picture is shown with.
    pub fn stops(&self) -> f32 {
        self.last.stops
    }

    /// The distribution of the pixels' brightness, and the stops that they are shown with.
    pub fn histogram(&self) -> Option<(Histogram, f32)> {
        Some((self.last.histogram?, self.last.stops))
    }

    /// Why the exposure is not the one that a camera would choose.
    pub fn warning(&self) -> Option<ExposureWarning> {
        self.last.warning
    }

    /// Measures the picture if a measurement is due. Returns each warning only once, not for every
    /// frame.
    ///
    /// # Errors
    /// If the device fails.
    pub async fn follow(
        &mut self,
        explorer: &Explorer,
    ) -> Result<Option<ExposureWarning>, ExplorerError> {
        if let Some(stops) = explorer.settings().exposure.fixed_stops() {
            self.last.stops = stops;
        }
        let frames = explorer.renderer().map_or(0, Renderer::frame_count);
        if !self.is_due(frames, frames >= explorer.settings().frames) {
            return Ok(None);
        }
        let metering = meter(explorer).await?;
        Ok(self.take(&metering, frames))
    }

    /// Measures only the stops of a scene's first, coarse picture; pictures of full size get a
    /// histogram and warnings.
    ///
    /// # Errors
    /// If the device fails.
    pub async fn follow_first(&mut self, explorer: &Explorer) -> Result<(), ExplorerError> {
        self.last.stops = meter(explorer).await?.stops;
        self.forget();
        Ok(())
    }

    /// The stops for another view, which is shown beside a picture of `first`. Both get the same
    /// exposure if both show light.
    ///
    /// # Errors
    /// If the device fails.
    pub async fn beside(&self, explorer: &Explorer, first: View) -> Result<f32, ExplorerError> {
        if first.is_light() && explorer.settings().view.is_light() {
            return Ok(self.last.stops);
        }
        Ok(meter(explorer).await?.stops)
    }

    /// Whether to measure: at 1, 2, 4, 8, ... frames and at the last one. In motion each picture
    /// has one frame, and is measured if [`MEASURE_EVERY`] has passed.
    fn is_due(&self, frames: u32, is_last: bool) -> bool {
        let Some(measured) = self.measured else { return true };
        if self.frames == Some(frames) {
            return false;
        }
        let is_step = frames > 1 || measured.elapsed() >= MEASURE_EVERY;
        is_last || (frames.is_power_of_two() && is_step)
    }

    fn take(&mut self, metering: &Metering, frames: u32) -> Option<ExposureWarning> {
        let before = std::mem::replace(&mut self.last, *metering);
        (self.measured, self.frames) = (Some(Instant::now()), Some(frames));
        let is_known = metering.warning.map(|w| discriminant(&w))
            == before.warning.map(|warning| discriminant(&warning));
        metering.warning.filter(|_| !is_known)
    }
}

async fn meter(explorer: &Explorer) -> Result<Metering, ExplorerError> {
    match explorer.renderer() {
        Some(renderer) => Ok(renderer.meter().await?),
        None => Ok(NOTHING),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metering(warning: Option<ExposureWarning>) -> Metering {
        Metering { stops: 2.0, warning, histogram: None }
    }

    #[test]
    fn exposure_is_metered_at_powers_of_two_frames() {
        let mut meter = ExposureMeter::default();
        let mut due = Vec::new();
        for frames in 1..=23 {
            if meter.is_due(frames, frames == 23) {
                meter.take(&metering(None), frames);
                due.push(frames);
            }
        }
        assert_eq!(due, [1, 2, 4, 8, 16, 23]);
        // An unchanged picture is not measured again.
        assert!(!meter.is_due(23, true));
        meter.start_again();
        assert!(meter.is_due(23, true));
    }

    #[test]
    fn exposure_is_metered_by_time_during_motion() {
        let mut meter = ExposureMeter::default();
        meter.take(&metering(None), 1);
        meter.start_again();
        assert!(!meter.is_due(1, false));
        meter.measured = Instant::now().checked_sub(2 * MEASURE_EVERY);
        assert!(meter.is_due(1, false) && !meter.is_due(3, false));
        meter.take(&metering(None), 1);
        meter.forget();
        assert!(meter.is_due(1, false));
    }

    #[test]
    fn a_warning_is_returned_once() {
        let mut meter = ExposureMeter::default();
        let black = Some(ExposureWarning::Black);
        let warned = [black, black, None, black].map(|warning| meter.take(&metering(warning), 1));
        assert_eq!(warned, [black, None, None, black]);
        assert_eq!((meter.stops(), meter.warning()), (2.0, black));
    }
}
