//! Presets: named starting points for all settings of a picture.
//!
//! A preset is one of the library's for the cones ([`Preset`]) or one that another crate adds
//! ([`AddedPreset`]), with companion settings ([`Companions`]). Front ends list presets by name and
//! summary, as collected by `lumivox-explorer`, and apply them with
//! [`RenderSettings::with_preset`]; picture, view and resolution do not change.

use std::sync::Arc;

use lumivox::hooks::{ConeModel, Injection, OctreeBuilding};
use lumivox::{Directionality, Preset, TraceSettings, VolumeKind};
use lumivox_scene::Scene;

use crate::look::LookChoice;
use crate::{Exposure, PHYSICAL, RenderSettings, ToneMap};

/// The starting point of a picture. Default: the default [`Preset`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PresetChoice {
    /// The physical look, with a preset for the cones.
    Cones(Preset),
    /// A preset of another crate.
    Added(&'static AddedPreset),
}

/// A preset that another crate adds: it may set a look, a cone model, an injection.
#[derive(Clone, Copy, Debug)]
pub struct AddedPreset {
    /// The name in lower case; presets are compared by it.
    pub name: &'static str,
    /// A description in one line, without a full stop.
    pub summary: &'static str,
    /// The settings of the cones.
    pub trace: fn() -> TraceSettings,
    /// The look for voxels at a resolution ([`RenderSettings::resolution`]).
    pub look: fn(resolution: u32) -> LookChoice,
    /// The companions of the preset, computed from the physical ones. If there is a look, exposure
    /// and curve are those of the look: [`Look::display`](crate::look::Look::display).
    pub companions: fn(Companions) -> Companions,
}

impl PartialEq for AddedPreset {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for AddedPreset {}

impl Default for PresetChoice {
    fn default() -> Self {
        Self::Cones(Preset::default())
    }
}

impl PresetChoice {
    /// The presets of this crate, from the cheapest to the most expensive.
    pub const ALL: [Self; 4] = [
        Self::Cones(Preset::Fast),
        Self::Cones(Preset::Realtime),
        Self::Cones(Preset::Balanced),
        Self::Cones(Preset::High),
    ];

    /// The name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cones(Preset::Fast) => "fast",
            Self::Cones(Preset::Realtime) => "realtime",
            Self::Cones(Preset::Balanced) => "balanced",
            Self::Cones(Preset::High) => "high",
            Self::Added(preset) => preset.name,
        }
    }

    /// A description in one line, without a full stop.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Cones(Preset::Fast) => "9 cones, one pixel in four",
            Self::Cones(Preset::Realtime) => {
                "as fast, with the light of earlier frames: for what moves"
            }
            Self::Cones(Preset::Balanced) => "9 cones, every pixel",
            Self::Cones(Preset::High) => {
                "12 cones, every pixel, samples half as large: fewest leaks"
            }
            Self::Added(preset) => preset.summary,
        }
    }

    /// The settings of the cones.
    pub fn trace(self) -> TraceSettings {
        match self {
            Self::Cones(preset) => TraceSettings::preset(preset),
            Self::Added(preset) => (preset.trace)(),
        }
    }

    /// The look for voxels at a resolution ([`RenderSettings::resolution`]).
    pub fn look(self, resolution: u32) -> LookChoice {
        match self {
            Self::Cones(_) => None,
            Self::Added(preset) => (preset.look)(resolution),
        }
    }
}

/// The settings of a preset besides its cones.
#[derive(Clone, Debug, PartialEq)]
pub struct Companions {
    /// Radiance by direction, or one value for all directions.
    pub directionality: Directionality,
    /// The storage of the cells.
    pub volume: VolumeKind,
    /// The method that builds an octree's nodes.
    pub octree_builder: Option<Arc<dyn OctreeBuilding>>,
    /// The method that injects light into the voxels.
    pub injection: Option<Arc<dyn Injection>>,
    /// The origin, the direction and the samples of the cones.
    pub cone_model: Option<Arc<dyn ConeModel>>,
    /// Reflections of indirect light.
    pub bounces: u32,
    /// The exposure. A look chooses it for each scene:
    /// [`Look::display`](crate::look::Look::display).
    pub exposure: Exposure,
    /// The curve that maps radiance to the screen's range. A look chooses it, too.
    pub tone_map: ToneMap,
}

impl Companions {
    /// The companions of a preset.
    pub fn of(preset: PresetChoice) -> Self {
        let RenderSettings {
            directionality,
            volume,
            octree_builder,
            injection,
            cone_model,
            bounces,
            exposure,
            tone_map,
            ..
        } = RenderSettings::default();
        let usual = Self {
            directionality,
            volume,
            octree_builder,
            injection,
            cone_model,
            bounces,
            exposure,
            tone_map,
        };
        match preset {
            PresetChoice::Cones(_) => usual,
            PresetChoice::Added(preset) => (preset.companions)(usual),
        }
    }
}

impl RenderSettings {
    /// These settings with a preset and its companions. Picture, view and resolution do not change,
    /// except for exposure and curve if the look changes: a look may show each scene differently.
    /// `scene` is the scene that will be shown; `None` if it is not known yet.
    #[must_use]
    pub fn with_preset(&self, preset: PresetChoice, scene: Option<&Scene>) -> Self {
        let companions = Companions::of(preset);
        let look = preset.look(self.resolution);
        let is_same_look = self.look_name() == look.as_ref().map_or(PHYSICAL, |look| look.name());
        let (exposure, tone_map) = match &look {
            _ if is_same_look => (self.exposure, self.tone_map),
            Some(look) => look.display(scene),
            None => (companions.exposure, companions.tone_map),
        };
        Self {
            look,
            trace: preset.trace(),
            directionality: companions.directionality,
            volume: companions.volume,
            octree_builder: companions.octree_builder,
            injection: companions.injection,
            cone_model: companions.cone_model,
            bounces: companions.bounces,
            exposure,
            tone_map,
            ..self.clone()
        }
    }

    /// If exposure and curve are the look's values for the last scene, changes them to its values
    /// for `scene`. Keeps other values.
    pub fn show_other(&mut self, last: Option<&Scene>, scene: &Scene) {
        let Some(look) = &self.look else { return };
        let shown = (self.exposure, self.tone_map);
        if shown == look.display(None) || last.is_some_and(|last| shown == look.display(Some(last)))
        {
            (self.exposure, self.tone_map) = look.display(Some(scene));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A preset's result does not depend on earlier settings; the default preset gives the
    /// defaults.
    #[test]
    fn presets_do_not_depend_on_earlier_settings() {
        let scene = lumivox_scene::builtin::scene("cornell").unwrap();
        let fresh = RenderSettings::default();
        assert_eq!(fresh.with_preset(PresetChoice::default(), None), fresh);
        for before in PresetChoice::ALL {
            for preset in PresetChoice::ALL {
                let direct = fresh.with_preset(preset, Some(&scene));
                let by_way = fresh.with_preset(before, Some(&scene));
                let by_way = by_way.with_preset(preset, Some(&scene));
                assert_eq!(by_way, direct, "{} after {}", preset.name(), before.name());
                let cones = direct.trace == preset.trace();
                assert!(cones && direct.look == preset.look(fresh.resolution));
            }
        }
    }
}
