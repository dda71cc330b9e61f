//! Who gathers when: faces take turns, from each change until the light has settled.

use crate::Lights;
use crate::cones::TraceSettings;

/// Gathers of every face after a change. In a closed room whose walls reflect 80 %, less than a thousandth of the change
/// is left then; in most rooms far less.
const SETTLING_GATHERS: u32 = 32;

/// The work of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    /// Direct light is not what it was.
    pub is_direct_new: bool,
    /// The most faces that gather; none: only direct light has changed.
    pub faces: u32,
    /// Counts up.
    pub number: u32,
}

/// The frames since the last change.
#[derive(Debug, Default)]
pub(super) struct Turns {
    number: u32,
    /// Frames until the light has settled.
    left: u64,
    is_disturbed: bool,
    /// All faces gather in the next frame.
    is_whole: bool,
    lights: Option<u64>,
    cones: Option<(TraceSettings, [f32; 4])>,
}

impl Turns {
    /// Geometry has changed.
    pub fn disturb(&mut self) {
        self.is_disturbed = true;
    }

    /// In the next frame all faces gather, whatever the budget.
    pub fn gather_all(&mut self) {
        self.is_whole = true;
    }

    /// Light came from darkness by so many gathers.
    pub fn solved(&mut self, lights: &Lights, gathers: u32) {
        self.lights = Some(lights.version);
        self.cones = None;
        // Others will go on where these stopped.
        self.is_disturbed = gathers < SETTLING_GATHERS;
        self.is_whole = false;
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
        if is_direct_new || self.cones != cones {
            let most = budget.map_or(u64::MAX, |budget| u64::from(budget.max(1)));
            self.left = u64::from(SETTLING_GATHERS) * capacity.div_ceil(most);
        }
        self.is_disturbed = false;
        (self.lights, self.cones) = (Some(lights.version), cones);
        self.left = self.left.checked_sub(1)?;
        self.number = self.number.wrapping_add(1);
        let is_whole = std::mem::take(&mut self.is_whole);
        let faces = if is_whole { u32::MAX } else { budget.unwrap_or(u32::MAX).max(1) };
        Some(Turn { is_direct_new, faces, number: self.number })
    }
}
