//! The thread that owns the console and in it the explorer: runs lines, renders frames, and publishes what came of it.
//!
//! It drains all orders that are there, runs their lines, publishes the model, renders one frame, publishes the
//! picture, and looks for orders again; once the picture is complete it sleeps until one comes. So a line waits for one
//! frame at most, and the window for nothing at all.

mod commands;
mod model;
mod pictures;
mod scenes;

use std::collections::VecDeque;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::{UVec2, Vec2};
use lumivox_render::{Gpu, GpuOptions};
use lumivox_scene::{Bounds, Camera, Picker};

use super::jobs::{Loaded, Loading, Traced, Tracing};
use super::lines::{Line, Origin, coalesce};
use super::model::{Comparand, FrameTime, JobModel, LogKind, Model, SceneModel, Selected, Shown};
use super::reload::Watched;
use crate::console::terminal::{self, Terminal};
use crate::console::{Console, Effect, Names, Queue};
use crate::explorer::{Opening, Revoxelize};
use model::Log;
use pictures::{Pace, Turn};

/// How often progress is shown while nothing else happens.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// The camera has come to rest when it has not moved for this long.
const REST: Duration = Duration::from_millis(300);

/// What the worker is told.
#[derive(Debug)]
pub enum Order {
    /// Run this.
    Line(Line),
    /// The camera is being moved by hand.
    Camera(Camera),
    /// There is room for a picture of this size, px.
    Size(UVec2),
    /// Choose what is at this place of the picture, as shares of its width and height.
    Pick(Vec2),
    /// Take times of stages, or not.
    Timed(bool),
    /// Fewer pixels while the camera moves, or not.
    Coarse(bool),
    /// Somebody wants the command line that reproduces the picture.
    CommandLine,
    /// A scene was read.
    Loaded(Box<Loaded>),
    /// A reference has more samples.
    Traced(Box<Traced>),
    /// Files of the scene have changed.
    FilesChanged,
    /// Stop what runs beside the frames.
    Cancel,
    /// The error was read.
    CloseError(u64),
    /// Something for the console from elsewhere.
    Say(LogKind, String),
    /// End.
    Quit,
}

/// What the window looks at.
#[derive(Clone, Debug, Default)]
pub struct Published {
    /// For the panels.
    pub model: Arc<Model>,
    /// The picture.
    pub picture: Option<Arc<Shown>>,
    /// What it is compared with.
    pub other: Option<Arc<Shown>>,
    /// The next thing that the window itself has to do.
    pub wish: Option<Wish>,
    /// Somebody asked for the end.
    pub has_ended: bool,
}

/// What only the window can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Lose its own device.
    LoseDevice,
}

/// The window's end of the worker.
#[derive(Clone, Debug)]
pub struct Shared(Arc<Mutex<Published>>);

impl Shared {
    /// What there is.
    pub fn get(&self) -> Published {
        let mut published = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let copy = published.clone();
        published.wish = None;
        copy
    }

    /// Whether the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).has_ended
    }

    fn change(&self, change: impl FnOnce(&mut Published)) {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// Starts the worker; `wake` is called when something was published. It ends at [`Order::Quit`] or a command that asks
/// for it.
pub fn start(
    console: Console,
    options: GpuOptions,
    opening: Option<Opening>,
    wake: impl Fn() + Send + 'static,
) -> (Sender<Order>, Shared, std::thread::JoinHandle<()>) {
    let (sender, orders) = mpsc::channel();
    let shared = Shared(Arc::new(Mutex::new(Published::default())));
    let worker =
        Worker::new(console, options, (sender.clone(), orders), shared.clone(), Box::new(wake));
    let thread = std::thread::spawn(move || worker.run(opening));
    (sender, shared, thread)
}

#[allow(clippy::struct_excessive_bools)] // Each tells of something else.
struct Worker {
    console: Console,
    options: GpuOptions,
    sender: Sender<Order>,
    orders: Receiver<Order>,
    inbox: VecDeque<Order>,
    shared: Shared,
    wake: Box<dyn Fn() + Send>,

    /// Lines that are still to be run.
    lines: VecDeque<Line>,
    /// Lines of scripts, which go before those.
    script: Queue,
    script_goes_on: bool,
    names: Names,
    /// Frames that are rendered before the next line.
    frames_to_wait: u32,
    lines_done: u64,

    loading: Option<Loading>,
    tracing: Option<Tracing>,
    watched: Option<Watched>,
    jobs: u64,

    log: Log,
    error: Option<(u64, String)>,
    command_line: Option<(u64, String)>,
    selected: Option<Selected>,
    selections: u64,
    picked_at: Option<glam::Vec3>,
    picker: Option<Picker>,
    mesh_bounds: Vec<Bounds>,
    scene_model: Option<Arc<SceneModel>>,
    /// Materials, lights or surroundings were changed since the scene was read.
    has_edits: bool,

    /// The picture's size when nothing moves.
    full_size: UVec2,
    pace: Pace,
    comparand: Comparand,
    turn: Turn,
    /// Rendering failed: nothing more is tried until something changes.
    has_failed: bool,
    last_tick: Instant,
    frame_times: VecDeque<FrameTime>,
    is_over: bool,
}

impl Worker {
    fn new(
        console: Console,
        options: GpuOptions,
        (sender, orders): (Sender<Order>, Receiver<Order>),
        shared: Shared,
        wake: Box<dyn Fn() + Send>,
    ) -> Self {
        let full_size = console.explorer.size();
        Self {
            console,
            options,
            sender,
            orders,
            inbox: VecDeque::new(),
            shared,
            wake,
            lines: VecDeque::new(),
            script: Queue::default(),
            script_goes_on: false,
            names: Names::default(),
            frames_to_wait: 0,
            lines_done: 0,
            loading: None,
            tracing: None,
            watched: None,
            jobs: 0,
            log: Log::default(),
            error: None,
            command_line: None,
            selected: None,
            selections: 0,
            picked_at: None,
            picker: None,
            mesh_bounds: Vec::new(),
            scene_model: None,
            has_edits: false,
            full_size,
            pace: Pace::default(),
            comparand: Comparand::default(),
            turn: Turn::default(),
            has_failed: false,
            last_tick: Instant::now(),
            frame_times: VecDeque::new(),
            is_over: false,
        }
    }

    fn run(mut self, opening: Option<Opening>) {
        self.log.terminal = hear_terminal(self.sender.clone());
        if let Some(opening) = opening {
            self.open(opening, false);
        }
        self.publish();
        let mut is_busy = false;
        while !self.is_over {
            self.wait(is_busy);
            let had_orders = !self.inbox.is_empty();
            self.take_orders();
            let has_run = self.run_lines();
            if had_orders || has_run || self.loading.is_some() || self.tracing.is_some() {
                self.publish();
            }
            if self.is_over {
                break;
            }
            is_busy = match self.render_some() {
                Ok(is_busy) => is_busy || (self.has_lines() && self.loading.is_none()),
                Err(error) => self.mend(&error),
            };
        }
        self.log.flush();
        self.shared.change(|published| published.has_ended = true);
        (self.wake)();
    }

    /// Fetches orders; sleeps until there are some where there is nothing to do.
    fn wait(&mut self, is_busy: bool) {
        if !is_busy && self.inbox.is_empty() {
            let look = self.loading.is_some() || self.tracing.as_ref().is_some_and(|t| !t.is_over);
            let timeout = if look || self.log.is_pending() || self.pace.is_moving() {
                Some(LOOK_EVERY)
            } else if let Revoxelize::Every(seconds) = self.console.explorer.revoxelize {
                Some(Duration::from_secs_f32(seconds.clamp(0.01, 1e6)))
            } else {
                None
            };
            let order = match timeout {
                None => self.orders.recv().map_err(|_| RecvTimeoutError::Disconnected),
                Some(timeout) => self.orders.recv_timeout(timeout),
            };
            match order {
                Ok(order) => self.inbox.push_back(order),
                Err(RecvTimeoutError::Timeout) => self.log.settle(),
                Err(RecvTimeoutError::Disconnected) => self.is_over = true,
            }
        }
        self.inbox.extend(self.orders.try_iter());
    }

    /// Whether somebody waits for something.
    fn has_orders(&mut self) -> bool {
        self.inbox.extend(self.orders.try_iter());
        self.inbox.iter().any(|order| !matches!(order, Order::Traced(_) | Order::Timed(_)))
    }

    fn take_orders(&mut self) {
        let mut lines = Vec::new();
        while let Some(order) = self.inbox.pop_front() {
            match order {
                Order::Line(line) => lines.push(line),
                Order::Camera(camera) => {
                    self.pace.move_on();
                    self.console.explorer.set_camera(camera);
                    self.start_again();
                }
                Order::Size(size) => {
                    self.full_size = size.max(UVec2::ONE);
                    self.start_again();
                }
                Order::Pick(at) => self.pick(at),
                Order::Timed(is_timed) => self.console.explorer.set_timed(is_timed),
                Order::Coarse(is_coarse) => self.pace.is_allowed = is_coarse,
                Order::CommandLine => self.tell_command_line(),
                Order::Loaded(loaded) => self.take_scene(*loaded),
                Order::Traced(traced) => self.take_reference(*traced),
                Order::FilesChanged => self.reload(),
                Order::Cancel => self.cancel(),
                Order::CloseError(number) => {
                    self.error = self.error.take().filter(|(other, _)| *other != number);
                }
                Order::Say(kind, text) => self.log.add(kind, &text),
                Order::Quit => self.is_over = true,
            }
        }
        if !lines.is_empty() {
            self.lines.extend(coalesce(lines));
        }
    }

    /// Runs lines until one has to wait for something; whether there was one.
    fn run_lines(&mut self) -> bool {
        let mut has_run = false;
        while !self.is_over && self.frames_to_wait == 0 {
            // A scene that somebody chooses supersedes the one that is being read; a script waits for it.
            let is_choice =
                |line: &Line| line.origin != Origin::Terminal && line.text.starts_with("load ");
            let is_held = self.loading.as_ref().is_some_and(|loading| !loading.is_reload);
            if is_held && !self.lines.front().is_some_and(is_choice) {
                break;
            }
            let of_script = self.script.next();
            self.script_goes_on = of_script.is_some();
            let of_script =
                of_script.map(|line| Line { text: line.text, origin: Origin::Terminal, serial: 0 });
            let Some(line) = of_script.or_else(|| self.lines.pop_front()) else { break };
            if !has_run {
                self.set_size(self.full_size);
            }
            has_run = true;
            self.run_line(&line);
            self.lines_done = self.lines_done.max(line.serial);
        }
        has_run
    }

    fn run_line(&mut self, line: &Line) {
        if line.text.trim().is_empty() {
            return;
        }
        self.log.add_command(line);
        let reply = match self.run_own(&line.text) {
            Some(done) => done.map(crate::console::Reply::say),
            None => self.console.run(&line.text),
        };
        match reply {
            Ok(reply) => {
                self.log.add(LogKind::Reply, &reply.text);
                self.follow(reply.effect);
            }
            Err(error) => {
                self.fail(&error);
                self.script.abandon();
            }
        }
        let size = self.console.explorer.size();
        if size != self.full_size {
            self.full_size = size;
        }
        self.note_edits(&line.text);
        self.start_again();
    }

    fn follow(&mut self, effect: Effect) {
        match effect {
            Effect::Nothing => {}
            Effect::Open(opening) => self.open(*opening, false),
            Effect::Wait(frames) => self.frames_to_wait = frames,
            Effect::Run(lines) => {
                if let Err(error) = self.script.interpose(lines) {
                    self.fail(&error.into());
                }
            }
            Effect::Quit => self.is_over = true,
        }
    }

    /// Tells of an error in the console and in the status bar.
    fn fail(&mut self, error: &anyhow::Error) {
        let mut text = String::new();
        for cause in error.chain().map(ToString::to_string) {
            if text.is_empty() {
                text = cause;
            } else if !text.contains(&cause) {
                text += ": ";
                text += &cause;
            }
        }
        self.log.add(LogKind::Error, &text);
        let number = self.error.as_ref().map_or(0, |(number, _)| *number) + 1;
        self.error = Some((number, text));
    }

    /// What is remembered of the scene's state is no longer true.
    fn forget_scene(&mut self) {
        self.picker = None;
        self.scene_model = None;
    }

    /// After a failure of rendering: another device where this one is lost; whether there is something to do.
    fn mend(&mut self, error: &anyhow::Error) -> bool {
        if !self.console.explorer.gpu().is_lost() {
            self.fail(error);
            self.has_failed = true;
            self.publish();
            return false;
        }
        self.tracing = None;
        match pollster::block_on(Gpu::new(&self.options)) {
            Ok(gpu) => {
                self.console.explorer.set_gpu(gpu);
                self.log.add(LogKind::Note, "the GPU was lost; going on with a new device");
                self.start_again();
                self.publish();
                true
            }
            Err(error) => {
                self.fail(&error.into());
                self.has_failed = true;
                self.publish();
                false
            }
        }
    }

    /// Whether there are lines to be run.
    fn has_lines(&self) -> bool {
        self.script_goes_on || !self.lines.is_empty()
    }

    /// What is under way, for the window.
    fn jobs(&self) -> Vec<JobModel> {
        let loading = self.loading.as_ref().map(|loading| JobModel {
            words: format!("{}: {}", loading.title, loading.watch.words()),
            share: loading.watch.share(),
            can_cancel: true,
        });
        let tracing = self.tracing.as_ref().filter(|tracing| !tracing.is_over);
        let tracing = tracing.map(|tracing| JobModel {
            words: format!(
                "reference: sample {:.0} of {}",
                tracing.samples().floor(),
                tracing.total()
            ),
            share: Some(tracing.samples() / tracing.total() as f32),
            can_cancel: true,
        });
        loading.into_iter().chain(tracing).collect()
    }
}

/// Forwards lines of the terminal, until the window is closed or there are no more. The end of them is not the end of the
/// window.
fn hear_terminal(orders: Sender<Order>) -> Option<Terminal> {
    let (sender, lines) = mpsc::channel();
    let terminal = terminal::spawn(sender).ok()?;
    std::thread::spawn(move || {
        for text in lines {
            let line = Line { text, origin: Origin::Terminal, serial: 0 };
            if orders.send(Order::Line(line)).is_err() {
                break;
            }
        }
    });
    Some(terminal)
}
