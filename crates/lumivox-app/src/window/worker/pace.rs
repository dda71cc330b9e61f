//! How large pictures are while the camera moves and when a scene is new, and when they are exposed anew.

use std::time::{Duration, Instant};

use lumivox_render::{ExposureWarning, Histogram, Metering};

use super::REST;

/// The least time between two measurements of the exposure while the picture changes.
const MEASURE_EVERY: Duration = Duration::from_millis(250);

/// By what the edges of the coarsest pictures are divided.
const COARSEST: u32 = 4;

/// How large pictures are while the camera moves, and when they are exposed anew.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Whether pictures may become coarser.
    pub is_allowed: bool,
    moved: Option<Instant>,
    /// Of a scene that was opened nothing was seen yet.
    pub(super) is_first: bool,
    /// What a frame of full size takes.
    pub(super) full_frame: Duration,
    pub(super) stops: f32,
    histogram: Option<Histogram>,
    /// Why the last picture is not what a camera would make of the scene.
    warned: Option<std::mem::Discriminant<ExposureWarning>>,
    measured: Option<Instant>,
    /// A picture of the present state was measured.
    pub(super) is_current: bool,
    /// Counts pictures.
    pub(super) serial: u64,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            is_allowed: true,
            moved: None,
            is_first: false,
            full_frame: Duration::ZERO,
            stops: 0.0,
            histogram: None,
            warned: None,
            measured: None,
            is_current: false,
            serial: 0,
        }
    }
}

impl Pace {
    /// The camera has moved.
    pub fn move_on(&mut self) {
        self.moved = Some(Instant::now());
    }

    /// Another scene was opened: its first picture is a coarse one, so that there is something to see.
    pub fn begin_scene(&mut self) {
        self.is_first = true;
    }

    /// Takes what was measured; a warning once for each reason, for the first frames are as dark as the last.
    pub fn measured(&mut self, metering: &Metering) -> Option<ExposureWarning> {
        self.stops = metering.stops;
        self.histogram = metering.histogram;
        self.measured = Some(Instant::now());
        let reason = metering.warning.map(|warning| std::mem::discriminant(&warning));
        let before = std::mem::replace(&mut self.warned, reason);
        metering.warning.filter(|_| reason != before)
    }

    /// How bright the pixels are, and the stops that they are shown with.
    pub fn histogram(&self) -> Option<(Histogram, f32)> {
        Some((self.histogram?, self.stops))
    }

    /// Whether it has moved a moment ago.
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|moved| moved.elapsed() < REST)
    }

    /// By what the edges of a picture are divided.
    pub(super) fn divisor(&self) -> u32 {
        if self.is_first {
            return COARSEST;
        }
        if !self.is_allowed || !self.is_moving() {
            return 1;
        }
        divisor(self.full_frame)
    }

    /// Whether the exposure is measured at a picture of this number of frames.
    pub(super) fn is_due(&self, frames: u32, is_last: bool) -> bool {
        let Some(measured) = self.measured else { return true };
        is_due(frames, is_last, measured.elapsed())
    }
}

/// At 100 ms a frame one looks at stills; a quarter of the pixels takes about a quarter of the time.
fn divisor(full_frame: Duration) -> u32 {
    match full_frame.as_millis() {
        0..100 => 1,
        100..400 => 2,
        _ => COARSEST,
    }
}

/// At 1, 2, 4, 8, ... frames and at the last; while everything moves there is never more than one, and time decides.
fn is_due(frames: u32, is_last: bool, since: Duration) -> bool {
    is_last || (frames.is_power_of_two() && (frames > 1 || since >= MEASURE_EVERY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_pictures_become_coarser_while_the_camera_moves() {
        assert_eq!([20, 150, 1000].map(|ms| divisor(Duration::from_millis(ms))), [1, 2, 4]);
        let mut pace = Pace { full_frame: Duration::from_secs(1), ..Pace::default() };
        assert_eq!(pace.divisor(), 1);
        pace.move_on();
        assert_eq!(pace.divisor(), 4);
        pace.is_allowed = false;
        assert_eq!(pace.divisor(), 1);
        // A scene's first picture is always coarse.
        pace.begin_scene();
        assert_eq!(pace.divisor(), 4);
    }

    #[test]
    fn the_exposure_is_measured_now_and_then() {
        let (soon, later) = (Duration::from_millis(10), Duration::from_millis(300));
        let due: Vec<u32> = (1..=16).filter(|frames| is_due(*frames, false, soon)).collect();
        assert_eq!(due, [2, 4, 8, 16]);
        assert!(is_due(1, false, later) && !is_due(3, false, later) && is_due(15, true, soon));
        assert!(Pace::default().is_due(1, false));
    }

    #[test]
    fn a_warning_is_told_once() {
        let mut pace = Pace::default();
        let black = Some(ExposureWarning::Black);
        let metering = |warning| Metering { stops: 2.0, warning, histogram: None };
        let told = [black, black, None, black].map(|warning| pace.measured(&metering(warning)));
        assert_eq!(told, [black, None, None, black]);
        assert_eq!(pace.stops, 2.0);
    }
}
