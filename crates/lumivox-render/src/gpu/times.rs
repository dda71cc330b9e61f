//! Times of the stages, averaged over frames.

use std::time::Duration;

use lumivox::gpu::StageTime;

/// Sums of times by stage and pass, in the order in which they first ran.
#[derive(Clone, Debug, Default)]
pub(crate) struct StageTimes {
    sums: Vec<(StageTime, u32)>,
}

impl StageTimes {
    /// Adds the times of one recording. The times of a pass that ran several times in it are
    /// summed.
    pub(crate) fn add(&mut self, times: Vec<StageTime>) {
        let mut recording: Vec<StageTime> = Vec::new();
        for time in times {
            match recording.iter_mut().find(|other| is_same(other, &time)) {
                Some(other) => other.duration += time.duration,
                None => recording.push(time),
            }
        }
        for time in recording {
            match self.sums.iter_mut().find(|(other, _)| is_same(other, &time)) {
                Some((sum, count)) => {
                    sum.duration += time.duration;
                    *count += 1;
                }
                None => self.sums.push((time, 1)),
            }
        }
    }

    /// The mean time of each pass over the recordings that contain it.
    pub(crate) fn means(&self) -> Vec<StageTime> {
        let mean = |sum: Duration, count: u32| sum.checked_div(count).unwrap_or_default();
        self.sums
            .iter()
            .map(|(time, count)| StageTime {
                duration: mean(time.duration, *count),
                ..time.clone()
            })
            .collect()
    }
}

fn is_same(a: &StageTime, b: &StageTime) -> bool {
    a.stage == b.stage && a.pass == b.pass
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_summed_within_and_averaged_over_frames() {
        let time = |pass: &str, millis| StageTime {
            stage: "trace",
            pass: pass.to_owned(),
            duration: Duration::from_millis(millis),
        };
        let mut times = StageTimes::default();
        times.add(vec![time("a", 1), time("b", 10), time("a", 2)]);
        times.add(vec![time("a", 5), time("b", 20)]);
        assert_eq!(times.means(), [time("a", 4), time("b", 15)]);
    }
}
