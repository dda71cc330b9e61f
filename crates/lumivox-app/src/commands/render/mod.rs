//! `lumivox render`: renders a scene to a picture, or to many.
//!
//! Cheap checks come first: the output's place, the scene's existence, the settings; then the GPU
//! and its limits; then the scene; then the work.

mod clock;
mod job;
mod noise;
mod report;
mod sequence;
mod still;

use std::cell::OnceCell;

use lumivox::gpu::Timing;
use lumivox_console::Failure;
use lumivox_scene::{Sight, SightOptions};

use crate::args::output;
use crate::args::scene;
use crate::cli::RenderArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::sequence::FrameFiles;
use crate::timeline::{
    AnimationName, PathFile, PictureTimes, Schedule, ScheduleOptions, TimeChoice,
};
use crate::{light, settings};
use clock::Clock;
use job::RenderJob;

/// Renders, writes and reports.
///
/// # Errors
/// When any step fails; the message says which.
pub fn run(args: &RenderArgs, verbosity: u8, host: &Host) -> anyhow::Result<()> {
    let is_asked = asks_for_sequence(args);
    let is_meant = FrameFiles::is_meant(&args.output, is_asked);
    // A name with # means one picture if nothing moves; only the loaded scene shows that.
    let may_be_one = !is_asked && FrameFiles::is_pattern(&args.output);
    if (is_meant || is_asked) && !may_be_one {
        FrameFiles::new(&args.output)?.check()?;
    } else {
        output::check(&args.output)?;
    }
    let mut settings = args.settings()?;
    let path = args.timeline.camera_path.as_deref().map(PathFile::read).transpose()?;
    scene::check(&args.scene.scene)?;
    light::check(&args.light.sources)?;

    let mut clock = Clock::start();
    let progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    settings.validate(&gpu.device.limits())?;
    if args.json || verbosity > 0 {
        settings.timing = Timing::for_device(&gpu.device);
    }
    let mut scene = args.scene.load(&progress)?;
    light::add(&mut scene, &args.light.sources, &progress)?;
    let is_still =
        scene.animations().is_empty() || args.timeline.animation == Some(AnimationName::None);
    let is_sequence = is_meant && !(may_be_one && is_still);
    let asked = ScheduleOptions {
        time: args.timeline.time,
        fps: f64::from(args.timeline.fps),
        animation: args.timeline.animation.as_ref(),
        orbit_deg: args.timeline.orbit,
        path: path.as_ref(),
        camera: args.picture.camera.as_ref(),
        is_sequence,
        aspect: args.picture.aspect(),
    };
    progress.set("looking at the scene", 0, 1);
    let framing = OnceCell::new();
    let schedule = Schedule::new(&asked, &scene, &framing)?;
    let is_found = scene.cameras.is_empty() && args.picture.camera.is_none() && path.is_none();
    let camera = schedule.camera(&scene, schedule.start_s(), 0.0);
    let sight = SightOptions {
        camera: (!is_found).then_some(camera),
        aspect: asked.aspect,
        staging: args.light.sources.staging(),
        fineness: settings.fineness(&scene),
    };
    let sight = Sight::of(&scene, &sight, &framing);
    scene.light_up(&sight);
    // `framing` takes 130 MB for a million triangles.
    drop(framing);
    settings::expose_for_look(&mut settings, &args.given(), &scene);
    clock.seconds.loading = clock.lap();

    let is_verbose = verbosity > 0;
    let notes = sight.notes;
    let mut stage = RenderJob {
        args,
        host,
        is_verbose,
        settings,
        gpu,
        scene,
        notes,
        schedule,
        progress,
        clock,
    };
    let time_s = match stage.schedule.times {
        PictureTimes::Sequence(_) => return sequence::run(stage, path.as_ref()),
        PictureTimes::Rest => 0.0,
        PictureTimes::At(time_s) => {
            stage.schedule.pose(&mut stage.scene, time_s)?;
            time_s
        }
    };
    if is_sequence {
        return Err(Failure::input(format!(
            "{}: is the place of a sequence, but one time gives one picture; name a .png or .exr \
             file without #",
            args.output.display()
        ))
        .into());
    }
    let camera = stage.schedule.camera(&stage.scene, time_s, 0.0);
    still::run(stage, &camera, &args.output)
}

/// Whether options other than the output request a sequence.
fn asks_for_sequence(args: &RenderArgs) -> bool {
    let timeline = &args.timeline;
    if timeline.pictures.is_some() {
        return true;
    }
    match timeline.time {
        Some(TimeChoice::Range(..)) => true,
        Some(TimeChoice::At(_)) => false,
        None => timeline.orbit.is_some() || timeline.camera_path.is_some(),
    }
}
