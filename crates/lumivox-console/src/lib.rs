//! The console: commands in words that look at and change everything at run time.
//!
//! A line is a command's name and its arguments, separated by white space; [`line`](self) describes
//! quotation marks, comments and several commands in a line. All commands are in one table
//! ([`COMMANDS`]), put together from a file for each group, from which the help, the completion and
//! the page in the docs are made as well. Each setting of [`lumivox_explorer::parameters`] is a
//! command as well: without a value it prints the setting, with a value it sets it.
//!
//! The window, the terminal, scripts and pages all give lines to a [`Console`]; it requests work
//! that takes long, or that is not its own, from them by an [`Effect`]. Lines that wait for such
//! effects are in a [`Queue`]. Files are reached by an [`Outside`], because a browser has no disk;
//! and code that waits is `async`, because a browser must not block.
//!
//! | file | is |
//! | --- | --- |
//! | `line.rs` | lines split into commands and words |
//! | `command.rs` | what a command is, and the table |
//! | `commands/` | what the commands do, a file for each group |
//! | `arguments.rs` | arguments read by kind |
//! | `queue.rs` | scripts, and lines that wait |
//! | `names.rs`, `complete.rs` | what can be named, and completion by it |
//! | `help.rs`, `page.rs` | the help, and the page in the docs |
//! | `opening/`, `outside.rs` | which scene is opened and how, and what is reached besides |
//! | `values/` | values that command lines have as well |
//! | `report.rs`, `comparison.rs`, `shown.rs` | what is said: tables, figures, text that a terminal does not obey |
//! | `classify.rs` | properties of a line that are known before it is run |

#![allow(clippy::format_push_string, reason = "what is said is put together once for each command")]
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]

mod arguments;
mod classify;
mod command;
mod commands;
mod comparison;
pub mod complete;
mod failure;
pub mod help;
mod line;
mod names;
mod opening;
mod outside;
pub mod page;
mod properties;
mod queue;
pub mod report;
pub mod shown;
pub mod values;

use std::fmt;
use std::ops::ControlFlow;
use std::sync::{Arc, Weak};

use lumivox_explorer::{Explorer, RequestedSettings, Revoxelize};
use lumivox_render::{PresetChoice, RenderProgress, RenderSettings};
use lumivox_scene::{EnvironmentMap, Scene};
use wgpu::WasmNotSend;

pub use classify::{LineInfo, words};
pub use command::{COMMANDS, Command, Edits, Group, Run, Takes, Urgency, Waiting};
pub use commands::program::read as script_of_bytes;
pub use commands::surroundings::SUN as SUN_OF_SKY;
pub use comparison::{Comparison, named_figures};
pub use failure::{Blame, Failure};
pub use line::{LineError, Word, Words, commands as begun, is_obeyed, quote, split};
pub use lumivox_explorer::suggest;
pub use names::{Names, is_scene};
pub use opening::{BUILTIN, LoadArgs, OpenedScene, SceneRequest, SceneSource, SourceArgs};
pub use outside::{Outside, Reading};
pub use queue::{Line, Queue, script};

/// The work that a command leaves to the front end that gave the line.
#[derive(Debug, Default)]
pub enum Effect {
    /// Nothing.
    #[default]
    Nothing,
    /// Read a scene and give it to [`Console::open`].
    Open(Box<SceneRequest>),
    /// Render this number of frames before the next command.
    Wait(u32),
    /// Do these lines next, before any that wait: [`Queue::interpose`].
    Run(Vec<Line>),
    /// End the program.
    Quit,
}

/// The result of a command.
#[derive(Debug, Default)]
pub struct Reply {
    /// For the user, without a line feed at its end; may be empty.
    pub text: String,
    /// The work that is left to do.
    pub effect: Effect,
}

impl Reply {
    /// Words for the user.
    pub fn say(text: impl Into<String>) -> Self {
        Self { text: text.into(), effect: Effect::Nothing }
    }

    /// Something left to do.
    pub fn ask(effect: Effect) -> Self {
        Self { text: String::new(), effect }
    }
}

/// Hears how far a command is that takes long; those that can be broken off end when it breaks.
pub trait ProgressListener: WasmNotSend {
    /// Hears of a step.
    fn progress(&mut self, step: RenderProgress) -> ControlFlow<()>;
}

impl<F: FnMut(RenderProgress) -> ControlFlow<()> + WasmNotSend> ProgressListener for F {
    fn progress(&mut self, step: RenderProgress) -> ControlFlow<()> {
        self(step)
    }
}

/// The console of an explorer.
pub struct Console {
    /// The state that the commands work on.
    pub explorer: Explorer,
    /// How its scene was opened.
    opening: Option<SceneRequest>,
    /// How scenes are read and lit that `load` says nothing of.
    defaults: Option<(LoadArgs, SourceArgs)>,
    listener: Box<dyn ProgressListener>,
    outside: Box<dyn Outside>,
    /// The scene that the following is about.
    generation: u32,
    /// The bounces that come back when indirect light is switched on.
    bounces: Option<u32>,
    /// The switches of voxels, and of objects, after the last flip of one.
    shown: commands::view::Shown,
    objects: commands::view::Objects,
    /// Panoramas and skies, with the commands that made them.
    maps: Vec<(Weak<EnvironmentMap>, String)>,
    /// The ray that is marked.
    ray: Option<commands::ray::RayMarker>,
    /// The interval of voxelizations when `dynamic` is on again.
    dynamic: Option<Revoxelize>,
}

impl fmt::Debug for Console {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Console").field("explorer", &self.explorer).finish_non_exhaustive()
    }
}

impl Console {
    /// The console of an explorer, and its access to things outside of it.
    pub fn new(explorer: Explorer, outside: Box<dyn Outside>) -> Self {
        Self {
            explorer,
            opening: None,
            defaults: None,
            listener: Box::new(|_| ControlFlow::Continue(())),
            outside,
            generation: 0,
            bounces: None,
            shown: commands::view::Shown::default(),
            objects: commands::view::Objects::default(),
            maps: Vec::new(),
            ray: None,
            dynamic: None,
        }
    }

    /// Scenes are read and lit like this where `load` does not say otherwise.
    #[must_use]
    pub fn with_defaults(mut self, load: LoadArgs, light: SourceArgs) -> Self {
        self.defaults = Some((load, light));
        self
    }

    /// Shows a scene from its camera: [`Explorer::open`]. From one of VXCT's scenes to another the
    /// camera stays, unless one was asked for: they fill the same cube.
    pub fn open(&mut self, scene: OpenedScene) {
        let is_of_vxct = |scene: &Scene| scene.grid_bounds.is_some() && scene.has_display_values();
        let stays = scene.request.camera.is_none()
            && is_of_vxct(scene.prepared.scene())
            && self.explorer.scene().is_some_and(is_of_vxct);
        let camera = stays.then(|| self.explorer.camera().clone());
        self.explorer.open(scene.prepared);
        if let Some(camera) = camera {
            self.explorer.set_camera(camera);
        }
        self.opening = Some(scene.request);
    }

    /// Shows a scene that was read again, with the changes of its objects: [`Explorer::reopen`].
    pub fn reopen(&mut self, scene: OpenedScene) -> usize {
        self.opening = Some(scene.request);
        self.explorer.reopen(scene.prepared)
    }

    /// How the scene was opened that is shown.
    pub fn scene_request(&self) -> Option<&SceneRequest> {
        self.opening.as_ref().filter(|_| self.explorer.scene().is_some())
    }

    /// Sets the listener for the progress of long commands, such as `screenshot` and `compare`.
    pub fn on_progress(&mut self, listener: Box<dyn ProgressListener>) {
        self.listener = listener;
    }

    /// Executes a line; an empty one, or a comment, does nothing. Several commands in a line come
    /// back as [`Effect::Run`].
    ///
    /// # Errors
    /// When there is no such command, an argument is wrong, or it cannot be done. The message says
    /// what would have been right. Nothing has changed then.
    pub async fn run(&mut self, line: &str) -> anyhow::Result<Reply> {
        let reply = self.run_on(line).await;
        self.explorer.end_gesture();
        reply
    }

    /// The same as a part of the last line's work, such as a drag: changes of the same things are
    /// one step for `undo`.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub async fn run_on(&mut self, line: &str) -> anyhow::Result<Reply> {
        let reply = self.obey(line).await;
        self.explorer.note_change();
        reply
    }

    async fn obey(&mut self, line: &str) -> anyhow::Result<Reply> {
        let commands = split(line).map_err(|error| Failure::input(error.to_string()))?;
        let words = match commands.as_slice() {
            [] => return Ok(Reply::default()),
            [words] => words,
            _ => {
                let lines = script(line, "")?.into_iter().map(Line::nowhere).collect();
                return Ok(Reply::ask(Effect::Run(lines)));
            }
        };
        self.notice_scene();
        let words: Vec<&str> = words.iter().map(|word| word.text.as_str()).collect();
        let Some((name, arguments)) = words.split_first() else { return Ok(Reply::default()) };
        let before = self.explorer.asked();
        let reply = match Command::find(name) {
            None => commands::parameters::run(self, name, arguments)?,
            // `sf` with a value is another command than `sf` without, as in VXCT, and so are
            // commands that are also settings.
            Some(command) if !command.counts().contains(&arguments.len()) => {
                return Err(wrong_count(command, arguments.len()).into());
            }
            Some(command) => match command.run {
                Run::Now(run) => run(self, arguments)?,
                Run::Waits(run) => run(self, arguments).await?,
            },
        };
        self.confirm(before).await?;
        Ok(reply)
    }

    /// Settings that take memory for voxels are applied at once, where there is a picture: a
    /// refusal of the renderer is then reported at its own line, and affects nothing else.
    async fn confirm(&mut self, before: RequestedSettings) -> anyhow::Result<()> {
        let of_voxels = |s: &RenderSettings| {
            let grid = (s.resolution, s.grid_offset, s.grid_bounds);
            (grid, s.directionality, s.volume, s.volume_memory, s.injection.clone())
        };
        let Self { explorer, listener, .. } = self;
        if of_voxels(explorer.settings()) != of_voxels(&before.settings) {
            let mut progress = |step| {
                let _ = listener.progress(step);
            };
            explorer.confirm(before, &mut progress).await?;
        }
        Ok(())
    }

    /// Forgets data of a scene that is no longer there.
    fn notice_scene(&mut self) {
        if self.generation != self.explorer.generation() {
            self.generation = self.explorer.generation();
            self.ray = None;
            self.maps.retain(|(map, _)| map.strong_count() > 0);
        }
    }

    /// Remembers how a panorama was made, for `script`.
    fn remember_map(&mut self, map: &Arc<EnvironmentMap>, line: String) {
        self.maps.push((Arc::downgrade(map), line));
    }

    /// The command that made a panorama.
    fn maker_of(&self, map: &Arc<EnvironmentMap>) -> Option<&str> {
        let is_it = |(known, _): &&(Weak<EnvironmentMap>, String)| {
            known.upgrade().is_some_and(|known| Arc::ptr_eq(&known, map))
        };
        self.maps.iter().find(is_it).map(|(_, line)| line.as_str())
    }

    /// Changes settings, all or nothing.
    ///
    /// # Errors
    /// When one is out of range.
    fn change(&mut self, change: impl FnOnce(&mut RenderSettings)) -> anyhow::Result<()> {
        let mut settings = self.explorer.settings().clone();
        change(&mut settings);
        self.set(settings, self.explorer.preset())
    }

    /// Asks for settings.
    ///
    /// # Errors
    /// When one is out of range.
    fn set(&mut self, settings: RenderSettings, preset: PresetChoice) -> anyhow::Result<()> {
        commands::voxels::check_level(&self.explorer, &settings)?;
        Ok(self.explorer.choose_settings(settings, preset)?)
    }

    /// Brings the renderer up to date.
    ///
    /// # Errors
    /// When there is nothing to show, or as [`Explorer::update`].
    async fn update(&mut self) -> anyhow::Result<()> {
        let Self { explorer, listener, .. } = self;
        let mut progress = |step| {
            let _ = listener.progress(step);
        };
        explorer.update(&mut progress).await?;
        if explorer.renderer().is_some() { Ok(()) } else { Err(nothing_to_show().into()) }
    }
}

fn nothing_to_show() -> Failure {
    Failure::input(
        "there is nothing to show; `load SCENE` opens a scene, `show all` shows its objects",
    )
}

fn wrong_count(command: &Command, count: usize) -> Failure {
    let takes = match command.usage {
        "" => "nothing",
        usage => usage,
    };
    let got = match count {
        0 => "nothing".to_owned(),
        1 => "1 word".to_owned(),
        count => format!("{count} words"),
    };
    let name = command.name;
    Failure::input(format!("{name} takes {takes}; got {got} (`help {name}` tells more)"))
}

#[cfg(test)]
mod corpus;
#[cfg(test)]
mod tests;
