//! Progress on stderr: a bar on a terminal, otherwise a line at intervals; nothing for short work.
//!
//! The work may block for seconds in drivers and loaders, so a separate thread shows its progress.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

use indicatif::{FormattedDuration, HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use crate::host::Host;

/// Work shorter than this has no bar.
const SHOW_AFTER: Duration = Duration::from_secs(1);
/// The interval at which the bar is drawn.
const REFRESH: Duration = Duration::from_millis(100);
/// The interval of lines if there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// Bar units per step, to show partly done steps.
const PARTS: f64 = 1000.0;

/// Shows the progress of work until it is dropped.
#[derive(Debug)]
pub struct ProgressDisplay {
    /// Its prefix is the stage, its message the steps; it has a length only with several steps.
    bar: ProgressBar,
    /// The thread that shows the bar; it ends when the channel is closed.
    shown: Option<(Sender<()>, JoinHandle<()>)>,
    stop: Arc<AtomicBool>,
}

impl ProgressDisplay {
    /// Starts the display with a stage of one step.
    pub fn start(host: &Host, stage: &'static str) -> Self {
        let mut progress = Self::silent(stage);
        let (sender, over) = mpsc::channel();
        let (bar, host) = (progress.bar.clone(), host.clone());
        // If the system refuses a thread, progress is not shown.
        let thread = std::thread::Builder::new().spawn(move || show(&bar, &host, &over)).ok();
        progress.shown = thread.map(|thread| (sender, thread));
        progress
    }

    /// Starts without a display; a `ProgressReader` reads it.
    pub fn silent(stage: &'static str) -> Self {
        let bar = ProgressBar::hidden().with_style(style(false)).with_prefix(stage);
        Self { bar, shown: None, stop: Arc::default() }
    }

    /// Makes Ctrl-C a request to stop, which the work must check (`Host::stop_on_interrupt`).
    ///
    /// # Errors
    /// When no signal handler can be installed.
    pub fn stop_on_interrupt(&mut self, host: &Host) -> anyhow::Result<()> {
        self.stop = host.stop_on_interrupt()?;
        Ok(())
    }

    /// Whether the user has asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// [`Self::is_stopped`], as a [`ControlFlow`].
    pub fn goes_on(&self) -> ControlFlow<()> {
        if self.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// A reader for another thread.
    pub fn watch(&self) -> ProgressReader {
        ProgressReader(self.bar.clone())
    }

    /// Reports progress: `done` steps of `total`.
    pub fn set(&self, stage: &'static str, done: u32, total: u32) {
        self.set_within(stage, done, total, 0.0);
    }

    /// As [`Self::set`], with a `share` (0 to 1) of the next step done.
    pub fn set_within(&self, stage: &'static str, done: u32, total: u32, share: f64) {
        let exact = f64::from(done) + share.min(0.999);
        self.change(stage, format!(" {done}/{total}"), exact, f64::from(total));
    }

    /// As [`Self::set`], for amounts such as bytes, which are shown in per cent.
    pub fn set_share(&self, stage: &'static str, done: u64, total: u64) {
        let percent = done.saturating_mul(100) / total.max(1);
        self.change(stage, format!(" {percent} %"), done as f64, total as f64);
    }

    fn change(&self, stage: &'static str, steps: String, done: f64, total: f64) {
        let bar = &self.bar;
        // Restart the time if the stage is new or restarts.
        let position = (done * PARTS) as u64;
        if bar.prefix() != stage || position < bar.position() {
            bar.set_prefix(stage);
            bar.reset();
        }
        // A stage of one step does not show a count.
        let has_steps = total > 1.0;
        if has_steps != bar.length().is_some() {
            bar.set_style(style(has_steps));
        }
        if has_steps {
            bar.set_message(steps);
            bar.set_length((total * PARTS) as u64);
            bar.set_position(position);
        } else {
            bar.set_message("");
            bar.unset_length();
        }
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        if let Some((sender, thread)) = self.shown.take() {
            drop(sender);
            // The panic hook has reported a panic in that thread.
            let _ = thread.join();
        }
    }
}

/// Reads the progress of a [`ProgressDisplay`] from another thread.
#[derive(Clone, Debug)]
pub struct ProgressReader(ProgressBar);

impl ProgressReader {
    /// The stage, its progress, and the estimated time left.
    pub fn words(&self) -> String {
        let (stage, steps) = (self.0.prefix(), self.0.message());
        let elapsed = self.0.elapsed();
        let left = left(f64::from(self.share().unwrap_or(0.0)), elapsed);
        format!("{stage}{steps}, {}{left}", FormattedDuration(elapsed))
    }

    /// The share of the stage that is done, from 0 to 1; `None` if it has only one step.
    pub fn share(&self) -> Option<f32> {
        self.0.length().map(|length| self.0.position() as f32 / length as f32)
    }
}

/// The name of a renderer's stage in the progress.
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

/// Body of the thread: shows the bar until the work is done.
fn show(bar: &ProgressBar, host: &Host, over: &Receiver<()>) {
    let lasts = |time| over.recv_timeout(time) == Err(RecvTimeoutError::Timeout);
    if !host.has_terminal_for_errors() || host.bars().is_hidden() {
        while lasts(LINE_EVERY) {
            host.complain(&format!("{}\n", ProgressReader(bar.clone()).words()));
        }
    } else if lasts(SHOW_AFTER) {
        host.bars().add(bar.clone());
        bar.enable_steady_tick(REFRESH);
        // Ends when the sender is dropped.
        let _ = over.recv();
        bar.finish_and_clear();
    }
}

fn style(has_steps: bool) -> ProgressStyle {
    let bar = if has_steps { "[{bar:24}] " } else { "" };
    ProgressStyle::with_template(&format!(
        "{{spinner}} {bar}{{prefix}}{{msg}}, {{elapsed_precise}}{{left}}"
    ))
    .unwrap_or_else(|_| ProgressStyle::default_spinner())
    .with_key("left", |state: &ProgressState, out: &mut dyn fmt::Write| {
        let share = if state.len().is_some() { f64::from(state.fraction()) } else { 0.0 };
        let _ = out.write_str(&left(share, state.elapsed()));
    })
    .tick_chars("-\\|/ ")
    .progress_chars("= ")
}

/// The estimated time left in the stage at its speed so far, as text. Empty before a tenth is done,
/// when the estimate is poor, and in the last second.
fn left(share: f64, elapsed: Duration) -> String {
    if !(0.1..1.0).contains(&share) {
        return String::new();
    }
    let left = elapsed.mul_f64((1.0 - share) / share);
    if left < Duration::from_secs(1) {
        return String::new();
    }
    format!(", about {:#} left", HumanDuration(left))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_text_shows_stage_steps_and_time() {
        let progress = ProgressDisplay::silent("loading");
        let watch = progress.watch();
        assert_eq!((watch.words(), watch.share()), ("loading, 00:00:00".to_owned(), None));
        progress.set_share("loading", 123_456, 987_654);
        assert!(watch.words().starts_with("loading 12 %, 00:00:00"), "{}", watch.words());
        progress.set("frame", 8, 16);
        assert!(watch.words().starts_with("frame 8/16, 00:00:00"), "{}", watch.words());
        assert_eq!(watch.share(), Some(0.5));
        progress.set_within("frame", 8, 16, 0.5);
        assert_eq!(watch.share(), Some(8.5 / 16.0));
        // Restarting the stage, as for a second picture, restarts the time.
        std::thread::sleep(Duration::from_millis(20));
        progress.set("frame", 4, 16);
        assert!(watch.0.elapsed() < Duration::from_millis(20));
        progress.set("uploading", 0, 1);
        assert_eq!((watch.words(), watch.share()), ("uploading, 00:00:00".to_owned(), None));
        let left = |share| left(share, Duration::from_secs(754));
        let expected =
            [(0.05, ""), (0.25, ", about 38m left"), (0.5, ", about 13m left"), (1.0, "")];
        for (share, words) in expected {
            assert_eq!(left(share), words);
        }
    }

    #[test]
    fn dropping_the_progress_display_does_not_wait() {
        let start = std::time::Instant::now();
        let progress = ProgressDisplay::start(&Host::of_process(), "testing");
        progress.set("testing", 1, 2);
        drop(progress);
        assert!(start.elapsed() < SHOW_AFTER);
    }
}
