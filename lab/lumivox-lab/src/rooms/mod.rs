//! `lumivox-lab rooms`: the errors of light in random rooms, for which Lumivox was not tuned.
//!
//! | file | is |
//! | --- | --- |
//! | `random/` | the rooms |
//! | `measure.rs` | one room: its sensors and a picture by cones and by paths |
//! | `figures.rs` | the figures of a room |
//! | `distribution.rs` | median, 90 % and worst of many rooms, as tables in Markdown |

mod distribution;
mod figures;
mod measure;
pub mod random;

use std::fmt::Write as _;
use std::path::Path;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use lumivox_app::Host;
use lumivox_app::parts::{ProgressDisplay, check_wish, output, settings};
use lumivox_console::report::AdapterReport;
use serde::Serialize;

use crate::cli::RoomsArgs;
pub use distribution::{at, by_group, faults, heading, row};
pub use figures::RoomFigures;
pub use measure::Meter;
use random::{Kind, Room, room};

/// A fresh seed: the clock's milliseconds, which wrap after 49 days.
pub fn fresh_seed() -> u32 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_millis() as u32)
}

/// The room of a seed; the seed also selects the kind among `kinds`.
///
/// # Errors
/// As [`room`].
pub fn room_of(seed: u32, kinds: &[Kind]) -> anyhow::Result<Room> {
    Ok(room(seed, kinds[seed as usize % kinds.len()])?)
}

/// Measures the rooms, and reports.
///
/// # Errors
/// When a room cannot be rendered or a file cannot be written.
pub fn run(args: &RoomsArgs, host: &Host) -> anyhow::Result<()> {
    let file = args.json.as_deref().filter(|file| *file != Path::new("-"));
    if let Some(file) = file {
        output::check_folder(file, &output::folder_of(file))?;
    }
    if let Some(folder) = &args.keep {
        output::make_folder(folder)?;
    }
    let kinds: Vec<Kind> = args.kinds.iter().flat_map(|choice| choice.kinds()).collect();
    let first = args.seed.unwrap_or_else(fresh_seed);
    let start = Instant::now();
    let mut progress = ProgressDisplay::start(host, "starting");
    let gpu = host.open_gpu(&args.gpu.options())?;
    progress.stop_on_interrupt(host)?;
    let settings = settings::of(args.preset, args.size, &[])?;
    let meter = Meter::new(&gpu, &progress, &settings, args.frames, args.samples);
    let tell = |line: &str| host.complain_above_bars(line);
    tell(&format!("{} rooms from --seed {first}\n", args.count));
    let mut all = Vec::new();
    for index in 0..args.count {
        let room = room_of(first.wrapping_add(index), &kinds)?;
        if let Some(folder) = &args.keep {
            keep(&room, folder)?;
        }
        let figures = meter.measure(&room, &args.resolutions, (index, args.count))?;
        check_wish(&progress)?;
        for figures in &figures {
            tell(&format!("{figures}\n"));
        }
        all.extend(figures);
    }
    drop(progress);
    let report = Report {
        version: env!("CARGO_PKG_VERSION"),
        seed: first,
        preset: args.preset.name(),
        samples: args.samples,
        frames: args.frames,
        rooms: all,
        seconds: start.elapsed().as_secs_f64(),
        adapter: AdapterReport::new(&gpu.adapter_info),
    };
    if args.json.is_some() && file.is_none() {
        return host.print_json(&report);
    }
    if let Some(file) = file {
        let text = serde_json::to_string_pretty(&report)? + "\n";
        output::write(file, text.as_bytes())?;
    }
    host.print(&report.text(&args.resolutions))
}

/// Writes a room and its sensors.
fn keep(room: &Room, folder: &Path) -> anyhow::Result<()> {
    let name = &room.scene.name;
    room.scene.save_glb(folder.join(format!("{name}.glb")))?;
    let mut text = "x,y,z,nx,ny,nz\n".to_owned();
    for (at, normal) in &room.sensors {
        let [x, y, z] = at.to_array();
        let [nx, ny, nz] = normal.to_array();
        let _ = writeln!(text, "{x},{y},{z},{nx},{ny},{nz}");
    }
    output::write(&folder.join(format!("{name}.csv")), text.as_bytes())
}

/// The figures of all rooms.
#[derive(Debug, Serialize)]
struct Report {
    version: &'static str,
    /// The seed of the first room.
    seed: u32,
    preset: &'static str,
    /// Samples of each sensor by the path tracer.
    samples: u32,
    /// Averaged frames of the cones.
    frames: u32,
    rooms: Vec<RoomFigures>,
    /// Total wall-clock time, s.
    seconds: f64,
    adapter: AdapterReport,
}

impl Report {
    fn text(&self, resolutions: &[u32]) -> String {
        let mut text = String::new();
        for resolution in resolutions {
            let table = by_group(&at(*resolution, &self.rooms));
            let _ = writeln!(text, "{resolution} voxels, {}\n\n{table}", self.preset);
        }
        let rooms: Vec<&RoomFigures> = self.rooms.iter().collect();
        let _ = writeln!(
            text,
            "{}\n--seed {}, {:.0} s on {}",
            faults(&rooms),
            self.seed,
            self.seconds,
            self.adapter.name
        );
        text
    }
}
