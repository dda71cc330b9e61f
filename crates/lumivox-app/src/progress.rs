//! Progress on stderr: a bar on a terminal, a line now and then elsewhere, nothing for short work.
//!
//! The work itself blocks for long, in drivers and loaders. So a thread of its own keeps what is
//! shown up to date, and the work only tells it how far it is.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::host::Host;

/// Work shorter than this shows nothing.
const SHOW_AFTER: Duration = Duration::from_secs(1);
/// How often the bar is brought up to date.
const REFRESH: Duration = Duration::from_millis(100);
/// How often a line is written where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// Characters of a full bar.
const BAR_WIDTH: usize = 24;
/// A guess from less than this would jump about.
const GUESS_AFTER: Duration = Duration::from_millis(500);

/// Shows how far the work is until it is dropped.
#[derive(Debug)]
pub struct Progress {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    stop: Arc<AtomicBool>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Clone, Debug)]
struct State {
    stage: &'static str,
    /// Steps done, maybe with a share of the next.
    done: f64,
    /// Steps of the stage; below 2, where they are counted, they are not worth telling.
    total: f64,
    is_counted: bool,
    stage_start: Instant,
    is_over: bool,
}

impl Progress {
    /// Starts with a stage of one step.
    pub fn start(host: &Host, stage: &'static str) -> Self {
        let state = State {
            stage,
            done: 0.0,
            total: 1.0,
            is_counted: true,
            stage_start: Instant::now(),
            is_over: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let (seen, host) = (shared.clone(), host.clone());
        // Without a thread (the system may refuse one) the work goes on, unseen.
        let thread = std::thread::Builder::new().spawn(move || show(&seen, &host)).ok();
        Self { shared, thread, stop: Arc::default() }
    }

    /// Shows nothing by itself: who has a [`Watch`] looks at it.
    pub fn silent(stage: &'static str) -> Self {
        let state = State {
            stage,
            done: 0.0,
            total: 1.0,
            is_counted: true,
            stage_start: Instant::now(),
            is_over: false,
        };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        Self { shared, thread: None, stop: Arc::default() }
    }

    /// From now on Ctrl-C is a wish to stop, which the work must look at: see [`Host::stop_on_interrupt`].
    ///
    /// # Errors
    /// When the system takes no handler.
    pub fn stop_on_interrupt(&mut self, host: &Host) -> anyhow::Result<()> {
        self.stop = host.stop_on_interrupt()?;
        Ok(())
    }

    /// Whether the user wishes the work to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The same for work that asks whether to go on.
    pub fn goes_on(&self) -> ControlFlow<()> {
        if self.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Looks at it from elsewhere.
    pub fn watch(&self) -> Watch {
        Watch(self.shared.clone())
    }

    /// Tells how far the work is: `done` steps of `total`.
    pub fn set(&self, stage: &'static str, done: u32, total: u32) {
        self.change(stage, f64::from(done), f64::from(total), true);
    }

    /// The same with a share of the next step, from 0 to 1, that is done.
    pub fn set_within(&self, stage: &'static str, done: u32, total: u32, share: f64) {
        self.change(stage, f64::from(done) + share.min(0.999), f64::from(total), true);
    }

    /// The same for what nobody counts, such as bytes: it is shown in per cent.
    pub fn set_share(&self, stage: &'static str, done: u64, total: u64) {
        self.change(stage, done as f64, total as f64, false);
    }

    fn change(&self, stage: &'static str, done: f64, total: f64, is_counted: bool) {
        let mut state = self.shared.lock();
        if state.stage != stage {
            (state.stage, state.stage_start) = (stage, Instant::now());
        }
        (state.done, state.total, state.is_counted) = (done, total, is_counted);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.shared.lock().is_over = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // A panic in there has been told by the hook.
            let _ = thread.join();
        }
    }
}

/// Looks at how far the work of a [`Progress`] is, from another thread.
#[derive(Clone, Debug)]
pub struct Watch(Arc<Shared>);

impl Watch {
    /// What is done, how far it is, and how long it will take.
    pub fn words(&self) -> String {
        self.0.lock().words()
    }

    /// The share of the stage that is done, from 0 to 1; `None` where there are no steps to count.
    pub fn share(&self) -> Option<f32> {
        let state = self.0.lock();
        state.has_steps().then(|| (state.done / state.total) as f32)
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A stage of the renderer as the progress names it.
pub fn words(stage: &'static str) -> &'static str {
    match stage {
        "upload" => "uploading",
        "compile" => "compiling shaders",
        "voxelize" => "voxelizing",
        "light" => "lighting the voxels",
        "render" => "frame",
        other => other,
    }
}

/// The thread: waits, looks, shows.
fn show(shared: &Shared, host: &Host) {
    let start = Instant::now();
    let has_terminal = host.has_terminal_for_errors() && !host.bars().is_hidden();
    let mut bar: Option<ProgressBar> = None;
    let mut last_line = start;
    let mut guard = shared.lock();
    while !guard.is_over {
        let waited = shared.changed.wait_timeout(guard, REFRESH);
        guard = waited.unwrap_or_else(PoisonError::into_inner).0;
        if guard.is_over || start.elapsed() < SHOW_AFTER {
            continue;
        }
        let state = guard.clone();
        drop(guard);
        if has_terminal {
            let bar = bar.get_or_insert_with(|| host.bars().add(new_bar()));
            bar.set_message(state.words_with_bar());
            bar.tick();
        } else if last_line.elapsed() >= LINE_EVERY {
            last_line = Instant::now();
            host.complain(&format!("{}\n", state.words()));
        }
        guard = shared.lock();
    }
    drop(guard);
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

fn new_bar() -> ProgressBar {
    // The bar is part of the message: set apart, they would be drawn one after the other.
    let style = ProgressStyle::with_template("{spinner} {wide_msg}")
        .unwrap_or_else(|_| ProgressStyle::default_spinner())
        .tick_chars("-\\|/ ");
    // Hidden until it is added: it must not draw beside the others.
    ProgressBar::with_draw_target(None, indicatif::ProgressDrawTarget::hidden()).with_style(style)
}

impl State {
    fn has_steps(&self) -> bool {
        self.total > 1.0
    }

    /// A bar, where there are steps, and the words.
    fn words_with_bar(&self) -> String {
        if !self.has_steps() {
            return self.words();
        }
        let full = (self.done * BAR_WIDTH as f64 / self.total) as usize;
        let bar = "=".repeat(full.min(BAR_WIDTH));
        format!("[{bar:<BAR_WIDTH$}] {}", self.words())
    }

    fn words(&self) -> String {
        let elapsed = self.stage_start.elapsed();
        let steps = match (self.has_steps(), self.is_counted) {
            (false, _) => String::new(),
            (true, true) => format!(" {}/{}", self.done.floor(), self.total),
            (true, false) => format!(" {:.0} %", (100.0 * self.done / self.total).floor()),
        };
        let left = match time_left(elapsed, self.done, self.total) {
            Some(left) => format!(", about {} left", clock(left)),
            None => String::new(),
        };
        format!("{}{steps}, {}{left}", self.stage, clock(elapsed))
    }
}

/// The time that the rest takes if it goes on as it went so far; `None` while that is unknown.
fn time_left(elapsed: Duration, done: f64, total: f64) -> Option<Duration> {
    if done <= 0.0 || total <= 1.0 || elapsed < GUESS_AFTER {
        return None;
    }
    Duration::try_from_secs_f64(elapsed.as_secs_f64() * (total - done).max(0.0) / done).ok()
}

/// `m:ss`, or `h:mm:ss`.
fn clock(duration: Duration) -> String {
    let seconds = duration.as_secs();
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    if hours > 0 {
        format!("{hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{minutes}:{seconds:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_is_guessed_from_what_was() {
        let seconds = Duration::from_secs;
        assert_eq!(time_left(seconds(10), 5.0, 16.0), Some(seconds(22)));
        assert_eq!(time_left(seconds(10), 2.5, 5.0), Some(seconds(10)));
        assert_eq!(time_left(seconds(10), 16.0, 16.0), Some(Duration::ZERO));
        assert_eq!(time_left(seconds(10), 0.0, 16.0), None);
        assert_eq!(time_left(seconds(10), 1.0, 1.0), None);
        assert_eq!(time_left(Duration::from_millis(10), 1.0, 16.0), None);
        assert_eq!(time_left(seconds(10), 1e-300, 16.0), None);
    }

    #[test]
    fn clocks_are_short() {
        assert_eq!(clock(Duration::from_secs(7)), "0:07");
        assert_eq!(clock(Duration::from_secs(754)), "12:34");
        assert_eq!(clock(Duration::from_secs(3600 * 3 + 62)), "3:01:02");
    }

    #[test]
    fn bars_grow_with_the_steps() {
        let stage_start = Instant::now();
        let state = |done, total| State {
            stage: "frame",
            done,
            total,
            is_counted: true,
            stage_start,
            is_over: false,
        };
        assert_eq!(state(0.0, 1.0).words_with_bar(), "frame, 0:00");
        let half = format!("[{}{}] frame 8/16, 0:00", "=".repeat(12), " ".repeat(12));
        assert_eq!(state(8.0, 16.0).words_with_bar(), half);
        assert_eq!(state(8.4, 16.0).words(), "frame 8/16, 0:00");
        assert!(state(16.0, 16.0).words_with_bar().starts_with(&format!("[{}]", "=".repeat(24))));
        let bytes = State { is_counted: false, ..state(123_456.0, 987_654.0) };
        assert_eq!(bytes.words(), "frame 12 %, 0:00");
    }

    #[test]
    fn it_ends_at_once() {
        let start = Instant::now();
        let progress = Progress::start(&Host::of_process(), "testing");
        progress.set("testing", 1, 2);
        drop(progress);
        assert!(start.elapsed() < SHOW_AFTER);
    }
}
