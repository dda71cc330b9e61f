//! The choice of the clock for stages: the GPU's timestamps where they are true.
//!
//! A driver may take timestamps at the wrong time (lavapipe: when commands are parsed), in the wrong unit, or not at all. So
//! they are held against the wall clock once, on work that keeps the GPU busy for long enough that the CPU's share does not
//! matter: the light of a scene's voxels, of which all passes go out in one submission that is waited for. Their sum must be
//! close to that time. Otherwise each pass is submitted by itself and waited for, and the wall clock is read.

use std::time::Instant;

use lumivox::gpu::Timing;
use lumivox_render::{Gpu, RenderError, RenderSettings, Renderer};
use lumivox_scene::Scene;

use super::report::{Spread, TimingReport};

/// Voxels for the comparison; the next is tried while the work is too short.
const RESOLUTIONS: [u32; 4] = [32, 64, 128, 256];
/// The shortest time of work that the CPU's share does not matter in, ms.
const LONG_MS: f64 = 10.0;
/// Shares of the wall clock within which the sum of the passes is true. Passes may overlap a little, and the time of the
/// wall clock includes recording and waiting.
const TRUE_SHARES: std::ops::RangeInclusive<f64> = 0.5..=1.25;
/// The lowest share where even the largest work is short.
const LEAST_SHARE_OF_SHORT: f64 = 0.1;
/// Comparisons, of which the median counts.
const RUNS: usize = 3;

/// Work on the GPU by both clocks, ms.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Compared {
    passes: f64,
    wall: f64,
}

/// The way to take the times of stages on a device, and the reason.
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
        Ok(compared) => {
            let words = format!(
                "the passes of the same work take {:.2} ms by timestamps, {:.2} ms by the wall clock",
                compared.passes, compared.wall
            );
            if is_true(compared) {
                let method = "timestamps".to_owned();
                (Timing::Timestamps, TimingReport { method, reason: words })
            } else {
                waited(format!("timestamps cannot be trusted: {words}"))
            }
        }
        Err(error) => waited(format!("timestamps could not be checked: {error}")),
    }
}

fn is_true(Compared { passes, wall }: Compared) -> bool {
    let share = passes / wall;
    let least = if wall < LONG_MS { LEAST_SHARE_OF_SHORT } else { *TRUE_SHARES.start() };
    (least..=*TRUE_SHARES.end()).contains(&share)
}

/// Takes the time of work that is as long as it has to be, if the device can do it.
fn compare(gpu: &Gpu, scene: &Scene) -> Result<Compared, RenderError> {
    let mut last = Err(RenderError::Device { doing: "comparing clocks", reason: String::new() });
    for resolution in RESOLUTIONS {
        let compared = pollster::block_on(compare_at(gpu, scene, resolution));
        match compared {
            Ok(compared) if compared.wall < LONG_MS => last = Ok(compared),
            Ok(compared) => return Ok(compared),
            // Less work was possible; else there is no comparison.
            Err(error) => return last.map_err(|_| error),
        }
    }
    last
}

async fn compare_at(gpu: &Gpu, scene: &Scene, resolution: u32) -> Result<Compared, RenderError> {
    let settings = RenderSettings {
        size: glam::UVec2::new(64, 36),
        resolution,
        timing: Timing::Timestamps,
        ..RenderSettings::default()
    };
    let quiet = &mut |_| ();
    let mut renderer = Renderer::new(gpu, scene, None, settings, quiet).await?;
    let (mut passes, mut walls) = (Vec::new(), Vec::new());
    // The first run is not counted.
    for _ in 0..=RUNS {
        renderer.forget_times();
        renderer.forget_light();
        let start = Instant::now();
        renderer.set_lights(scene, quiet).await?;
        walls.push(start.elapsed().as_secs_f64() * 1e3);
        passes.push(renderer.times().iter().map(|time| time.duration.as_secs_f64() * 1e3).sum());
    }
    let median = |ms: Vec<f64>| Spread::of(ms[1..].to_vec()).median;
    Ok(Compared { passes: median(passes), wall: median(walls) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_render::GpuOptions;

    #[test]
    fn timestamps_are_true_if_they_agree_with_the_wall_clock() {
        let judge = |passes, wall| is_true(Compared { passes, wall });
        assert!(judge(95.0, 100.0) && judge(110.0, 100.0) && judge(60.0, 100.0));
        // Of another unit, zero, or not a number.
        assert!(!judge(3.0, 100.0) && !judge(0.0, 100.0) && !judge(2600.0, 100.0));
        assert!(!judge(f64::NAN, 100.0));
        // Much of a short time is the CPU's.
        assert!(judge(1.0, 4.0) && !judge(0.1, 4.0) && !judge(8.0, 4.0));
    }

    /// Lavapipe has timestamps, which are wrong; those of a GPU have to agree.
    #[test]
    fn a_software_drivers_timestamps_are_found_out() {
        let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap();
        assert!(gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY));
        let scene = lumivox_scene::builtin::scene("cornell").unwrap();
        let compared = compare(&gpu, &scene).unwrap();
        assert_eq!(is_true(compared), !gpu.is_software(), "{compared:?}");
        let timing = if gpu.is_software() { Timing::SubmitAndWait } else { Timing::Timestamps };
        assert_eq!(choose(&gpu, &scene).0, timing);
    }
}
