//! The worker thread: owns the console and its explorer, runs lines, renders frames, and publishes
//! the results.
//!
//! In a loop, it drains the orders, runs their lines, publishes the model, renders one frame, and
//! publishes the picture; once the picture is complete, it sleeps until an order arrives. So a line
//! waits for at most one frame, and the window never waits.
//!
//! | file | is |
//! | --- | --- |
//! | `link.rs` | the inbox of orders, and publishing |
//! | `lines.rs`, `running.rs`, `commands.rs` | the queue; running lines; the window's commands |
//! | `jobs.rs`, `scenes.rs` | scenes and references from other threads; applying them |
//! | `pictures.rs`, `totals.rs` | the pictures on the screen, and the times of their frames |
//! | `model.rs`, `log.rs`, `session.rs` | the state that the panels show |

mod commands;
mod jobs;
mod lines;
mod link;
mod log;
mod model;
mod pictures;
mod running;
mod scenes;
mod session;
mod totals;

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::sync::mpsc::{self, Sender};
use std::time::Duration;

use lumivox_console::{Console, LineInfo, SceneRequest, Urgency};
use lumivox_explorer::Revoxelize;
use lumivox_render::GpuOptions;

use super::lines::{Line, Origin};
use super::orders::{Order, Shared, Wake};
use super::priority::give_way;
use super::terminal::{self, Terminal};
use jobs::Jobs;
use lines::Lines;
use link::{Inbox, Publisher, Waited};
use log::Messages;
use pictures::Pictures;
use session::Session;

/// Interval of progress updates while the worker is idle.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Starts the worker, which calls `wake` when it has published something. It ends at
/// [`Order::Quit`] or a command to quit.
pub fn start(
    console: Console,
    options: GpuOptions,
    opening: Option<SceneRequest>,
    wake: impl Fn() + Send + Sync + 'static,
) -> (Sender<Order>, Shared, std::thread::JoinHandle<()>) {
    let (inbox, shared) = (Inbox::new(), Shared::default());
    shared.change(|published| published.gpu = Some(console.explorer.gpu().clone()));
    let sender = inbox.sender();
    let wake: Wake = Arc::new(wake);
    let publisher = Publisher::new(shared.clone(), wake);
    let end = End(publisher.clone());
    let worker = Worker::new(console, options, inbox, publisher);
    let thread = std::thread::spawn(move || {
        give_way();
        let _end = end;
        worker.run(opening);
    });
    (sender, shared, thread)
}

/// Publishes when dropped that the worker has ended, even by a panic.
struct End(Publisher);

impl Drop for End {
    fn drop(&mut self) {
        self.0.publish(|published| published.has_ended = true);
    }
}

struct Worker {
    console: Console,
    /// Options for opening another device.
    options: GpuOptions,
    inbox: Inbox,
    publisher: Publisher,
    lines: Lines,
    jobs: Jobs,
    pictures: Pictures,
    session: Session,
    messages: Messages,
    /// `true` if stdin is a terminal, whose lines are typed, not piped.
    is_terminal: bool,
    is_over: bool,
}

impl Worker {
    fn new(console: Console, options: GpuOptions, inbox: Inbox, publisher: Publisher) -> Self {
        let full_size = console.explorer.settings().size;
        Self {
            console,
            options,
            jobs: Jobs::new(inbox.sender()),
            inbox,
            publisher,
            lines: Lines::default(),
            pictures: Pictures::new(full_size),
            session: Session::default(),
            messages: Messages::default(),
            is_terminal: std::io::stdin().is_terminal(),
            is_over: false,
        }
    }

    fn run(mut self, opening: Option<SceneRequest>) {
        if let Some(terminal) =
            hear_terminal(self.inbox.sender(), self.publisher.shared().clone(), self.is_terminal)
        {
            self.messages.log.print_to(terminal);
        }
        let listener = self.progress_listener();
        self.console.on_progress(listener);
        if let Some(opening) = opening {
            self.jobs.load(opening, false);
        }
        self.publish();
        let mut is_busy = false;
        while !self.is_over {
            self.wait(is_busy);
            let had_orders = self.inbox.has_changes();
            self.take_orders();
            let has_run = self.run_lines();
            if had_orders || has_run || self.jobs.are_there() {
                self.publish();
            }
            if self.is_over {
                break;
            }
            is_busy = match self.render_some() {
                Ok(is_rendering) => {
                    if !is_rendering && self.is_screen_current() {
                        self.lines.screen_is_current();
                    }
                    is_rendering || self.has_work()
                }
                Err(error) => self.mend(&error),
            };
            self.measure_light();
            if !is_busy {
                self.publisher.rest();
            }
        }
        self.messages.log.flush();
    }

    /// Fetches orders; if there is nothing to do, sleeps until there are some.
    fn wait(&mut self, is_busy: bool) {
        if !is_busy {
            let timeout = if self.jobs.are_under_way()
                || self.messages.log.is_pending()
                || self.console.explorer.pacing.is_moving()
            {
                Some(LOOK_EVERY)
            } else if let Revoxelize::Every(seconds) = self.console.explorer.revoxelize {
                Some(Duration::from_secs_f32(seconds.clamp(0.01, 1e6)))
            } else {
                None
            };
            match self.inbox.sleep(timeout) {
                Waited::Orders => {}
                Waited::Timeout => self.messages.log.settle(),
                Waited::Closed => self.is_over = true,
            }
        }
        self.inbox.fetch();
    }

    fn take_orders(&mut self) {
        while let Some(order) = self.inbox.take() {
            match order {
                Order::Line(line) => match self.urgency(&line) {
                    None => self.lines.push(line),
                    Some(urgency) => {
                        self.messages.log.add_command(&line);
                        self.lines.finish(&line);
                        match urgency {
                            Urgency::Cancel => self.cancel(None),
                            Urgency::Quit => self.is_over = true,
                        }
                    }
                },
                // Ignore motion that began in the previous scene.
                Order::Camera { scene, .. } if scene != self.session.opened => {}
                Order::Camera { camera, number, .. } => {
                    self.session.cameras_done = number;
                    self.console.explorer.pacing.camera_dragged();
                    self.console.explorer.set_camera(camera);
                    self.start_again();
                }
                Order::CameraLine(text) => {
                    let line = Line { text, origin: Origin::Panel, serial: 0, gesture: 0 };
                    self.messages.log.add_command(&line);
                }
                Order::Size(size) => {
                    self.pictures.set_full_size(size);
                    self.start_again();
                }
                Order::Pick(at) => self.pick(at),
                Order::Probe(at) => self.pictures.probe = Some(at),
                Order::Timed(is_timed) => self.console.explorer.set_timed(is_timed),
                Order::Device(device) => {
                    self.pictures.screen.draw_with(device);
                    self.pictures.show_again();
                }
                Order::Shown(serial) => self.pictures.set_on_screen(serial),
                Order::CommandLine => self.tell_command_line(),
                Order::Loaded(loaded) => self.take_scene(*loaded),
                Order::Traced(traced) => self.take_reference(*traced),
                Order::FilesChanged => self.reload(),
                Order::Cancel(which) => self.cancel(which),
                Order::CloseError(number) => self.messages.close_error(number),
                Order::Say(kind, text) => self.messages.log.add(kind, &text),
                Order::Quit => self.is_over = true,
            }
        }
    }

    /// Whether there are lines that can run now.
    fn has_work(&self) -> bool {
        let is_held = self.jobs.is_opening() || self.lines.is_waiting_for_screen();
        self.lines.are_left() && !is_held
    }

    /// The urgency of a line that runs before others, if it has any. In piped input, `quit` waits
    /// for its turn, as in a script.
    fn urgency(&self, line: &Line) -> Option<Urgency> {
        let is_piped = line.origin == Origin::Terminal && !self.is_terminal;
        let urgency = LineInfo::of(&line.text).urgency;
        urgency.filter(|urgency| !(is_piped && *urgency == Urgency::Quit))
    }
}

/// Forwards lines of the terminal until the window is closed or the input ends. The end of the
/// input does not close the window.
fn hear_terminal(orders: Sender<Order>, shared: Shared, is_terminal: bool) -> Option<Terminal> {
    let (sender, lines) = mpsc::channel();
    let terminal = terminal::spawn(sender).ok()?;
    std::thread::spawn(move || {
        for text in lines {
            let urgency = LineInfo::of(&text).urgency;
            if urgency.is_some_and(|urgency| is_terminal || urgency == Urgency::Cancel) {
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
