//! The type of a command, and the table of all commands.

use std::ops::RangeInclusive;
use std::pin::Pin;
use std::sync::LazyLock;

use super::{Console, Reply, commands};

/// The group of a command, for the help and the docs.
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
    /// The view: surfaces, voxels, wires.
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

    /// The heading of the group.
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

/// The kind of thing that an argument names, for the completion.
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
    /// A name for a stored camera.
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

/// Why a command runs before waiting commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgency {
    /// It cancels running work.
    Cancel,
    /// It ends the program.
    Quit,
}

/// The part of the scene that a command may change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Edits {
    /// Nothing.
    Nothing,
    /// Objects, or the whole scene. Changes of objects survive when the scene's file is read again.
    #[default]
    Scene,
    /// Materials, lights or surroundings. These changes are lost when the scene's file is read
    /// again.
    Look,
}

/// A command.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// Its name.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// The group that it belongs to.
    pub group: Group,
    /// Its arguments, as in `NAME X Y Z` or `[FILE]`.
    pub usage: &'static str,
    /// The least and the most arguments.
    pub count: (usize, usize),
    /// The kinds of its arguments, in order; the last also applies to further ones.
    pub takes: &'static [Takes],
    /// A sentence on its effect, without a full stop.
    pub summary: &'static str,
    /// Details: units, ranges, defaults, output. May be empty.
    pub details: &'static str,
    /// Details generated from a table; may be empty.
    pub more: fn() -> String,
    /// An example line.
    pub example: &'static str,
    /// For a command that only sets something: how many of its first words name the target, its
    /// name included. A later line with the same first words supersedes it.
    pub sets: Option<usize>,
    /// `true` if it may set the camera.
    pub moves_camera: bool,
    /// Why it runs before waiting lines if it has no arguments; `None` if it does not.
    pub urgency: Option<Urgency>,
    /// The part of the scene that it may change.
    pub edits: Edits,
    /// Whether it needs all frames of the picture: front ends render them first, one by one.
    pub needs_all_frames: bool,
    /// Its code.
    pub run: Run,
}

/// The code of a command.
#[derive(Clone, Copy, Debug)]
pub enum Run {
    /// Runs at once.
    Now(fn(&mut Console, &[&str]) -> anyhow::Result<Reply>),
    /// Waits for the GPU or for a file.
    Waits(for<'a> fn(&'a mut Console, &'a [&'a str]) -> Waiting<'a>),
}

/// A running command.
pub type Waiting<'a> = Pin<Box<dyn Future<Output = anyhow::Result<Reply>> + 'a>>;

/// Any number of arguments.
pub const MANY: usize = usize::MAX;

/// Defaults of a command's fields.
pub const PLAIN: Command = Command {
    name: "",
    aliases: &[],
    group: Group::Program,
    usage: "",
    count: (0, 0),
    takes: &[],
    summary: "",
    details: "",
    more: String::new,
    example: "",
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

    /// The name and the aliases.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        [self.name].into_iter().chain(self.aliases.iter().copied())
    }

    /// All details, in one line.
    pub fn details(&self) -> String {
        format!("{} {}", self.details, (self.more)()).trim().to_owned()
    }

    /// The range of the number of arguments.
    pub fn counts(&self) -> RangeInclusive<usize> {
        self.count.0..=self.count.1
    }

    /// The name and the arguments.
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
