//! `lumivox bake`: light in a file, for renderers without global illumination of their own.
//!
//! | file | bakes |
//! | --- | --- |
//! | `volume.rs` | indirect light at a grid of probes |
//! | `lightmap.rs` | light on surfaces, as an image |

mod lightmap;
mod volume;

use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use glam::Vec3;
use lumivox_console::report::AdapterReport;
use lumivox_console::{Failure, LoadArgs, SourceArgs};
use lumivox_render::reference::{MeterSettings, Reading, Sensor};
use lumivox_render::{Gpu, RenderSettings};
use lumivox_scene::{Camera, Scene, write_atomically};

use super::measure::Task;
use super::staged::stage;
use crate::args::{output, scene};
use crate::cli::{BakeArgs, Method};
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::{light, settings};

/// Bakes, writes and reports.
///
/// # Errors
/// When any step fails; the message says which.
pub fn run(args: &BakeArgs, host: &Host) -> anyhow::Result<()> {
    if args.lightmap { lightmap::run(args, host) } else { volume::run(args, host) }
}

/// A scene to bake.
struct Bake<'a> {
    args: &'a BakeArgs,
    start: Instant,
    progress: ProgressDisplay,
    gpu: Gpu,
    scene: Scene,
    camera: Camera,
    settings: RenderSettings,
    /// The most bounces of paths, if they are limited.
    bounces: Option<u32>,
}

impl<'a> Bake<'a> {
    /// Loads the scene.
    fn prepare(args: &'a BakeArgs, host: &Host) -> anyhow::Result<Self> {
        output::check_folder(&args.output, &output::folder_of(&args.output))?;
        let given = [args.voxels.given(), args.light.given(), args.cones.settings.given()].concat();
        let size = glam::UVec2::splat(16);
        let settings = settings::of(args.cones.preset(), size, &given)?;
        scene::check(&args.scene.scene)?;
        light::check(&args.sources)?;
        let start = Instant::now();
        let mut progress = ProgressDisplay::start(host, "loading");
        let gpu = host.open_gpu(&args.gpu.options())?;
        // No default light is added, unless --surroundings asks for some.
        let adds = args.sources.surroundings.is_some();
        let sources = SourceArgs { no_default_light: !adds, ..args.sources.clone() };
        let load = LoadArgs { second_uvs: args.lightmap, ..args.scene.load.clone() };
        let (scene, camera) =
            stage(&args.scene.scene, &load, &sources, &args.view, size, &progress)?;
        progress.stop_on_interrupt(host)?;
        let bounces = given.iter().any(|(parameter, _)| parameter.name == "bounces");
        let bounces = bounces.then_some(settings.bounces);
        Ok(Self { args, start, progress, gpu, scene, camera, settings, bounces })
    }

    /// The irradiance at places towards their normals, lux: the indirect light, or all.
    fn irradiance(&self, places: &[(Vec3, Vec3)], with_direct: bool) -> anyhow::Result<Vec<Vec3>> {
        let Self { args, gpu, scene, camera, progress, .. } = self;
        if places.is_empty() {
            return Ok(Vec::new());
        }
        let task = Task { gpu, scene, camera, progress };
        Ok(match args.method {
            Method::Cones => {
                let gathered = task.gathered(places, self.settings.clone(), args.frames)?;
                let light = |light: &lumivox::Irradiance| {
                    if with_direct { light.total() } else { light.indirect }
                };
                gathered.iter().map(light).collect()
            }
            Method::Paths => {
                let settings =
                    MeterSettings { samples: args.samples, seed: args.seed, bounces: self.bounces };
                let sensor = |&(at, normal): &(Vec3, Vec3)| Sensor::Irradiance { at, normal };
                let read = task.traced(&places.iter().map(sensor).collect::<Vec<_>>(), settings)?;
                let light = |light: &Reading| {
                    let total = Vec3::from(light.total);
                    if with_direct {
                        total
                    } else {
                        (total - Vec3::from(light.direct)).max(Vec3::ZERO)
                    }
                };
                read.iter().map(light).collect()
            }
        })
    }

    /// The seconds so far, and the GPU, for reports.
    fn figures(&self) -> (f64, AdapterReport) {
        (self.start.elapsed().as_secs_f64(), AdapterReport::new(&self.gpu.adapter_info))
    }
}

/// The extension of the output file in lower case.
fn ending(file: &Path) -> String {
    file.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Writes a file, complete or not at all.
fn write(file: &Path, what: &str, bytes: &[u8]) -> anyhow::Result<()> {
    write_atomically(file, |out| out.write_all(bytes)).map_err(|error| {
        let reason = format!("{}: cannot write the {what}: {error}", file.display());
        Failure::output(reason + "; check the folder and its permissions").into()
    })
}
