//! `lumivox-lab volumes`: cost of the kinds of volumes, side by side.

use glam::Vec3;
use lumivox::gpu::{StageTime, Timing};
use lumivox::{Directionality, Grid, VolumeKind, dense_volume_bytes};
use lumivox_app::Host;
use lumivox_app::parts::{ProgressDisplay, check_scene, look_at, output};
use lumivox_console::report::{AdapterReport, SceneCounts, Table, bytes, count};
use lumivox_console::shown;
use lumivox_explorer::parameters::{Value, find_parameter};
use lumivox_render::{Gpu, Overlay, RenderSettings, Renderer, Wires};
use lumivox_scene::{Scene, Staging};
use serde::Serialize;

use crate::charts::{MemoryPoint, memory_against_resolution};
use crate::cli::VolumesArgs;

/// Number of timed frames, after one untimed frame.
const FRAMES: u32 = 2;

/// Measures and reports.
///
/// # Errors
/// When the scene cannot be read, a file cannot be written, or the device fails.
pub fn run(args: &VolumesArgs, host: &Host) -> anyhow::Result<()> {
    check_scene(&args.scene.scene)?;
    if let Some(file) = &args.output {
        output::check_kind(file, "svg", "a chart is written as SVG")?;
    }
    let progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let mut scene = args.scene.load(&progress)?;
    look_at(&mut scene, None, args.size, Staging::Auto, &progress)?;
    let mut rows = Vec::new();
    let variants = variants(args.alternatives);
    let total = (args.resolutions.len() * variants.len()) as u32;
    for &resolution in &args.resolutions {
        for variant in &variants {
            progress.set("measuring", rows.len() as u32, total);
            rows.push(Row::measure(&gpu, &scene, args, resolution, variant)?);
        }
    }
    drop(progress);
    let report = Report {
        scene: SceneCounts::new(&scene),
        adapter: AdapterReport::new(&gpu.adapter_info),
        rows,
    };
    if let Some(file) = &args.output {
        let chart = memory_against_resolution(&report.scene.name, &report.points())?;
        output::write(file, chart.as_bytes())?;
    }
    if args.json {
        return host.print_json(&report);
    }
    host.print(&report.text())
}

/// A kind of volume with its options.
struct Variant {
    name: &'static str,
    volume: VolumeKind,
    /// The value of the setting `octree_builder`; `None` for the default.
    builder: Option<&'static str>,
}

fn variants(with_alternatives: bool) -> Vec<Variant> {
    let octree = |name, builder| Variant { name, volume: VolumeKind::Octree, builder };
    let mut variants = vec![
        Variant { name: "dense", volume: VolumeKind::Dense, builder: None },
        octree("octree", None),
    ];
    if with_alternatives {
        variants.push(octree("locks", Some("locks")));
    }
    variants
}

/// The cost of one volume at one resolution.
#[derive(Clone, Debug, Serialize)]
struct Row {
    resolution: u32,
    name: &'static str,
    volume: &'static str,
    voxels: Option<u32>,
    /// Bytes of the volume itself; known for a dense volume even if it does not fit.
    bytes: Option<u64>,
    /// Time to build an octree's nodes from the voxel list, or a dense volume's masks.
    build_ms: Option<f64>,
    /// Time of each change of light: to store the faces' radiance, filter, and fill bricks.
    update_ms: Option<f64>,
    /// The part of `update_ms` for filtering.
    filter_ms: Option<f64>,
    /// The part of `update_ms` for filling bricks.
    fill_ms: Option<f64>,
    /// Time of the cones of one frame.
    trace_ms: Option<f64>,
    /// Groups of eight slots for nodes.
    groups: Option<u32>,
    bricks: Option<u32>,
    /// Passes of the builder with locks, and the threads that they deferred.
    lock_passes: Option<u64>,
    deferred: Option<u64>,
    /// Why the volume was not measured; `None` if it was.
    problem: Option<String>,
}

impl Row {
    fn measure(
        gpu: &Gpu,
        scene: &Scene,
        args: &VolumesArgs,
        resolution: u32,
        variant: &Variant,
    ) -> anyhow::Result<Self> {
        let bounds = scene.voxel_bounds();
        let grid = Grid::fit(bounds.min, bounds.max, resolution, Vec3::ZERO)?;
        let directionality =
            if args.isotropic { Directionality::Isotropic } else { Directionality::SixLobes };
        let dense = matches!(variant.volume, VolumeKind::Dense);
        let row = Self {
            resolution,
            name: variant.name,
            volume: if dense { "dense" } else { "octree" },
            voxels: None,
            bytes: dense.then(|| dense_volume_bytes(&grid, directionality)),
            build_ms: None,
            update_ms: None,
            filter_ms: None,
            fill_ms: None,
            trace_ms: None,
            groups: None,
            bricks: None,
            lock_passes: None,
            deferred: None,
            problem: None,
        };
        let mut settings = RenderSettings {
            size: args.size,
            resolution,
            directionality,
            volume: variant.volume,
            bounces: 1,
            // Show an overlay of cells, or they are not kept.
            overlay: Overlay { wire_voxels: Wires::Over, ..Overlay::default() },
            frames: FRAMES,
            timing: Timing::for_device(&gpu.device),
            ..RenderSettings::default()
        };
        if let Some(builder) = variant.builder {
            let row = find_parameter("octree_builder");
            let row = row.unwrap_or_else(|| unreachable!("this program has the classics"));
            row.set(&mut settings, Value::Choice(builder))?;
        }
        match pollster::block_on(timed(gpu, scene, settings, !args.no_trace)) {
            Ok(renderer) => Ok(row.of(&renderer)),
            Err(error) if is_limit(&error) => Ok(Self { problem: Some(error.to_string()), ..row }),
            Err(error) => Err(error.into()),
        }
    }

    fn of(self, renderer: &Renderer) -> Self {
        let times = renderer.times();
        let sum = |is: &dyn Fn(&StageTime) -> bool| {
            let ms: Vec<f64> =
                times.iter().filter(|t| is(t)).map(|t| t.duration.as_secs_f64() * 1e3).collect();
            (!ms.is_empty()).then(|| ms.iter().sum())
        };
        let memory = renderer.gi().memory();
        let volume = memory.iter().filter(|(name, _)| name.starts_with("volume"));
        let stats = renderer.gi().octree_stats();
        let counted = |name: &str| {
            let counts = &stats.as_ref()?.counts;
            counts.iter().find(|(other, _)| *other == name).map(|(_, count)| *count)
        };
        Self {
            voxels: Some(renderer.voxel_stats().voxels),
            bytes: Some(volume.map(|(_, bytes)| bytes).sum()),
            build_ms: sum(&|time| time.stage == "volume"),
            update_ms: sum(&|time| time.stage == "filter"),
            filter_ms: sum(&|time| time.stage == "filter" && time.pass.contains("filter")),
            fill_ms: sum(&|time| time.stage == "filter" && time.pass.contains("fill")),
            trace_ms: sum(&|time| time.stage == "trace"),
            bricks: stats.as_ref().map(|stats| stats.bricks),
            groups: stats.as_ref().map(|stats| stats.groups),
            lock_passes: counted("lock_passes"),
            deferred: counted("deferred"),
            ..self
        }
    }

    fn bytes_per_voxel(&self) -> Option<f64> {
        Some(self.bytes? as f64 / f64::from(self.voxels?))
    }
}

/// A renderer that has voxelized, lit and traced (if `with_trace`), with the times of a second run:
/// in the first, drivers compile shaders.
async fn timed(
    gpu: &Gpu,
    scene: &Scene,
    settings: RenderSettings,
    with_trace: bool,
) -> Result<Renderer, lumivox_render::RenderError> {
    let ignore = &mut |_| ();
    let mut renderer = Renderer::new(gpu, scene, None, settings, ignore).await?;
    if with_trace {
        renderer.render_frame().await?;
    }
    renderer.forget_times();
    renderer.forget_light();
    renderer.set_scene(scene, ignore).await?;
    for _ in 0..if with_trace { FRAMES } else { 0 } {
        renderer.render_frame().await?;
    }
    Ok(renderer)
}

/// Whether the error means that something does not fit the GPU.
fn is_limit(error: &lumivox_render::RenderError) -> bool {
    use lumivox::GiError;
    use lumivox_render::RenderError;
    matches!(
        error,
        RenderError::Gi(GiError::Limit { .. } | GiError::Budget { .. })
            | RenderError::OutOfMemory { .. }
            | RenderError::Limit { .. }
    )
}

#[derive(Clone, Debug, Serialize)]
struct Report {
    scene: SceneCounts,
    adapter: AdapterReport,
    rows: Vec<Row>,
}

impl Report {
    /// The points of the chart: dense volumes and octrees with default options.
    fn points(&self) -> Vec<MemoryPoint> {
        let usual = self.rows.iter().filter(|row| row.name == row.volume);
        usual
            .filter_map(|row| {
                Some(MemoryPoint {
                    volume: row.volume,
                    resolution: row.resolution,
                    bytes: row.bytes?,
                    is_measured: row.problem.is_none(),
                })
            })
            .collect()
    }

    fn text(&self) -> String {
        let mut table = Table::new(&[
            "volume", "voxels", "occupied", "memory", "a voxel", "build", "update", "filter",
            "fill", "trace",
        ]);
        let ms = |value: Option<f64>| value.map_or("-".to_owned(), |ms| format!("{ms:.1} ms"));
        for row in &self.rows {
            let indent = if row.name == row.volume { "" } else { "  " };
            table.row([
                format!("{indent}{}", row.name),
                row.resolution.to_string(),
                row.voxels.map_or("-".to_owned(), |voxels| count(voxels.into())),
                row.bytes.map_or("-".to_owned(), bytes),
                row.bytes_per_voxel().map_or("-".to_owned(), |bytes| format!("{bytes:.0} B")),
                ms(row.build_ms),
                ms(row.update_ms),
                ms(row.filter_ms),
                ms(row.fill_ms),
                ms(row.trace_ms),
            ]);
        }
        let mut text = format!("{}\n\n{}", shown::line(&self.scene.name), table.text());
        for row in &self.rows {
            if let (Some(passes), Some(deferred)) = (row.lock_passes, row.deferred) {
                text += &format!(
                    "\nLocks at {}: {passes} passes, {} threads deferred.\n",
                    row.resolution,
                    count(deferred)
                );
            }
            if let Some(problem) = &row.problem {
                text += &format!("\n{} at {}: {problem}.\n", row.name, row.resolution);
            }
        }
        text + &format!(
            "\nBuild: from the voxel list; update: when light changes; trace: the cones of a frame. On {}.\n",
            self.adapter.description
        )
    }
}
