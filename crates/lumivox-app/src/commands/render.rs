//! `lumivox render`: a scene to a picture.
//!
//! What is cheap to check comes first: the output's place, the scene's existence, the settings; then
//! the GPU and its limits; then the scene; then the work.

use std::path::Path;
use std::time::Instant;

use indicatif::MultiProgress;
use lumivox::gpu::Timing;
use lumivox::{Directionality, TraceResolution};
use lumivox_render::{Gpu, Picture, RenderSettings, Renderer};
use lumivox_scene::{Camera, Scene};
use serde::Serialize;

use super::open_gpu;
use crate::args::{camera, choices, output};
use crate::cli::RenderArgs;
use crate::progress::Progress;
use crate::report::{
    AdapterReport, GridReport, MemoryReport, SceneCounts, Times, bytes, count, counted,
    memory_table, print, print_json, total_bytes,
};

/// Renders, writes, reports.
///
/// # Errors
/// When anything that the arguments ask for cannot be done; the message says what.
pub fn run(args: &RenderArgs, verbosity: u8, bars: &MultiProgress) -> anyhow::Result<()> {
    output::check(&args.output)?;
    let mut settings = settings(args);
    settings.trace.validate()?;
    args.scene.scene.check()?;

    let mut clock = Clock::start();
    let progress = Progress::start(bars, "loading");
    let gpu = open_gpu(&args.gpu)?;
    settings.validate(&gpu.device.limits())?;
    if args.json || verbosity > 0 {
        settings.timing = Timing::for_device(&gpu.device);
    }
    let mut scene = args.scene.scene.load()?;
    add_light(&mut scene, args);
    let aspect = args.size.x as f32 / args.size.y as f32;
    let camera = camera::resolve(args.camera.as_ref(), &scene, aspect)?;
    scene.add_default_light(Some(&camera));
    clock.seconds.loading = clock.lap();

    let mut tell = |step: lumivox_render::Progress| {
        progress.set(words(step.stage), step.done, step.total);
    };
    let renderer = Renderer::new(&gpu, &scene, Some(&camera), settings, &mut tell);
    let mut renderer = pollster::block_on(renderer)?;
    clock.seconds.preparing = clock.lap();
    let picture = pollster::block_on(renderer.render(&mut tell))?;
    clock.seconds.rendering = clock.lap();
    progress.set("writing", 0, 1);
    picture.write(&args.output)?;
    clock.seconds.writing = clock.lap();
    clock.seconds.total = clock.start.elapsed().as_secs_f64();
    drop(progress);

    let report = Report::new(&args.output, &gpu, &scene, &renderer, &picture, clock.seconds);
    if args.json {
        return print_json(&report);
    }
    print(&report.text(verbosity > 0))
}

/// What the arguments ask for; times are not taken.
pub fn settings(args: &RenderArgs) -> RenderSettings {
    RenderSettings {
        size: args.size,
        resolution: args.voxels.resolution,
        grid_offset: args.voxels.grid_offset,
        directionality: args.voxels.directionality(),
        trace: args.cones.settings(),
        bounces: args.bounces,
        frames: args.frames,
        view: args.view,
        voxel_level: args.level,
        exposure: args.exposure,
        tone_map: args.tone_map,
        shadows: args.shadows,
        shadow_resolution: args.shadow_resolution,
        timing: Timing::Off,
    }
}

fn add_light(scene: &mut Scene, args: &RenderArgs) {
    scene.lights.extend(args.sun.clone());
    if let Some(radiance) = args.environment {
        scene.environment.radiance = radiance;
    }
}

/// A stage of the renderer as the progress names it.
fn words(stage: &'static str) -> &'static str {
    match stage {
        "upload" => "uploading",
        "voxelize" => "voxelizing",
        "light" => "lighting the voxels",
        "render" => "frame",
        other => other,
    }
}

/// Wall-clock times of the whole.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Seconds {
    loading: f64,
    preparing: f64,
    rendering: f64,
    writing: f64,
    total: f64,
}

struct Clock {
    start: Instant,
    lap: Instant,
    seconds: Seconds,
}

impl Clock {
    fn start() -> Self {
        let now = Instant::now();
        Self { start: now, lap: now, seconds: Seconds::default() }
    }

    /// Seconds since the last call.
    fn lap(&mut self) -> f64 {
        let lap = std::mem::replace(&mut self.lap, Instant::now());
        (self.lap - lap).as_secs_f64()
    }
}

/// What was rendered, and what it cost.
#[derive(Clone, Debug, Serialize)]
struct Report {
    /// The picture's file.
    file: String,
    /// Width and height in pixels.
    size: [u32; 2],
    scene: SceneCounts,
    camera: CameraReport,
    grid: GridReport,
    /// Occupied voxels.
    voxels: u32,
    /// Sides of voxels that have surface.
    faces: u32,
    memory: Vec<MemoryReport>,
    memory_bytes: u64,
    /// On the GPU, milliseconds; passes of frames are the mean of a frame.
    #[serde(flatten)]
    times: Times,
    /// By the clock on the wall.
    seconds: Seconds,
    /// In stops; for `auto` the one that was found. None for views that are not exposed.
    exposure: Option<f32>,
    settings: SettingsReport,
    adapter: AdapterReport,
}

#[derive(Clone, Debug, Serialize)]
struct CameraReport {
    name: String,
    position: [f32; 3],
    forward: [f32; 3],
    up: [f32; 3],
    vertical_fov_deg: f32,
}

/// The settings under the names of the command line.
#[derive(Clone, Debug, Serialize)]
struct SettingsReport {
    resolution: u32,
    grid_offset: [f32; 3],
    isotropic: bool,
    bounces: u32,
    frames: u32,
    view: &'static str,
    level: u32,
    tone_map: &'static str,
    shadows: &'static str,
    shadow_resolution: u32,
    cones: u32,
    half: bool,
    voxel_per_diameter: f32,
    clearance: f32,
    normal_offset: f32,
    step: f32,
    min_transmittance: f32,
    specular: bool,
    specular_share: f32,
    /// None is unlimited.
    occlusion_distance: Option<f32>,
}

impl CameraReport {
    fn new(camera: &Camera) -> Self {
        Self {
            name: camera.name.clone(),
            position: camera.position.to_array(),
            forward: camera.forward.to_array(),
            up: camera.up.to_array(),
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
        }
    }
}

impl SettingsReport {
    fn new(settings: &RenderSettings) -> Self {
        let trace = &settings.trace;
        let reach_m = trace.occlusion_distance_m;
        Self {
            resolution: settings.resolution,
            grid_offset: settings.grid_offset.to_array(),
            isotropic: settings.directionality == Directionality::Isotropic,
            bounces: settings.bounces,
            frames: settings.frames,
            view: settings.view.name(),
            level: settings.voxel_level,
            tone_map: settings.tone_map.name(),
            shadows: choices::shadows_name(settings.shadows),
            shadow_resolution: settings.shadow_resolution,
            cones: trace.diffuse_cones,
            half: trace.resolution == TraceResolution::Half,
            voxel_per_diameter: trace.voxel_per_diameter,
            clearance: trace.clearance,
            normal_offset: trace.normal_offset_voxels,
            step: trace.step_per_voxel,
            min_transmittance: trace.min_transmittance,
            specular: trace.specular,
            specular_share: trace.specular_share,
            occlusion_distance: reach_m.is_finite().then_some(reach_m),
        }
    }
}

impl Report {
    fn new(
        file: &Path,
        gpu: &Gpu,
        scene: &Scene,
        renderer: &Renderer,
        picture: &Picture,
        seconds: Seconds,
    ) -> Self {
        let settings = renderer.settings();
        let memory: Vec<MemoryReport> = renderer.memory().into_iter().map(Into::into).collect();
        let exposure = settings.view.is_light().then(|| settings.exposure.stops(&picture.hdr));
        Self {
            file: file.display().to_string(),
            size: picture.size.to_array(),
            scene: SceneCounts::new(scene),
            camera: CameraReport::new(renderer.camera()),
            grid: GridReport::new(renderer.gi().grid()),
            voxels: renderer.voxel_stats().voxels,
            faces: renderer.voxel_stats().faces,
            memory_bytes: total_bytes(&memory),
            memory,
            times: Times::new(&renderer.times()),
            seconds,
            exposure,
            settings: SettingsReport::new(settings),
            adapter: AdapterReport::new(&gpu.adapter_info),
        }
    }

    fn text(&self, is_verbose: bool) -> String {
        let Self { file, scene, grid, seconds, settings, .. } = self;
        let [width, height] = self.size;
        let [x, y, z] = grid.dimensions;
        let frames = counted(settings.frames as usize, "frame", "frames");
        let frame_ms = seconds.rendering * 1e3 / f64::from(settings.frames);
        let mut text = format!("{file}: {width}x{height}, view {}, {frames}", settings.view);
        if let Some(stops) = self.exposure {
            text += &format!(", exposure {stops:.2}");
        }
        text += &format!(
            "\n  scene    {}: {}, {}, {}; camera {}\n",
            scene.name,
            counted(scene.triangles, "triangle", "triangles"),
            counted(scene.materials, "material", "materials"),
            counted(scene.lights, "light", "lights"),
            self.camera.name,
        );
        text += &format!(
            "  voxels   {} with {} in {x} x {y} x {z} of {:.4} m\n",
            count(self.voxels.into()),
            counted(self.faces as usize, "face", "faces"),
            grid.voxel_size_m
        );
        text += &format!("  memory   {} on the GPU\n", bytes(self.memory_bytes));
        text += &format!(
            "  time     {:.2} s: loading {:.2}, preparing {:.2}, rendering {:.2} \
             ({frame_ms:.1} ms a frame), writing {:.2}\n",
            seconds.total, seconds.loading, seconds.preparing, seconds.rendering, seconds.writing
        );
        text += &format!("  GPU      {}\n", self.adapter.description);
        if is_verbose {
            text.push('\n');
            text += &self.times.table("stage and pass (of a frame: mean)");
            text.push('\n');
            text += &memory_table(&self.memory);
        }
        text
    }
}
