//! Times of frames for the panels, and sums of stage times, whose means `times` prints.

use std::collections::VecDeque;
use std::time::Duration;

use lumivox::gpu::StageTime;
use lumivox_console::Failure;
use lumivox_console::report::TimesReport;

use crate::window::model::{FrameTime, KEPT_FRAMES};

/// Times of the last frames, and totals of the stages of all frames.
#[derive(Debug, Default)]
pub struct FrameLog {
    frames: VecDeque<FrameTime>,
    pub totals: StageTotals,
}

impl FrameLog {
    /// Adds a frame. A renderer's first frame, which includes its creation, only counts in totals.
    pub fn add(&mut self, total: Duration, stages: &[StageTime], is_first: bool) {
        self.totals.add(stages);
        if is_first {
            return;
        }
        let mut time = FrameTime { total_ms: total.as_secs_f32() * 1e3, ..FrameTime::default() };
        for stage in stages {
            time.add(stage.stage, stage.duration.as_secs_f32() * 1e3);
        }
        if self.frames.len() == KEPT_FRAMES {
            self.frames.pop_front();
        }
        self.frames.push_back(time);
    }

    /// The last frames.
    pub fn frames(&self) -> Vec<FrameTime> {
        self.frames.iter().copied().collect()
    }
}

/// Sums of the times of passes, and how many frames had each.
#[derive(Debug, Default)]
pub struct StageTotals(Vec<(StageTime, u32)>);

impl StageTotals {
    /// Adds the times of a frame.
    pub fn add(&mut self, frame: &[StageTime]) {
        for time in frame {
            let is_it = |(known, _): &&mut (StageTime, u32)| {
                known.stage == time.stage && known.pass == time.pass
            };
            match self.0.iter_mut().find(is_it) {
                Some((sum, frames)) => {
                    sum.duration += time.duration;
                    *frames += 1;
                }
                None => self.0.push((time.clone(), 1)),
            }
        }
    }

    /// Clears the sums.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether there are no times.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn means(&self) -> Vec<StageTime> {
        let mean = |(sum, frames): &(StageTime, u32)| {
            let duration: Duration = sum.duration / *frames;
            StageTime { duration, ..sum.clone() }
        };
        self.0.iter().map(mean).collect()
    }

    /// The output of `times [passes]`.
    ///
    /// # Errors
    /// When the arguments are invalid.
    pub fn table(&self, arguments: &[&str]) -> anyhow::Result<String> {
        let mut times = TimesReport::new(&self.means());
        match arguments {
            [] => times.passes.clear(),
            ["passes"] => {}
            _ => return Err(Failure::input("times takes passes or nothing").into()),
        }
        Ok(times.table("stage").trim_end().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_log_keeps_the_last_frames() {
        let mut log = FrameLog::default();
        for ms in 0..=KEPT_FRAMES as u64 + 1 {
            log.add(Duration::from_millis(ms), &[], ms == 0);
        }
        let frames = log.frames();
        assert_eq!((frames.len(), frames[0].total_ms), (KEPT_FRAMES, 2.0));
    }

    #[test]
    fn pass_means_ignore_frames_without_the_pass() {
        let time = |pass: &str, ms| StageTime {
            stage: "trace",
            pass: pass.to_owned(),
            duration: Duration::from_millis(ms),
        };
        let mut totals = StageTotals::default();
        totals.add(&[time("a", 2), time("b", 8)]);
        totals.add(&[time("a", 4)]);
        assert_eq!(totals.means(), [time("a", 3), time("b", 8)]);
        assert!(totals.table(&[]).unwrap().contains("11.000"));
        assert!(totals.table(&["all"]).is_err());
        totals.clear();
        assert!(totals.is_empty());
    }
}
