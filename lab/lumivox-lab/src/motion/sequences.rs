//! The sequences: what moves, in which scene, at which step.
//!
//! A sequence has phases, in which something or nothing moves, and a pose for each step. A pose
//! depends only on the scene at the start and the step.

use lumivox_console::Failure;
use lumivox_scene::Scene;

use super::moves::{
    BLOCK, DOOR, Pose, Start, Step, add_door, animation, block, door, lamp, orbit, sun, switch,
};

/// The scene that a sequence is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Home {
    /// The built-in scene of this name; the sequence moves things that only it has.
    Only(&'static str),
    /// Any scene; by default this built-in scene.
    Any(&'static str),
    /// Files with animations.
    Animated,
}

/// Whether anything moves in a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Something moves in every step; the last step shows the end of the motion.
    Moves,
    /// Nothing moves, but the first step may differ from the end of the previous phase.
    Holds,
}

/// A part of a sequence.
#[derive(Clone, Copy, Debug)]
pub struct Phase {
    pub name: &'static str,
    pub kind: Kind,
    pub steps: u32,
}

/// A change whose latency is measured: from the last step of one phase to the still picture of the
/// first step of another.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    pub name: &'static str,
    /// The phase whose last step is the picture before the change.
    pub before: usize,
    /// The hold whose first step is the first frame after the change.
    pub after: usize,
}

/// A sequence of steps; each is one frame.
#[derive(Clone, Copy, Debug)]
pub struct Sequence {
    pub name: &'static str,
    /// A sentence about what moves.
    pub about: &'static str,
    pub home: Home,
    pub phases: &'static [Phase],
    /// The phase of motion after which the camera stops, for the errors at the stop.
    pub stop: Option<usize>,
    pub changes: &'static [Change],
    /// Names of objects that move.
    pub moving: &'static [&'static str],
    prepare: fn(&mut Scene) -> Result<(), Failure>,
    pose: fn(&Start, &Step) -> Pose,
}

const fn moves(name: &'static str, steps: u32) -> Phase {
    Phase { name, kind: Kind::Moves, steps }
}

const fn holds(name: &'static str, steps: u32) -> Phase {
    Phase { name, kind: Kind::Holds, steps }
}

/// Steps of a hold after a change: enough to measure latencies and trails.
const AFTER: u32 = 24;

const ORBIT: Sequence = Sequence {
    name: "orbit",
    about: "The camera orbits the still scene by 15 degrees, and stops.",
    home: Home::Any("cornell"),
    phases: &[holds("start", 1), moves("orbit", 90), holds("stopped", 64)],
    stop: Some(1),
    changes: &[],
    moving: &[],
    prepare: |_| Ok(()),
    pose: orbit,
};

const SLIDING: Sequence = Sequence {
    name: "block",
    about: "The short block slides and turns, and is back at once.",
    home: Home::Only("cornell"),
    phases: &[holds("start", 1), moves("slides", 16), holds("back", AFTER)],
    stop: None,
    changes: &[Change { name: "back", before: 1, after: 2 }],
    moving: &[BLOCK],
    prepare: |_| Ok(()),
    pose: block,
};

/// All sequences.
pub const SEQUENCES: &[Sequence] = &[
    ORBIT,
    Sequence {
        name: "orbit-glossy",
        about: "As `orbit`, in a glossy scene.",
        home: Home::Only("cornell-glossy"),
        ..ORBIT
    },
    Sequence {
        name: "lamp",
        about: "The lamp moves to a corner, and is back at once.",
        home: Home::Any("cornell"),
        phases: &[holds("start", 1), moves("away", 16), holds("back", AFTER)],
        stop: None,
        changes: &[Change { name: "back", before: 1, after: 2 }],
        moving: &[],
        prepare: needs_lamp,
        pose: lamp,
    },
    Sequence {
        name: "switch",
        about: "All lamps are switched off, and on again.",
        home: Home::Any("cornell"),
        phases: &[holds("on", 2), holds("off", AFTER), holds("on again", AFTER)],
        stop: None,
        changes: &[
            Change { name: "off", before: 0, after: 1 },
            Change { name: "on", before: 1, after: 2 },
        ],
        moving: &[],
        prepare: needs_lamp,
        pose: switch,
    },
    SLIDING,
    Sequence {
        name: "block-glossy",
        about: "As `block`, in a glossy scene.",
        home: Home::Only("cornell-glossy"),
        ..SLIDING
    },
    Sequence {
        name: "door",
        about: "The door between the rooms closes, and opens again; seen from the dark room.",
        home: Home::Only("two-rooms"),
        phases: &[
            holds("open", 2),
            moves("closes", 8),
            holds("closed", AFTER),
            moves("opens", 8),
            holds("open again", AFTER),
        ],
        stop: None,
        changes: &[
            Change { name: "closed", before: 0, after: 2 },
            Change { name: "opened", before: 2, after: 4 },
        ],
        moving: &[DOOR],
        prepare: add_door,
        pose: door,
    },
    Sequence {
        name: "sun",
        about: "The sun crosses the opening in the roof.",
        home: Home::Only("atrium"),
        phases: &[holds("start", 1), moves("crosses", 16)],
        stop: None,
        changes: &[],
        moving: &[],
        prepare: |_| Ok(()),
        pose: sun,
    },
    Sequence {
        name: "animation",
        about: "The file's first animation runs once.",
        home: Home::Animated,
        phases: &[holds("start", 1), moves("plays", 32)],
        stop: None,
        changes: &[],
        moving: &[],
        prepare: needs_animation,
        pose: animation,
    },
];

impl Sequence {
    /// The sequence of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SEQUENCES.iter().find(|sequence| sequence.name == name)
    }

    /// The name of the default built-in scene.
    pub fn builtin(&self) -> Option<&'static str> {
        match self.home {
            Home::Only(name) | Home::Any(name) => Some(name),
            Home::Animated => None,
        }
    }

    /// The phases; `moving_steps`, if given, replaces the number of steps of phases of motion.
    pub fn phases(&self, moving_steps: Option<u32>) -> Vec<Phase> {
        let phase = |phase: &Phase| match (phase.kind, moving_steps) {
            (Kind::Moves, Some(steps)) => Phase { steps, ..*phase },
            _ => *phase,
        };
        self.phases.iter().map(phase).collect()
    }

    /// Makes a scene ready for the sequence.
    ///
    /// # Errors
    /// A [`Failure`] of input when the scene has nothing to move.
    pub fn prepare(&self, scene: &mut Scene) -> Result<(), Failure> {
        if let Home::Only(name) = self.home
            && scene.name != name
        {
            return Err(Failure::input(format!(
                "the sequence {} moves things of builtin:{name}, not of \"{}\"; leave the scene out, or give {}",
                self.name,
                scene.name,
                any_scene()
            )));
        }
        (self.prepare)(scene)
    }

    /// The pose at a step.
    pub fn pose(&self, start: &Start, step: &Step) -> Pose {
        (self.pose)(start, step)
    }
}

fn needs_lamp(scene: &mut Scene) -> Result<(), Failure> {
    let has_lamp = scene.lights.iter().any(|light| !light.kind.is_parallel());
    if has_lamp {
        return Ok(());
    }
    Err(Failure::input(format!(
        "\"{}\" has no lamp that could move or be switched off; give another scene, or the \
         sequence orbit (--sequence orbit)",
        scene.name
    )))
}

fn needs_animation(scene: &mut Scene) -> Result<(), Failure> {
    if scene.animations().is_empty() {
        return Err(Failure::input(format!(
            "nothing moves in the scene \"{}\": it has no animation; give {}",
            scene.name,
            any_scene()
        )));
    }
    Ok(())
}

/// The names of the sequences for any scene, in words.
pub fn any_scene() -> String {
    let names = SEQUENCES.iter().filter(|sequence| matches!(sequence.home, Home::Any(_)));
    let names: Vec<&str> = names.map(|sequence| sequence.name).collect();
    format!("a sequence for any scene (--sequence {})", names.join(","))
}

/// The steps of phases, in order.
pub fn steps(phases: &[Phase]) -> Vec<Step> {
    let mut steps = Vec::new();
    for (phase, Phase { steps: count, .. }) in phases.iter().enumerate() {
        for i in 0..*count {
            let share = (i + 1) as f32 / *count as f32;
            steps.push(Step { index: steps.len() as u32, phase, share });
        }
    }
    steps
}

/// The number of the first step of a phase.
pub fn first_of(phases: &[Phase], phase: usize) -> u32 {
    phases[..phase].iter().map(|phase| phase.steps).sum()
}

/// The number of the last step of a phase.
pub fn last_of(phases: &[Phase], phase: usize) -> u32 {
    first_of(phases, phase) + phases[phase].steps - 1
}

/// The steps that are shown, and measured even in large pictures: the middle and the end of a
/// motion, the first and the last step of a hold.
pub fn marked(phases: &[Phase]) -> Vec<u32> {
    let mut marked = Vec::new();
    for (index, phase) in phases.iter().enumerate() {
        let (first, last) = (first_of(phases, index), last_of(phases, index));
        marked.push(if phase.kind == Kind::Moves { first + (last - first) / 2 } else { first });
        marked.push(last);
    }
    marked.dedup();
    marked
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use lumivox_scene::builtin;

    use super::*;

    fn started(sequence: &Sequence) -> Option<Start> {
        let mut scene = builtin::scene(sequence.builtin()?).unwrap();
        sequence.prepare(&mut scene).unwrap();
        scene.validate().unwrap();
        let camera = scene.cameras[0].clone();
        Some(Start { scene, camera, duration_s: 0.0 })
    }

    #[test]
    fn sequences_move_only_in_their_moving_phases() {
        for sequence in SEQUENCES {
            let Some(start) = started(sequence) else { continue };
            let phases = sequence.phases(None);
            let steps = steps(&phases);
            assert!(steps.iter().enumerate().all(|(i, step)| step.index as usize == i));
            for pair in steps.windows(2) {
                let [before, now] = [0, 1].map(|i| sequence.pose(&start, &pair[i]));
                let phase = phases[pair[1].phase];
                let is_first = pair[0].phase != pair[1].phase;
                let name = (sequence.name, phase.name, pair[1].index);
                match phase.kind {
                    Kind::Moves => assert_ne!(before, now, "{name:?}"),
                    Kind::Holds if !is_first => assert_eq!(before, now, "{name:?}"),
                    Kind::Holds => {}
                }
            }
        }
    }

    #[test]
    fn changes_alter_the_scene_and_are_held_20_steps() {
        for sequence in SEQUENCES {
            let Some(start) = started(sequence) else { continue };
            let phases = sequence.phases(Some(3));
            let steps = steps(&phases);
            for change in sequence.changes {
                let before = steps[last_of(&phases, change.before) as usize];
                let after = steps[first_of(&phases, change.after) as usize];
                assert_ne!(sequence.pose(&start, &before), sequence.pose(&start, &after));
                assert!(phases[change.after].steps >= 20, "{} {}", sequence.name, change.name);
                assert_eq!(phases[change.after].kind, Kind::Holds);
            }
        }
    }

    #[test]
    fn marked_steps_are_middles_and_ends_of_phases() {
        let phases = [holds("a", 1), moves("b", 4), holds("c", 3)];
        assert_eq!(marked(&phases), [0, 2, 4, 5, 7]);
        assert_eq!([first_of(&phases, 2), last_of(&phases, 2)], [5, 7]);
        let shares: Vec<f32> = steps(&phases)[1..5].iter().map(|step| step.share).collect();
        assert_eq!(shares, [0.25, 0.5, 0.75, 1.0]);
    }

    #[test]
    fn the_door_covers_the_doorway_only_when_closed() {
        let sequence = Sequence::named("door").unwrap();
        let start = started(sequence).unwrap();
        let picker_at = |index: u32| {
            let phases = sequence.phases(None);
            let pose = sequence.pose(&start, &steps(&phases)[index as usize]);
            let mut scene = start.scene.clone();
            let (name, place) = pose.places[0];
            let door = scene.instances.iter_mut().find(|instance| instance.name == name).unwrap();
            door.world_from_local = place;
            lumivox_scene::Picker::new(&scene)
        };
        let phases = sequence.phases(None);
        let (open, closed) = (picker_at(0), picker_at(first_of(&phases, 2)));
        for (y, z) in [(0.8, 0.5), (0.01, 0.16), (1.59, 0.94)] {
            let hit = |picker: &lumivox_scene::Picker| {
                picker.pick(Vec3::new(1.0, y, z), Vec3::NEG_X).unwrap().position.x
            };
            assert!(hit(&closed) > -0.05, "{}", hit(&closed));
            assert!(hit(&open) < -1.9, "{}", hit(&open));
        }
    }

    #[test]
    fn scenes_without_the_needed_objects_are_refused() {
        let mut furnace = builtin::scene("furnace").unwrap();
        for (name, words) in
            [("switch", "no lamp"), ("block", "builtin:cornell"), ("animation", "no animation")]
        {
            let error = Sequence::named(name).unwrap().prepare(&mut furnace).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
    }
}
