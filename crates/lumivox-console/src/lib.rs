//! The console: text commands that inspect and change everything at run time.
//!
//! A line is a command's name and its arguments, separated by white space; [`line`](self) describes
//! quotation marks, comments and several commands in a line. All commands are in one table
//! ([`COMMANDS`]), assembled from a file for each group. The help, the completion and the page in
//! the docs are made from it. Each setting of [`lumivox_explorer::parameters`] is a command as
//! well: without a value it prints the setting, with a value it sets it.
//!
//! The window, the terminal, scripts and web pages pass lines to a [`Console`]. Work for these
//! front ends is returned as an [`Effect`]; lines that wait for it are in a [`Queue`]. Files are
//! read and written through [`Outside`], because a browser has no disk; functions that wait are
//! `async`, because a browser must not block.
//!
//! | file | is |
//! | --- | --- |
//! | `line.rs` | lines split into commands and words |
//! | `command.rs` | the type of a command, and the table |
//! | `commands/` | the commands, one file for each group |
//! | `arguments.rs` | reading arguments by kind |
//! | `queue.rs` | scripts and queued lines |
//! | `names.rs`, `complete.rs` | the names in a scene, and completion with them |
//! | `help.rs`, `page.rs` | the help, and the generated page `docs/generated/console.md` |
//! | `opening/`, `outside.rs` | requests to open a scene, and access to files and the network |
//! | `values/` | values shared with command-line options |
//! | `report.rs`, `comparison.rs`, `shown.rs` | output: tables, comparisons, printable text |
//! | `classify.rs` | properties of a line known before it runs |

#![allow(clippy::format_push_string, reason = "output is assembled once for each command")]
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
pub use comparison::{Comparison, named_figures};
pub use failure::{Blame, Failure};
pub use line::{LineError, Word, Words, commands as begun, is_obeyed, quote, split};
pub use lumivox_explorer::suggest;
pub use names::{Names, is_scene};
pub use opening::{BUILTIN, LoadArgs, OpenedScene, SceneRequest, SceneSource, SourceArgs};
pub use outside::{Outside, Reading};
pub use queue::{Line, Queue, script};

/// Work of a command that its front end does.
#[derive(Debug, Default)]
pub enum Effect {
    /// Nothing.
    #[default]
    Nothing,
    /// Read a scene and give it to [`Console::open`].
    Open(Box<SceneRequest>),
    /// Render this many frames before the next command.
    Wait(u32),
    /// Run these lines next, before any that wait: [`Queue::interpose`].
    Run(Vec<Line>),
    /// End the program.
    Quit,
}

/// The result of a command.
#[derive(Debug, Default)]
pub struct Reply {
    /// Text for the user, without a line feed at its end; may be empty.
    pub text: String,
    /// Work left to the front end.
    pub effect: Effect,
}

impl Reply {
    /// A reply of text.
    pub fn say(text: impl Into<String>) -> Self {
        Self { text: text.into(), effect: Effect::Nothing }
    }

    /// A reply that leaves work to the front end.
    pub fn ask(effect: Effect) -> Self {
        Self { text: String::new(), effect }
    }
}

/// Listens to the progress of long commands. [`ControlFlow::Break`] cancels a command that supports
/// it.
pub trait ProgressListener: WasmNotSend {
    /// Receives a step.
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
    /// The request that opened the scene.
    opening: Option<SceneRequest>,
    /// How `load SCENE` without options reads and lights the scene; `None` for the defaults of the
    /// command line.
    defaults: Option<(LoadArgs, SourceArgs)>,
    listener: Box<dyn ProgressListener>,
    outside: Box<dyn Outside>,
    /// [`Explorer::generation`] for which `ray` and `maps` are valid.
    generation: u32,
    /// The bounces that `vox_diffuse on` restores.
    bounces: Option<u32>,
    /// States of VXCT's switches for voxels and objects after their last flip.
    shown: commands::view::Shown,
    objects: commands::view::Objects,
    /// Panoramas and skies, each with the command that made it.
    maps: Vec<(Weak<EnvironmentMap>, String)>,
    /// The ray that is drawn.
    ray: Option<commands::ray::RayMarker>,
    /// The interval of voxelizations that `dynamic on` restores.
    dynamic: Option<Revoxelize>,
}

impl fmt::Debug for Console {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Console").field("explorer", &self.explorer).finish_non_exhaustive()
    }
}

impl Console {
    /// Makes the console of an explorer; `outside` provides files and scenes.
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

    /// Sets how `load SCENE` without options reads and lights the scene.
    #[must_use]
    pub fn with_defaults(mut self, load: LoadArgs, light: SourceArgs) -> Self {
        self.defaults = Some((load, light));
        self
    }

    /// Shows a scene from its camera: [`Explorer::open`]. If the old and the new scene have display
    /// values and their own grids, the camera is kept unless the request names one: such scenes all
    /// fill the same cube.
    pub fn open(&mut self, scene: OpenedScene) {
        let is_of_display =
            |scene: &Scene| scene.grid_bounds.is_some() && scene.has_display_values();
        let stays = scene.request.camera.is_none()
            && is_of_display(scene.prepared.scene())
            && self.explorer.scene().is_some_and(is_of_display);
        let camera = stays.then(|| self.explorer.camera().clone());
        self.explorer.open(scene.prepared);
        if let Some(camera) = camera {
            self.explorer.set_camera(camera);
        }
        self.opening = Some(scene.request);
    }

    /// Shows a scene that was read again, keeping the edits of its objects: [`Explorer::reopen`].
    pub fn reopen(&mut self, scene: OpenedScene) -> usize {
        self.opening = Some(scene.request);
        self.explorer.reopen(scene.prepared)
    }

    /// The request that opened the present scene.
    pub fn scene_request(&self) -> Option<&SceneRequest> {
        self.opening.as_ref().filter(|_| self.explorer.scene().is_some())
    }

    /// Sets the listener for the progress of long commands, such as `screenshot` and `compare`.
    pub fn on_progress(&mut self, listener: Box<dyn ProgressListener>) {
        self.listener = listener;
    }

    /// Runs a line; an empty one, or a comment, does nothing. Several commands in a line are
    /// returned as [`Effect::Run`].
    ///
    /// # Errors
    /// When the command does not exist or fails, or an argument is wrong. The message names the
    /// remedy. Nothing has changed then.
    pub async fn run(&mut self, line: &str) -> anyhow::Result<Reply> {
        let reply = self.run_on(line).await;
        self.explorer.end_gesture();
        reply
    }

    /// Runs a line that continues the last one, as in a drag: changes of the same things become one
    /// undo step.
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

    /// If there is a renderer, applies at once changed settings that need memory for voxels. If it
    /// refuses them, the settings of `before` return, and the line that caused the error reports
    /// it.
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

    /// Forgets the data of a scene that is no longer open.
    fn notice_scene(&mut self) {
        if self.generation != self.explorer.generation() {
            self.generation = self.explorer.generation();
            self.ray = None;
            self.maps.retain(|(map, _)| map.strong_count() > 0);
        }
    }

    /// Remembers the command that made a panorama, for `script`.
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

    /// Changes settings, all or none.
    ///
    /// # Errors
    /// When one is out of range.
    fn change(&mut self, change: impl FnOnce(&mut RenderSettings)) -> anyhow::Result<()> {
        let mut settings = self.explorer.settings().clone();
        change(&mut settings);
        self.set(settings, self.explorer.preset())
    }

    /// Requests settings.
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
    /// When nothing can be shown, or as [`Explorer::update`].
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
    Failure::input(format!("{name} takes {takes}; got {got} (see `help {name}`)"))
}

#[cfg(test)]
mod corpus;
#[cfg(test)]
mod tests;
