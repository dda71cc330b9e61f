//! Schedules gathers: which faces gather in a frame, from each change until light has converged.

use crate::Grid;
use crate::cones::TraceSettings;

/// Gathers of every face after a change. In a closed room whose walls reflect 80 %, less than a
/// thousandth of the change is missing after them; in most rooms far less.
const SETTLING_GATHERS: u32 = 32;

/// Gathers of every face after a change until less than a hundredth of it is missing.
const NEARLY_SETTLED_GATHERS: u32 = 9;

/// log2 of the maximum number of frames between two gathers of a cascade.
pub(super) const RAREST_CASCADE: u32 = 3;

/// After surface has moved, rays are traced again in this many groups, one a frame.
pub(super) const RAY_CLASSES: u32 = 4;

/// Numbers of gathers of every face after which the far light of pixels is updated: later gathers
/// change less and less.
const SHOWN_GATHERS: [u32; 8] = [4, 6, 8, 12, 16, 20, 26, SETTLING_GATHERS];

/// The work of a frame.
#[allow(clippy::struct_excessive_bools, reason = "independent facts about one frame")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    /// `true` if light starts from darkness.
    pub is_from_darkness: bool,
    /// Number of gathers; each sees the light of the previous one.
    pub gathers: u32,
    /// `true` if direct light has changed.
    pub is_direct_new: bool,
    /// `true` if faces sample emitters again, since emitters or occluders may have changed.
    pub may_shine_anew: bool,
    /// `true` if the far light of pixels is updated.
    pub shows_far: bool,
    /// The maximum number of faces that gather.
    pub faces: u32,
    /// `true` if faces gather by cascade: those of coarse cascades less often.
    pub is_by_cascade: bool,
    /// `true` if any face may never have gathered.
    pub is_list_new: bool,
    /// Number of the frame.
    pub number: u32,
    /// The rays that faces trace again, a bit for each class (`turn.wgsl`).
    pub rays_anew: u32,
}

impl Turn {
    /// `true` if the volume stores all cells instead of only changed ones. From darkness with many
    /// bounces nearly everything changes in every gather: looking for unchanged faces would cost
    /// more than it saves.
    pub fn stores_all(&self) -> bool {
        self.is_from_darkness && self.gathers > 0
    }
}

/// Whether the stored hits of the faces' rays are valid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Rays {
    /// All hits are valid.
    #[default]
    Traced,
    /// Surface has moved since the last frame.
    Outdated,
    /// Surface has moved, and rays are traced again for `frames` more frames: all rays of the faces
    /// in turn, or one group of all faces.
    Renewed { frames: u64, all_at_once: bool },
}

/// The schedule of gathers since the last change.
#[derive(Debug, Default)]
pub(super) struct Turns {
    number: u32,
    /// Frames until the light has converged.
    left: u64,
    /// The value of `left` at which less than a hundredth of the change is missing.
    nearly_settled: u64,
    /// Gathers of the last solve from darkness, until the next frame.
    solved: Option<u32>,
    /// Frames until all faces have sampled the emitters again.
    shines: u64,
    is_disturbed: bool,
    rays: Rays,
    /// `true` if the list is the first, or has replaced an earlier one.
    is_list_new: bool,
    /// `true` if there are cascades.
    has_cascades: bool,
    lights: Option<u64>,
    cones: Option<(TraceSettings, [f32; 4])>,
}

impl Turns {
    /// The schedule for the faces of a grid.
    pub fn new(grid: &Grid) -> Self {
        Self { has_cascades: grid.cascades.is_some(), ..Self::default() }
    }

    /// Restarts the schedule after light has changed.
    pub fn disturb(&mut self) {
        self.is_disturbed = true;
    }

    /// Restarts the schedule after surface has moved.
    pub fn surface_moved(&mut self) {
        (self.is_disturbed, self.rays) = (true, Rays::Outdated);
    }

    /// Makes all faces that have never gathered do so in the next frame, whatever the budget.
    pub fn gather_fresh(&mut self) {
        self.is_list_new = true;
    }

    /// The work of lighting everything from darkness with this number of bounces; `lights` is the
    /// version of the lights. Later frames continue from its result.
    pub fn restart(&mut self, lights: u64, bounces: u32) -> Turn {
        let gathers = bounces.saturating_sub(1);
        self.lights = Some(lights);
        self.cones = None;
        self.solved = Some(gathers);
        self.is_disturbed = false;
        self.shines = 0;
        self.is_list_new = false;
        self.rays = Rays::Traced;
        Turn {
            is_from_darkness: true,
            gathers,
            is_direct_new: true,
            may_shine_anew: gathers > 0,
            shows_far: bounces > 0,
            faces: u32::MAX,
            is_by_cascade: false,
            is_list_new: false,
            number: 0,
            rays_anew: 0,
        }
    }

    /// Frames until less than a hundredth of the last change is missing (with cascades, in the
    /// finest one).
    pub fn frames_left(&self) -> u32 {
        u32::try_from(self.left.saturating_sub(self.nearly_settled)).unwrap_or(u32::MAX)
    }

    /// The work of the next frame; `None` once the light has converged.
    pub fn next(
        &mut self,
        lights: u64,
        cones: (TraceSettings, [f32; 4]),
        capacity: u64,
        budget: Option<u32>,
    ) -> Option<Turn> {
        let cones = Some(cones);
        let is_direct_new = self.is_disturbed || self.lights != Some(lights);
        let rarest = if self.has_cascades { 1 << RAREST_CASCADE } else { 1 };
        let turns = budget.map_or(rarest, |budget| capacity.div_ceil(budget.max(1).into()));
        // The finest cascade gathers in every frame.
        let turns_of_finest = if budget.is_some() { turns } else { 1 };
        self.nearly_settled = u64::from(SETTLING_GATHERS) * turns
            - u64::from(NEARLY_SETTLED_GATHERS) * turns_of_finest;
        let done = self.solved.take();
        if is_direct_new {
            self.shines = turns;
        }
        if is_direct_new || self.cones != cones {
            let done = done.filter(|_| !is_direct_new).unwrap_or(0);
            self.left = u64::from(SETTLING_GATHERS.saturating_sub(done)) * turns;
        }
        self.is_disturbed = false;
        if self.rays == Rays::Outdated {
            // Faces that take turns trace all their rays in one turn.
            let all_at_once = turns > 1;
            let frames = if all_at_once { turns } else { RAY_CLASSES.into() };
            self.rays = Rays::Renewed { frames, all_at_once };
        }
        (self.lights, self.cones) = (Some(lights), cones);
        self.left = self.left.checked_sub(1)?;
        self.number = self.number.wrapping_add(1);
        let may_shine_anew = self.shines > 0;
        self.shines = self.shines.saturating_sub(1);
        let gathers = u64::from(SETTLING_GATHERS).saturating_sub(self.left / turns);
        let is_shown = |shown: &u32| u64::from(*shown) == gathers;
        let shows_far = is_direct_new
            || gathers < SHOWN_GATHERS[0].into()
            || (self.left.is_multiple_of(turns) && SHOWN_GATHERS.iter().any(is_shown));
        let rays_anew = match &mut self.rays {
            Rays::Renewed { frames, all_at_once } if *frames > 0 => {
                *frames -= 1;
                if *all_at_once { (1 << RAY_CLASSES) - 1 } else { 1 << (self.number % RAY_CLASSES) }
            }
            _ => 0,
        };
        Some(Turn {
            is_from_darkness: false,
            gathers: 1,
            is_direct_new,
            may_shine_anew,
            shows_far: shows_far || rays_anew != 0,
            faces: budget.unwrap_or(u32::MAX).max(1),
            is_by_cascade: self.has_cascades && budget.is_none(),
            is_list_new: std::mem::take(&mut self.is_list_new),
            number: self.number,
            rays_anew,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn next(turns: &mut Turns, budget: Option<u32>) -> Option<Turn> {
        turns.next(1, (TraceSettings::default(), [0.0; 4]), 100, budget)
    }

    #[test]
    fn turns_after_a_solve_skip_unchanged_work() {
        let mut turns = Turns::default();
        turns.restart(1, 17);
        let all: Vec<Turn> = std::iter::from_fn(|| next(&mut turns, None)).collect();
        assert_eq!(all.len(), 16);
        assert!(all.iter().all(|turn| !turn.is_direct_new && !turn.may_shine_anew));
        let shown = all.iter().filter(|turn| turn.shows_far).count();
        assert!(all[15].shows_far && shown < 6, "{shown} of 16");
    }

    #[test]
    fn after_a_move_all_faces_resample_emitters() {
        let mut turns = Turns::default();
        turns.restart(1, 17);
        turns.surface_moved();
        // Four turns of 25 faces.
        let all: Vec<Turn> = std::iter::from_fn(|| next(&mut turns, Some(25))).collect();
        assert_eq!(all.len(), 4 * 32);
        let shining: Vec<bool> = all.iter().map(|turn| turn.may_shine_anew).collect();
        assert!(shining[..4].iter().all(|shines| *shines) && !shining[4..].contains(&true));
        assert!(all[0].is_direct_new && !all[1].is_direct_new);
        assert!(all[..12].iter().all(|turn| turn.shows_far));
        assert!(all[15].shows_far && all[127].shows_far && !all[14].shows_far);
    }
}
