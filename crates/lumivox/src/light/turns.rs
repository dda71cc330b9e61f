//! Who gathers when: faces take turns, from each change until the light has settled.

use crate::cones::TraceSettings;
use crate::{Grid, Lights};

/// Gathers of every face after a change. In a closed room whose walls reflect 80 %, less than a thousandth of the change
/// is left then; in most rooms far less.
const SETTLING_GATHERS: u32 = 32;

/// The most frames from a cascade's gather to its next one (`RAREST` of `turn.wgsl`).
const RAREST_CASCADE: u64 = 8;

/// Rays are traced anew in so many groups, one a frame, after surface has moved.
const RAY_CLASSES: u32 = 4;

/// The work of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    /// Direct light is not what it was.
    pub is_direct_new: bool,
    /// The most faces that gather.
    pub faces: u32,
    /// The faces of a cascade take turns together, those of coarse ones less often.
    pub is_by_cascade: bool,
    /// Faces of any place in the list may never have gathered.
    pub is_list_new: bool,
    /// Counts up.
    pub number: u32,
    /// The rays that faces trace anew, a bit for each class (`turn.wgsl`).
    pub rays_anew: u32,
}

impl Turn {
    /// All faces gather.
    pub const OF_ALL: Self = Self {
        is_direct_new: true,
        faces: u32::MAX,
        is_by_cascade: false,
        is_list_new: false,
        number: 0,
        rays_anew: 0,
    };
}

/// Whether what the rays of faces have met is still there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Rays {
    /// It is.
    #[default]
    Traced,
    /// Surface has moved since the last frame.
    Outdated,
    /// It has, and for so many frames more rays are traced anew: of the faces whose turn it is all, or a group.
    Renewed { frames: u64, all_at_once: bool },
}

/// The frames since the last change.
#[derive(Debug, Default)]
pub(super) struct Turns {
    number: u32,
    /// Frames until the light has settled.
    left: u64,
    is_disturbed: bool,
    rays: Rays,
    /// The list has come in the place of another, or of none.
    is_list_new: bool,
    /// There are cascades.
    has_cascades: bool,
    lights: Option<u64>,
    cones: Option<(TraceSettings, [f32; 4])>,
}

impl Turns {
    /// For the faces of a grid.
    pub fn new(grid: &Grid) -> Self {
        Self { has_cascades: grid.cascades.is_some(), ..Self::default() }
    }

    /// Light has changed.
    pub fn disturb(&mut self) {
        self.is_disturbed = true;
    }

    /// Surface has moved.
    pub fn surface_moved(&mut self) {
        (self.is_disturbed, self.rays) = (true, Rays::Outdated);
    }

    /// In the next frame all faces gather that never have, whatever the budget.
    pub fn gather_fresh(&mut self) {
        self.is_list_new = true;
    }

    /// Light came from darkness by so many gathers.
    pub fn solved(&mut self, lights: &Lights, gathers: u32) {
        self.lights = Some(lights.version);
        self.cones = None;
        // Others will go on where these stopped.
        self.is_disturbed = gathers < SETTLING_GATHERS;
        self.is_list_new = false;
        self.rays = Rays::Traced;
    }

    /// The work of the next frame; none once the light has settled.
    pub fn next(
        &mut self,
        lights: &Lights,
        (settings, values): (&TraceSettings, [f32; 4]),
        capacity: u64,
        budget: Option<u32>,
    ) -> Option<Turn> {
        let cones = Some((*settings, values));
        let is_direct_new = self.is_disturbed || self.lights != Some(lights.version);
        let rarest = if self.has_cascades { RAREST_CASCADE } else { 1 };
        let turns = budget.map_or(rarest, |budget| capacity.div_ceil(budget.max(1).into()));
        if is_direct_new || self.cones != cones {
            self.left = u64::from(SETTLING_GATHERS) * turns;
        }
        self.is_disturbed = false;
        if self.rays == Rays::Outdated {
            // Faces that take turns trace all their rays in one.
            let all_at_once = turns > 1;
            let frames = if all_at_once { turns } else { RAY_CLASSES.into() };
            self.rays = Rays::Renewed { frames, all_at_once };
        }
        (self.lights, self.cones) = (Some(lights.version), cones);
        self.left = self.left.checked_sub(1)?;
        self.number = self.number.wrapping_add(1);
        let rays_anew = match &mut self.rays {
            Rays::Renewed { frames, all_at_once } if *frames > 0 => {
                *frames -= 1;
                if *all_at_once { (1 << RAY_CLASSES) - 1 } else { 1 << (self.number % RAY_CLASSES) }
            }
            _ => 0,
        };
        Some(Turn {
            is_direct_new,
            faces: budget.unwrap_or(u32::MAX).max(1),
            is_by_cascade: self.has_cascades && budget.is_none(),
            is_list_new: std::mem::take(&mut self.is_list_new),
            number: self.number,
            rays_anew,
        })
    }
}
