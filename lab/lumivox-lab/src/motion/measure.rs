//! Measures one sequence with one set of settings.

use std::rc::Rc;

use lumivox_app::parts::{ProgressDisplay, check_wish};
use lumivox_render::compare::{CompareError, ErrorFigures, LinearPicture};
use lumivox_render::{Gpu, RenderSettings};
use lumivox_scene::{Camera, Scene};

use super::drive::{Drive, Shown, StepCost};
use super::figures::{
    DisplayError, Known, Pool, Spread, error_on_screen, flicker, flicker_on_screen, mean,
    share_of_change, trail,
};
use super::moves::{Pose, Step};
use super::report::{
    AtStop, Change, Disoccluded, FlickerFigures, InMotion, Latency, Left, SequenceReport, Share,
    StepFigures, Trail,
};
use super::seen::Seen;
use super::sequences::{Kind, Phase, Sequence, first_of, last_of, marked, steps};
use super::truth::{Truth, Truths};
use crate::block_noise::BlockNoise;

/// Frames of a still picture.
pub const STILL_FRAMES: u32 = 32;
/// Frames after a change at which its latency and its trail are measured.
const LATENCY_FRAMES: [u32; 5] = [1, 2, 4, 8, 16];
const TRAIL_FRAMES: [u32; 3] = [1, 5, 20];
/// Frames after a stop at which errors are measured.
const STOP_FRAMES: [u32; 5] = [0, 1, 4, 16, 64];
/// Frames after a change that count as motion in a sequence in which nothing moves.
const SETTLING: u32 = 16;
/// The least change of mean irradiance whose latency is measured, as a share of the larger mean.
const LEAST_CHANGE: f64 = 0.1;
/// Steps whose truth is darker than this share of the brightest truth have no relative errors: they
/// would be meaningless.
const DARKEST_SHARE: f64 = 0.01;
/// The largest picture for which the truth is traced at every step, px.
pub const SMALL_PIXELS: u32 = 128 * 72;

/// A sequence to measure, with its scene and settings.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    pub gpu: &'a Gpu,
    pub progress: &'a ProgressDisplay,
    pub sequence: &'static Sequence,
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    /// The settings to measure.
    pub settings: &'a RenderSettings,
    /// The settings of still pictures, for comparison.
    pub balanced: &'a RenderSettings,
    /// Number of steps of each phase of motion; `None`: as the sequence has them.
    pub moving_steps: Option<u32>,
}

/// A sequence that was measured.
#[derive(Debug)]
pub struct Measured {
    pub report: SequenceReport,
    /// The pictures shown at each step.
    pub shown: Vec<Shown>,
    /// The truth at the steps that have one.
    pub truths: Vec<Option<Rc<Truth>>>,
    /// The steps that are shown in pictures.
    pub marked: Vec<u32>,
}

impl Measured {
    /// The exposure of the brightest truth, in stops; `None` if all are black.
    pub fn stops(&self) -> Option<f32> {
        stops(&self.truths)
    }
}

/// The exposure of the brightest truth, in stops; the same for all steps, like a camera without
/// auto exposure. `None` if all truths are black.
fn stops(truths: &[Option<Rc<Truth>>]) -> Option<f32> {
    let lit = truths.iter().flatten().filter(|truth| mean(truth.picture().picture) > 0.0);
    lit.map(|truth| truth.picture().picture.exposure_stops()).min_by(f32::total_cmp)
}

impl Task<'_> {
    /// Traces, renders and compares.
    ///
    /// # Errors
    /// When the scene has nothing to move, rendering fails, or the user stops the work.
    pub fn measure(&self, truths: &mut Truths<'_>) -> anyhow::Result<Measured> {
        let phases = self.sequence.phases(self.moving_steps);
        let steps = steps(&phases);
        let marked = marked(&phases);
        let mut drive = self.drive(self.settings)?;
        let poses: Vec<Pose> =
            steps.iter().map(|step| self.sequence.pose(drive.start(), step)).collect();
        let truths = self.truths(&poses, &marked, truths)?;
        let masks = self.masks(&poses)?;

        let (mut shown, mut costs) = (Vec::new(), Vec::new());
        for (step, pose) in poses.iter().enumerate() {
            check_wish(self.progress)?;
            self.progress.set("rendering steps", step as u32, poses.len() as u32);
            costs.push(drive.step(pose, &mut |_| {})?);
            shown.push(drive.shown()?);
        }
        drop(drive);
        let mut stills = Stills::new(self, self.balanced);
        let is_moving = is_moving(self.sequence, &phases, &poses);
        let taken =
            Taken { phases: &phases, steps: &steps, poses: &poses, shown: &shown, truths: &truths };

        let mut by_step = Vec::new();
        for step in &steps {
            let index = step.index as usize;
            let is_marked = marked.contains(&step.index) && is_moving[index];
            let still = if is_marked && taken.is_bright(index) {
                Some(stills.at(&poses[index])?)
            } else {
                None
            };
            by_step.push(taken.figures(index, is_moving[index], still.as_deref())?);
        }
        let is_balanced = self.settings == self.balanced;
        let mut own = if is_balanced { stills } else { Stills::new(self, self.settings) };
        let report = SequenceReport {
            sequence: self.sequence.name.to_owned(),
            scene: self.scene.name.clone(),
            moves: self.sequence.about.to_owned(),
            steps: steps.len() as u32,
            truths: truths.iter().flatten().count() as u32,
            settings: self.settings.clone(),
            in_motion: InMotion::of(&by_step),
            at_stop: self.at_stop(&taken, &by_step),
            flicker: taken.flicker(&is_moving),
            latency: self.latency(&taken, &mut own)?,
            trail: self.trail(&taken, &mut own)?,
            disoccluded: taken.disoccluded(&masks, &by_step),
            leak_percent: taken.leak(),
            cost: StepCost::report(&costs, &is_moving),
            by_step,
        };
        Ok(Measured { report, shown, truths, marked })
    }

    fn drive(&self, settings: &RenderSettings) -> anyhow::Result<Drive> {
        Drive::new(self.gpu, self.sequence, (self.scene, self.camera), settings)
    }

    /// The truths: of small pictures at every step, else at the marked steps and those before them.
    fn truths(
        &self,
        poses: &[Pose],
        marked: &[u32],
        truths: &mut Truths<'_>,
    ) -> anyhow::Result<Vec<Option<Rc<Truth>>>> {
        let is_small = self.settings.size.x * self.settings.size.y <= SMALL_PIXELS;
        let mut plan = self.drive(self.settings)?;
        let mut traced = Vec::new();
        for (step, pose) in (0_u32..).zip(poses) {
            let is_wanted = is_small || marked.contains(&step) || marked.contains(&(step + 1));
            if !is_wanted {
                traced.push(None);
                continue;
            }
            check_wish(self.progress)?;
            self.progress.set("tracing the truth of steps", step, poses.len() as u32);
            plan.pose(pose)?;
            traced.push(Some(truths.at(pose, plan.now(), self.progress)?));
        }
        Ok(traced)
    }

    /// For each step, the pixels that were hidden or off screen in the step before; `None` for the
    /// first step, and if the pose is unchanged.
    fn masks(&self, poses: &[Pose]) -> anyhow::Result<Vec<Option<Vec<bool>>>> {
        let mut plan = self.drive(self.settings)?;
        let mut before: Option<(&Pose, Seen)> = None;
        let mut masks = Vec::new();
        for (step, pose) in poses.iter().enumerate() {
            if let Some((last, _)) = &before
                && *last == pose
            {
                masks.push(None);
                continue;
            }
            self.progress.set("looking at what becomes visible", step as u32, poses.len() as u32);
            plan.pose(pose)?;
            let (scene, camera) = plan.now();
            let seen = Seen::new(scene, camera, self.settings.size);
            masks.push(before.as_ref().map(|(_, before)| seen.disoccluded_since(before)));
            before = Some((pose, seen));
        }
        Ok(masks)
    }

    fn at_stop(&self, taken: &Taken<'_>, by_step: &[StepFigures]) -> Vec<AtStop> {
        let Some(stop) = self.sequence.stop.map(|phase| last_of(taken.phases, phase)) else {
            return Vec::new();
        };
        let at = |after: &u32| {
            let number = (stop + after) as usize;
            let step = by_step.get(number)?;
            let on_screen = taken.error_on_screen(number);
            Some(AtStop { after: *after, full: step.full, picture: step.picture, on_screen })
        };
        STOP_FRAMES.iter().filter_map(at).collect()
    }

    /// Each change, with the indices of the last step before it and the first step after it.
    fn changes(&self, taken: &Taken<'_>) -> Vec<(Change, [usize; 2])> {
        let change = |change: &super::sequences::Change| {
            let before = last_of(taken.phases, change.before);
            let after = first_of(taken.phases, change.after);
            let name = change.name.to_owned();
            (Change { name, step: after }, [before as usize, after as usize])
        };
        self.sequence.changes.iter().map(change).collect()
    }

    fn latency(&self, taken: &Taken<'_>, own: &mut Stills<'_>) -> anyhow::Result<Vec<Latency>> {
        let mut all = Vec::new();
        for (change, [before, after]) in self.changes(taken) {
            let stills = [own.at(&taken.poses[before])?, own.at(&taken.poses[after])?];
            let [from, to] = stills.each_ref().map(|still| mean(&still.full));
            if (to - from).abs() < LEAST_CHANGE * from.max(to) {
                continue;
            }
            let share = |frames: &u32| {
                let shown = taken.shown.get(after + *frames as usize - 1)?;
                let share = share_of_change(from, to, mean(&shown.full))?;
                Some(Share { frames: *frames, percent: 100.0 * share })
            };
            let truth = |step: usize| Some(mean(taken.truths[step].as_ref()?.full().picture));
            let of_truth = truth(before)
                .zip(truth(after))
                .and_then(|(before, after)| share_of_change(0.0, after - before, to - from));
            all.push(Latency {
                change,
                there: LATENCY_FRAMES.iter().filter_map(share).collect(),
                whole_of_truth_percent: of_truth.map(|share| 100.0 * share),
            });
        }
        Ok(all)
    }

    fn trail(&self, taken: &Taken<'_>, own: &mut Stills<'_>) -> anyhow::Result<Vec<Trail>> {
        let mut all = Vec::new();
        for (change, [before, after]) in self.changes(taken) {
            let stills = [own.at(&taken.poses[before])?, own.at(&taken.poses[after])?];
            let left = |frames: &u32| {
                let shown = taken.shown.get(after + *frames as usize - 1)?;
                let left = trail(&shown.full, &stills[0].full, &stills[1].full)?;
                Some(Left { frames: *frames, percent: 100.0 * left })
            };
            all.push(Trail { change, left: TRAIL_FRAMES.iter().filter_map(left).collect() });
        }
        Ok(all)
    }
}

/// Whether each step differs from the previous one; in sequences without phases of motion, whether
/// it is among the first [`SETTLING`] after a change.
fn is_moving(sequence: &Sequence, phases: &[Phase], poses: &[Pose]) -> Vec<bool> {
    if phases.iter().any(|phase| phase.kind == Kind::Moves) {
        let moved = |step: usize| step > 0 && poses[step] != poses[step - 1];
        return (0..poses.len()).map(moved).collect();
    }
    let settles = |step: u32| {
        sequence.changes.iter().any(|change| {
            let first = first_of(phases, change.after);
            (first..first + SETTLING).contains(&step)
        })
    };
    (0..poses.len() as u32).map(settles).collect()
}

/// Still pictures of poses, each rendered once.
struct Stills<'a> {
    task: &'a Task<'a>,
    settings: &'a RenderSettings,
    drive: Option<Drive>,
    known: Vec<(Pose, Rc<Shown>)>,
}

impl<'a> Stills<'a> {
    fn new(task: &'a Task<'a>, settings: &'a RenderSettings) -> Self {
        Self { task, settings, drive: None, known: Vec::new() }
    }

    /// The picture of a pose after [`STILL_FRAMES`] frames.
    fn at(&mut self, pose: &Pose) -> anyhow::Result<Rc<Shown>> {
        if let Some((_, shown)) = self.known.iter().find(|(known, _)| known == pose) {
            return Ok(shown.clone());
        }
        check_wish(self.task.progress)?;
        if self.drive.is_none() {
            self.drive = Some(self.task.drive(self.settings)?);
        }
        let Some(drive) = &mut self.drive else { anyhow::bail!("no scene to stand still") };
        for frame in 0..STILL_FRAMES {
            self.task.progress.set("rendering what stands still", frame, STILL_FRAMES);
            drive.step(pose, &mut |_| {})?;
        }
        let shown = Rc::new(drive.shown()?);
        self.known.push((pose.clone(), shown.clone()));
        Ok(shown)
    }
}

/// Everything that was rendered and traced.
struct Taken<'a> {
    phases: &'a [Phase],
    steps: &'a [Step],
    poses: &'a [Pose],
    shown: &'a [Shown],
    truths: &'a [Option<Rc<Truth>>],
}

impl Taken<'_> {
    /// The mean irradiance of the brightest truth.
    fn brightest(&self) -> f64 {
        self.truths.iter().flatten().map(brightness).fold(0.0, f64::max)
    }

    /// Whether the truth of a step is known and bright enough to divide by.
    fn is_bright(&self, step: usize) -> bool {
        let least = DARKEST_SHARE * self.brightest();
        self.truths[step].as_ref().is_some_and(|truth| brightness(truth) > least)
    }

    /// Excess light in steps that are nearly black, in percent of the brightest truth.
    fn leak(&self) -> Option<Spread> {
        let brightest = self.brightest();
        let leak = |(truth, shown): (&Option<Rc<Truth>>, &Shown)| {
            let truth = truth.as_ref().map(brightness)?;
            let is_dark = brightest > 0.0 && truth <= DARKEST_SHARE * brightest;
            is_dark.then(|| 100.0 * (mean(&shown.full) - truth) / brightest)
        };
        Spread::of(self.truths.iter().zip(self.shown).filter_map(leak))
    }

    fn figures(
        &self,
        step: usize,
        is_moving: bool,
        still: Option<&Shown>,
    ) -> anyhow::Result<StepFigures> {
        let phase = self.phases[self.steps[step].phase].name.to_owned();
        let mut figures =
            StepFigures { step: step as u32, phase, is_moving, ..StepFigures::default() };
        let Some(truth) = self.truths[step].as_ref().filter(|_| self.is_bright(step)) else {
            return Ok(figures);
        };
        let shown = &self.shown[step];
        figures.full = compare(truth.full(), &shown.full)?;
        figures.picture = compare(truth.picture(), &shown.picture)?;
        if let Some(still) = still {
            figures.still_full = compare(truth.full(), &still.full)?;
            figures.still_picture = compare(truth.picture(), &still.picture)?;
            figures.off_still = Some(BlockNoise::new(&shown.picture, &still.picture));
        }
        Ok(figures)
    }

    /// The error of a step's picture on a screen; `None` without a truth or a previous step.
    fn error_on_screen(&self, step: usize) -> Option<DisplayError> {
        let truth = self.truths[step].as_ref()?;
        let ours = [&self.shown[step.checked_sub(1)?].picture, &self.shown[step].picture];
        Some(error_on_screen(ours, truth.picture(), stops(self.truths)?))
    }

    fn flicker(&self, is_moving: &[bool]) -> Option<FlickerFigures> {
        let stops = stops(self.truths)?;
        let mut all = Vec::new();
        for step in (1..self.steps.len()).filter(|step| is_moving[*step]) {
            let (Some(before), Some(now)) = (&self.truths[step - 1], &self.truths[step]) else {
                continue;
            };
            let is_same = Rc::ptr_eq(before, now);
            let ours = [&self.shown[step - 1], &self.shown[step]];
            let full = [before.full(), now.full()];
            let picture = [before.picture(), now.picture()];
            let pictures = ours.map(|shown| &shown.picture);
            all.push([
                flicker(ours.map(|shown| &shown.full), full, is_same),
                flicker(pictures, picture, is_same),
                Some(flicker_on_screen(pictures, picture, is_same, stops)),
            ]);
        }
        FlickerFigures::of(&all)
    }

    fn disoccluded(
        &self,
        masks: &[Option<Vec<bool>>],
        by_step: &[StepFigures],
    ) -> Option<Disoccluded> {
        let (mut full, mut picture) = (Pool::default(), Pool::default());
        let (mut steps, mut pixels) = (0, 0);
        for (step, mask) in masks.iter().enumerate() {
            let (Some(mask), Some(truth)) = (mask, &self.truths[step]) else { continue };
            steps += 1;
            pixels += mask.len();
            full.add(mask, truth.full(), &self.shown[step].full);
            picture.add(mask, truth.picture(), &self.shown[step].picture);
        }
        let still = |of: fn(&StepFigures) -> Option<ErrorFigures>| {
            Spread::of(by_step.iter().filter_map(of).map(|f| f.rmse_percent))
        };
        let of_still = |figures: Option<ErrorFigures>, still: Option<Spread>| {
            let still = still?.median;
            (still > 0.0).then_some(figures?.rmse_percent / still)
        };
        (full.len() > 0).then(|| {
            let (full_figures, picture_figures) = (full.figures(), picture.figures());
            Disoccluded {
                pixels: full.len() as u64,
                percent_of_pixels: 100.0 * full.len() as f64 / pixels as f64,
                steps,
                full: full_figures,
                picture: picture_figures,
                full_of_still: of_still(full_figures, still(|step| step.still_full)),
                picture_of_still: of_still(picture_figures, still(|step| step.still_picture)),
            }
        })
    }
}

fn brightness(truth: &Rc<Truth>) -> f64 {
    mean(truth.full().picture)
}

/// The figures of a picture; `None` if the truth is black.
fn compare(truth: Known<'_>, ours: &LinearPicture) -> anyhow::Result<Option<ErrorFigures>> {
    match ErrorFigures::new(truth.picture, Some(truth.variance), ours) {
        Ok(figures) => Ok(Some(figures)),
        Err(CompareError::Black { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
