//! The measurement of one case.

use std::time::{Duration, Instant};

use lumivox::TraceResolution;
use lumivox::gpu::{StageTime, Timing};
use lumivox_console::report::TimesReport;
use lumivox_render::{Gpu, RenderError, RenderSettings, Renderer, View};
use lumivox_scene::{Camera, Scene};
use pollster::block_on;

use super::motion::MovingScene;
use super::plan::{Case, Motion};
use super::report::{Cones, Figures, Part, Spread, Stage};
use crate::progress::ProgressDisplay;

/// A measurement ends after this time, if it has enough runs.
const BUDGET: Duration = Duration::from_secs(4);
/// The fewest runs of a measurement.
const LEAST_RUNS: u32 = 3;
/// The most runs that voxelize and light everything again.
const MOST_CHANGES: u32 = 16;
/// Minimum frames of the warm-up, and its minimum time: drivers compile shaders, buffers of voxels
/// grow, and a GPU raises its clock.
const WARM_UP: u32 = 3;
const WARM_UP_TIME: Duration = Duration::from_millis(400);
/// The most late frames skipped before the first measured one.
const MOST_LATE: u32 = 32;
/// Phases of a measurement, for its progress.
const PHASES: f64 = 5.0;

/// Data that all measurements share, and the progress through them.
#[derive(Debug)]
pub struct Bench<'a> {
    pub gpu: &'a Gpu,
    /// How times of stages are taken.
    pub timing: Timing,
    /// The most frames of a measurement.
    pub frames: u32,
    pub progress: &'a ProgressDisplay,
    /// Numbers of finished measurements and of all measurements.
    pub done: u32,
    pub total: u32,
}

/// A scene ready to be measured.
#[derive(Clone, Debug)]
pub struct Subject {
    pub scene: Scene,
    pub camera: Camera,
}

impl Bench<'_> {
    /// Measures a case.
    ///
    /// # Errors
    /// When the library rejects the case, or the device fails.
    pub fn measure(
        &self,
        subject: &Subject,
        case: &Case,
        motion: Motion,
    ) -> Result<Figures, RenderError> {
        // Discard errors of earlier cases.
        while self.gpu.check("starting").is_err() && !self.gpu.is_lost() {}
        let settings = RenderSettings {
            volume: case.volume.volume(),
            resolution: case.resolution,
            size: case.size,
            frames: self.frames,
            ..RenderSettings::default().with_preset(case.preset, None)
        };
        match motion {
            Motion::Still => self.still(subject, &settings),
            Motion::Moving => self.moving(subject, settings),
        }
    }

    fn still(&self, subject: &Subject, settings: &RenderSettings) -> Result<Figures, RenderError> {
        let Subject { scene, camera } = subject;
        let quiet = &mut |_| ();
        self.reach(0.0);
        let mut renderer =
            block_on(Renderer::new(self.gpu, scene, Some(camera), settings.clone(), quiet))?;
        self.change(&mut renderer)?;
        warm_up(&mut || self.frame(&mut renderer))?;
        self.reach(1.0);
        let change = self.walls(MOST_CHANGES, &mut || self.change(&mut renderer))?;
        self.reach(2.0);
        let frame = self.walls(self.frames, &mut || self.frame(&mut renderer))?;
        let timed = RenderSettings { timing: self.timing, ..settings.clone() };
        block_on(renderer.set_settings(timed, quiet))?;
        self.reach(3.0);
        let change = self.part(&change, MOST_CHANGES, &mut || {
            renderer.forget_times();
            self.change(&mut renderer)?;
            Ok(renderer.times())
        })?;
        self.reach(4.0);
        let frame = self.part(&frame, self.frames, &mut || {
            renderer.forget_times();
            self.frame(&mut renderer)?;
            Ok(renderer.times())
        })?;
        let figures = Figures {
            voxels: renderer.voxel_stats().voxels.into(),
            change: Some(change),
            ..figures(scene, &renderer, frame)
        };
        Ok(Figures { cones: Some(self.cones(&mut renderer)?), ..figures })
    }

    fn moving(&self, subject: &Subject, settings: RenderSettings) -> Result<Figures, RenderError> {
        let mut moving = MovingScene::new(subject.scene.clone());
        let quiet = &mut |_| ();
        self.reach(0.0);
        // Light starts with one bounce, and each frame adds one.
        let settings = RenderSettings { bounces: 1, ..settings };
        let camera = Some(&subject.camera);
        let mut renderer =
            block_on(Renderer::new(self.gpu, &moving.scene, camera, settings.clone(), quiet))?;
        let mut voxels = 0;
        let mut step = |renderer: &mut Renderer| -> Result<bool, RenderError> {
            moving.advance();
            let frame = block_on(renderer.render_moved(&moving.scene, &[moving.block]))?;
            self.gpu.wait("rendering a moved frame")?;
            voxels = frame.voxels;
            Ok(frame.is_late)
        };
        warm_up(&mut || step(&mut renderer).map(|_| ()))?;
        let mut late = 0;
        while late < MOST_LATE && step(&mut renderer)? {
            late += 1;
        }
        self.reach(1.0);
        let mut late_frames = 0;
        let frame = self.walls(self.frames, &mut || {
            late_frames += u32::from(step(&mut renderer)?);
            Ok(())
        })?;
        let timed = RenderSettings { timing: self.timing, ..settings };
        block_on(renderer.set_settings(timed, quiet))?;
        self.reach(3.0);
        let frame = self.part(&frame, self.frames, &mut || {
            renderer.forget_times();
            step(&mut renderer)?;
            Ok(renderer.times())
        })?;
        Ok(Figures {
            voxels: voxels.into(),
            late_frames,
            ..figures(&moving.scene, &renderer, frame)
        })
    }

    /// Voxelizes and lights everything again.
    fn change(&self, renderer: &mut Renderer) -> Result<(), RenderError> {
        renderer.forget_light();
        block_on(renderer.revoxelize(&mut |_| ()))?;
        self.gpu.wait("lighting the voxels")
    }

    fn frame(&self, renderer: &mut Renderer) -> Result<(), RenderError> {
        block_on(renderer.render_frame())?;
        self.gpu.wait("rendering a frame")
    }

    /// The samples of a frame, counted by the shaders.
    fn cones(&self, renderer: &mut Renderer) -> Result<Cones, RenderError> {
        let trace = renderer.settings().trace;
        renderer.set_view(View::Cost, 0)?;
        self.frame(renderer)?;
        let picture = block_on(renderer.finish())?;
        let shown: f64 = picture.hdr.iter().map(|pixel| f64::from(pixel[0])).sum();
        let is_counted = trace.resolution == TraceResolution::Full;
        // One pixel in four is traced; the others show the mean of traced neighbours.
        let share = if is_counted { 1.0 } else { 0.25 };
        Ok(Cones { samples: shown * share, is_counted })
    }

    /// Wall-clock times of repeated work, ms.
    fn walls(
        &self,
        most: u32,
        work: &mut dyn FnMut() -> Result<(), RenderError>,
    ) -> Result<Vec<f64>, RenderError> {
        let mut walls = Vec::new();
        self.repeat(most, &mut || {
            let start = Instant::now();
            work()?;
            walls.push(start.elapsed().as_secs_f64() * 1e3);
            Ok(())
        })?;
        Ok(walls)
    }

    /// Repeats the work to time its stages; `walls` are the wall-clock times of earlier runs.
    fn part(
        &self,
        walls: &[f64],
        most: u32,
        work: &mut dyn FnMut() -> Result<Vec<StageTime>, RenderError>,
    ) -> Result<Part, RenderError> {
        let mut runs = Vec::new();
        self.repeat(most, &mut || {
            runs.push(TimesReport::new(&work()?));
            Ok(())
        })?;
        let runs: Vec<Vec<(String, f64)>> = runs
            .into_iter()
            .map(|run| run.stages.into_iter().map(|stage| (stage.stage, stage.ms)).collect())
            .collect();
        Ok(Part {
            runs: walls.len() as u32,
            whole: Spread::of(walls.to_vec()),
            stages: stages(&runs),
        })
    }

    /// Repeats work until there are enough runs, or the time is up.
    fn repeat(
        &self,
        most: u32,
        work: &mut dyn FnMut() -> Result<(), RenderError>,
    ) -> Result<(), RenderError> {
        let start = Instant::now();
        for run in 0..most.max(LEAST_RUNS) {
            let is_enough = run >= LEAST_RUNS && start.elapsed() > BUDGET;
            if run > 0 && (is_enough || self.progress.is_stopped()) {
                break;
            }
            work()?;
        }
        Ok(())
    }

    fn reach(&self, phase: f64) {
        self.progress.set_within("measuring", self.done, self.total, phase / PHASES);
    }
}

fn warm_up(work: &mut dyn FnMut() -> Result<(), RenderError>) -> Result<(), RenderError> {
    let start = Instant::now();
    let mut runs = 0;
    while runs < WARM_UP || start.elapsed() < WARM_UP_TIME {
        work()?;
        runs += 1;
    }
    Ok(())
}

/// Figures with the triangles, memory and frame; the others are zero or `None`.
fn figures(scene: &Scene, renderer: &Renderer, frame: Part) -> Figures {
    let memory = renderer.memory();
    let is_volume = |name: &str| name.starts_with("volume") || name == "voxels: surface for rays";
    let volume = memory.iter().filter(|part| is_volume(&part.name));
    Figures {
        triangles: scene.triangle_count() as u64,
        voxels: 0,
        memory_bytes: memory.iter().map(|part| part.bytes).sum(),
        volume_bytes: volume.map(|part| part.bytes).sum(),
        change: None,
        frame,
        late_frames: 0,
        cones: None,
    }
}

/// Each stage over all runs, in the order in which they first ran; a run without it counts as zero.
fn stages(runs: &[Vec<(String, f64)>]) -> Vec<Stage> {
    let mut names: Vec<&String> = Vec::new();
    for (name, _) in runs.iter().flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let ms_of = |run: &Vec<(String, f64)>, name: &String| {
        run.iter().find(|(other, _)| other == name).map_or(0.0, |(_, ms)| *ms)
    };
    names
        .into_iter()
        .map(|name| Stage {
            stage: name.clone(),
            ms: Spread::of(runs.iter().map(|run| ms_of(run, name)).collect()),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_that_did_not_run_took_no_time() {
        let run = |stages: &[(&str, f64)]| {
            stages.iter().map(|(name, ms)| ((*name).to_owned(), *ms)).collect::<Vec<_>>()
        };
        let runs = [run(&[("a", 1.0)]), run(&[("a", 3.0), ("b", 2.0)]), run(&[("a", 2.0)])];
        let stages = stages(&runs);
        let names: Vec<&str> = stages.iter().map(|stage| stage.stage.as_str()).collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(stages[0].ms, Spread { median: 2.0, p95: 3.0 });
        assert_eq!(stages[1].ms, Spread { median: 0.0, p95: 2.0 });
    }
}
