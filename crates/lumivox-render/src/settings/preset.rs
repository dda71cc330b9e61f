//! Presets: the few names that all settings of a picture can start from.
//!
//! A preset is one of the library's for the cones ([`Preset`]) or another's look, and what it brings along
//! ([`Companions`]). Front ends list [`PresetChoice::ALL`] by name and summary and take
//! [`RenderSettings::with_preset`]; picture, view and resolution stay as they are.

use lumivox::{Directionality, OctreeOptions, Preset, TraceSettings, VolumeKind};
use lumivox_scene::Scene;

use crate::classics::{self, InjectionChoice, ReportCones};
use crate::{Exposure, Look, RenderSettings, ToneMap, VxctDisplay, VxctSettings, vxct_display};

/// What a picture starts from: presets of the cones, or the look of another renderer. Default: the default [`Preset`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PresetChoice {
    /// The physical look.
    Cones(Preset),
    /// The tuning of the sparse voxel octree report.
    Report,
    /// The look of VXCT.
    Vxct,
}

impl Default for PresetChoice {
    fn default() -> Self {
        Self::Cones(Preset::default())
    }
}

impl PresetChoice {
    /// All, from the cheapest to the dearest, then those that are not physical.
    pub const ALL: [Self; 5] = [
        Self::Cones(Preset::Fast),
        Self::Cones(Preset::Balanced),
        Self::Cones(Preset::High),
        Self::Report,
        Self::Vxct,
    ];

    /// The name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cones(Preset::Fast) => "fast",
            Self::Cones(Preset::Balanced) => "balanced",
            Self::Cones(Preset::High) => "high",
            Self::Report => "report",
            Self::Vxct => "vxct",
        }
    }

    /// The preset of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// What it is, in a line without a full stop.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Cones(Preset::Fast) => "6 cones, one pixel in four",
            Self::Cones(Preset::Balanced) => "6 cones, every pixel",
            Self::Cones(Preset::High) => {
                "12 cones, every pixel, samples half as large: fewest leaks"
            }
            Self::Report => {
                "the SVO report's tuning, which is not physical, with an isotropic octree, photons and one bounce"
            }
            Self::Vxct => {
                "VXCT's look: Phong's light and its own cones, isotropic voxels, colours as display values"
            }
        }
    }

    /// The settings of the cones; VXCT's look does not use them, and leaves the default ones.
    pub fn trace(self) -> TraceSettings {
        match self {
            Self::Cones(preset) => TraceSettings::preset(preset),
            Self::Report => ReportCones::trace_settings(),
            Self::Vxct => TraceSettings::default(),
        }
    }

    /// How pictures come about, with voxels of a resolution ([`RenderSettings::resolution`]).
    pub fn look(self, resolution: u32) -> Look {
        match self {
            Self::Cones(_) | Self::Report => Look::Physical,
            Self::Vxct => Look::Vxct(VxctSettings::for_resolution(resolution)),
        }
    }
}

/// What a preset brings along besides its cones, where nobody says otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Companions {
    /// Light by direction, or one for all.
    pub directionality: Directionality,
    /// Where cells are stored.
    pub volume: VolumeKind,
    /// How light comes into the voxels.
    pub injection: InjectionChoice,
    /// Where the cones depart from the physics.
    pub report_cones: ReportCones,
    /// Reflections of indirect light.
    pub bounces: u32,
    /// How radiance becomes brightness. In VXCT's look a scene in physical units has one of its own: [`vxct_display`].
    pub exposure: Exposure,
    /// The curve to the screen's range; in VXCT's look as the exposure.
    pub tone_map: ToneMap,
}

impl Companions {
    /// Those of a preset.
    pub fn of(preset: PresetChoice) -> Self {
        let RenderSettings {
            directionality,
            volume,
            injection,
            report_cones,
            bounces,
            exposure,
            tone_map,
            ..
        } = RenderSettings::default();
        let usual =
            Self { directionality, volume, injection, report_cones, bounces, exposure, tone_map };
        match preset {
            PresetChoice::Cones(_) => usual,
            // What is seen are photons that were reflected once.
            PresetChoice::Report => Self {
                directionality: Directionality::Isotropic,
                volume: VolumeKind::Octree(OctreeOptions::default()),
                injection: classics::injection("photons"),
                report_cones: ReportCones::REPORT,
                bounces: 1,
                ..usual
            },
            // VXCT computes with display values.
            PresetChoice::Vxct => Self {
                directionality: Directionality::Isotropic,
                bounces: 1,
                exposure: Exposure::Stops(0.0),
                tone_map: ToneMap::Raw,
                ..usual
            },
        }
    }
}

impl RenderSettings {
    /// The settings of a preset and its companions; picture, view and resolution stay, but for the exposure and the curve
    /// where the look changes: VXCT's shows each scene in its own way. `scene` is the one that will be shown, if it is known.
    #[must_use]
    pub fn with_preset(&self, preset: PresetChoice, scene: Option<&Scene>) -> Self {
        let companions = Companions::of(preset);
        let look = preset.look(self.resolution);
        let is_same_look = matches!(self.look, Look::Physical) == matches!(look, Look::Physical);
        let (exposure, tone_map) = match (is_same_look, preset, scene) {
            (true, ..) => (self.exposure, self.tone_map),
            (false, PresetChoice::Vxct, Some(scene)) => {
                let VxctDisplay { exposure, tone_map, .. } = vxct_display(scene);
                (exposure, tone_map)
            }
            _ => (companions.exposure, companions.tone_map),
        };
        Self {
            look,
            trace: preset.trace(),
            directionality: companions.directionality,
            volume: companions.volume,
            injection: companions.injection,
            report_cones: companions.report_cones,
            bounces: companions.bounces,
            exposure,
            tone_map,
            ..self.clone()
        }
    }

    /// In the look of VXCT: exposure and curve of another scene, where those of the last were as the look has them; what
    /// was asked for otherwise stays.
    pub fn show_other(&mut self, last: Option<&Scene>, scene: &Scene) {
        let Companions { exposure, tone_map, .. } = Companions::of(PresetChoice::Vxct);
        let found = last.map(vxct_display).map(|display| (display.exposure, display.tone_map));
        let shown = (self.exposure, self.tone_map);
        let is_usual = shown == (exposure, tone_map) || found == Some(shown);
        if self.look != Look::Physical && is_usual {
            let display = vxct_display(scene);
            (self.exposure, self.tone_map) = (display.exposure, display.tone_map);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_again() {
        for preset in PresetChoice::ALL {
            assert_eq!(PresetChoice::named(preset.name()), Some(preset));
            assert!(preset.summary().len() > 10, "{}", preset.name());
        }
        assert_eq!(PresetChoice::named("Fast"), None);
    }

    /// Whatever the settings were, the preset decides what is its own, and the default is what settings default to.
    #[test]
    fn presets_do_not_depend_on_what_was_before() {
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

    #[test]
    fn what_was_asked_for_otherwise_stays() {
        let [first, second] =
            ["spheres", "cornell"].map(|name| lumivox_scene::builtin::scene(name).unwrap());
        assert_ne!(vxct_display(&first), vxct_display(&second), "or else nothing is tested");
        let mut settings = RenderSettings::default();
        settings.show_other(None, &second);
        assert_eq!(
            settings,
            RenderSettings::default(),
            "the physical look knows no white of a scene"
        );

        let asked = Exposure::Stops(-3.25);
        settings = settings.with_preset(PresetChoice::Vxct, Some(&first));
        let shown = vxct_display(&second);
        settings.show_other(Some(&first), &second);
        assert_eq!((settings.exposure, settings.tone_map), (shown.exposure, shown.tone_map));
        settings.exposure = asked;
        settings.show_other(Some(&second), &first);
        assert_eq!(settings.exposure, asked);
    }
}
