//! Frames of an animation create no resources and wait for nothing. It has its own program, since
//! resources are counted per process.

#[path = "it/common/mod.rs"]
mod common;

use glam::{Mat4, Vec3};
use lumivox::gpu::{MadeResources, Recorder, Timing, storage_buffer};
use lumivox::internal::waits;
use lumivox::{
    Draw, Frame, Geometry, GeometryBatch, Gi, GiConfig, Grid, Light, LightSource, Shadow,
    SurfaceMaterial, TraceSettings, VolumeKind,
};

/// A quad over x and z, facing up.
const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

fn lamp(position: Vec3) -> Light {
    let source =
        LightSource::Point { position, intensity: Vec3::ONE, radius_m: 0.02, range_m: None };
    Light { source, shadow: Shadow::Cone }
}

/// 100 frames in which a lamp and a plate move, each recorded into the caller's encoder, without
/// waiting.
#[test]
#[ignore = "slow: over three seconds"]
fn steady_frames_create_no_gpu_resources() {
    for volume in [VolumeKind::Dense, VolumeKind::Octree] {
        check_steady(volume);
    }
}

fn check_steady(volume: VolumeKind) {
    let (device, queue) = common::device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO).expect("it fits");
    let config = GiConfig { volume, ..GiConfig::new(grid) };
    let mut gi = Gi::with_pipelines(&device, &queue, config).expect("a device");
    let positions = storage_buffer(&device, "positions", size_of_val(&CORNERS) as u64);
    queue.write_buffer(&positions, 0, bytemuck::cast_slice(&CORNERS));
    let order = [0_u32, 1, 2, 0, 2, 3];
    let indices = storage_buffer(&device, "indices", size_of_val(&order) as u64);
    queue.write_buffer(&indices, 0, bytemuck::cast_slice(&order));
    let mut draws = vec![Draw::new(0, 6, 0), Draw::new(0, 6, 0)];
    draws[0].is_static = true;
    let batch =
        GeometryBatch::new(wgpu::Buffer::clone(&positions), wgpu::Buffer::clone(&indices), draws);
    let mut geometry = Geometry::new(vec![batch], vec![SurfaceMaterial::default()]);
    let mut lights = gi.bind_lights(&[lamp(Vec3::splat(0.5))], Vec3::ZERO, None);
    let settings = TraceSettings::default();
    pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let mut before = (MadeResources::now(), waits());
    for frame in 0..120 {
        let time = frame as f32 / 120.0;
        let place = Vec3::new(0.3 * time, 0.2 + 0.5 * time, 0.2);
        geometry.batches[0].draws[1].world_from_local =
            Mat4::from_translation(place) * Mat4::from_scale(Vec3::splat(0.5));
        lights.update(&queue, &[lamp(Vec3::new(0.5, 0.9 - 0.3 * time, 0.5))], Vec3::ZERO, None);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::on(&device, &queue, &mut encoder);
        let faces_per_frame = Some(200);
        let frame_of = Frame { faces_per_frame, ..Frame::new(&geometry, &lights, &settings) };
        gi.frame(&mut recorder, frame_of).expect("it fits");
        drop(recorder);
        queue.submit([encoder.finish()]);
        // The first frames may overflow buffers, which grow until later frames fit.
        while frame < 20 && gi.status().is_pending {
            device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
        }
        if frame == 19 {
            before = (MadeResources::now(), waits());
        }
    }
    let now = (MadeResources::now(), waits());
    assert_eq!(now, before, "100 frames of {volume:?} have made something, or waited");
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    assert!(gi.voxels().is_some_and(|list| list.voxel_count() > 100));
}
