//! The cases to measure, and their names.

use glam::UVec2;
use lumivox::Preset;
use lumivox_console::SceneSource;
use lumivox_render::PresetChoice;
use serde::{Deserialize, Serialize};

use crate::cli::{BenchArgs, VolumeChoice};

/// The size at which everything is measured.
const SIZE: UVec2 = UVec2::new(640, 360);
/// The size of a screen, and the only resolution of voxels at which it is measured.
const SCREEN: (UVec2, u32) = (UVec2::new(1920, 1080), 128);
/// The resolution of the small part.
const SMALL: u32 = 64;

/// Whether things move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// Nothing moves: frames of a still picture, and the cost of changing everything.
    Still,
    /// A lamp and a block move in every frame.
    Moving,
}

impl Motion {
    pub const ALL: [Self; 2] = [Self::Still, Self::Moving];

    fn name(self) -> &'static str {
        match self {
            Self::Still => "still",
            Self::Moving => "moving",
        }
    }
}

/// One case.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The index of its scene in the plan.
    pub scene: usize,
    /// The name of its scene.
    pub scene_name: String,
    pub volume: VolumeChoice,
    /// Voxels along the scene's longest axis.
    pub resolution: u32,
    pub preset: PresetChoice,
    pub size: UVec2,
}

impl Case {
    /// The name, the same in all reports: `cornell/dense/64/fast/640x360/still`.
    pub fn id(&self, motion: Motion) -> String {
        format!(
            "{}/{}/{}/{}/{}x{}/{}",
            self.scene_name,
            self.volume.name(),
            self.resolution,
            self.preset.name(),
            self.size.x,
            self.size.y,
            motion.name()
        )
    }
}

/// All cases of a run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scenes.
    pub scenes: Vec<SceneSource>,
    /// The cases, scene by scene.
    pub cases: Vec<Case>,
    /// A description of the choice of cases, for the report.
    pub words: &'static str,
}

impl Plan {
    /// The plan of a command line, on a software driver or on a GPU.
    pub fn new(args: &BenchArgs, is_software: bool) -> Self {
        let is_own = !(args.scenes.is_empty()
            && args.volumes.is_empty()
            && args.resolutions.is_empty()
            && args.presets.is_empty()
            && args.sizes.is_empty());
        let is_small = args.quick || is_software;
        let is_smallest = args.quick && is_software;
        let words = match (is_own, is_software, args.quick) {
            (true, ..) => "chosen on the command line",
            (false, true, true) => {
                "the smallest part of the standard cases: a software driver, --quick"
            }
            (false, true, false) => {
                "the small part of the standard cases, because this is a software driver"
            }
            (false, false, true) => "the small part of the standard cases: --quick",
            (false, false, false) => "all standard cases",
        };
        let builtin = |name: &str| SceneSource::Builtin(name.to_owned());
        let mut usual = vec![builtin("cornell"), builtin("atrium")];
        usual.truncate(if is_smallest { 1 } else { 2 });
        let [fast, balanced] = [Preset::Fast, Preset::Balanced].map(PresetChoice::Cones);
        let presets = if is_smallest { vec![fast] } else { vec![fast, balanced] };
        let resolutions = if is_small { vec![SMALL] } else { vec![SMALL, 128, 256] };
        let or = |given: &Vec<u32>, usual: Vec<u32>| {
            if given.is_empty() { usual } else { given.clone() }
        };
        let scenes = if args.scenes.is_empty() { usual } else { args.scenes.clone() };
        let volumes =
            if args.volumes.is_empty() { VolumeChoice::ALL.to_vec() } else { args.volumes.clone() };
        let presets = if args.presets.is_empty() { presets } else { args.presets.clone() };
        let resolutions = or(&args.resolutions, resolutions);
        let sizes = |resolution: u32| match &args.sizes[..] {
            [] if !is_small && resolution == SCREEN.1 => vec![SIZE, SCREEN.0],
            [] => vec![SIZE],
            given => given.to_vec(),
        };
        let mut cases: Vec<Case> = Vec::new();
        for (scene, source) in scenes.iter().enumerate() {
            for &volume in &volumes {
                for &resolution in &resolutions {
                    for &preset in &presets {
                        for size in sizes(resolution) {
                            let scene_name = name_of(source);
                            let case = Case { scene, scene_name, volume, resolution, preset, size };
                            if !cases.contains(&case) {
                                cases.push(case);
                            }
                        }
                    }
                }
            }
        }
        Self { scenes, cases, words }
    }
}

/// The name of a scene within an id.
fn name_of(source: &SceneSource) -> String {
    match source {
        SceneSource::Builtin(name) => name.clone(),
        SceneSource::File(file) => {
            let name = file.file_name().unwrap_or_default();
            name.to_string_lossy().into_owned()
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use std::collections::BTreeSet;

    use clap::Parser as _;

    use super::*;
    use crate::cli::{Cli, Command};

    /// The plan of a command line.
    pub fn plan(line: &str, is_software: bool) -> Plan {
        let words = format!("lumivox bench {line}");
        match Cli::try_parse_from(words.split_whitespace()).unwrap().command {
            Some(Command::Bench(args)) => Plan::new(&args, is_software),
            _ => panic!("{line} is no bench command"),
        }
    }

    fn ids(plan: &Plan) -> BTreeSet<String> {
        let ids = plan.cases.iter().flat_map(|case| Motion::ALL.map(|motion| case.id(motion)));
        let set: BTreeSet<String> = ids.collect();
        assert_eq!(set.len(), 2 * plan.cases.len(), "names are unique");
        set
    }

    #[test]
    fn smaller_plans_are_parts_of_larger_ones() {
        let full = ids(&plan("", false));
        assert_eq!(full.len(), 64);
        assert!(full.contains("atrium/octree/128/balanced/1920x1080/moving"), "{full:?}");
        let (small, smallest) = (ids(&plan("--quick", false)), ids(&plan("--quick", true)));
        assert_eq!(small, ids(&plan("", true)), "a software driver's are the quick ones");
        assert!(small.is_subset(&full) && smallest.is_subset(&small));
        assert_eq!((small.len(), smallest.len()), (16, 4));
    }

    #[test]
    fn options_override_the_standard_plan() {
        let own =
            plan("--scene builtin:glow --resolutions 32,32 --sizes 64x36 --volumes octree", true);
        assert_eq!(own.words, "chosen on the command line");
        let ids = ids(&own);
        assert_eq!(ids.len(), 4, "{ids:?}");
        assert!(ids.contains("glow/octree/32/fast/64x36/still"), "{ids:?}");
    }
}
