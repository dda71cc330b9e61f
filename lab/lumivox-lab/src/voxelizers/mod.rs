//! `lumivox-lab voxelizers`: comparison of all voxelizers with the exact one.

mod picture;

use std::time::Instant;

use anyhow::Context as _;
use glam::Vec3;
use lumivox::gpu::Timing;
use lumivox::{Geometry, Gi, GiConfig, GiError, Grid};
use lumivox_app::Host;
use lumivox_app::parts::{ProgressDisplay, check_scene, output, upload, write_strip};
use lumivox_console::report::{AdapterReport, GridReport, SceneCounts, Table, count};
use lumivox_console::shown;
use lumivox_console::values::camera::resolve;
use lumivox_explorer::parameters::{Kind, Parameter, Value, find_parameter};
use lumivox_render::{Gpu, RenderSettings, VoxelSet};
use serde::Serialize;

use crate::cli::VoxelizersArgs;
use picture::{Panel, picture};

/// Number of timed voxelizations; the fastest counts.
const TIMED_RUNS: u32 = 3;

/// The setting `voxelizer`.
fn voxelizers() -> &'static Parameter {
    find_parameter("voxelizer").unwrap_or_else(|| unreachable!("this program has the classics"))
}

/// Voxelizes with all voxelizers, compares and reports.
///
/// # Errors
/// When the scene cannot be read, its voxels do not fit the GPU, or the picture cannot be written.
pub fn run(args: &VoxelizersArgs, host: &Host) -> anyhow::Result<()> {
    if let Some(file) = &args.output {
        output::check_kind(file, "png", "pictures of voxelizers are written as PNG")?;
    }
    check_scene(&args.scene.scene)?;
    let progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let scene = args.scene.load(&progress)?;
    let size = args.size;
    let camera = match &args.output {
        Some(_) => {
            let aspect = size.x as f32 / size.y as f32;
            Some(resolve(args.camera.as_ref(), &scene, aspect)?)
        }
        None => None,
    };
    let bounds = scene.voxel_bounds();
    let grid = Grid::fit(bounds.min, bounds.max, args.resolution, Vec3::ZERO)?;
    progress.set("uploading", 0, 1);
    let uploaded = upload(&gpu, &scene)?;
    gpu.wait("uploading the scene")?;

    let Kind::Choice(methods) = voxelizers().kind else { unreachable!("they are choices") };
    let total = methods.len() as u32;
    let mut found = Vec::new();
    for (done, method) in (0..).zip(methods) {
        progress.set("voxelizing", done, total);
        found.push(Found::new(&gpu, &grid, &uploaded.geometry, method.name)?);
    }
    let (exact, _) = found.split_first().unwrap_or_else(|| unreachable!("there are methods"));
    let exact = &exact.set;
    let methods: Vec<_> = found.iter().map(|found| MethodReport::new(found, exact)).collect();

    if let (Some(file), Some(camera)) = (&args.output, &camera) {
        progress.set("drawing", 0, 1);
        let panels: Vec<_> = found
            .iter()
            .zip(&methods)
            .map(|(found, report)| Panel { set: &found.set, caption: report.caption() })
            .collect();
        write_strip(file, &picture(&panels, exact, camera, size))?;
    }
    drop(progress);
    let report = Report {
        scene: SceneCounts::new(&scene),
        grid: GridReport::new(&grid),
        methods,
        picture: args.output.as_ref().map(|file| file.display().to_string()),
        adapter: AdapterReport::new(&gpu.adapter_info),
    };
    if args.json {
        return host.print_json(&report);
    }
    host.print(&report.text())
}

/// The voxels and the time of one voxelizer.
struct Found {
    method: &'static str,
    set: VoxelSet,
    fragments: u64,
    faces: u32,
    wall_ms: f64,
}

impl Found {
    fn new(
        gpu: &Gpu,
        grid: &Grid,
        geometry: &Geometry,
        method: &'static str,
    ) -> anyhow::Result<Self> {
        let mut settings = RenderSettings::default();
        voxelizers().set(&mut settings, Value::Choice(method))?;
        let config = GiConfig { voxelizer: settings.voxelizer, ..GiConfig::new(*grid) };
        let mut gi = Gi::with_pipelines(&gpu.pipelines, &gpu.queue, config)?;
        let mut once = || match pollster::block_on(gi.voxelize(geometry, Timing::Off)) {
            Ok(voxelized) => Ok(Some(voxelized.stats)),
            // Small triangles may all miss the centres of pixels.
            Err(GiError::NothingToVoxelize { .. }) => Ok(None),
            Err(error) => Err(error),
        };
        // Do not time the first voxelization: drivers compile kernels at their first use.
        let voxelized = once()?;
        gpu.wait("voxelizing")?;
        let mut wall_ms = f64::INFINITY;
        for _ in 0..TIMED_RUNS {
            let start = Instant::now();
            once()?;
            gpu.wait("voxelizing")?;
            wall_ms = wall_ms.min(start.elapsed().as_secs_f64() * 1e3);
        }
        let (set, fragments, faces) = match voxelized {
            Some(stats) => {
                let list = gi.voxels().context("a voxelization makes a list")?;
                let set = pollster::block_on(VoxelSet::read(gpu, grid, list))?;
                (set, stats.fragments, stats.faces)
            }
            None => (VoxelSet::new(*grid, Vec::new()), 0, 0),
        };
        gpu.check("reading voxels")?;
        Ok(Self { method, set, fragments, faces, wall_ms })
    }
}

#[derive(Clone, Debug, Serialize)]
struct Report {
    scene: SceneCounts,
    grid: GridReport,
    methods: Vec<MethodReport>,
    picture: Option<String>,
    adapter: AdapterReport,
}

/// The comparison of one voxelizer with the exact one.
#[derive(Clone, Debug, Serialize)]
struct MethodReport {
    name: &'static str,
    voxels: u32,
    /// Voxels of the exact voxelizer that this one misses.
    missing: u32,
    /// Missing voxels that surfaces touch, but in which they have no area.
    missing_touched: u32,
    /// Voxels that the exact voxelizer does not have.
    extra: u32,
    /// Share of the exact surface that is in missing voxels, 0 to 1.
    missing_area: f64,
    /// Area found divided by the exact area.
    area: f64,
    /// RMSE of reflectance, 0 to 1, over voxels in common.
    color_rmse: f64,
    faces: u32,
    /// Pieces of triangles in voxels.
    fragments: u64,
    /// Wall-clock time of the fastest voxelization, ms.
    wall_ms: f64,
}

impl MethodReport {
    fn new(found: &Found, exact: &VoxelSet) -> Self {
        let difference = found.set.difference(exact);
        Self {
            name: found.method,
            voxels: difference.voxels,
            missing: difference.missing,
            missing_touched: difference.missing_touched,
            extra: difference.extra,
            missing_area: difference.missing_area,
            area: difference.area,
            color_rmse: difference.color_rmse,
            faces: found.faces,
            fragments: found.fragments,
            wall_ms: found.wall_ms,
        }
    }

    fn caption(&self) -> [String; 2] {
        let [voxels, missing, extra] =
            [self.voxels, self.missing, self.extra].map(|number| count(number.into()));
        [
            format!("{}: {voxels} voxels", self.name),
            format!("{missing} missing, {extra} too many, colour RMSE {:.4}", self.color_rmse),
        ]
    }
}

impl Report {
    fn text(&self) -> String {
        let mut table = Table::new(&[
            "voxelizer",
            "voxels",
            "missing",
            "(touched)",
            "too many",
            "surface missed",
            "surface in all",
            "colour RMSE",
            "fragments",
            "ms",
        ]);
        for method in &self.methods {
            let percent = |share: f64| format!("{:.2} %", 100.0 * share);
            table.row([
                method.name.to_owned(),
                count(method.voxels.into()),
                count(method.missing.into()),
                count(method.missing_touched.into()),
                count(method.extra.into()),
                percent(method.missing_area),
                percent(method.area),
                format!("{:.5}", method.color_rmse),
                count(method.fragments),
                format!("{:.1}", method.wall_ms),
            ]);
        }
        let [x, y, z] = self.grid.dimensions;
        let mut text = format!(
            "{}, {x} x {y} x {z} voxels\n\n{}",
            shown::line(&self.scene.name),
            table.text()
        );
        text += "\nMissing and too many: against the exact voxels; touched: of the missing, those without \
                 any surface\nin them. Surface: areas along the sides of voxels, as shares of the exact \
                 one. Colour: reflectance\nof the voxels in which both have surface.\n";
        text += &format!("Times on {}: the fastest of {TIMED_RUNS}.\n", self.adapter.description);
        if let Some(picture) = &self.picture {
            text += &format!("The picture is {picture}.\n");
        }
        text
    }
}
