//! The report: figures under the names of the tables, as JSON and for people.

use std::fmt::Write as _;

use lumivox_app::parts::settings;
use lumivox_console::report::{Table, bytes};
use lumivox_render::RenderSettings;
use lumivox_render::compare::ErrorFigures;
use serde::{Deserialize, Serialize};

use super::drive::StepCost;
use super::figures::{CostSpread, DisplayError, Flicker, Spread};
use crate::block_noise::BlockNoise;

/// A measurement, and the name of its preset.
pub struct Case {
    pub preset: &'static str,
    pub report: SequenceReport,
    /// `true` if the page shows the strip and the animation.
    pub is_shown: bool,
}

/// One sequence with one set of settings.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SequenceReport {
    /// The sequence's name.
    pub sequence: String,
    pub scene: String,
    /// A sentence about what moves.
    pub moves: String,
    pub steps: u32,
    /// The number of steps with a truth.
    pub truths: u32,
    /// Errors while something moves; without motion, in the first 16 frames after a change.
    pub in_motion: InMotion,
    /// Errors when the camera stops and some frames after; empty for sequences without a stop.
    pub at_stop: Vec<AtStop>,
    /// Flicker; `None` if no two consecutive steps have a truth.
    pub flicker: Option<FlickerFigures>,
    /// For each change of at least a tenth of the light, the share that has arrived after some
    /// frames.
    pub latency: Vec<Latency>,
    /// For each change, the share of the former light that is left after some frames.
    pub trail: Vec<Trail>,
    /// Errors of newly visible pixels; `None` if there are none.
    pub disoccluded: Option<Disoccluded>,
    /// Light that leaks or is left over: our mean irradiance minus the truth's, in percent of the
    /// brightest truth's, in steps whose truth is nearly black. `None` without such steps.
    pub leak_percent: Option<Spread>,
    /// Cost of the steps of motion; `None` if nothing moves.
    pub cost: Option<CostFigures>,
    pub by_step: Vec<StepFigures>,
    #[serde(serialize_with = "settings::serialize", skip_deserializing)]
    pub settings: RenderSettings,
}

/// The errors of one step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct StepFigures {
    /// The step's number, from 0.
    pub step: u32,
    /// The name of the step's phase.
    pub phase: String,
    /// `true` if the step counts as motion.
    pub is_moving: bool,
    /// Errors of the irradiance by all light except direct light of lamps; `None` if the truth is
    /// missing or nearly black.
    pub full: Option<ErrorFigures>,
    /// Errors of the picture.
    pub picture: Option<ErrorFigures>,
    /// Errors of a still picture of the same pose; only at marked steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub still_full: Option<ErrorFigures>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub still_picture: Option<ErrorFigures>,
    /// The picture's difference from the still picture of the same pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off_still: Option<BlockNoise>,
}

/// Errors over the steps of motion.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct InMotion {
    /// The number of steps with figures.
    pub steps: u32,
    /// Errors of the irradiance by all light except direct light of lamps.
    pub full: Option<ErrorSpread>,
    /// Errors of the picture.
    pub picture: Option<ErrorSpread>,
    /// The picture's difference from still pictures: of the median block, and the 95th percentile
    /// of the blocks.
    pub off_still: Option<[Spread; 2]>,
}

/// The spread of each figure over steps.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct ErrorSpread {
    pub bias_percent: Spread,
    pub rmse_percent: Spread,
    pub p95_percent: Spread,
    pub flip: Option<Spread>,
    pub noise_percent: Option<Spread>,
    /// The RMSE divided by that of a still picture: the same pose after 32 frames of `balanced`.
    pub rmse_of_still: Option<Spread>,
    /// The RMSE of the still pictures.
    pub still_rmse_percent: Option<Spread>,
}

/// Errors some frames after a stop.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct AtStop {
    /// Frames after the last step of the motion.
    pub after: u32,
    pub full: Option<ErrorFigures>,
    pub picture: Option<ErrorFigures>,
    /// Errors of the picture on a screen, at the exposure of the brightest step.
    pub on_screen: Option<DisplayError>,
}

/// Change that the truth does not have, from step to step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct FlickerFigures {
    /// The number of pairs of steps.
    pub pairs: u32,
    /// Flicker of irradiance, in percent of the truth's mean.
    pub full_percent: Option<Spread>,
    /// Flicker of the picture, in percent of the truth's mean.
    pub picture_percent: Option<Spread>,
    /// Flicker of the picture on a screen, 0 to 1.
    pub display: Option<Spread>,
    /// Medians including the truth's noise, and of this noise only.
    pub with_noise: NoiseFigures,
    pub noise: NoiseFigures,
}

/// Medians over pairs of steps, as in [`FlickerFigures`].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct NoiseFigures {
    pub full_percent: Option<f64>,
    pub picture_percent: Option<f64>,
    pub display: Option<f64>,
}

/// A sudden change.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Change {
    pub name: String,
    /// The first step after the change.
    pub step: u32,
}

/// The arrival of light after a change.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Latency {
    #[serde(flatten)]
    pub change: Change,
    pub there: Vec<Share>,
    /// The whole change, between our still pictures, in percent of the truth's change.
    pub whole_of_truth_percent: Option<f64>,
}

/// A share of a change after a number of frames.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Share {
    pub frames: u32,
    /// Percent of the change of mean irradiance that has arrived, without direct light.
    pub percent: f64,
}

/// The trail of a change.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Trail {
    #[serde(flatten)]
    pub change: Change,
    pub left: Vec<Left>,
}

/// The trail after a number of frames.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Left {
    pub frames: u32,
    /// Percent of the former irradiance that is left, without direct light.
    pub percent: f64,
}

/// Errors of pixels in the first step in which their surface is visible.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Disoccluded {
    /// Number of newly visible pixels over all steps.
    pub pixels: u64,
    /// Their share of the pixels of these steps.
    pub percent_of_pixels: f64,
    pub steps: u32,
    pub full: Option<ErrorFigures>,
    pub picture: Option<ErrorFigures>,
    /// The RMSE divided by the median RMSE of whole still pictures.
    pub full_of_still: Option<f64>,
    pub picture_of_still: Option<f64>,
}

/// The cost of the steps of motion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct CostFigures {
    /// The number of steps.
    pub steps: u32,
    pub ms: CostSpread,
    pub samples_per_pixel: CostSpread,
    pub waits: CostSpread,
    pub allocated_bytes: CostSpread,
}

impl InMotion {
    /// The spread over the steps that count as motion.
    pub fn of(steps: &[StepFigures]) -> Self {
        let moving: Vec<&StepFigures> =
            steps.iter().filter(|step| step.is_moving && step.full.is_some()).collect();
        let off_still = |of: fn(BlockNoise) -> f64| {
            Spread::of(moving.iter().filter_map(|step| step.off_still).map(of))
        };
        let both = off_still(|noise| noise.median).zip(off_still(|noise| noise.p95));
        Self {
            steps: moving.len() as u32,
            off_still: both.map(<[Spread; 2]>::from),
            full: ErrorSpread::of(moving.iter().map(|step| (step.full, step.still_full))),
            picture: ErrorSpread::of(moving.iter().map(|step| (step.picture, step.still_picture))),
        }
    }
}

impl ErrorSpread {
    fn of(
        steps: impl Iterator<Item = (Option<ErrorFigures>, Option<ErrorFigures>)>,
    ) -> Option<Self> {
        let steps: Vec<_> = steps.filter_map(|(now, still)| Some((now?, still))).collect();
        let spread = |of: fn(&ErrorFigures) -> Option<f64>| {
            Spread::of(steps.iter().filter_map(|(now, _)| of(now)))
        };
        let with_still = || steps.iter().filter_map(|(now, still)| Some((now, (*still)?)));
        let ratio = |(now, still): (&ErrorFigures, ErrorFigures)| {
            (still.rmse_percent > 0.0).then_some(now.rmse_percent / still.rmse_percent)
        };
        Some(Self {
            bias_percent: spread(|figures| Some(figures.bias_percent))?,
            rmse_percent: spread(|figures| Some(figures.rmse_percent))?,
            p95_percent: spread(|figures| Some(figures.p95_percent))?,
            flip: spread(|figures| figures.flip),
            noise_percent: spread(|figures| figures.noise_percent),
            rmse_of_still: Spread::of(with_still().filter_map(ratio)),
            still_rmse_percent: Spread::of(with_still().map(|(_, still)| still.rmse_percent)),
        })
    }
}

impl FlickerFigures {
    /// The spread over pairs of steps, each with the flicker of irradiance, of the picture, and of
    /// the picture on a screen.
    pub fn of(pairs: &[[Option<Flicker>; 3]]) -> Option<Self> {
        let of = |which: usize, scale: f64, of: fn(Flicker) -> f64| {
            Spread::of(pairs.iter().filter_map(|pair| Some(scale * of(pair[which]?))))
        };
        let medians = |value: fn(Flicker) -> f64| {
            let median = |which, scale| of(which, scale, value).map(|spread| spread.median);
            NoiseFigures {
                full_percent: median(0, 100.0),
                picture_percent: median(1, 100.0),
                display: median(2, 1.0),
            }
        };
        (!pairs.is_empty()).then(|| Self {
            pairs: pairs.len() as u32,
            full_percent: of(0, 100.0, |flicker| flicker.value),
            picture_percent: of(1, 100.0, |flicker| flicker.value),
            display: of(2, 1.0, |flicker| flicker.value),
            with_noise: medians(|flicker| flicker.with_noise),
            noise: medians(|flicker| flicker.noise),
        })
    }
}

impl StepCost {
    /// The cost of the steps of motion; `None` if there are none.
    pub fn report(steps: &[Self], is_moving: &[bool]) -> Option<CostFigures> {
        let moving: Vec<&Self> =
            steps.iter().zip(is_moving).filter_map(|(step, moves)| moves.then_some(step)).collect();
        let spread = |of: fn(&Self) -> f64| CostSpread::of(moving.iter().map(|step| of(step)));
        Some(CostFigures {
            steps: moving.len() as u32,
            ms: spread(|step| step.ms)?,
            samples_per_pixel: spread(|step| step.samples_per_pixel)?,
            waits: spread(|step| step.waits as f64)?,
            allocated_bytes: spread(|step| step.allocated_bytes as f64)?,
        })
    }
}

impl SequenceReport {
    /// The report as text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}, {}: {}\n  {} steps, {} of them with a truth\n\n",
            self.sequence, self.scene, self.moves, self.steps, self.truths
        );
        text += &self.errors_in_motion();
        text += &self.others();
        if let Some(cost) = &self.cost {
            text += "\n";
            text += &cost.table();
        }
        text
    }

    fn errors_in_motion(&self) -> String {
        let mut table =
            Table::new(&["in motion", "bias", "RMSE", "p95", "FLIP", "noise", "of still"]);
        let percent = |value: f64| format!("{value:.1} %");
        for (name, spread) in [("full", self.in_motion.full), ("picture", self.in_motion.picture)] {
            let Some(spread) = spread else { continue };
            for (rank, of) in
                [("median", (|s| s.median) as fn(Spread) -> f64), ("worst", |s| s.worst)]
            {
                let known = |spread: Option<Spread>, shown: &dyn Fn(f64) -> String| {
                    spread.map_or("-".to_owned(), |spread| shown(of(spread)))
                };
                table.row([
                    format!("{name}, {rank}"),
                    format!("{:+.1} %", of(spread.bias_percent)),
                    percent(of(spread.rmse_percent)),
                    percent(of(spread.p95_percent)),
                    known(spread.flip, &|flip| format!("{flip:.4}")),
                    known(spread.noise_percent, &percent),
                    known(spread.rmse_of_still, &|ratio| format!("{ratio:.2} x")),
                ]);
            }
        }
        table.text()
    }

    fn others(&self) -> String {
        let mut text = String::new();
        let rmse = |figures: Option<ErrorFigures>| {
            figures.map_or("-".to_owned(), |figures| format!("{:.1} %", figures.rmse_percent))
        };
        if !self.at_stop.is_empty() {
            let at = |stop: &AtStop| format!("+{} {}", stop.after, rmse(stop.full));
            let at: Vec<String> = self.at_stop.iter().map(at).collect();
            let _ = writeln!(text, "\n  at stop      RMSE of full: {}", at.join(", "));
        }
        if let Some(flicker) = &self.flicker {
            let percent = |spread: Option<Spread>| {
                spread.map_or("-".to_owned(), |spread| format!("{:.2} %", spread.median))
            };
            let display = flicker.display.map_or("-".to_owned(), |d| format!("{:.4}", d.median));
            let _ = writeln!(
                text,
                "  flicker      full {}, picture {}, on screen {display}",
                percent(flicker.full_percent),
                percent(flicker.picture_percent)
            );
        }
        for latency in &self.latency {
            let shares: Vec<String> = latency
                .there
                .iter()
                .map(|share| format!("{:.1} % after {}", share.percent, share.frames))
                .collect();
            let _ = writeln!(text, "  latency      {}: {}", latency.change.name, shares.join(", "));
        }
        for trail in &self.trail {
            let left: Vec<String> = trail
                .left
                .iter()
                .map(|left| format!("{:.1} % after {}", left.percent, left.frames))
                .collect();
            let _ = writeln!(text, "  trail        {}: {}", trail.change.name, left.join(", "));
        }
        if let Some(leak) = self.leak_percent {
            let _ = writeln!(
                text,
                "  leak         {:.2} %, worst {:.2} %, of the brightest step where the truth is black",
                leak.median, leak.worst
            );
        }
        if let Some(disoccluded) = &self.disoccluded {
            let _ = writeln!(
                text,
                "  disoccluded  RMSE of full {}, picture {}; {:.1} % of the pixels of {} steps",
                rmse(disoccluded.full),
                rmse(disoccluded.picture),
                disoccluded.percent_of_pixels,
                disoccluded.steps
            );
        }
        text
    }
}

impl CostFigures {
    fn table(&self) -> String {
        let mut table = Table::new(&["cost of a step", "median", "p95", "worst"]);
        let mut row = |name: &str, cost: CostSpread, shown: &dyn Fn(f64) -> String| {
            table.row([name.to_owned(), shown(cost.median), shown(cost.p95), shown(cost.worst)]);
        };
        row("ms", self.ms, &|ms| format!("{ms:.1}"));
        row("cone samples a pixel", self.samples_per_pixel, &|count| format!("{count:.1}"));
        row("waits for the GPU", self.waits, &|count| format!("{count:.0}"));
        row("bytes allocated", self.allocated_bytes, &|count| bytes(count as u64));
        table.text()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(rmse_percent: f64) -> ErrorFigures {
        ErrorFigures { rmse_percent, ..ErrorFigures::default() }
    }

    #[test]
    fn only_moving_steps_count_and_ratios_need_a_still() {
        let step = |is_moving, rmse, still: Option<f64>| StepFigures {
            is_moving,
            full: Some(figures(rmse)),
            still_full: still.map(figures),
            ..StepFigures::default()
        };
        let steps = [step(false, 99.0, None), step(true, 10.0, Some(5.0)), step(true, 30.0, None)];
        let in_motion = InMotion::of(&steps);
        assert_eq!(in_motion.steps, 2);
        let full = in_motion.full.unwrap();
        assert_eq!(full.rmse_percent, Spread { median: 20.0, worst: 30.0 });
        assert_eq!(full.rmse_of_still, Some(Spread { median: 2.0, worst: 2.0 }));
        assert!(in_motion.picture.is_none());
    }

    #[test]
    fn cost_of_motion_excludes_still_steps() {
        let step = |ms| StepCost { ms, ..StepCost::default() };
        let steps = [step(1000.0), step(10.0), step(20.0)];
        let cost = StepCost::report(&steps, &[false, true, true]).unwrap();
        assert_eq!((cost.steps, cost.ms.median, cost.ms.worst), (2, 15.0, 20.0));
        assert!(StepCost::report(&steps, &[false; 3]).is_none());
    }
}
