//! The report's figures in their stored layout.

use serde::{Deserialize, Serialize};

use super::machine::Machine;
use super::plan::{Case, Motion};

/// The version of this layout.
pub const FORMAT: u32 = 1;

/// A report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`FORMAT`].
    pub format: u32,
    /// The version of Lumivox.
    pub version: String,
    /// `release`, or `debug` without optimization.
    pub build: String,
    pub machine: Machine,
    /// The choice of cases, in words.
    pub cases: String,
    /// The most frames of a measurement.
    pub frames: u32,
    /// How the times of stages were taken.
    pub timing: TimingReport,
    /// The cases, each still and moving.
    pub rows: Vec<Row>,
}

/// How the times of stages were taken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimingReport {
    /// `timestamps` or `waited submits`.
    pub method: String,
    /// The reason for the method.
    pub reason: String,
}

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Its name, the same in all reports.
    pub id: String,
    pub scene: String,
    pub volume: String,
    /// Voxels along the scene's longest axis.
    pub resolution: u32,
    pub preset: String,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    pub motion: Motion,
    /// Why there are no figures; `None` if there are.
    pub problem: Option<String>,
    pub figures: Option<Figures>,
}

impl Row {
    /// The row of a case.
    pub fn new(case: &Case, motion: Motion, measured: Result<Figures, String>) -> Self {
        let (figures, problem) = match measured {
            Ok(figures) => (Some(figures), None),
            Err(problem) => (None, Some(problem)),
        };
        Self {
            id: case.id(motion),
            scene: case.scene_name.clone(),
            volume: case.volume.name().to_owned(),
            resolution: case.resolution,
            preset: case.preset.name().to_owned(),
            size: case.size.to_array(),
            motion,
            problem,
            figures,
        }
    }
}

/// The measured figures of a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    pub triangles: u64,
    pub voxels: u64,
    /// All GPU memory.
    pub memory_bytes: u64,
    /// GPU memory that cones sample: faces with their index, or cells.
    pub volume_bytes: u64,
    /// Times of voxelizing and lighting everything again, with all bounces; `None` for moving
    /// cases.
    pub change: Option<Part>,
    /// Times of a frame.
    pub frame: Part,
    /// Frames that showed the voxels of an earlier frame.
    pub late_frames: u32,
    /// The work of the cones on screen; `None` for moving cases.
    pub cones: Option<Cones>,
}

/// Times of one kind of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Number of runs that `whole` measures.
    pub runs: u32,
    /// Wall-clock time from the first call to the end of all GPU work.
    pub whole: Spread,
    /// The stages on the GPU, in order.
    pub stages: Vec<Stage>,
}

impl Part {
    /// The sum of the medians of some stages, ms; `None` if none of them ran.
    pub fn sum_of(&self, stages: &[&str]) -> Option<f64> {
        let ran = self.stages.iter().filter(|stage| stages.contains(&stage.stage.as_str()));
        let ms: Vec<f64> = ran.map(|stage| stage.ms.median).collect();
        (!ms.is_empty()).then(|| ms.iter().sum())
    }
}

/// The time of a stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    pub stage: String,
    pub ms: Spread,
}

/// Milliseconds over several runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
}

impl Spread {
    /// The spread of some times; they must not be empty.
    pub fn of(mut ms: Vec<f64>) -> Self {
        ms.sort_unstable_by(f64::total_cmp);
        let rank = |share: f64| ms[((ms.len() as f64 * share).ceil() as usize).max(1) - 1];
        Self { median: rank(0.5), p95: rank(0.95) }
    }
}

/// The work of a frame's cones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cones {
    /// Steps of all rays in a frame.
    pub samples: f64,
    /// `true` if the samples of every pixel were counted. `false` if one pixel in four is traced:
    /// `samples` is then a quarter of the picture's sum, too low at edges, where every pixel is
    /// traced.
    pub is_counted: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_takes_median_and_p95_by_nearest_rank() {
        assert_eq!(Spread::of(vec![3.0, 1.0, 2.0]), Spread { median: 2.0, p95: 3.0 });
        assert_eq!(Spread::of(vec![7.0]), Spread { median: 7.0, p95: 7.0 });
        let hundred = (1..=100).rev().map(f64::from).collect();
        assert_eq!(Spread::of(hundred), Spread { median: 50.0, p95: 95.0 });
    }
}
