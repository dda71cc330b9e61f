//! The thread that owns the console and in it the explorer: runs lines, renders frames, and publishes what came of it.
//!
//! It drains all orders that are there, runs their lines, publishes the model, renders one frame, publishes the
//! picture, and looks for orders again; once the picture is complete it sleeps until one comes. So a line waits for one
//! frame at most, and the window for nothing at all.

mod commands;
mod model;
mod pace;
mod pictures;
mod running;
mod scenes;
mod totals;

use std::collections::VecDeque;
use std::io::IsTerminal as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use glam::{UVec2, Vec2};
use lumivox_console::{Console, Names, Opening, Queue};
use lumivox_explorer::Revoxelize;
use lumivox_render::GpuOptions;
use lumivox_scene::{Bounds, Camera, Picker};

use super::jobs::{Loaded, Loading, Reference, Traced, Tracing};
use super::lines::{Line, Origin, Urgent, coalesce, urgent};
use super::model::{
    Comparand, Doing, FrameTime, Job, LightAt, LogKind, Model, SceneModel, Selected, Shown,
};
use super::priority::give_way;
use super::reload::Watched;
use super::terminal::{self, Terminal};
use model::Log;
use pace::Pace;
use pictures::Turn;
use totals::StageTotals;

/// How often progress is shown while nothing else happens.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// The camera has come to rest when it has not moved for this long.
const REST: Duration = Duration::from_millis(300);

/// What the worker is told.
#[derive(Debug)]
pub enum Order {
    /// Run this.
    Line(Line),
    /// The camera is being moved by hand, in the scene of this number.
    Camera(Camera, u64),
    /// There is room for a picture of this size, px.
    Size(UVec2),
    /// Choose what is at this place of the picture, as shares of its width and height.
    Pick(Vec2),
    /// Measure the light there.
    Probe(Vec2),
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
    /// Stop this, or all that is under way.
    Cancel(Option<Job>),
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
    /// The light at a place of the picture.
    pub light: Option<LightAt>,
    /// What the worker is busy with, and since when.
    pub doing: Option<Doing>,
    /// The next thing that the window itself has to do.
    pub wish: Option<Wish>,
    /// The worker has published a model.
    pub has_model: bool,
    /// The worker has ended, however that came.
    pub has_ended: bool,
}

/// What only the window can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Lose its own device.
    LoseDevice,
    /// Take all of the screen, or no longer.
    FullScreen,
}

/// The window's end of the worker.
#[derive(Clone, Debug, Default)]
pub struct Shared {
    published: Arc<Mutex<Published>>,
    /// Somebody wants the end, or the end of a command that takes long.
    stop: Arc<AtomicBool>,
}

impl Shared {
    /// What there is.
    pub fn get(&self) -> Published {
        let mut published = self.published.lock().unwrap_or_else(PoisonError::into_inner);
        let copy = published.clone();
        published.wish = None;
        copy
    }

    /// Whether the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.published.lock().unwrap_or_else(PoisonError::into_inner).has_ended
    }

    /// Breaks off a command that takes long. The order that says what is wanted follows: the worker does not hear it
    /// before.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn go_on(&self) {
        self.stop.store(false, Ordering::Relaxed);
    }

    fn change(&self, change: impl FnOnce(&mut Published)) {
        change(&mut self.published.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// Starts the worker; `wake` is called when something was published. It ends at [`Order::Quit`] or a command that asks
/// for it.
pub fn start(
    console: Console,
    options: GpuOptions,
    opening: Option<Opening>,
    wake: impl Fn() + Send + Sync + 'static,
) -> (Sender<Order>, Shared, std::thread::JoinHandle<()>) {
    let (sender, orders) = mpsc::channel();
    let shared = Shared::default();
    let wake: Wake = Arc::new(wake);
    let channel = (sender.clone(), orders);
    let worker = Worker::new(console, options, channel, shared.clone(), wake.clone());
    let end = End { shared: shared.clone(), wake };
    let thread = std::thread::spawn(move || {
        give_way();
        let _end = end;
        worker.run(opening);
    });
    (sender, shared, thread)
}

/// Wakes the window.
type Wake = Arc<dyn Fn() + Send + Sync>;

/// Tells the window that the worker has ended, after a panic as well.
struct End {
    shared: Shared,
    wake: Wake,
}

impl Drop for End {
    fn drop(&mut self) {
        self.shared.change(|published| published.has_ended = true);
        (self.wake)();
    }
}

#[allow(clippy::struct_excessive_bools)] // Each tells of something else.
struct Worker {
    console: Console,
    options: GpuOptions,
    sender: Sender<Order>,
    orders: Receiver<Order>,
    inbox: VecDeque<Order>,
    shared: Shared,
    wake: Wake,

    /// Lines that are still to be run.
    lines: VecDeque<Line>,
    /// Lines of scripts, which go before those.
    script: Queue,
    script_goes_on: bool,
    /// A line whose frames are being rendered before it is run, and whether the present one was such.
    pending: Option<Line>,
    is_prepared: bool,
    names: Names,
    names_are_old: bool,
    /// Frames that are rendered before the next line.
    frames_to_wait: u32,
    lines_done: u64,

    loading: Option<Loading>,
    tracing: Option<Tracing>,
    /// The picture of what is traced, as far as it is.
    reference: Option<Reference>,
    watched: Option<Watched>,
    /// Files have changed while a scene was read.
    has_changed: bool,
    jobs: u64,
    /// Scenes that were opened.
    opened: u64,
    /// Lines that have moved the camera.
    camera_moves: u64,

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
    /// Where light is to be measured.
    probe: Option<Vec2>,
    /// The last line belongs to this one.
    gesture: u64,
    comparand: Comparand,
    turn: Turn,
    /// Rendering failed: nothing more is tried until something changes.
    has_failed: bool,
    /// Devices that were lost since the last frame.
    losses: u32,
    last_tick: Instant,
    /// Seconds since voxels were made anew for the time's sake.
    voxels_s: f32,
    frame_times: VecDeque<FrameTime>,
    stage_totals: StageTotals,
    /// Lines of the terminal are typed, not piped.
    is_terminal: bool,
    is_over: bool,
}

impl Worker {
    fn new(
        console: Console,
        options: GpuOptions,
        (sender, orders): (Sender<Order>, Receiver<Order>),
        shared: Shared,
        wake: Wake,
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
            pending: None,
            is_prepared: false,
            names: Names::default(),
            names_are_old: true,
            frames_to_wait: 0,
            lines_done: 0,
            loading: None,
            tracing: None,
            reference: None,
            watched: None,
            has_changed: false,
            jobs: 0,
            opened: 0,
            camera_moves: 0,
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
            probe: None,
            gesture: 0,
            comparand: Comparand::default(),
            turn: Turn::default(),
            has_failed: false,
            losses: 0,
            last_tick: Instant::now(),
            voxels_s: 0.0,
            frame_times: VecDeque::new(),
            stage_totals: StageTotals::default(),
            is_terminal: std::io::stdin().is_terminal(),
            is_over: false,
        }
    }

    fn run(mut self, opening: Option<Opening>) {
        if let Some(terminal) = hear_terminal(self.sender.clone(), self.shared.clone()) {
            self.log.print_to(terminal);
        }
        let hear = self.hear();
        self.console.on_progress(hear);
        if let Some(opening) = opening {
            self.open(opening, false);
        }
        self.publish();
        let mut is_busy = false;
        while !self.is_over {
            self.wait(is_busy);
            let had_orders = self.inbox.iter().any(|order| !matches!(order, Order::Probe(_)));
            self.take_orders();
            let has_run = self.run_lines();
            if had_orders || has_run || self.loading.is_some() || self.tracing.is_some() {
                self.publish();
            }
            if self.is_over {
                break;
            }
            is_busy = match self.render_some() {
                Ok(is_busy) => is_busy || self.has_work(),
                Err(error) => self.mend(&error),
            };
            self.measure_light();
            if !is_busy {
                self.rest();
            }
        }
        self.log.flush();
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
        let waits =
            |order: &Order| !matches!(order, Order::Traced(_) | Order::Timed(_) | Order::Probe(_));
        self.inbox.iter().any(waits)
    }

    fn take_orders(&mut self) {
        let mut lines = Vec::new();
        while let Some(order) = self.inbox.pop_front() {
            match order {
                Order::Line(line) => match self.urgency(&line) {
                    None => lines.push(line),
                    Some(urgency) => {
                        self.log.add_command(&line);
                        self.lines_done = self.lines_done.max(line.serial);
                        match urgency {
                            Urgent::Cancel => self.cancel(None),
                            Urgent::Quit => self.is_over = true,
                        }
                    }
                },
                // A hand that is still in the last scene.
                Order::Camera(_, scene) if scene != self.opened => {}
                Order::Camera(camera, _) => {
                    self.pace.move_on();
                    self.console.explorer.set_camera(camera);
                    self.start_again();
                }
                Order::Size(size) => {
                    self.full_size = size.max(UVec2::ONE);
                    self.start_again();
                }
                Order::Pick(at) => self.pick(at),
                Order::Probe(at) => self.probe = Some(at),
                Order::Timed(is_timed) => self.console.explorer.set_timed(is_timed),
                Order::Coarse(is_coarse) => self.pace.is_allowed = is_coarse,
                Order::CommandLine => self.tell_command_line(),
                Order::Loaded(loaded) => self.take_scene(*loaded),
                Order::Traced(traced) => self.take_reference(*traced),
                Order::FilesChanged => self.reload(),
                Order::Cancel(which) => self.cancel(which),
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

    /// Whether there are lines whose turn is now.
    fn has_work(&self) -> bool {
        self.has_lines() && self.loading.as_ref().is_none_or(|loading| loading.is_reload)
    }

    /// Whether a line goes before all others. What is piped in is a script, in which `quit` has its turn.
    fn urgency(&self, line: &Line) -> Option<Urgent> {
        let is_piped = line.origin == Origin::Terminal && !self.is_terminal;
        urgent(&line.text).filter(|urgency| !(is_piped && *urgency == Urgent::Quit))
    }
}

/// Forwards lines of the terminal, until the window is closed or there are no more. The end of them is not the end of the
/// window.
fn hear_terminal(orders: Sender<Order>, shared: Shared) -> Option<Terminal> {
    let (sender, lines) = mpsc::channel();
    let terminal = terminal::spawn(sender).ok()?;
    let is_terminal = std::io::stdin().is_terminal();
    std::thread::spawn(move || {
        for text in lines {
            if urgent(&text).is_some_and(|urgency| is_terminal || urgency == Urgent::Cancel) {
                shared.stop();
            }
            let line = Line { text, origin: Origin::Terminal, serial: 0, gesture: 0 };
            if orders.send(Order::Line(line)).is_err() {
                break;
            }
        }
    });
    Some(terminal)
}
