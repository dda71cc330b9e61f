//! `lumivox voxels`: the voxels of a scene and their cost.

use std::time::Instant;

use glam::Vec3;
use lumivox::gpu::Timing;
use lumivox::{Gi, Grid, VolumeKind, VoxelizeStats};
use lumivox_console::report::{
    AdapterReport, GridReport, MemoryReport, OctreeReport, SceneCounts, Table, TimesReport, count,
    memory_table, total_bytes,
};
use lumivox_console::shown;
use lumivox_explorer::parameters::find_parameter;
use lumivox_render::{
    Gpu, GpuScene, Lighting, RenderError, RenderSettings, global_illumination, radiance_unit,
};
use lumivox_scene::Scene;
use serde::Serialize;

use crate::args::camera::resolve;
use crate::args::scene;
use crate::cli::VoxelsArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::settings;

/// Voxelizes and reports.
///
/// # Errors
/// When the scene cannot be read, or its voxels do not fit the GPU.
pub fn run(args: &VoxelsArgs, host: &Host) -> anyhow::Result<()> {
    let settings = settings::of_voxels(&args.voxels)?;
    scene::check(&args.scene.scene)?;
    let progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let scene = args.scene.load(&progress)?;
    let grid = grid(&settings, &scene)?;

    progress.set("uploading", 0, 1);
    let uploaded = upload(&gpu, &scene)?;
    let mut gi = pollster::block_on(global_illumination(&gpu, settings.gi_config(grid)))?;
    gpu.wait("uploading the scene")?;

    progress.set("voxelizing", 0, 1);
    // Voxelize first without timing of passes, which may slow it down, then with it.
    let start = Instant::now();
    let voxelized = pollster::block_on(gi.voxelize(&uploaded.geometry, Timing::Off));
    let voxelized = voxelized.map_err(|error| RenderError::of_scene(error, &scene))?;
    gpu.wait("voxelizing")?;
    let wall_ms = start.elapsed().as_secs_f64() * 1e3;
    let timing = Timing::for_device(&gpu.device);
    let timed = pollster::block_on(gi.voxelize(&uploaded.geometry, timing))?;
    gpu.check("voxelizing")?;
    drop(progress);

    let way = find_parameter("voxelizer").map_or("exact", |row| row.get(&settings).name());
    let times = TimesReport::new(&timed.times);
    let report = Report::new(&scene, &gi, way, &voxelized.stats, times, wall_ms);
    let report = Report { adapter: Some(AdapterReport::new(&gpu.adapter_info)), ..report };
    if args.json {
        return host.print_json(&report);
    }
    host.print(&report.text())
}

/// The grid of a scene's voxels.
///
/// # Errors
/// When the settings are invalid for a grid.
pub fn grid(settings: &RenderSettings, scene: &Scene) -> anyhow::Result<Grid> {
    let centre = match settings.volume {
        // Cascades are centred on the default camera.
        VolumeKind::Cascades => resolve(None, scene, 16.0 / 9.0)?.position,
        VolumeKind::Dense | VolumeKind::Octree => Vec3::ZERO,
    };
    Ok(settings.grid(scene.voxel_bounds(), centre)?)
}

/// Uploads a scene, to voxelize it.
///
/// # Errors
/// When it does not fit the GPU.
pub fn upload(gpu: &Gpu, scene: &Scene) -> anyhow::Result<GpuScene> {
    let lighting = Lighting::of(scene);
    let unit = radiance_unit(scene, &lighting);
    Ok(GpuScene::new(gpu, scene, &lighting, unit, None)?)
}

#[derive(Clone, Debug, Serialize)]
struct Report {
    scene: SceneCounts,
    grid: GridReport,
    voxelizer: &'static str,
    /// Triangles given to the voxelizer.
    triangles: u64,
    /// Triangles left out: without area, or with non-finite coordinates.
    skipped: u64,
    /// Triangles outside the grid.
    outside: u64,
    /// Tiles of triangles: the threads of each walk.
    work_items: u64,
    /// Pieces of triangles in voxels.
    fragments: u64,
    voxels: u32,
    faces: u32,
    levels: Vec<LevelReport>,
    /// `None` for a dense volume.
    octree: Option<OctreeReport>,
    /// Memory that stays on the GPU.
    memory: Vec<MemoryReport>,
    memory_bytes: u64,
    /// Wall-clock time of one voxelization without timing of passes, ms.
    wall_ms: f64,
    #[serde(flatten)]
    times: TimesReport,
    adapter: Option<AdapterReport>,
}

/// The report on one level of the pyramid.
#[derive(Clone, Debug, Serialize)]
struct LevelReport {
    level: u32,
    dimensions: [u32; 3],
    /// The edge of a cell, m.
    cell_size_m: f32,
    /// Occupied cells.
    nodes: u32,
    /// Share of the cells that is occupied.
    occupancy: f64,
}

impl Report {
    fn new(
        scene: &Scene,
        gi: &Gi,
        voxelizer: &'static str,
        stats: &VoxelizeStats,
        times: TimesReport,
        wall_ms: f64,
    ) -> Self {
        let grid = gi.grid();
        let named = |(name, bytes): (&'static str, u64)| MemoryReport { name: name.into(), bytes };
        let memory: Vec<_> = gi.memory().into_iter().map(named).collect();
        let level = |level: u32| {
            let dimensions = grid.level_dimensions(level);
            let nodes = gi.voxels().map_or(0, |voxels| voxels.level_nodes(level).len() as u32);
            let cells = dimensions.as_u64vec3().element_product();
            LevelReport {
                level,
                dimensions: dimensions.to_array(),
                cell_size_m: grid.voxel_size_m * (1_u32 << level) as f32,
                nodes,
                occupancy: f64::from(nodes) / cells as f64,
            }
        };
        Self {
            scene: SceneCounts::new(scene),
            grid: GridReport::new(grid),
            voxelizer,
            triangles: stats.triangles,
            skipped: stats.skipped,
            outside: stats.outside,
            work_items: stats.work_items,
            fragments: stats.fragments,
            voxels: stats.voxels,
            faces: stats.faces,
            levels: (0..grid.levels).map(level).collect(),
            octree: OctreeReport::new(gi),
            memory_bytes: total_bytes(&memory),
            memory,
            wall_ms,
            times,
            adapter: None,
        }
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n\n", shown::line(&self.scene.name));
        let mut table = Table::new(&["voxelization", ""]);
        for (name, value) in [
            ("triangles", self.triangles),
            ("  without an area, skipped", self.skipped),
            ("  outside the grid", self.outside),
            ("tiles of triangles", self.work_items),
            ("pieces of triangles in voxels", self.fragments),
            ("voxels", self.voxels.into()),
            ("faces of voxels", self.faces.into()),
        ] {
            table.row([name.to_owned(), count(value)]);
        }
        text += &table.text();

        let mut table = Table::new(&["level", "cells", "edge in m", "occupied", "share"]);
        for level in &self.levels {
            let [x, y, z] = level.dimensions;
            table.row([
                level.level.to_string(),
                format!("{x} x {y} x {z}"),
                format!("{:.4}", level.cell_size_m),
                count(level.nodes.into()),
                format!("{:.2} %", level.occupancy * 100.0),
            ]);
        }
        text.push('\n');
        text += &table.text();
        if let Some(octree) = &self.octree {
            text += &format!("\n{}\n", octree.line());
        }
        text.push('\n');
        text += &memory_table(&self.memory);
        text.push('\n');
        text += &self.times.table("stage and pass");
        text += &format!("\nOne voxelization takes {:.2} ms in all", self.wall_ms);
        if let Some(adapter) = &self.adapter {
            text += &format!(" on {}", adapter.description);
        }
        text + ".\n"
    }
}
