//! The size of the next picture: coarse for a new scene, and in motion if frames exceed their
//! budget.
//!
//! Each size has half the pixels of the next finer one, and takes about half the time. A coarser
//! size is chosen after some frames over the budget, as coarse as their times require; a finer one
//! only after more frames so fast that twice the pixels would fit well within the budget. So a
//! single slow frame changes nothing, and sizes do not alternate. The chosen size is kept for the
//! next motion. At rest the size is the full one.

use std::time::Duration;

use glam::UVec2;
use web_time::Instant;

/// The scene is at rest when nothing has changed for this long since the last change was seen.
pub const REST: Duration = Duration::from_millis(300);

/// The default of [`Pacing::budget_ms`]: 30 frames a second.
pub const FRAME_BUDGET_MS: f32 = 33.0;

/// The longest budget, ms: a user who accepts such frames wants the whole picture.
pub const LONGEST_BUDGET_MS: f32 = 10_000.0;

/// The coarsest step: a sixteenth of the pixels.
const COARSEST: u32 = 4;

/// Frames over the budget before pictures become coarser.
const COARSER_AFTER: u32 = 3;
/// Frames well below the budget before pictures become finer.
const FINER_AFTER: u32 = 8;
/// The share of the budget that the finer picture may take.
const HEADROOM: f32 = 0.8;

/// Chooses the size of the next picture.
#[allow(clippy::struct_excessive_bools)] // Each is one thing that was noted.
#[derive(Clone, Copy, Debug)]
pub struct Pacing {
    /// The time that a frame may take while something moves, in milliseconds, up to
    /// [`LONGEST_BUDGET_MS`]; at 0 pictures are never coarser. Default: [`FRAME_BUDGET_MS`]. Lower:
    /// smoother motion, with fewer pixels.
    pub budget_ms: f32,
    /// Time at which the last change was shown, or made if not shown yet.
    changed: Option<Instant>,
    /// Whether the last change is not shown yet.
    is_awaited: bool,
    /// Whether the last change was part of a motion.
    is_motion: bool,
    is_first: bool,
    /// The step of pictures in motion: each step halves the pixels.
    step: u32,
    /// The step of the present picture.
    shown: u32,
    /// Whether the present frame is the first one of its size.
    is_resized: bool,
    /// Frames in a row that were over the budget, or well below it.
    over: u32,
    below: u32,
}

impl Default for Pacing {
    fn default() -> Self {
        Self {
            budget_ms: FRAME_BUDGET_MS,
            changed: None,
            is_awaited: false,
            is_motion: false,
            is_first: false,
            step: 0,
            shown: 0,
            is_resized: false,
            over: 0,
            below: 0,
        }
    }
}

impl Pacing {
    /// Notes that the user drags the camera.
    pub fn camera_dragged(&mut self) {
        self.note_change(true);
    }

    /// Notes that the camera, lights, objects or time have changed. A motion is a change within
    /// [`REST`] of the previous one.
    pub fn scene_changed(&mut self) {
        self.note_change(self.has_just_changed());
    }

    fn note_change(&mut self, is_motion: bool) {
        self.changed = Some(Instant::now());
        self.is_awaited = true;
        self.is_motion = is_motion;
    }

    fn has_just_changed(&self) -> bool {
        self.changed.is_some_and(|changed| changed.elapsed() < REST)
    }

    /// Whether something is moving, or came to rest less than [`REST`] ago.
    pub fn is_moving(&self) -> bool {
        self.is_motion && self.has_just_changed()
    }

    /// Notes that another scene was opened: its first picture is a coarse one, so that something is
    /// visible soon.
    pub fn scene_opened(&mut self) {
        *self = Self { budget_ms: self.budget_ms, is_first: true, ..Self::default() };
    }

    /// Notes that the first picture of a scene is shown, or is not wanted.
    pub fn first_shown(&mut self) {
        self.is_first = false;
    }

    /// Whether the next picture is the first one of a scene; its settings are those of
    /// [`first_look`](crate::first_look).
    pub fn is_first(&self) -> bool {
        self.is_first
    }

    /// Notes the time of a frame of the last [`Self::next_size`].
    pub fn note_frame(&mut self, duration: Duration) {
        if std::mem::take(&mut self.is_awaited) {
            self.changed = Some(Instant::now());
        }
        // The first frame of a size makes its textures.
        if std::mem::take(&mut self.is_resized) || self.is_first || self.budget_ms <= 0.0 {
            return;
        }
        // The time of a picture in motion, scaled by pixels.
        let ms = duration.as_secs_f32() * 1e3 * pixels(self.step) / pixels(self.shown);
        let is_over = ms > self.budget_ms;
        // Frames at rest do not include the costs that only motion has.
        let is_below = self.is_moving() && 2.0 * ms < HEADROOM * self.budget_ms;
        self.over = if is_over { self.over + 1 } else { 0 };
        self.below = if is_below { self.below + 1 } else { 0 };
        if self.over == COARSER_AFTER {
            let steps = (ms / self.budget_ms).log2().ceil().max(1.0) as u32;
            self.step = self.step.saturating_add(steps).min(COARSEST);
        } else if self.below == FINER_AFTER {
            self.step = self.step.saturating_sub(1);
        } else {
            return;
        }
        (self.over, self.below) = (0, 0);
    }

    /// Whether the next picture has fewer pixels than its final size.
    pub fn is_coarse(&self) -> bool {
        self.next_step() > 0
    }

    /// The width and height of the present picture as a share of its final size.
    pub fn scale(&self) -> f32 {
        pixels(self.shown).sqrt()
    }

    /// The size of the next picture, px.
    pub fn next_size(&mut self, full: UVec2) -> UVec2 {
        let step = self.next_step();
        self.is_resized |= step != self.shown;
        self.shown = step;
        (full.as_vec2() * self.scale()).round().as_uvec2().max(UVec2::ONE)
    }

    fn next_step(&self) -> u32 {
        if self.is_first {
            return COARSEST;
        }
        if self.budget_ms > 0.0 && self.is_moving() { self.step } else { 0 }
    }
}

/// The share of the pixels at a step.
fn pixels(step: u32) -> f32 {
    0.5_f32.powi(step as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: UVec2 = UVec2::new(640, 2);

    /// The widths of pictures in a motion, from the time of each frame at full size, ms.
    fn widths(pacing: &mut Pacing, full_ms: impl IntoIterator<Item = f32>) -> Vec<u32> {
        let frames = full_ms.into_iter().map(|ms| {
            pacing.camera_dragged();
            let size = pacing.next_size(FULL);
            pacing.note_frame(Duration::from_secs_f32(1e-3 * ms * pacing.scale().powi(2)));
            size.x
        });
        frames.collect()
    }

    #[test]
    fn slow_frames_lower_the_resolution_of_motion() {
        let mut pacing = Pacing::default();
        let slow = widths(&mut pacing, [100.0; 60]);
        // A quarter of the pixels takes 25 ms of 33; half would take 50.
        assert_eq!(slow[..4], [640, 640, 640, 320]);
        assert!(slow[4..].iter().all(|width| *width == 320), "{slow:?}");
        // At rest, all pixels; the next motion starts with the last one's size.
        pacing.changed = pacing.changed.and_then(|changed| changed.checked_sub(REST));
        assert_eq!((pacing.next_size(FULL), pacing.is_coarse()), (FULL, false));
        assert_eq!(widths(&mut pacing, [100.0]), [320]);
        // Frames at rest make it coarser, but not finer.
        for (ms, width) in [(1.0, 320), (1000.0, 160)] {
            pacing.is_motion = false;
            for _ in 0..40 {
                assert_eq!(pacing.next_size(FULL), FULL);
                pacing.note_frame(Duration::from_secs_f32(1e-3 * ms));
            }
            pacing.camera_dragged();
            assert_eq!(pacing.next_size(FULL).x, width);
        }
    }

    #[test]
    fn resolution_does_not_oscillate_between_sizes() {
        // Occasional slow frames change nothing.
        let mut pacing = Pacing::default();
        let spikes = widths(&mut pacing, (0..60).map(|i| if i % 3 == 0 { 500.0 } else { 20.0 }));
        assert!(spikes.iter().all(|width| *width == 640), "{spikes:?}");
        // At any constant cost a motion reaches one size.
        for ms in (5..600).step_by(5) {
            let mut pacing = Pacing::default();
            let all = widths(&mut pacing, [ms as f32; 80]);
            let changes = all.windows(2).filter(|pair| pair[0] != pair[1]).count();
            assert!(changes <= 1, "{ms} ms: {all:?}");
            let is_within = ms as f32 * pacing.scale().powi(2) <= pacing.budget_ms;
            assert!(is_within || all[79] == 160, "{ms} ms: {all:?}");
        }
        // Once frames are cheap again, pictures become finer step by step.
        let mut pacing = Pacing::default();
        widths(&mut pacing, [400.0; 10]);
        let cheap = widths(&mut pacing, [10.0; 60]);
        assert!(cheap[0] == 160 && cheap.is_sorted() && cheap[59] == 640, "{cheap:?}");
        assert!(cheap[..FINER_AFTER as usize].iter().all(|width| *width == 160));
    }

    #[test]
    fn a_single_change_does_not_count_as_motion() {
        let mut pacing = Pacing { step: 2, ..Pacing::default() };
        pacing.scene_changed();
        assert!(!pacing.is_moving() && !pacing.is_coarse());
        // However long that change's frame took, the next change is part of a motion.
        pacing.changed = pacing.changed.and_then(|changed| changed.checked_sub(2 * REST));
        pacing.note_frame(2 * REST);
        pacing.scene_changed();
        assert!(pacing.is_moving() && pacing.is_coarse());
        pacing.budget_ms = 0.0;
        assert_eq!((pacing.is_moving(), pacing.next_size(FULL)), (true, FULL));
        // The first picture of a scene is always coarse.
        pacing.scene_opened();
        assert_eq!((pacing.next_size(FULL).x, pacing.budget_ms), (160, 0.0));
        pacing.first_shown();
        assert_eq!(pacing.next_size(FULL), FULL);
    }
}
