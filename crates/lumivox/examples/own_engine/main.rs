//! Lumivox in an engine of its own: own triangles, own G-buffer, own shading, no other crate of the project.
//!
//! `cargo run --release -p lumivox --example own_engine -- [picture.png]` renders a room with a point light
//! into a corner of which light only gets by bouncing.

mod raster;

use glam::{UVec2, Vec3};
use lumivox::gpu::{BindGroupBuilder, Kernel, LayoutBuilder, Recorder, Timing};
use lumivox::gpu::{open_device, read_buffer, storage_buffer};
use lumivox::{
    CameraView, Draw, Geometry, GeometryBatch, Gi, GiConfig, Grid, Light, LightSource, Shadow,
    SurfaceMaterial, TraceSettings,
};
use raster::{Mesh, Raster};

const SIZE: UVec2 = UVec2::new(480, 360);
const FRAMES: u32 = 16;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "own_engine.png".to_owned());
    let pixels = pollster::block_on(render())?;
    image::save_buffer(&path, &pixels, SIZE.x, SIZE.y, image::ColorType::Rgb8)?;
    println!("{path}");
    Ok(())
}

async fn render() -> Result<Vec<u8>, Failure> {
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
    let draws = (0..mesh.colors.len() as u32).map(|quad| Draw::new(6 * quad, 6, quad));
    let (positions, indices) = raster.geometry();
    let batch = GeometryBatch::new(positions, indices, draws.collect());
    let materials = mesh.colors.iter().map(|color| SurfaceMaterial {
        reflectance: color.extend(1.0),
        ..SurfaceMaterial::default()
    });
    let geometry = Geometry { batches: vec![batch], materials: materials.collect() };
    let voxelized = gi.voxelize(&geometry, Timing::Off).await?;
    println!("{} voxels, {} faces", voxelized.stats.voxels, voxelized.stats.faces);

    // One light; its shadows come from cones through the voxels, so no shadow map is needed.
    let lamp = LightSource::Point {
        position: Vec3::new(-0.6, 1.6, 0.3),
        intensity: Vec3::splat(2.0),
        radius_m: 0.05,
        range_m: None,
    };
    let lamp = Light { source: lamp, shadow: Shadow::Cone };
    let lights = gi.bind_lights(&[lamp], Vec3::ZERO, None);
    let mut recorder = Recorder::new(&device, &queue);
    let settings = TraceSettings::default();
    gi.light(&mut recorder, &lights, 4, &settings)?;
    recorder.submit();

    // The camera and the G-buffer.
    let position = Vec3::new(0.0, 1.0, 3.6);
    let clip_from_world =
        glam::camera::rh::proj::directx::perspective_infinite_reverse(
            45_f32.to_radians(),
            SIZE.x as f32 / SIZE.y as f32,
            0.1,
        ) * glam::camera::rh::view::look_at_mat4(position, Vec3::new(0.0, 1.0, 0.0), Vec3::Y);
    let mut view = CameraView::new(clip_from_world, position, SIZE);
    let gbuffer = gi.bind_gbuffer(raster.views(), view);
    let targets = gi.targets(SIZE, settings.resolution);

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
        .view(&targets.irradiance)
        .buffer(&picture)
        .build(&device, "shade");

    for frame in 0..FRAMES {
        view.frame = frame;
        gbuffer.set_camera(&queue, view);
        // One encoder a frame: the engine's passes and Lumivox's.
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        raster.draw(&mut encoder, &queue, view.clip_from_world);
        let mut recorder = Recorder::on(&device, &queue, &mut encoder);
        gi.trace(&mut recorder, &gbuffer, &lights, &settings, &targets)?;
        let groups = [gi.globals(), &group, &lights.group, &gbuffer.group];
        shade.run(&mut recorder, &groups, [SIZE.x, SIZE.y, 1]);
        drop(recorder);
        queue.submit([encoder.finish()]);
    }

    let picture: Vec<[f32; 4]> = read_buffer(&device, &queue, &picture, 0..bytes).await?;
    Ok(picture.iter().flat_map(|pixel| [pixel[0], pixel[1], pixel[2]].map(srgb)).collect())
}

/// The sRGB encoding of a linear value: IEC 61966-2-1.
fn srgb(linear: f32) -> u8 {
    let encoded =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// A white room with a red and a blue wall, and a screen that keeps the lamp's light off its right half.
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
    // The screen: a thin box, its front sides outside.
    let (low, size) = (Vec3::new(0.15, 0.0, -0.5), Vec3::new(0.04, 1.3, 1.2));
    let (sx, sy, sz) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    mesh.quad(low, sz, sy, white);
    mesh.quad(low + sx, sy, sz, white);
    mesh.quad(low + sy, sz, sx, white);
    mesh.quad(low, sy, sx, white);
    mesh.quad(low + sz, sx, sy, white);
    mesh
}
