//! The choice of the clock for stages: the GPU's timestamps if they are accurate.
//!
//! A driver may take timestamps at the wrong time (software drivers: when they read commands, not
//! when they run), in the wrong unit, or not at all. So they are checked once against the wall
//! clock: the same work (lighting a scene's voxels, and a frame) is timed by timestamps, and by
//! submitting each pass separately and waiting for it. A wait costs some tenths of a millisecond,
//! so only passes that are much longer are compared, and the work grows until there are some. If
//! the two clocks disagree, the wall clock is used for all measurements.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use glam::UVec2;
use lumivox::gpu::Timing;
use lumivox_render::{Gpu, RenderError, RenderSettings, Renderer};
use lumivox_scene::Scene;

use super::report::{Spread, TimingReport};

/// Voxels per axis and pixels of the work; the next entry is tried if no pass is long.
const WORK: [(u32, UVec2); 4] = [
    (32, UVec2::new(320, 180)),
    (64, UVec2::new(640, 360)),
    (128, UVec2::new(1280, 720)),
    (256, UVec2::new(1920, 1080)),
];
/// The shortest time of a long pass, far above the cost of a wait, ms.
const LONG_MS: f64 = 10.0;
/// Accepted ratios of stamped to waited time of a long pass: waiting costs time, which lowers the
/// ratio; chance may raise it.
const TRUE_SHARES: RangeInclusive<f64> = 0.5..=1.25;
/// The lowest accepted ratio of all passes together, if even the largest work has no long pass.
const LEAST_SHARE_OF_SHORT: f64 = 0.05;
/// Runs of the work; the median counts.
const RUNS: usize = 3;

/// The time of a pass by both clocks, ms.
#[derive(Clone, Debug, PartialEq)]
struct Compared {
    pass: String,
    stamped: f64,
    waited: f64,
}

/// Chooses the clock for stages on a device; also returns the reason.
pub fn choose(gpu: &Gpu, scene: &Scene) -> (Timing, TimingReport) {
    let waited = |reason: String| {
        let method = "waited submits".to_owned();
        (Timing::SubmitAndWait, TimingReport { method, reason })
    };
    if gpu.is_software() {
        return waited(
            "a software driver takes timestamps when it reads commands, not when they run"
                .to_owned(),
        );
    }
    if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        return waited("the device has no timestamps".to_owned());
    }
    match compare(gpu, scene) {
        Ok(compared) => match judge(&compared) {
            Ok(reason) => {
                let method = "timestamps".to_owned();
                (Timing::Timestamps, TimingReport { method, reason })
            }
            Err(reason) => waited(format!("timestamps cannot be trusted: {reason}")),
        },
        Err(error) => waited(format!("timestamps could not be checked: {error}")),
    }
}

/// Returns why timestamps can be trusted, or why not.
fn judge(compared: &[Compared]) -> Result<String, String> {
    let is_long = |pass: &&Compared| pass.waited >= LONG_MS;
    let words = |name: &str, stamped: f64, waited: f64| {
        format!("{name} takes {stamped:.2} ms by them, {waited:.2} ms by the wall clock")
    };
    // NaN counts as wrong.
    let is_wrong = |pass: &&Compared| !TRUE_SHARES.contains(&(pass.stamped / pass.waited));
    if let Some(pass) = compared.iter().filter(is_long).find(is_wrong) {
        return Err(words(&pass.pass, pass.stamped, pass.waited));
    }
    if let Some(pass) = compared.iter().find(is_long) {
        return Ok(words(&pass.pass, pass.stamped, pass.waited));
    }
    let sum = |of: fn(&Compared) -> f64| compared.iter().map(of).sum::<f64>();
    let (stamped, waited) = (sum(|pass| pass.stamped), sum(|pass| pass.waited));
    let words = words("all work", stamped, waited);
    let shares = LEAST_SHARE_OF_SHORT..=*TRUE_SHARES.end();
    if shares.contains(&(stamped / waited)) { Ok(words) } else { Err(words) }
}

/// Times increasingly large work until a pass is long or the device fails.
fn compare(gpu: &Gpu, scene: &Scene) -> Result<Vec<Compared>, RenderError> {
    let mut last = None;
    for (resolution, size) in WORK {
        match pollster::block_on(compare_at(gpu, scene, resolution, size)) {
            Ok(compared) => {
                let has_long = compared.iter().any(|pass| pass.waited >= LONG_MS);
                last = Some(compared);
                if has_long {
                    break;
                }
            }
            // Use the times of the largest work that succeeded, if any did.
            Err(error) => return last.ok_or(error),
        }
    }
    Ok(last.unwrap_or_default())
}

async fn compare_at(
    gpu: &Gpu,
    scene: &Scene,
    resolution: u32,
    size: UVec2,
) -> Result<Vec<Compared>, RenderError> {
    let timing = Timing::Timestamps;
    let settings = RenderSettings { size, resolution, timing, ..RenderSettings::default() };
    let quiet = &mut |_| ();
    let mut renderer = Renderer::new(gpu, scene, None, settings.clone(), quiet).await?;
    let stamped = times(&mut renderer, scene).await?;
    let waited = RenderSettings { timing: Timing::SubmitAndWait, ..settings };
    renderer.set_settings(waited, quiet).await?;
    let waited = times(&mut renderer, scene).await?;
    let compared = waited.into_iter().map(|(pass, waited)| {
        let stamped = stamped.get(&pass).copied().unwrap_or(0.0);
        Compared { pass, stamped, waited }
    });
    Ok(compared.collect())
}

/// The median time of each pass of the work, ms.
async fn times(
    renderer: &mut Renderer,
    scene: &Scene,
) -> Result<BTreeMap<String, f64>, RenderError> {
    let mut runs: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for run in 0..=RUNS {
        renderer.forget_times();
        renderer.forget_light();
        renderer.set_lights(scene, &mut |_| ()).await?;
        renderer.render_frame().await?;
        // Skip the first run, in which drivers compile.
        for time in renderer.times().into_iter().filter(|_| run > 0) {
            runs.entry(time.pass).or_default().push(time.duration.as_secs_f64() * 1e3);
        }
    }
    Ok(runs.into_iter().map(|(pass, ms)| (pass, Spread::of(ms).median)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_render::GpuOptions;

    fn is_true(passes: &[(f64, f64)]) -> bool {
        let compared = passes.iter().map(|&(stamped, waited)| {
            let pass = "a pass".to_owned();
            Compared { pass, stamped, waited }
        });
        judge(&compared.collect::<Vec<_>>()).is_ok()
    }

    #[test]
    fn timestamps_are_trusted_if_long_passes_match_the_clock() {
        assert!(
            is_true(&[(95.0, 100.0)]) && is_true(&[(110.0, 100.0)]) && is_true(&[(60.0, 100.0)])
        );
        // Timestamps of another unit, zero, or not a number.
        assert!(!is_true(&[(3.0, 100.0)]) && !is_true(&[(0.0, 100.0)]));
        assert!(!is_true(&[(2600.0, 100.0)]) && !is_true(&[(f64::NAN, 100.0)]));
        // Each long pass has to agree, even if the sum does.
        assert!(!is_true(&[(100.0, 20.0), (20.0, 100.0)]));
        // Waiting takes most of the time of short passes.
        assert!(is_true(&[(95.0, 100.0), (0.01, 0.4), (0.0, 0.3)]));
        assert!(is_true(&[(1.0, 4.0)]) && !is_true(&[(0.1, 4.0)]) && !is_true(&[(8.0, 4.0)]));
        assert!(!is_true(&[]), "nothing was compared");
    }

    #[test]
    #[ignore = "slow: over three seconds"]
    fn both_clocks_time_the_same_passes() {
        let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap();
        assert!(gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY));
        let scene = lumivox_scene::builtin::scene("cornell").unwrap();
        let compared = compare(&gpu, &scene).unwrap();
        assert!(compared.len() > 10, "{compared:?}");
        for pass in &compared {
            assert!(pass.waited > 0.0 && pass.stamped >= 0.0, "{pass:?}");
        }
        let bounce = compared.iter().find(|pass| pass.pass == "light::bounce").unwrap();
        assert!(bounce.waited >= LONG_MS || !gpu.is_software(), "{bounce:?}");
        let timing = choose(&gpu, &scene).0;
        assert_eq!(timing == Timing::SubmitAndWait, gpu.is_software());
    }
}
