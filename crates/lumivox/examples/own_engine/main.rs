//! Lumivox in a custom engine: own triangles, own G-buffer, own shading, no other crate of the
//! project.
//!
//! `cargo run --release -p lumivox --example own_engine -- [picture.png] [--json]` renders 120
//! frames of a room in which a lamp and a screen move, and saves the mean of the last ones, in
//! which they rest. The engine records each frame into an encoder of its own and never waits. Then
//! it prints what a frame took, what it created (nothing), and the time of each stage of one more
//! frame.

mod raster;

use std::fmt::Write as _;
use std::time::Instant;

use glam::{Mat4, UVec2, Vec3};
use lumivox::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, MadeResources, Recorder, StageTime, Timing,
};
use lumivox::gpu::{open_device, read_buffer, storage_buffer};
use lumivox::{
    CameraView, Draw, Frame, Geometry, GeometryBatch, Gi, GiConfig, Grid, Light, LightSource,
    Lights, Shadow, SurfaceMaterial, TraceSettings,
};
use raster::{Camera, Mesh, Raster};

const SIZE: UVec2 = UVec2::new(480, 360);
const FRAMES: u32 = 120;
/// The last of them, in which nothing moves: their mean is the picture that is saved.
const STILL_FRAMES: u32 = 16;
/// Frames in which buffers may still grow.
const GROWTH_FRAMES: u32 = 20;
/// The faces that gather in a frame, of some 20 000.
const FACES_PER_FRAME: u32 = 5000;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.iter().find(|argument| !argument.starts_with("--"));
    let path = path.map_or("own_engine.png", String::as_str);
    let (pixels, report) = pollster::block_on(render())?;
    image::save_buffer(path, &pixels, SIZE.x, SIZE.y, image::ColorType::Rgb8)?;
    if arguments.iter().any(|argument| argument == "--json") {
        println!("{}", report.json());
    } else {
        println!("{path}\n{}", report.text());
    }
    Ok(())
}

/// The cost of the frames.
struct Report {
    /// The mean time of a frame, ms: until it was recorded, and until the GPU was done.
    recording_ms: f64,
    frame_ms: f64,
    /// Buffers, textures and bind groups made after the first frames.
    made: u64,
    stages: Vec<StageTime>,
}

impl Report {
    /// Milliseconds by stage, in the order in which they ran.
    fn by_stage(&self) -> Vec<(&'static str, f64)> {
        let mut sums: Vec<(&'static str, f64)> = Vec::new();
        for time in &self.stages {
            let ms = time.duration.as_secs_f64() * 1e3;
            match sums.iter_mut().find(|(stage, _)| *stage == time.stage) {
                Some((_, sum)) => *sum += ms,
                None => sums.push((time.stage, ms)),
            }
        }
        sums
    }

    fn text(&self) -> String {
        let mut text = format!(
            "{FRAMES} frames: {:.1} ms each, of which recording {:.1} ms; {} buffers, textures and bind groups made after \
             the first {GROWTH_FRAMES}\n",
            self.frame_ms, self.recording_ms, self.made
        );
        for (stage, ms) in self.by_stage() {
            let _ = writeln!(text, "  {stage:10} {ms:8.2} ms");
        }
        text
    }

    fn json(&self) -> String {
        let stages = self.by_stage().into_iter().map(|(stage, ms)| format!("\"{stage}\": {ms:.3}"));
        format!(
            "{{\"frames\": {FRAMES}, \"frame_ms\": {:.3}, \"recording_ms\": {:.3}, \"made\": {}, \
             \"stages_ms\": {{{}}}}}",
            self.frame_ms,
            self.recording_ms,
            self.made,
            stages.collect::<Vec<_>>().join(", ")
        )
    }
}

async fn render() -> Result<(Vec<u8>, Report), Failure> {
    // WebGPU's default limits are all that Lumivox needs.
    let (device, queue) = open_device().await?;

    // The engine's scene: every quad has a colour of its own.
    let mesh = room();
    let raster = Raster::new(&device, &mesh, SIZE);

    // Lumivox takes the same triangles, as they lie in the engine's buffers, and materials.
    let (min, max) = mesh.bounds();
    let grid = Grid::fit(min, max, 64, Vec3::ZERO)?;
    let config = GiConfig::new(grid);
    let mut gi = Gi::new(&device, &queue, config)?;
    // Static draws are walked once.
    let draw = |quad| Draw { is_static: quad < mesh.first_moving, ..Draw::new(6 * quad, 6, quad) };
    let draws = (0..mesh.colors.len() as u32).map(draw);
    let (positions, indices) = raster.geometry();
    let batch = GeometryBatch::new(positions, indices, draws.collect());
    let materials = mesh.colors.iter().map(|color| SurfaceMaterial {
        reflectance: color.extend(1.0),
        ..SurfaceMaterial::default()
    });
    let mut geometry = Geometry::new(vec![batch], materials.collect());
    // The first voxels, awaited, so that no frame is shown without them.
    let voxelized = gi.voxelize(&geometry, Timing::Off).await?;
    println!("{} voxels, {} faces", voxelized.stats.voxels, voxelized.stats.faces);

    // One light; its shadows come from cones through the voxels, so no shadow map is needed.
    let mut lights = gi.bind_lights(&[lamp_at(0.0)], Vec3::ZERO, None);
    let settings = TraceSettings::default();

    // The camera and the G-buffer.
    let position = Vec3::new(0.0, 1.0, 3.6);
    let clip_from_world =
        glam::camera::rh::proj::directx::perspective_infinite_reverse(
            45_f32.to_radians(),
            SIZE.x as f32 / SIZE.y as f32,
            0.1,
        ) * glam::camera::rh::view::look_at_mat4(position, Vec3::new(0.0, 1.0, 0.0), Vec3::Y);
    let mut view = gi.view(raster.views(), SIZE, &settings);

    // The engine's shading kernel, linked against Lumivox's shader modules.
    let mut shaders = gi.shaders().clone();
    shaders.add("engine::shade", include_str!("shade.wgsl"));
    let layout = LayoutBuilder::compute()
        .texture_2d_unfilterable()
        .storage_mut()
        .build(gi.pipelines(), "shade");
    let layouts = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
    let shade = Kernel::new(gi.pipelines(), &shaders, "engine::shade", "shade", &layouts)?;
    let bytes = u64::from(SIZE.element_product()) * 16;
    let picture = storage_buffer(&device, "picture", bytes);
    let group = BindGroupBuilder::new(&layout)
        .view(view.irradiance())
        .buffer(&picture)
        .build(&device, "shade");

    let start = Instant::now();
    let mut recording = 0.0;
    let mut made = MadeResources::now();
    for frame in 0..FRAMES {
        let frame_start = Instant::now();
        let first_still = FRAMES - STILL_FRAMES;
        let time = frame.min(first_still) as f32 / 60.0;
        // The engine's shading takes the mean from frame 0 on.
        let mut camera = CameraView::new(clip_from_world, position);
        camera.frame = Some(frame.saturating_sub(first_still));
        view.set_camera(&queue, camera);
        lights.update(&queue, &[lamp_at(time)], Vec3::ZERO, None);
        for draw in geometry.batches[0].draws.iter_mut().filter(|draw| !draw.is_static) {
            draw.world_from_local = screen_at(time);
        }
        // One encoder a frame: the engine's passes and Lumivox's.
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let camera = Camera::new(view.clip_from_world(), screen_at(time));
        raster.draw(&mut encoder, &queue, camera);
        let mut recorder = Recorder::on(&device, &queue, &mut encoder);
        gi.frame(&mut recorder, frame_of(&geometry, &lights, &settings))?;
        gi.trace(&mut recorder, &mut view, &lights)?;
        let groups = [gi.globals(), &group, &lights.group, view.group()];
        shade.run(&mut recorder, &groups, [SIZE.x, SIZE.y, 1]);
        drop(recorder);
        queue.submit([encoder.finish()]);
        recording += frame_start.elapsed().as_secs_f64();
        if frame == GROWTH_FRAMES {
            made = MadeResources::now();
        }
    }
    let now = MadeResources::now();
    let made = now.buffers + now.textures + now.bind_groups
        - (made.buffers + made.textures + made.bind_groups);

    let picture: Vec<[f32; 4]> = read_buffer(&device, &queue, &picture, 0..bytes).await?;
    let frame_ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(FRAMES);
    let pixels = picture.iter().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]].map(srgb));

    // The time of each stage when something moves, of a frame that a recorder of its own submits:
    // an engine's encoder has none.
    lights.update(&queue, &[lamp_at(FRAMES as f32 / 60.0)], Vec3::ZERO, None);
    geometry.invalidate();
    let mut recorder = Recorder::with_timing(&device, &queue, Timing::for_device(&device));
    gi.frame(&mut recorder, frame_of(&geometry, &lights, &settings))?;
    gi.trace(&mut recorder, &mut view, &lights)?;
    let stages = recorder.finish().await?;
    let recording_ms = recording * 1e3 / f64::from(FRAMES);
    Ok((pixels.collect(), Report { recording_ms, frame_ms, made, stages }))
}

/// The inputs of [`Gi::frame`].
fn frame_of<'a>(
    geometry: &'a Geometry,
    lights: &'a Lights,
    settings: &'a TraceSettings,
) -> Frame<'a> {
    let faces_per_frame = Some(FACES_PER_FRAME);
    Frame { faces_per_frame, ..Frame::new(geometry, lights, settings) }
}

/// The lamp, on a circle below the ceiling.
fn lamp_at(time: f32) -> Light {
    let (sine, cosine) = (0.9 * time).sin_cos();
    let source = LightSource::Point {
        position: Vec3::new(-0.3 - 0.3 * cosine, 1.6, 0.3 + 0.4 * sine),
        intensity: Vec3::splat(2.0),
        radius_m: 0.05,
        range_m: None,
    };
    Light { source, shadow: Shadow::Cone }
}

/// The screen, which slides.
fn screen_at(time: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(0.25 * (1.3 * time).sin(), 0.0, 0.1 * time.sin()))
}

/// The sRGB encoding of a linear value: IEC 61966-2-1.
fn srgb(linear: f32) -> u8 {
    let encoded =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// A white room with a red and a blue wall, and a screen that keeps the lamp's light off its right
/// half.
fn room() -> Mesh {
    let white = Vec3::splat(0.75);
    let (red, blue) = (Vec3::new(0.7, 0.1, 0.08), Vec3::new(0.1, 0.2, 0.7));
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let corner = Vec3::new(-1.0, 0.0, -1.0);
    let mut mesh = Mesh::default();
    mesh.quad(corner, z, x, white); // floor
    mesh.quad(corner + y, x, z, white); // ceiling
    mesh.quad(corner, x, y, white); // back
    mesh.quad(corner, y, z, red); // left
    mesh.quad(corner + x, z, y, blue); // right
    // The screen: a box of a few voxels' thickness, its front sides outside.
    mesh.first_moving = mesh.colors.len() as u32;
    let (low, size) = (Vec3::new(0.15, 0.0, -0.5), Vec3::new(0.12, 1.3, 1.2));
    let (sx, sy, sz) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    mesh.quad(low, sz, sy, white);
    mesh.quad(low + sx, sy, sz, white);
    mesh.quad(low + sy, sz, sx, white);
    mesh.quad(low, sy, sx, white);
    mesh.quad(low + sz, sx, sy, white);
    mesh
}
