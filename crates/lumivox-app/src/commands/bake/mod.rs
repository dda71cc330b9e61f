//! `lumivox bake`: the indirect light of a scene in a volume of probes, for other engines.

mod ktx2;
mod probes;

use std::io::Write as _;

use glam::{UVec2, Vec3};
use lumivox_console::report::{AdapterReport, SceneCounts, bytes, count};
use lumivox_console::{Failure, shown};
use lumivox_render::{PresetChoice, Renderer};
use lumivox_scene::{Scene, Staging, write_atomically};
use serde::Serialize;

use super::{light, settings, staged};
use crate::args::{output, scene};
use crate::cli::BakeArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use probes::Probes;

/// Probes along the longest edge of a scene without `--spacing`.
const PROBES_BY_DEFAULT: f32 = 16.0;

/// Bakes and reports.
///
/// # Errors
/// When the scene cannot be read, the file cannot be written, the volume is too large, or the device fails.
pub fn run(args: &BakeArgs, host: &Host) -> anyhow::Result<()> {
    scene::check(&args.scene.scene)?;
    output::check_kind(&args.output, "ktx2", "a volume is written as KTX2")?;
    light::check(&args.light.sources)?;
    let given = [args.voxels.given(), args.light.settings.given()].concat();
    // Nothing is seen of it but its light.
    let size = UVec2::splat(8);
    let settings = settings::of(PresetChoice::default(), size, &given)?;
    let progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu)?;
    let mut scene = args.scene.load(&progress)?;
    light::add(&mut scene, &args.light.sources, &progress)?;
    staged::look_at(&mut scene, None, size, Staging::Auto, &progress)?;
    let probes = probes_of(&scene, args.spacing)?;

    progress.set("lighting", 0, 1);
    let renderer = Renderer::new(&gpu, &scene, None, settings, &mut |_| {});
    let renderer = pollster::block_on(renderer)?;
    progress.set("gathering", 0, 1);
    let cubes = pollster::block_on(probes.gather(&renderer, args.frames))?;
    let (texels, filled) = probes.texels(&cubes);
    let file = ktx2::volume(probes.texture_size(), &texels);
    drop(progress);
    write_atomically(&args.output, |out| out.write_all(&file)).map_err(|error| {
        Failure::output(format!("{}: cannot be written: {error}", args.output.display()))
    })?;
    let report = Report {
        file: args.output.display().to_string(),
        scene: SceneCounts::new(&scene),
        adapter: AdapterReport::new(&gpu.adapter_info),
        probes: probes.count.to_array(),
        probes_in_walls: filled,
        center_m: (0.5 * (probes.min + probes.max)).to_array(),
        size_m: (probes.max - probes.min).to_array(),
        bytes: file.len() as u64,
        mean_cd_m2: probes::mean_luminance(&texels),
    };
    if args.json {
        return host.print_json(&report);
    }
    host.print(&report.text())
}

/// Probes in the box of the scene.
fn probes_of(scene: &Scene, spacing_m: Option<f32>) -> anyhow::Result<Probes> {
    let bounds = scene.voxel_bounds();
    let longest = (bounds.max - bounds.min).max_element();
    let spacing_m = spacing_m.unwrap_or(longest / PROBES_BY_DEFAULT);
    Ok(Probes::fit(bounds.min, bounds.max, spacing_m).map_err(Failure::input)?)
}

/// What was baked.
#[derive(Serialize)]
struct Report {
    file: String,
    scene: SceneCounts,
    adapter: AdapterReport,
    /// Along x, y and z.
    probes: [u32; 3],
    /// Probes that got the light of their neighbours.
    probes_in_walls: usize,
    /// The place of the volume: the translation of its entity in Bevy, and its scale.
    center_m: [f32; 3],
    size_m: [f32; 3],
    bytes: u64,
    mean_cd_m2: f32,
}

impl Report {
    fn text(&self) -> String {
        let [x, y, z] = self.probes;
        let [center, size] = [self.center_m, self.size_m].map(Vec3::from);
        format!(
            "{}: {x} x {y} x {z} probes of {}, {} of them in walls; {}; mean {:.3} cd/m2\n\
             In Bevy: IrradianceVolume {{ voxels, intensity: 1.0, .. }} with\n  \
             Transform::from_xyz({:?}, {:?}, {:?}).with_scale(Vec3::new({:?}, {:?}, {:?}))\n",
            shown::line(&self.file),
            shown::line(&self.scene.name),
            count(self.probes_in_walls as u64),
            bytes(self.bytes),
            self.mean_cd_m2,
            center.x,
            center.y,
            center.z,
            size.x,
            size.y,
            size.z,
        )
    }
}
