//! The queue of lines.

use lumivox_console::{Line as ScriptLine, Queue};
use lumivox_explorer::ChangeQueue;

use crate::window::lines::{Line, Origin};

/// Lines that wait for a scene, for frames, or for a script.
#[derive(Debug, Default)]
pub struct Lines {
    waiting: ChangeQueue<Line>,
    /// Lines of scripts, which run before waiting ones.
    script: Queue,
    script_goes_on: bool,
    /// A line that runs once its frames are rendered. `is_prepared`: `true` if the current line was
    /// pending.
    pending: Option<Line>,
    is_prepared: bool,
    frames_to_wait: u32,
    waits_for_screen: bool,
    done: u64,
    gesture: u64,
}

impl Lines {
    /// Adds a line, which supersedes a waiting one with the same target.
    pub fn push(&mut self, line: Line) {
        self.waiting.push(line.target(), line);
    }

    /// The next line that can run. While a scene is being read, only lines of the terminal and of
    /// scripts wait; while waiting for frames or the screen, all lines except those of panels.
    pub fn next(&mut self, is_loading: bool) -> Option<Line> {
        let is_waiting = self.frames_to_wait > 0 || self.waits_for_screen;
        if !is_loading && !is_waiting {
            if let Some(line) = self.pending.take() {
                self.is_prepared = true;
                return Some(line);
            }
            if let Some(ScriptLine { text, .. }) = self.script.take() {
                self.script_goes_on = true;
                return Some(Line { text, origin: Origin::Script, serial: 0, gesture: 0 });
            }
            self.script_goes_on = false;
            // Reset the depth of nested scripts.
            self.script = Queue::default();
        }
        self.waiting.take_first(|line| match line.origin {
            Origin::Panel => true,
            Origin::Pane => !is_waiting,
            Origin::Terminal | Origin::Script => !is_waiting && !is_loading,
        })
    }

    /// Whether any line is still to be run.
    pub fn are_left(&self) -> bool {
        self.script_goes_on || self.pending.is_some() || !self.waiting.is_empty()
    }

    /// Whether the current line's frames have been rendered; clears the flag.
    pub fn take_prepared(&mut self) -> bool {
        std::mem::take(&mut self.is_prepared)
    }

    /// Runs a line after this number of frames.
    pub fn run_after(&mut self, line: Line, frames: u32) {
        self.frames_to_wait = frames;
        self.pending = Some(line);
    }

    /// Makes lines wait for this number of frames.
    pub fn wait_for(&mut self, frames: u32) {
        self.frames_to_wait = frames;
    }

    /// Makes lines wait until the window shows the newest picture.
    pub fn wait_for_screen(&mut self) {
        self.waits_for_screen = true;
    }

    /// Whether lines wait until the window shows the last picture.
    pub fn is_waiting_for_screen(&self) -> bool {
        self.waits_for_screen
    }

    /// Ends the wait for the screen.
    pub fn screen_is_current(&mut self) {
        self.waits_for_screen = false;
    }

    /// Frames left to wait for.
    pub fn frames_to_wait(&self) -> u32 {
        self.frames_to_wait
    }

    /// Counts a rendered frame.
    pub fn frame_rendered(&mut self) {
        self.frames_to_wait = self.frames_to_wait.saturating_sub(1);
    }

    /// Ends the wait for frames.
    pub fn frames_are_over(&mut self) {
        self.frames_to_wait = 0;
    }

    /// Whether lines wait for a script, frames or the screen.
    pub fn are_under_way(&self) -> bool {
        self.frames_to_wait > 0 || self.waits_for_screen || self.script_goes_on
    }

    /// Puts lines of a script before all waiting lines.
    ///
    /// # Errors
    /// When scripts are nested too deeply.
    pub fn interpose(&mut self, lines: Vec<ScriptLine>) -> anyhow::Result<()> {
        self.script.interpose(lines)?;
        self.script_goes_on = true;
        Ok(())
    }

    /// Drops the rest of a script, the pending line, and all waits.
    pub fn abandon(&mut self) {
        self.script = Queue::default();
        self.script_goes_on = false;
        self.pending = None;
        self.frames_to_wait = 0;
        self.waits_for_screen = false;
    }

    /// Marks a line as done.
    pub fn finish(&mut self, line: &Line) {
        self.done = self.done.max(line.serial);
    }

    /// The number of the window's last line that is done.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// Whether a line begins a new step for `undo`: its gesture differs from the last line's.
    pub fn begins_gesture(&mut self, line: &Line) -> bool {
        let is_other = line.gesture == 0 || line.gesture != self.gesture;
        self.gesture = line.gesture;
        is_other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(lines: &[(&str, Origin)]) -> Lines {
        let mut queue = Lines::default();
        for (serial, (text, origin)) in lines.iter().enumerate() {
            let (text, serial) = ((*text).to_owned(), serial as u64 + 1);
            queue.push(Line { text, origin: *origin, serial, gesture: 0 });
        }
        queue
    }

    fn all(mut lines: Lines) -> Vec<String> {
        std::iter::from_fn(|| lines.next(false)).map(|line| line.text).collect()
    }

    fn of_panels(texts: &[&str]) -> Vec<String> {
        all(lines(&texts.iter().map(|text| (*text, Origin::Panel)).collect::<Vec<_>>()))
    }

    #[test]
    fn only_the_last_queued_value_of_a_parameter_runs() {
        let lines = ["bounces 1", "exposure 2", "bounces 2", "bounces 3"];
        assert_eq!(of_panels(&lines), ["exposure 2", "bounces 3"]);
        let lines = ["bounces 1", "preset high", "bounces 2"];
        assert_eq!(of_panels(&lines), lines);
        let lines = [
            ("bounces 1", Origin::Panel),
            ("bounces 2", Origin::Pane),
            ("bounces 3", Origin::Panel),
        ];
        assert_eq!(all(self::lines(&lines)).len(), 3);
    }

    #[test]
    fn panel_lines_run_while_typed_lines_wait() {
        let written = [("echo a", Origin::Terminal), ("echo b", Origin::Pane)];
        let mut lines = lines(&[&written[..], &[("bounces 1", Origin::Panel)]].concat());
        lines.wait_for(2);
        assert_eq!(lines.next(false).map(|line| line.serial), Some(3));
        assert!(lines.next(false).is_none() && lines.are_left());
        lines.frames_are_over();
        assert_eq!(lines.next(true).map(|line| line.serial), Some(2));
        assert_eq!(lines.next(false).map(|line| line.serial), Some(1));
        assert!(!lines.are_left());
    }

    #[test]
    fn typed_lines_wait_until_the_screen_is_current() {
        let mut lines = lines(&[("echo a", Origin::Terminal), ("bounces 1", Origin::Panel)]);
        lines.wait_for_screen();
        lines.frames_are_over();
        assert_eq!(lines.next(false).map(|line| line.serial), Some(2));
        assert!(lines.next(false).is_none() && lines.are_under_way());
        lines.screen_is_current();
        assert_eq!(lines.next(false).map(|line| line.serial), Some(1));
        // Cancelling ends the wait for a minimized window, too.
        lines.wait_for_screen();
        lines.abandon();
        assert!(!lines.are_under_way());
    }

    #[test]
    fn a_line_waiting_for_frames_blocks_later_lines() {
        let mut lines = lines(&[("screenshot a.png", Origin::Pane), ("echo b", Origin::Pane)]);
        let line = lines.next(false).unwrap();
        assert!(!lines.take_prepared());
        lines.run_after(line, 1);
        assert!(lines.next(false).is_none());
        lines.frame_rendered();
        assert_eq!(lines.next(false).map(|line| line.serial), Some(1));
        assert!(lines.take_prepared() && !lines.take_prepared());
    }

    #[test]
    fn the_lines_of_a_drag_are_one_gesture() {
        let mut lines = Lines::default();
        let line =
            |gesture| Line { text: String::new(), origin: Origin::Panel, serial: 0, gesture };
        let begins = [1, 1, 2, 0, 0].map(|gesture| lines.begins_gesture(&line(gesture)));
        assert_eq!(begins, [true, false, true, true, true]);
    }
}
