//! The measurements: scenes, their rotation, presets, resolutions.

use std::fmt;

use glam::Vec3;
use lumivox::Preset;
use lumivox_app::parts::{Kept, Leak};
use lumivox_render::PresetChoice;
use lumivox_render::compare::{Cost, LayerFigures};
use serde::{Deserialize, Serialize};

use crate::cli::QualityArgs;

/// The folder of the pictures, below the page's folder.
pub const PICTURES: &str = "images/quality";

/// The result of a measurement.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Entry {
    pub figures: LayerFigures,
    pub leak: Option<Leak>,
    pub cost: Cost,
}

/// All measurements so far.
pub type Store = Kept<Entry>;

/// The rotation of a scene against the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rotation {
    /// Degrees about x, y and z, as in `--rotate`.
    pub degrees: [i32; 3],
}

impl Rotation {
    pub const NONE: Self = Self { degrees: [0; 3] };
    /// Odd angles: no wall is parallel to an axis or at 45 degrees to one.
    pub const ODD: Self = Self { degrees: [29, 20, 23] };

    pub fn angles_rad(self) -> Vec3 {
        let [x, y, z] = self.degrees.map(|degrees| (degrees as f32).to_radians());
        Vec3::new(x, y, z)
    }
}

/// One measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    pub scene: String,
    pub rotation: Rotation,
    pub preset: PresetChoice,
    pub resolution: u32,
}

impl Case {
    /// The unique key of the measurement.
    pub fn key(&self) -> String {
        let [x, y, z] = self.rotation.degrees;
        format!("{} {x},{y},{z} {} {}", self.scene, self.preset.name(), self.resolution)
    }

    /// The number of grid positions over which figures are averaged: several for unrotated scenes
    /// at the middle resolution, else one.
    pub fn offsets(&self, args: &QualityArgs) -> u32 {
        let is_middle =
            self.rotation == Rotation::NONE && self.resolution == middle(&args.resolutions);
        if is_middle { args.offsets } else { 1 }
    }

    /// The file of the strip; only for unrotated scenes with preset high at the middle resolution.
    pub fn picture(&self, resolutions: &[u32]) -> Option<String> {
        let is_shown = self.rotation == Rotation::NONE
            && self.preset == PresetChoice::Cones(Preset::High)
            && self.resolution == middle(resolutions);
        is_shown.then(|| format!("{}.png", self.scene))
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let preset = self.preset.name();
        write!(f, "{}, {preset}, {} voxels", self.scene, self.resolution)?;
        if self.rotation != Rotation::NONE {
            let [x, y, z] = self.rotation.degrees;
            write!(f, ", turned by {x}, {y}, {z} degrees")?;
        }
        Ok(())
    }
}

/// The resolution in the middle of a list.
pub fn middle(resolutions: &[u32]) -> u32 {
    let mut sorted = resolutions.to_vec();
    sorted.sort_unstable();
    sorted[sorted.len() / 2]
}

/// The scenes that are measured with all presets at all resolutions: a closed room with a lamp, and
/// a hall under sun and sky.
const SWEPT: [&str; 2] = ["cornell", "atrium"];

/// All measurements, scene by scene. Scenes named in `asked` are measured with all presets at all
/// resolutions. Without names, so are those in [`SWEPT`]; others only at the middle resolution,
/// with the presets that have goals.
pub fn cases(
    scenes: &[String],
    asked: bool,
    presets: &[PresetChoice],
    resolutions: &[u32],
) -> Vec<Case> {
    let middle = middle(resolutions);
    let mut cases = Vec::new();
    for scene in scenes {
        let is_swept = asked || SWEPT.contains(&scene.as_str());
        let mut add = |rotation, preset, resolution| {
            cases.push(Case { scene: scene.clone(), rotation, preset, resolution });
        };
        let has_goal = |preset| preset != PresetChoice::Cones(Preset::Fast);
        for &resolution in resolutions {
            for &preset in presets {
                if is_swept || (resolution == middle && has_goal(preset)) {
                    add(Rotation::NONE, preset, resolution);
                }
            }
        }
        if scene.ends_with("-glossy") {
            continue;
        }
        for &preset in presets.iter().filter(|preset| has_goal(**preset)) {
            add(Rotation::ODD, preset, middle);
        }
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plan_contains_each_case_exactly_once() {
        let scenes = ["cornell".to_owned(), "glow".to_owned()];
        let presets = [Preset::Fast, Preset::High].map(PresetChoice::Cones);
        let resolutions = [64, 128, 256];
        let asked = cases(&scenes, true, &presets, &resolutions);
        // Three resolutions of two presets, and one preset of the rotated scene.
        assert_eq!(asked.len(), 2 * (3 * 2 + 1));
        let cases = cases(&scenes, false, &presets, &resolutions);
        assert_eq!(cases.len(), (3 * 2 + 1) + (1 + 1));
        let mut keys: Vec<String> = cases.iter().map(Case::key).collect();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), cases.len());
        let shown = cases.iter().filter_map(|case| case.picture(&[64, 128, 256]));
        assert_eq!(shown.collect::<Vec<_>>(), ["cornell.png", "glow.png"]);
    }
}
