//! `lumivox-lab dynamic`: the gain of keeping the static surface while other things move.
//!
//! A share of the triangles moves in a copy of the scene. Each move is voxelized and lit twice: as
//! a whole, and with the static surface kept.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::time::Instant;

use glam::{Mat4, Vec3};
use lumivox::gpu::{Recorder, StageTime, Timing, read_buffer};
use lumivox::voxels::FaceRecord;
use lumivox::{Geometry, Gi, GiConfig, Lights, TraceSettings};
use lumivox_app::Host;
use lumivox_app::parts::{ProgressDisplay, check_scene, grid, settings, upload};
use lumivox_console::report::{
    AdapterReport, GridReport, SceneCounts, Table, TimeReport, TimesReport, count,
};
use lumivox_console::shown;
use lumivox_render::{Gpu, GpuScene, Lighting, global_illumination};
use lumivox_scene::{Bounds, Mesh, Scene};
use serde::Serialize;

use crate::cli::DynamicArgs;

/// The distance of moved instances from their place, in voxels.
const REACH_VOXELS: f32 = 1.5;

/// Measures and reports.
///
/// # Errors
/// When the scene cannot be read, its voxels do not fit the GPU, or the two ways gave different
/// bits.
pub fn run(args: &DynamicArgs, host: &Host) -> anyhow::Result<()> {
    let settings = settings::of_voxels(&args.voxels)?;
    check_scene(&args.scene.scene)?;
    let progress = ProgressDisplay::start(host, "loading");
    let gpu = host.open_gpu(&args.gpu.options())?;
    let mut scene = args.scene.load(&progress)?;
    mark(&mut scene, args.share);
    let config = settings.gi_config(grid(&settings, &scene)?);
    let config = GiConfig { keeps_cells: true, ..config };
    progress.set("uploading", 0, 1);
    let uploaded = upload(&gpu, &scene)?;
    let report = measure(&gpu, &scene, &uploaded, &config, args.moves, &progress)?;
    drop(progress);
    report.print(args.json, host)
}

/// Marks a share of the triangles as dynamic, and all others as static: small instances first,
/// those of equal size in an arbitrary order. The last instance is cut in two to meet the share.
fn mark(scene: &mut Scene, share: f32) {
    let total = scene.triangle_count();
    let mut left = ((total as f64 * f64::from(share)).round() as usize).clamp(1, total);
    let mut order: Vec<(f32, u64, usize)> = (0..scene.instances.len())
        .map(|index| {
            let instance = &scene.instances[index];
            let positions = &scene.meshes[instance.mesh].positions;
            let points = positions.iter().map(|p| instance.world_from_local.transform_point3(*p));
            let mut hasher = DefaultHasher::new();
            index.hash(&mut hasher);
            (Bounds::from_points(points).size().length(), hasher.finish(), index)
        })
        .collect();
    // Truncate: the sizes of equal instances differ by rounding.
    order.sort_by_key(|&(size, mix, _)| ((size * 1e3) as u64, mix));
    for (_, _, index) in order {
        let triangles = scene.meshes[scene.instances[index].mesh].triangle_count();
        scene.instances[index].is_static = left == 0;
        if left > 0 && left < triangles {
            cut(scene, index, left);
        }
        left = left.saturating_sub(triangles);
    }
}

/// Leaves an instance its first triangles, and moves the others to a new, static instance.
fn cut(scene: &mut Scene, index: usize, triangles: usize) {
    let mut rest = scene.instances[index].clone();
    let whole = &scene.meshes[rest.mesh];
    let (first, second) = whole.indices.split_at(3 * triangles);
    let parts = [first.to_vec(), second.to_vec()].map(|indices| Mesh { indices, ..whole.clone() });
    scene.instances[index].mesh = scene.meshes.len();
    rest.mesh = scene.meshes.len() + 1;
    rest.is_static = true;
    scene.meshes.extend(parts);
    scene.instances.push(rest);
}

/// The offset of all dynamic instances at a move.
fn offset(step: u32, voxel_size_m: f32) -> Vec3 {
    // Steps by the golden angle: no two moves are alike.
    let (sin, cos) = (2.399_963 * step as f32).sin_cos();
    Vec3::new(cos, 0.3 * sin, sin) * (REACH_VOXELS * voxel_size_m)
}

fn moved(geometry: &Geometry, offset: Vec3) -> Geometry {
    let mut geometry = geometry.clone();
    for draw in geometry.batches.iter_mut().flat_map(|batch| &mut batch.draws) {
        if !draw.is_static {
            draw.world_from_local = Mat4::from_translation(offset) * draw.world_from_local;
        }
    }
    geometry
}

/// One of the two ways to update the voxels after a move.
struct Way {
    gi: Gi,
    lights: Lights,
    keeps_static: bool,
    steps: u32,
    voxelize_ms: f64,
    light_ms: f64,
    times: Vec<StageTime>,
}

impl Way {
    fn step(&mut self, gpu: &Gpu, geometry: &Geometry, timing: Timing) -> anyhow::Result<()> {
        let start = Instant::now();
        let voxelized = if self.keeps_static {
            pollster::block_on(self.gi.voxelize_dynamic(geometry, timing))?
        } else {
            pollster::block_on(self.gi.voxelize(geometry, timing))?
        };
        gpu.wait("voxelizing")?;
        // The first step has no static surface to reuse.
        let has_static =
            geometry.batches.iter().flat_map(|batch| &batch.draws).any(|d| d.is_static);
        let must_reuse = self.keeps_static && self.steps > 0 && has_static;
        if must_reuse && !voxelized.stats.static_reused {
            anyhow::bail!("the static surface was voxelized again, which is a defect of Lumivox");
        }
        self.steps += 1;
        let voxelize_ms = start.elapsed().as_secs_f64() * 1e3;
        if !self.keeps_static {
            self.gi.forget_light();
        }
        let start = Instant::now();
        let mut recorder = Recorder::with_timing(&gpu.device, &gpu.queue, timing);
        self.gi.light(&mut recorder, &self.lights, 1, &TraceSettings::default())?;
        let times = pollster::block_on(recorder.finish())?;
        gpu.wait("lighting the voxels")?;
        if timing == Timing::Off {
            self.voxelize_ms += voxelize_ms;
            self.light_ms += start.elapsed().as_secs_f64() * 1e3;
        } else {
            self.times.extend(voxelized.times);
            self.times.extend(times);
        }
        Ok(())
    }

    /// The voxel list and its light, as words.
    fn bits(&self, gpu: &Gpu) -> anyhow::Result<Vec<Vec<u32>>> {
        let Some((voxels, light)) = self.gi.voxels().zip(self.gi.face_radiance()) else {
            anyhow::bail!("there are no voxels");
        };
        let node_count = voxels.level_starts.last().copied().unwrap_or(0);
        [
            (&voxels.occupancy, voxels.occupancy.size()),
            (&voxels.ranks, voxels.ranks.size()),
            (&voxels.nodes, u64::from(node_count) * 8),
            (&voxels.first_faces, u64::from(voxels.voxel_count()) * 4),
            (&voxels.faces, u64::from(voxels.face_count) * size_of::<FaceRecord>() as u64),
            (light, u64::from(voxels.face_count) * 16),
        ]
        .into_iter()
        .map(|(buffer, bytes)| {
            Ok(pollster::block_on(read_buffer(&gpu.device, &gpu.queue, buffer, 0..bytes))?)
        })
        .collect()
    }
}

/// Moves the dynamic instances, and measures the times of both ways.
fn measure(
    gpu: &Gpu,
    scene: &Scene,
    uploaded: &GpuScene,
    config: &GiConfig,
    moves: u32,
    progress: &ProgressDisplay,
) -> anyhow::Result<Report> {
    let lights = Lighting::of(scene).to_gpu(uploaded.radiance_unit);
    let environment = scene.environment.radiance / uploaded.radiance_unit;
    let way = |keeps_static: bool| -> anyhow::Result<Way> {
        let gi = pollster::block_on(global_illumination(gpu, config.clone()))?;
        let lights = gi.bind_lights(&lights, environment, None);
        let (voxelize_ms, light_ms, times) = (0.0, 0.0, Vec::new());
        Ok(Way { gi, lights, keeps_static, steps: 0, voxelize_ms, light_ms, times })
    };
    let mut ways = [way(false)?, way(true)?];
    let timing = Timing::for_device(&gpu.device);
    let mut has_same_bits = true;
    let mut changed = 0.0;
    // The first move is untimed: it allocates buffers and compiles kernels. Then moves are timed by
    // the wall clock, and at last pass by pass, which slows everything down.
    let steps = 1 + 2 * moves;
    for step in 0..steps {
        progress.set("moving", step, steps);
        let geometry = moved(&uploaded.geometry, offset(step, config.grid.voxel_size_m));
        let timing = if step <= moves { Timing::Off } else { timing };
        for way in &mut ways {
            way.step(gpu, &geometry, timing)?;
            if step == 0 {
                (way.voxelize_ms, way.light_ms) = (0.0, 0.0);
            }
        }
        let [whole, kept] = &ways;
        has_same_bits &= whole.bits(gpu)? == kept.bits(gpu)?;
        if step > 0 {
            changed += share_of_changed(gpu, &kept.gi)? / f64::from(steps - 1);
        }
    }
    let [whole, kept] = ways;
    Ok(Report::new(gpu, scene, moves, (&whole, &kept), (changed, has_same_bits)))
}

/// The share of the occupied cells of all levels that the last update wrote.
fn share_of_changed(gpu: &Gpu, gi: &Gi) -> anyhow::Result<f64> {
    let Some((voxels, changed)) = gi.voxels().zip(gi.changed_cells()) else { return Ok(1.0) };
    let count = |buffer: &wgpu::Buffer| -> anyhow::Result<f64> {
        let bytes = 0..voxels.occupancy.size();
        let words: Vec<u32> =
            pollster::block_on(read_buffer(&gpu.device, &gpu.queue, buffer, bytes))?;
        Ok(words.iter().map(|word| f64::from(word.count_ones())).sum())
    };
    Ok(count(changed)? / count(&voxels.occupancy)?)
}

/// The report on the moves.
#[derive(Clone, Debug, Serialize)]
struct Report {
    scene: SceneCounts,
    grid: GridReport,
    dynamic_instances: usize,
    dynamic_triangles: usize,
    /// Voxels at the last move.
    voxels: u32,
    faces: u32,
    moves: u32,
    /// Wall-clock time of a move for the voxelization and the volume's update to the new list, ms:
    /// as a whole, and with the static surface kept.
    whole_voxelize_ms: f64,
    kept_voxelize_ms: f64,
    /// Time to compute, store and filter direct light, ms.
    whole_light_ms: f64,
    kept_light_ms: f64,
    /// Times of a move, waiting for each pass.
    stages: Vec<StageReport>,
    passes: Vec<StageReport>,
    /// Share of the occupied cells of all levels that a move writes.
    changed_share: f64,
    /// Whether both ways gave the same lists and light at every move.
    has_same_bits: bool,
    /// Bytes of the kept surface.
    kept_bytes: u64,
    adapter: AdapterReport,
}

/// A stage, or a pass of it.
#[derive(Clone, Debug, Serialize)]
struct StageReport {
    stage: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pass: Option<String>,
    whole_ms: f64,
    kept_ms: f64,
}

impl Report {
    fn new(
        gpu: &Gpu,
        scene: &Scene,
        moves: u32,
        (whole, kept): (&Way, &Way),
        (changed_share, has_same_bits): (f64, bool),
    ) -> Self {
        let a_move = |ms: f64| ms / f64::from(moves);
        let [of_whole, of_kept] = [whole, kept].map(|way| TimesReport::new(&way.times));
        let pairs = |whole: &[TimeReport], kept: &[TimeReport]| -> Vec<StageReport> {
            let pair = |own: &TimeReport| {
                let is_same =
                    |other: &&TimeReport| other.stage == own.stage && other.pass == own.pass;
                StageReport {
                    stage: own.stage.clone(),
                    pass: own.pass.clone(),
                    whole_ms: a_move(whole.iter().find(is_same).map_or(0.0, |other| other.ms)),
                    kept_ms: a_move(own.ms),
                }
            };
            kept.iter().map(pair).collect()
        };
        let dynamic = || scene.instances.iter().filter(|instance| !instance.is_static);
        let voxels = kept.gi.voxels();
        let memory = kept.gi.memory();
        let kept_memory = memory.iter().filter(|(name, _)| name.contains("kept"));
        Self {
            scene: SceneCounts::new(scene),
            grid: GridReport::new(kept.gi.grid()),
            dynamic_instances: dynamic().count(),
            dynamic_triangles: dynamic()
                .map(|instance| scene.meshes[instance.mesh].triangle_count())
                .sum(),
            voxels: voxels.map_or(0, lumivox::voxels::VoxelList::voxel_count),
            faces: voxels.map_or(0, |voxels| voxels.face_count),
            moves,
            whole_voxelize_ms: a_move(whole.voxelize_ms),
            kept_voxelize_ms: a_move(kept.voxelize_ms),
            whole_light_ms: a_move(whole.light_ms),
            kept_light_ms: a_move(kept.light_ms),
            stages: pairs(&of_whole.stages, &of_kept.stages),
            passes: pairs(&of_whole.passes, &of_kept.passes),
            changed_share,
            has_same_bits,
            kept_bytes: kept_memory.map(|(_, bytes)| bytes).sum(),
            adapter: AdapterReport::new(&gpu.adapter_info),
        }
    }

    /// Prints the report. It is an error if the two ways gave different bits.
    fn print(&self, json: bool, host: &Host) -> anyhow::Result<()> {
        if json {
            host.print_json(self)?;
        } else {
            host.print(&self.text())?;
        }
        anyhow::ensure!(
            self.has_same_bits,
            "keeping the static surface gave other bits than voxelizing everything: a defect of this \
             program or of the GPU's driver; please report it"
        );
        Ok(())
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n\n", shown::line(&self.scene.name));
        let mut table = Table::new(&["", ""]);
        let share = self.dynamic_triangles as f64 / self.scene.triangles.max(1) as f64;
        for (name, value) in [
            ("triangles", count(self.scene.triangles as u64)),
            ("  that move", count(self.dynamic_triangles as u64)),
            ("  share", format!("{:.2} %", share * 100.0)),
            ("instances", count(self.scene.instances as u64)),
            ("  that move", count(self.dynamic_instances as u64)),
            ("voxels", count(self.voxels.into())),
            ("cells that a move writes", format!("{:.1} %", self.changed_share * 100.0)),
            ("moves", self.moves.to_string()),
            ("memory of the kept surface", lumivox_console::report::bytes(self.kept_bytes)),
        ] {
            table.row([name.to_owned(), value]);
        }
        text += &table.text();
        text.push('\n');
        let mut table = Table::new(&["ms a move", "everything", "static kept", "gain"]);
        let mut row = |name: &str, whole: f64, kept: f64| {
            let gain = format!("{:.2} x", whole / kept.max(1e-9));
            table.row([name.to_owned(), format!("{whole:.2}"), format!("{kept:.2}"), gain]);
        };
        row("voxels and volume, by the clock", self.whole_voxelize_ms, self.kept_voxelize_ms);
        row("direct light and filter, by the clock", self.whole_light_ms, self.kept_light_ms);
        for stage in &self.stages {
            row(&format!("  {}", stage.stage), stage.whole_ms, stage.kept_ms);
        }
        text += &table.text();
        let bits = if self.has_same_bits { "the same bits" } else { "DIFFERENT BITS" };
        text +=
            &format!("\nBoth ways gave {bits} at every move, on {}.\n", self.adapter.description);
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exactly the requested share of triangles moves, no triangle is lost, and small instances
    /// move first.
    #[test]
    fn the_marked_dynamic_share_matches_the_request() {
        for (name, share) in
            [("spheres", 0.01), ("spheres", 0.5), ("cornell", 0.1), ("cornell", 1.0)]
        {
            let scene = lumivox_scene::builtin::scene(name).unwrap();
            let mut marked = scene.clone();
            mark(&mut marked, share);
            marked.validate().unwrap();
            assert_eq!(marked.triangle_count(), scene.triangle_count());
            assert_eq!(marked.bounds(), scene.bounds());
            let moving: usize = marked
                .instances
                .iter()
                .filter(|instance| !instance.is_static)
                .map(|instance| marked.meshes[instance.mesh].triangle_count())
                .sum();
            let wanted = scene.triangle_count() as f64 * f64::from(share);
            assert!((moving as f64 - wanted).abs() <= 1.0, "{name}: {moving} of {wanted}");
        }
        let mut spheres = lumivox_scene::builtin::scene("spheres").unwrap();
        mark(&mut spheres, 0.5);
        let floor = spheres.instances.iter().find(|instance| instance.name == "floor").unwrap();
        assert!(floor.is_static);
    }
}
