//! The table of commands.

use super::{Console, Reply, commands};

/// What a command belongs to, for the help and the docs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// The program itself.
    Program,
    /// Scenes and pictures.
    Files,
    /// Objects and materials.
    Objects,
    /// Cameras.
    Camera,
    /// Voxels.
    Voxels,
    /// What is shown.
    View,
    /// Light, cones, the look.
    Light,
    /// Frames and their times.
    Frames,
}

/// A command.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// Its name.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// What it belongs to.
    pub group: Group,
    /// Its arguments, as in `NAME X Y Z` or `[FILE]`.
    pub usage: &'static str,
    /// What it does, in one sentence without a full stop.
    pub summary: &'static str,
    /// More about it: units, ranges, defaults, what it prints. May be empty.
    pub details: &'static str,
    /// Of a command that VXCT has: what differs here; empty where nothing does. `None`: VXCT has none like it.
    pub vxct: Option<&'static str>,
    /// Does it.
    pub run: fn(&mut Console, &[&str]) -> anyhow::Result<Reply>,
}

impl Command {
    /// The command of a name or an alias.
    pub fn find(name: &str) -> Option<&'static Self> {
        COMMANDS.iter().find(|command| command.name == name || command.aliases.contains(&name))
    }
}

/// All commands, group by group.
pub static COMMANDS: &[Command] = &[Command {
    name: "quit",
    aliases: &["exit", "q"],
    group: Group::Program,
    usage: "",
    summary: "End the program",
    details: "",
    vxct: Some(""),
    run: commands::program::quit,
}];
