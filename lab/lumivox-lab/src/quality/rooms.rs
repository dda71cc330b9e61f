//! Random rooms: the page begins with the distribution of their errors.

use std::fmt::Write as _;

use glam::UVec2;
use lumivox_app::parts::{Kept, ProgressDisplay, check_wish, settings};
use lumivox_render::{Gpu, PresetChoice};

use crate::cli::QualityArgs;
use crate::rooms::random::Kind;
use crate::rooms::{Meter, RoomFigures, at, by_group, faults, fresh_seed, heading, room_of, row};

/// The sets of rooms: the value of `lumivox-lab rooms --kinds`, and its kinds.
const SETS: [(&str, &[Kind]); 2] = [("plain", &[Kind::Plain]), ("all", &Kind::ALL)];
/// Default number of rooms in each set. A room takes about 20 s of CPU time without a GPU, most of
/// it at 128 voxels, so both sets take 7 minutes on two cores.
const COUNT: u32 = 20;
const RESOLUTIONS: [u32; 2] = [64, 128];
/// The path tracer's samples of a sensor.
const SAMPLES: u32 = 2048;
/// The size of a picture.
const SIZE: UVec2 = UVec2::new(48, 36);

/// The rooms of a page.
pub struct Rooms {
    seed: u32,
    count: u32,
    frames: u32,
    /// The figures of each set.
    sets: [Vec<RoomFigures>; 2],
}

/// Measures the rooms of both sets with a fresh seed, or reads them from the cache, with its seed.
/// `None` if there are no rooms.
///
/// # Errors
/// When rendering fails, the cache cannot be used, or the user stops it.
pub fn measure(
    args: &QualityArgs,
    gpu: &Gpu,
    progress: &ProgressDisplay,
) -> anyhow::Result<Option<Rooms>> {
    let count = args.rooms.unwrap_or(if args.scenes.is_empty() { COUNT } else { 0 });
    if count == 0 {
        return Ok(None);
    }
    let folder = args.cache.as_ref().map(|cache| cache.join("rooms"));
    let words = format!(
        "{SAMPLES} samples, {} frames, {RESOLUTIONS:?} voxels, version {}",
        args.frames,
        env!("CARGO_PKG_VERSION")
    );
    let mut store: Kept<Vec<RoomFigures>> = Kept::open(folder.as_deref(), words)?;
    let key = |set: &str, index: u32| format!("{set} {index}");
    let kept = store.get(&key(SETS[0].0, 0)).and_then(|figures| figures.first());
    let seed = kept.map_or_else(fresh_seed, |figures| figures.seed);
    let preset = PresetChoice::default();
    let settings = settings::of(preset, SIZE, &[])?;
    let meter = Meter::new(gpu, progress, &settings, args.frames, SAMPLES);
    let mut sets = [Vec::new(), Vec::new()];
    for ((number, (set, kinds)), measured) in (0..).zip(SETS).zip(&mut sets) {
        for index in 0..count {
            let key = key(set, index);
            if store.get(&key).is_none() && !args.kept {
                let room = room_of(seed.wrapping_add(index), kinds)?;
                let place = (number * count + index, SETS.len() as u32 * count);
                let figures = meter.measure(&room, &RESOLUTIONS, place)?;
                check_wish(progress)?;
                store.put(key.clone(), figures)?;
            }
            measured.extend(store.get(&key).into_iter().flatten().cloned());
        }
    }
    let is_empty = sets.iter().all(Vec::is_empty);
    Ok((!is_empty).then_some(Rooms { seed, count, frames: args.frames, sets }))
}

impl Rooms {
    /// The seed of the first room.
    pub fn seed(&self) -> u32 {
        self.seed
    }

    /// The section of the page.
    pub fn section(&self) -> String {
        let Self { seed, count, frames, .. } = self;
        let [coarse, fine] = RESOLUTIONS;
        let (width, height) = (SIZE.x, SIZE.y);
        let mut text = format!(
            "## Rooms at random\n\n{count} plain rooms and {count} of all kinds, with seeds that no page had before, so \
             that nothing can be tuned to them: here from {seed}. `lumivox-lab rooms --seed {seed} --count {count} --kinds \
             plain --resolutions {coarse},{fine}` measures the same rooms again, with `--kinds all` the others, and \
             with `--keep FOLDER` it writes them as files. Preset `balanced`, {frames} frames; the truth has {SAMPLES} \
             samples at a sensor. \
             *Error* is how far the mean of a lit room's sensors is off, in per cent; *truth's noise* is the standard error \
             of that truth, below which no error can be seen; *picture* is the irradiance of \
             all bounces in {width} x {height} pixels from within the room, its median bias and its RMSE; *leak* is \
             what the brightest sensor reads in rooms whose truth is below a thousandth of the illuminance outside, in \
             per cent of that. Signs are left out.\n\n{}",
            heading("rooms, voxels")
        );
        for ((set, _), rooms) in SETS.iter().zip(&self.sets) {
            for resolution in RESOLUTIONS {
                text += &row(&format!("{set}, {resolution}"), &at(resolution, rooms));
            }
        }
        let all = || self.sets.iter().flatten();
        let _ = writeln!(text, "\n{}\n", faults(&all().collect::<Vec<_>>()));
        for resolution in RESOLUTIONS {
            let table = by_group(&at(resolution, all()));
            let _ = writeln!(text, "### Both sets at {resolution} voxels\n\n{table}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_contains_the_command_that_repeats_it() {
        let lit = RoomFigures::example("plain", Some(30.0), None);
        let fine = RoomFigures { resolution: 128, error_percent: Some(-10.0), ..lit.clone() };
        let tent = RoomFigures::example("tent", None, Some(0.5));
        let rooms = Rooms { seed: 7, count: 1, frames: 4, sets: [vec![lit, fine], vec![tent]] };
        let text = rooms.section();
        for part in [
            "`lumivox-lab rooms --seed 7 --count 1 --kinds plain --resolutions 64,128`",
            "| plain, 64 | 1 | 30.0 |",
            "| plain, 128 | 1 | 10.0 |",
            "| all, 64 | 1 | - |",
            "| all, 128 | 0 | - |",
            "No reading and no pixel",
            "### Both sets at 64 voxels",
            "| tent | 1 | - |",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }
}
