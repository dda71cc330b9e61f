//! Properties of a line that are known before it runs, from columns of the command table.

use lumivox_explorer::parameters::find_parameter;

use super::{COMMANDS, Command, Edits, Group, Urgency, split};
use crate::command::PLAIN;

const WINDOW: Command = Command { group: Group::Program, edits: Edits::Nothing, ..PLAIN };

/// Commands that only the window has. Other front ends skip them in scripts.
const OF_WINDOW: [Command; 6] = [
    Command { name: "select", sets: Some(1), ..WINDOW },
    Command { name: "compare_with", sets: Some(1), ..WINDOW },
    Command { name: "cancel", urgency: Some(Urgency::Cancel), ..WINDOW },
    Command { name: "fullscreen", ..WINDOW },
    Command { name: "wait_shown", ..WINDOW },
    Command { name: "lose_device", ..WINDOW },
];

/// Properties of a line that are known before it is run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineInfo {
    /// The target if the line only sets something: a later line with the same target supersedes it.
    pub target: Option<String>,
    /// Why it runs before waiting lines; `None` if it does not.
    pub urgency: Option<Urgency>,
    /// `true` if it may set the camera.
    pub moves_camera: bool,
    /// The part of the scene that it may change.
    pub edits: Edits,
    /// Whether the line needs all frames of the picture.
    pub needs_all_frames: bool,
    /// The command's name if it exists only in the window.
    pub window_command: Option<&'static str>,
}

impl LineInfo {
    /// The properties of a line of one command; the default for other lines.
    pub fn of(text: &str) -> Self {
        let Some(words) = words(text) else { return Self::default() };
        let Some(name) = words.first() else { return Self::default() };
        let of_window = OF_WINDOW.iter().find(|command| command.name == name);
        let command = COMMANDS.iter().find(|command| command.names().any(|known| known == name));
        let is_setting = find_parameter(name).is_some();
        let Command { sets, urgency, moves_camera, edits, needs_all_frames, .. } =
            *of_window.or(command).unwrap_or(&PLAIN);
        let sets = sets.or(is_setting.then_some(1)).filter(|named_by| words.len() > *named_by);
        Self {
            target: sets.map(|named_by| words[..named_by].join("\u{0}")),
            urgency: urgency.filter(|_| words.len() == 1),
            moves_camera,
            edits: if is_setting { Edits::Nothing } else { edits },
            needs_all_frames,
            window_command: of_window.map(|command| command.name),
        }
    }
}

/// The words of a line of one command; `None` for other lines.
pub fn words(text: &str) -> Option<Vec<String>> {
    let commands = split(text).ok()?;
    let [words] = commands.as_slice() else { return None };
    Some(words.iter().map(|word| word.text.clone()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_commands_are_distinguished_from_similar_words() {
        assert_eq!(LineInfo::of("select 'a b'").window_command, Some("select"));
        assert_eq!(LineInfo::of("selected").window_command, None);
        let is_in_both = |command: &Command| Command::find(command.name).is_some();
        assert!(!OF_WINDOW.iter().any(is_in_both));
    }

    #[test]
    fn lines_that_only_set_something_have_a_target() {
        let target = |text| LineInfo::of(text).target;
        assert_eq!(target("bounces 1"), target("bounces  2"));
        assert_eq!(target("place 'a b' 1 0 0 0 0 0 1"), target("place \"a b\" 2 0 0 0 0 0 1"));
        assert_ne!(target("light lamp position 1 2 3"), target("light lamp color 1 1 1"));
        // These print, accumulate, or contain several commands.
        for text in ["bounces", "place a", "translate a 1 0 0", "size 8x8; size 9x9", ""] {
            assert_eq!(target(text), None, "{text}");
        }
    }

    #[test]
    fn only_bare_quit_and_cancel_are_urgent() {
        let urgency = |text| LineInfo::of(text).urgency;
        assert_eq!(urgency(" quit "), Some(Urgency::Quit));
        assert_eq!(urgency("exit"), Some(Urgency::Quit));
        assert_eq!(urgency("cancel"), Some(Urgency::Cancel));
        assert_eq!((urgency("echo quit"), urgency("quit now")), (None, None));
    }

    #[test]
    fn line_info_says_what_a_command_changes() {
        assert!(LineInfo::of("pos1").moves_camera && !LineInfo::of("store 1").moves_camera);
        let edits = |text| LineInfo::of(text).edits;
        assert_eq!(edits("setmat a kd 1 1 1"), Edits::Look);
        assert_eq!(edits("translate a 1 0 0"), Edits::Scene);
        assert_eq!((edits("bounces 2"), edits("orbit 1 0")), (Edits::Nothing, Edits::Nothing));
        assert!(LineInfo::of("screenshot a.png").needs_all_frames);
    }
}
