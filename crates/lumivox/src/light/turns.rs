//! Schedules gathers: which faces gather in a frame, from each change until light has converged.

use crate::Grid;
use crate::cones::TraceSettings;

/// Gathers of every face after a change. In a closed room whose walls reflect 80 %, less than a
/// thousandth of the change is missing after them; in most rooms far less.
const SETTLING_GATHERS: u32 = 32;

/// As [`SETTLING_GATHERS`], for accelerated gathers.
const SETTLING_RELAXED: u32 = 18;

/// Gathers of every face after a change until less than a hundredth of it is missing.
const NEARLY_SETTLED_GATHERS: u32 = 9;

/// As [`NEARLY_SETTLED_GATHERS`], for accelerated gathers.
const NEARLY_SETTLED_RELAXED: u32 = 6;

/// Factors of accelerated gathers (heavy ball: Polyak 1964): of the change that a gather has found,
/// and of the last step, whose sum is the next step. With 1.4 and 0.15 light overshoots by 2 %.
pub(super) const RELAXATION: f32 = 1.3;
pub(super) const MOMENTUM: f32 = 0.1;
/// Growth of [`MOMENTUM`] with each gather from the fifth on, and its maximum: where surfaces
/// reflect much light, later steps are nearly as long as the ones before.
pub(super) const GROWTH_OF_MOMENTUM: f32 = 0.08;
pub(super) const MOST_MOMENTUM: f32 = 0.6;

/// Minimum number of bounces of a still picture whose gathers are accelerated. With fewer, light
/// has exactly this number of bounces.
const RELAXED_BOUNCES: u32 = 8;

/// log2 of the maximum number of frames between two gathers of a cascade.
pub(super) const RAREST_CASCADE: u32 = 3;

/// After surface has moved, rays are traced again in this many groups, one a frame. Faces sample
/// emitters again in as many groups.
pub(super) const RAY_CLASSES: u32 = 4;

/// Number of boxes of moved surface that are kept: one for each group of rays, and the one before.
pub(super) const MOVED_BOXES: u32 = RAY_CLASSES + 1;

/// Numbers of gathers of every face after which the far light of pixels is updated: later gathers
/// change less and less.
const SHOWN_GATHERS: [u32; 8] = [4, 6, 8, 12, SETTLING_RELAXED, 22, 26, SETTLING_GATHERS];

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
    /// The faces that sample emitters again.
    pub shines: Shines,
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
    /// The rays that faces trace again, and the faces that sample emitters again: a bit for each
    /// class (`turn.wgsl`).
    pub rays_anew: u32,
    /// `true` if gathers are accelerated.
    pub relaxes: bool,
    /// `true` if faces may have outdated or unknown hits.
    pub finds: bool,
    /// `true` if all hits and the light from emitters are found again, because surface has moved.
    pub forgets_hits: bool,
    /// `true` if the box around dynamic surface is found and written to the place `box_written`.
    pub writes_box: bool,
    /// Place of the last box.
    pub box_written: u32,
    /// Number of latest boxes that cover all surface moved since the oldest stored hit was traced,
    /// and since the emitters' oldest stored irradiance; 0 if unknown.
    pub boxes: u32,
}

/// Faces that sample emitters again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shines {
    /// No faces: neither emitters nor occluders have changed.
    OnNone,
    /// Faces that may see emitters past moved surface, a group of them a frame.
    BehindMoved,
    /// All faces.
    OnAll,
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
#[allow(clippy::struct_excessive_bools, reason = "independent facts about the schedule")]
#[derive(Debug, Default)]
pub(super) struct Turns {
    number: u32,
    /// Frames until the light has converged.
    left: u64,
    /// The value of `left` at which less than a hundredth of the change is missing.
    nearly_settled: u64,
    /// Gathers of the last solve from darkness, until the next frame.
    solved: Option<u32>,
    /// Frames until all faces have sampled emitters again; 0 if only those past moved surface do.
    shines_on_all: u64,
    /// `true` if light from emitters was never computed, or lost.
    is_unlit: bool,
    is_disturbed: bool,
    rays: Rays,
    /// Boxes since all rays were traced, at most [`MOVED_BOXES`].
    boxes: u32,
    box_written: u32,
    /// `true` if these boxes cover all surface moved since the oldest stored hit was traced.
    are_boxes_complete: bool,
    /// `true` if all rays are traced in the turn of the next box.
    are_rays_new: bool,
    /// Frames until all faces have looked for outdated hits.
    finds: u64,
    /// Frames of a gather of all faces, at the last call of [`Self::next`].
    frames_of_gather: u64,
    /// `true` if surface has moved since the last solve from darkness.
    has_moved: bool,
    /// `true` if the list is the first, or has replaced an earlier one.
    is_list_new: bool,
    /// `true` if there are cascades.
    has_cascades: bool,
    /// `true` if cones march. Their gathers are not accelerated, because their noise differs from
    /// gather to gather.
    marches: bool,
    /// Versions of lights and emitters.
    lights: Option<u64>,
    emitters: Option<u64>,
    cones: Option<(TraceSettings, [f32; 4])>,
}

impl Turns {
    /// The schedule for the faces of a grid.
    pub fn new(grid: &Grid, marches: bool) -> Self {
        Self { has_cascades: grid.cascades.is_some(), marches, ..Self::default() }
    }

    /// Restarts the schedule after light has changed, including that of emitters.
    pub fn disturb(&mut self) {
        (self.is_disturbed, self.is_unlit) = (true, true);
    }

    /// Forgets hits and light from emitters, whose buffers were replaced.
    pub fn replace_rays(&mut self) {
        (self.is_unlit, self.boxes, self.are_boxes_complete) = (true, 0, false);
        self.are_rays_new = true;
    }

    /// Counts the box that the next turn writes.
    fn add_box(&mut self) {
        self.box_written = (self.box_written + 1) % MOVED_BOXES;
        self.boxes = (self.boxes + 1).min(MOVED_BOXES);
        self.are_boxes_complete |=
            std::mem::take(&mut self.are_rays_new) || self.boxes == MOVED_BOXES;
    }

    /// Restarts the schedule after surface has moved.
    pub fn surface_moved(&mut self) {
        (self.is_disturbed, self.has_moved, self.rays) = (true, true, Rays::Outdated);
    }

    /// Makes all faces that have never gathered do so in the next frame, whatever the budget.
    pub fn gather_fresh(&mut self) {
        self.is_list_new = true;
    }

    /// The work of lighting everything from darkness with this number of bounces; `versions` are
    /// those of lights and emitters. Later frames continue from its result.
    pub fn restart(&mut self, [lights, emitters]: [u64; 2], bounces: u32) -> Turn {
        let relaxes = bounces >= RELAXED_BOUNCES && !self.marches;
        let mut gathers = bounces.saturating_sub(1);
        if relaxes {
            // At least as much light as with the gathers that are left out, unless two walls only
            // light each other.
            gathers -= 2 * (gathers - 1) / 5;
        }
        let has_moved = self.has_moved;
        let is_lit = !(has_moved || self.is_unlit)
            && self.shines_on_all == 0
            && self.emitters == Some(emitters);
        let shines = if is_lit || gathers == 0 { Shines::OnNone } else { Shines::OnAll };
        self.is_unlit = !is_lit && gathers == 0;
        self.shines_on_all = 0;
        // Without bounces no hits are found: those of moved surface stay outdated.
        let traces = bounces > 0;
        let finds = traces && (has_moved || self.finds > 0);
        if traces {
            (self.has_moved, self.finds, self.rays) = (false, 0, Rays::Traced);
            (self.boxes, self.are_rays_new) = (0, true);
            self.add_box();
        } else if self.finds > 0 {
            self.rays = Rays::Outdated;
        }
        (self.lights, self.emitters) = (Some(lights), Some(emitters));
        self.cones = None;
        self.solved = Some(gathers);
        self.is_disturbed = false;
        self.is_list_new = false;
        Turn {
            is_from_darkness: true,
            gathers,
            is_direct_new: true,
            shines,
            shows_far: traces,
            faces: u32::MAX,
            is_by_cascade: false,
            is_list_new: false,
            number: 0,
            rays_anew: 0,
            relaxes,
            finds,
            forgets_hits: traces && has_moved,
            writes_box: traces,
            box_written: self.box_written,
            boxes: 0,
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
        [lights, emitters]: [u64; 2],
        cones: (TraceSettings, [f32; 4]),
        capacity: u64,
        budget: Option<u32>,
    ) -> Option<Turn> {
        let cones = Some(cones);
        let are_emitters_new = self.emitters.replace(emitters) != Some(emitters);
        let is_direct_new = self.is_disturbed || self.lights != Some(lights) || are_emitters_new;
        let rarest = if self.has_cascades { 1 << RAREST_CASCADE } else { 1 };
        let turns = budget.map_or(rarest, |budget| capacity.div_ceil(budget.max(1).into()));
        // The finest cascade gathers in every frame.
        let turns_of_finest = if budget.is_some() { turns } else { 1 };
        // Faces that gather in different turns would overshoot: they see each other's steps.
        let can_relax = turns == 1 && !self.marches;
        let (settling, nearly) = if can_relax {
            (SETTLING_RELAXED, NEARLY_SETTLED_RELAXED)
        } else {
            (SETTLING_GATHERS, NEARLY_SETTLED_GATHERS)
        };
        self.nearly_settled = u64::from(settling) * turns - u64::from(nearly) * turns_of_finest;
        let done = self.solved.take();
        let before = std::mem::replace(&mut self.frames_of_gather, turns).max(1);
        if before != turns {
            // Otherwise, faces that would have had their turn later would be left out.
            self.left = self.left.div_ceil(before) * turns;
            if self.finds > 0 {
                self.rays = Rays::Outdated;
            }
            if self.shines_on_all > 0 {
                self.is_unlit = true;
            }
        }
        if std::mem::take(&mut self.is_unlit) | are_emitters_new {
            self.shines_on_all = turns;
        }
        if is_direct_new || self.cones != cones {
            let done = done.filter(|_| !is_direct_new).unwrap_or(0);
            self.left = u64::from(settling.saturating_sub(done)) * turns;
        }
        self.is_disturbed = false;
        let writes_box = self.rays == Rays::Outdated;
        if writes_box {
            self.add_box();
        }
        if turns > 1 || self.has_cascades {
            // In turns, a group of rays may wait longer than RAY_CLASSES frames, so the kept boxes
            // do not suffice. Voxels of cascades have other coordinates.
            (self.boxes, self.are_boxes_complete) = (0, false);
        }
        if self.rays == Rays::Outdated {
            // Faces that take turns trace all their rays in one turn.
            let all_at_once = turns > 1;
            let frames = if all_at_once { turns } else { RAY_CLASSES.into() };
            self.finds = frames;
            self.rays = Rays::Renewed { frames, all_at_once };
        }
        (self.lights, self.cones) = (Some(lights), cones);
        self.left = self.left.checked_sub(1)?;
        self.number = self.number.wrapping_add(1);
        let gathers = u64::from(settling).saturating_sub(self.left / turns);
        let is_shown = |shown: &u32| u64::from(*shown) == gathers;
        let shows_far = is_direct_new
            || gathers < SHOWN_GATHERS[0].into()
            || (self.left.is_multiple_of(turns) && SHOWN_GATHERS.iter().any(is_shown));
        let finds = self.finds > 0;
        self.finds = self.finds.saturating_sub(1);
        let rays_anew = match &mut self.rays {
            Rays::Renewed { frames, all_at_once } if *frames > 0 => {
                *frames -= 1;
                if *all_at_once { (1 << RAY_CLASSES) - 1 } else { 1 << (self.number % RAY_CLASSES) }
            }
            _ => 0,
        };
        let shines = match (self.shines_on_all > 0, rays_anew) {
            (true, _) => Shines::OnAll,
            (false, 0) => Shines::OnNone,
            (false, _) => Shines::BehindMoved,
        };
        self.shines_on_all = self.shines_on_all.saturating_sub(1);
        Some(Turn {
            is_from_darkness: false,
            gathers: 1,
            is_direct_new,
            shines,
            shows_far: shows_far || rays_anew != 0,
            faces: budget.unwrap_or(u32::MAX).max(1),
            is_by_cascade: self.has_cascades && budget.is_none(),
            is_list_new: std::mem::take(&mut self.is_list_new),
            number: self.number,
            rays_anew,
            // The first gather is plain: it replaces light by what arrives at once.
            relaxes: can_relax && gathers > 1,
            finds,
            forgets_hits: false,
            writes_box,
            box_written: self.box_written,
            boxes: if self.are_boxes_complete && !self.marches { self.boxes } else { 0 },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn next(turns: &mut Turns, budget: Option<u32>) -> Option<Turn> {
        turns.next([1; 2], (TraceSettings::default(), [0.0; 4]), 100, budget)
    }

    #[test]
    fn turns_after_a_solve_skip_unchanged_work() {
        let mut turns = Turns::default();
        turns.restart([1; 2], 17);
        let all: Vec<Turn> = std::iter::from_fn(|| next(&mut turns, None)).collect();
        // Ten of 18 gathers are done.
        assert_eq!(all.len(), 8);
        assert!(
            all.iter()
                .all(|turn| !turn.is_direct_new && turn.shines == Shines::OnNone && turn.relaxes)
        );
        let shown = all.iter().filter(|turn| turn.shows_far).count();
        assert!(all[7].shows_far && shown < 4, "{shown} of 8");
    }

    #[test]
    fn only_later_gathers_of_all_faces_are_accelerated() {
        let mut turns = Turns::default();
        assert!(!turns.restart([1; 2], 7).relaxes && turns.restart([1; 2], 8).relaxes);
        turns.disturb();
        let all: Vec<Turn> = std::iter::from_fn(|| next(&mut turns, None)).collect();
        assert_eq!(all.len(), 18);
        assert!(!all[0].relaxes && all[1..].iter().all(|turn| turn.relaxes));
        turns.disturb();
        let quarters = std::iter::from_fn(|| next(&mut turns, Some(25)));
        assert!(quarters.into_iter().all(|turn| !turn.relaxes));
        let mut marching = Turns { marches: true, ..Turns::default() };
        assert!(!marching.restart([1; 2], 17).relaxes);
        assert_eq!(std::iter::from_fn(|| next(&mut marching, None)).count(), 16);
    }

    #[test]
    fn hits_stay_outdated_until_light_bounces() {
        let mut turns = Turns::default();
        turns.surface_moved();
        let dark = turns.restart([1; 2], 0);
        assert!(!dark.finds && !dark.forgets_hits && !dark.writes_box);
        let lit = turns.restart([1; 2], 1);
        assert!(lit.finds && lit.forgets_hits && lit.writes_box);
        assert!(!turns.restart([1; 2], 1).finds);
        turns.surface_moved();
        turns.restart([1; 2], 0);
        assert!(next(&mut turns, None).is_some_and(|turn| turn.finds && turn.writes_box));
    }

    #[test]
    fn boxes_are_used_only_if_every_ray_was_traced_since() {
        let mut turns = Turns::default();
        turns.restart([1; 2], 17);
        for moves in 2..8 {
            turns.surface_moved();
            let turn = next(&mut turns, None).expect("a turn");
            assert!(turn.writes_box && turn.finds && turn.boxes == moves.min(MOVED_BOXES));
        }
        assert!((0..3).all(|_| next(&mut turns, None).is_some_and(|turn| turn.finds)));
        assert!(!next(&mut turns, None).expect("a turn").finds);
        // In turns, after a change of the budget, and with cascades, all hits are found again.
        turns.surface_moved();
        assert_eq!(next(&mut turns, Some(25)).expect("a turn").boxes, 0);
        let changed = next(&mut turns, Some(50)).expect("a turn");
        assert!(changed.finds && changed.rays_anew != 0 && changed.boxes == 0);
        let mut cascades = Turns { has_cascades: true, ..Turns::default() };
        cascades.restart([1; 2], 17);
        cascades.surface_moved();
        assert_eq!(next(&mut cascades, Some(100)).expect("a turn").boxes, 0);
    }

    #[test]
    fn after_a_move_all_faces_resample_emitters() {
        let mut turns = Turns::default();
        turns.restart([1; 2], 17);
        turns.surface_moved();
        // Four turns of 25 faces.
        let all: Vec<Turn> = std::iter::from_fn(|| next(&mut turns, Some(25))).collect();
        assert_eq!(all.len(), 4 * 32);
        let shines: Vec<Shines> = all.iter().map(|turn| turn.shines).collect();
        assert!(shines[..4].iter().all(|shines| *shines == Shines::BehindMoved));
        assert!(shines[4..].iter().all(|shines| *shines == Shines::OnNone));
        assert!(all[0].is_direct_new && !all[1].is_direct_new);
        assert!(all[..12].iter().all(|turn| turn.shows_far));
        assert!(all[15].shows_far && all[127].shows_far && !all[14].shows_far);
    }
}
