//! The size of the next picture: coarse while a scene is new, and while the camera moves if frames
//! are slow.

use std::time::Duration;

use glam::UVec2;
use web_time::Instant;

/// The camera is at rest when it has not moved for this long.
pub const REST: Duration = Duration::from_millis(300);

/// The divisor of the edges of the coarsest pictures.
const COARSEST: u32 = 4;

/// Chooses the size of the next picture.
#[derive(Clone, Copy, Debug)]
pub struct Pacing {
    /// Whether pictures may be coarser while the camera moves. Default: yes.
    pub is_allowed: bool,
    moved: Option<Instant>,
    is_first: bool,
    full_frame: Duration,
}

impl Default for Pacing {
    fn default() -> Self {
        Self { is_allowed: true, moved: None, is_first: false, full_frame: Duration::ZERO }
    }
}

impl Pacing {
    /// Notes that the user moved the camera.
    pub fn camera_moved(&mut self) {
        self.moved = Some(Instant::now());
    }

    /// Whether the camera was moved within the last [`REST`].
    pub fn is_moving(&self) -> bool {
        self.moved.is_some_and(|moved| moved.elapsed() < REST)
    }

    /// Notes that another scene was opened: its first picture is a coarse one, so that something is
    /// visible soon.
    pub fn scene_opened(&mut self) {
        self.is_first = true;
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

    /// Notes the time of a frame of full size.
    pub fn note_frame(&mut self, duration: Duration) {
        self.full_frame = duration;
    }

    /// Whether the next picture has fewer pixels than its final size.
    pub fn is_coarse(&self) -> bool {
        self.divisor() > 1
    }

    /// The size of the next picture, px.
    pub fn size(&self, full: UVec2) -> UVec2 {
        (full / self.divisor()).max(UVec2::ONE)
    }

    fn divisor(&self) -> u32 {
        if self.is_first {
            return COARSEST;
        }
        if !self.is_allowed || !self.is_moving() {
            return 1;
        }
        divisor(self.full_frame)
    }
}

/// The divisor of the edges for a frame time at full size. From 100 ms on, a user sees single
/// pictures; a quarter of the pixels takes about a quarter of the time.
fn divisor(full_frame: Duration) -> u32 {
    match full_frame.as_millis() {
        0..100 => 1,
        100..400 => 2,
        _ => COARSEST,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_pictures_become_coarser_while_the_camera_moves() {
        assert_eq!([20, 150, 1000].map(|ms| divisor(Duration::from_millis(ms))), [1, 2, 4]);
        let full = UVec2::new(640, 2);
        let mut pacing = Pacing::default();
        pacing.note_frame(Duration::from_secs(1));
        assert_eq!((pacing.size(full), pacing.is_coarse()), (full, false));
        pacing.camera_moved();
        assert_eq!((pacing.size(full), pacing.is_coarse()), (UVec2::new(160, 1), true));
        pacing.is_allowed = false;
        assert_eq!(pacing.size(full), full);
        // The first picture of a scene is always coarse.
        pacing.scene_opened();
        assert_eq!(pacing.size(full), UVec2::new(160, 1));
        pacing.first_shown();
        assert_eq!(pacing.size(full), full);
    }
}
