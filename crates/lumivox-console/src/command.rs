//! The table of commands: what the commands are, apart from what they do.

use std::ops::RangeInclusive;
use std::pin::Pin;
use std::sync::LazyLock;

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
    /// Lamps and surroundings.
    Light,
    /// Cones, shadows, the look.
    Look,
    /// Frames and their times.
    Frames,
}

impl Group {
    /// All groups in order.
    pub const ALL: [Self; 9] = [
        Self::Program,
        Self::Files,
        Self::Objects,
        Self::Camera,
        Self::Voxels,
        Self::View,
        Self::Light,
        Self::Look,
        Self::Frames,
    ];

    /// What it holds, as a heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Program => "The program",
            Self::Files => "Scenes and pictures",
            Self::Objects => "Objects and materials",
            Self::Camera => "Camera",
            Self::Voxels => "Voxels",
            Self::View => "What is shown",
            Self::Light => "Lamps and surroundings",
            Self::Look => "Light, cones, the look",
            Self::Frames => "Frames and time",
        }
    }
}

/// What an argument names, for the completion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// Something that cannot be completed, such as a number.
    Anything,
    /// An object.
    Object,
    /// A material.
    Material,
    /// A light.
    Light,
    /// A camera of the scene, or one that was stored.
    Camera,
    /// Where a camera is stored.
    Stored,
    /// A scene: a file, a name in a folder of scenes, or a built-in one.
    Scene,
    /// A file.
    File,
    /// An animation.
    Animation,
    /// A command or a setting.
    Command,
    /// A setting.
    Parameter,
    /// `on` or `off`.
    Switch,
    /// One of these words.
    Word(&'static [&'static str]),
}

/// Why a command goes before those that wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// It stops what is under way.
    Cancel,
    /// It ends the program.
    Quit,
}

/// The part of the scene that a command may change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edits {
    /// Nothing.
    Nothing,
    /// Objects, or the scene as a whole. Changes of objects stay when the scene's file is read again.
    #[default]
    Scene,
    /// Materials, lights or surroundings, which are those of the file when it is read again.
    Look,
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
    /// How many there may be, the least and the most.
    pub count: (usize, usize),
    /// What they name, in order; the last stands for those beyond.
    pub takes: &'static [Takes],
    /// What it does, in one sentence without a full stop.
    pub summary: &'static str,
    /// More about it: units, ranges, defaults, what it prints. May be empty.
    pub details: &'static str,
    /// A line that uses it.
    pub example: &'static str,
    /// Of a command that VXCT has: what differs here; empty where nothing does. `None`: VXCT has none like it.
    pub vxct: Option<&'static str>,
    /// If it does nothing but set something to what it says: how many of its words, its name included, say what it
    /// sets. It has more words then, and a later line that begins with these supersedes it.
    pub sets: Option<usize>,
    /// Whether the camera is where it has put it afterwards.
    pub moves_camera: bool,
    /// Without arguments it goes before lines that wait.
    pub urgency: Option<Urgency>,
    /// The part of the scene that it may change.
    pub edits: Edits,
    /// Whether it asks for all frames of the picture: front ends render them before, one by one.
    pub needs_all_frames: bool,
    /// Does it.
    pub run: Run,
}

/// How a command is done.
#[derive(Clone, Copy, Debug)]
pub enum Run {
    /// At once.
    Now(fn(&mut Console, &[&str]) -> anyhow::Result<Reply>),
    /// It waits, for the GPU or for a file.
    Waits(for<'a> fn(&'a mut Console, &'a [&'a str]) -> Waiting<'a>),
}

/// A command that is being done.
pub type Waiting<'a> = Pin<Box<dyn Future<Output = anyhow::Result<Reply>> + 'a>>;

/// As many arguments as one likes.
pub const MANY: usize = usize::MAX;

/// What commands are made from.
pub const PLAIN: Command = Command {
    name: "",
    aliases: &[],
    group: Group::Program,
    usage: "",
    count: (0, 0),
    takes: &[],
    summary: "",
    details: "",
    example: "",
    vxct: None,
    sets: None,
    moves_camera: false,
    urgency: None,
    edits: Edits::Scene,
    needs_all_frames: false,
    run: Run::Now(|_, _| Ok(Reply::default())),
};

impl Command {
    /// The command of a name or an alias.
    pub fn find(name: &str) -> Option<&'static Self> {
        COMMANDS.iter().find(|command| command.names().any(|known| known == name))
    }

    /// Its name and its aliases.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        [self.name].into_iter().chain(self.aliases.iter().copied())
    }

    /// How many arguments there may be.
    pub fn counts(&self) -> RangeInclusive<usize> {
        self.count.0..=self.count.1
    }

    /// Its name and its arguments.
    pub fn form(&self) -> String {
        format!("{} {}", self.name, self.usage).trim_end().to_owned()
    }
}

/// All commands, group by group.
pub static COMMANDS: LazyLock<Vec<Command>> = LazyLock::new(|| {
    let tables = [
        commands::program::TABLE,
        commands::parameters::TABLE,
        commands::files::TABLE,
        commands::pictures::TABLE,
        commands::objects::TABLE,
        commands::materials::TABLE,
        commands::camera::TABLE,
        commands::voxels::TABLE,
        commands::view::TABLE,
        commands::ray::TABLE,
        commands::lights::TABLE,
        commands::surroundings::TABLE,
        commands::look::TABLE,
        commands::frames::TABLE,
        commands::animation::TABLE,
    ];
    tables.concat()
});
