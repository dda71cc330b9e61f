//! The schedule of two pictures side by side, which one renderer makes in turn.
//!
//! After a change each side gets one frame, so that both show the same moment; then the left is
//! completed, then the right, and both stay until something changes. Alternating all the time would
//! restart both means at every frame, and neither picture would improve.

/// One of two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The picture itself.
    Left,
    /// The picture that it is compared with.
    Right,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// One frame of the left.
    #[default]
    FirstLeft,
    /// One frame of the right.
    FirstRight,
    /// The rest of the left.
    Left,
    /// The rest of the right.
    Right,
    Complete,
}

/// Which of the two is rendered next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplitSchedule {
    phase: Phase,
}

impl SplitSchedule {
    /// The side of the next frame; `None` when both are complete.
    pub fn next(&self) -> Option<Side> {
        match self.phase {
            Phase::FirstLeft | Phase::Left => Some(Side::Left),
            Phase::FirstRight | Phase::Right => Some(Side::Right),
            Phase::Complete => None,
        }
    }

    /// Advances after the turn of [`Self::next`]. `has_rendered`: it had a frame to render;
    /// `is_changing`: the next frames differ, as while an animation plays.
    pub fn advance(&mut self, has_rendered: bool, is_changing: bool) {
        self.phase = match self.phase {
            Phase::FirstLeft => Phase::FirstRight,
            Phase::FirstRight if is_changing => Phase::FirstLeft,
            Phase::FirstRight => Phase::Left,
            Phase::Left if !has_rendered => Phase::Right,
            Phase::Right if !has_rendered => Phase::Complete,
            phase => phase,
        };
    }

    /// Starts both pictures again.
    pub fn start_again(&mut self) {
        self.phase = Phase::FirstLeft;
    }

    /// Notes that the scene has changed by itself: both pictures start again once both show the
    /// last change.
    pub fn scene_changed(&mut self) {
        if self.phase != Phase::FirstRight {
            self.phase = Phase::FirstLeft;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sides that are rendered until both pictures of `frames` frames are complete.
    fn sides(schedule: &mut SplitSchedule, frames: u32) -> String {
        let mut left = [frames; 2];
        let mut sides = String::new();
        while let Some(side) = schedule.next() {
            let (rest, letter) = match side {
                Side::Left => (&mut left[0], 'l'),
                Side::Right => (&mut left[1], 'r'),
            };
            let has_rendered = *rest > 0;
            if has_rendered {
                *rest -= 1;
                sides.push(letter);
            }
            schedule.advance(has_rendered, false);
        }
        sides
    }

    #[test]
    fn each_side_gets_one_frame_before_either_is_completed() {
        let mut schedule = SplitSchedule::default();
        assert_eq!(sides(&mut schedule, 3), "lrllrr");
        assert_eq!(schedule.next(), None);
        schedule.start_again();
        assert_eq!(sides(&mut schedule, 1), "lr");
    }

    #[test]
    fn sides_alternate_while_the_scene_keeps_changing() {
        let mut schedule = SplitSchedule::default();
        let sides: Vec<_> = (0..4)
            .map(|_| {
                schedule.scene_changed();
                let side = schedule.next();
                schedule.advance(true, true);
                side
            })
            .collect();
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        assert_eq!(sides, [left, right, left, right]);
    }
}
