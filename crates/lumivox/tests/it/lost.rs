//! A device that is lost in the middle of a frame: nothing panics, and a new device works.

use std::sync::Arc;

use glam::{Mat4, Vec3};
use lumivox::gpu::{Recorder, Timing, open_device};
use lumivox::{
    Draw, Frame, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial, TraceSettings,
    VolumeKind,
};
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};

/// A static and a moving floor.
fn geometry(device: &wgpu::Device) -> Geometry {
    let corners = [[0.0_f32, 0.1, 0.0], [0.0, 0.1, 1.0], [1.0, 0.1, 1.0], [1.0, 0.1, 0.0]];
    let buffer = |contents: &[u8]| {
        let usage = wgpu::BufferUsages::STORAGE;
        device.create_buffer_init(&BufferInitDescriptor { label: None, contents, usage })
    };
    let positions = buffer(bytemuck::cast_slice(&corners));
    let indices = buffer(bytemuck::cast_slice(&[0_u32, 1, 2, 0, 2, 3]));
    let mut draws = vec![Draw::new(0, 6, 0), Draw::new(0, 6, 0)];
    draws[0].is_static = true;
    let batch = GeometryBatch::new(positions, indices, draws);
    Geometry::new(vec![batch], vec![SurfaceMaterial::default()])
}

#[test]
fn losing_the_device_mid_frame_does_not_panic() {
    for volume in [VolumeKind::Dense, VolumeKind::Octree] {
        let (device, queue) = pollster::block_on(open_device()).expect("a device");
        let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO).expect("it fits");
        let config = GiConfig { volume, ..GiConfig::new(grid) };
        let mut gi = Gi::new(&device, &queue, config.clone()).expect("a volume");
        let mut geometry = geometry(&device);
        let settings = TraceSettings::default();
        let lights = gi.bind_lights(&[], Vec3::ONE, None);
        for frame in 0..12 {
            let rise = Mat4::from_translation(Vec3::Y * 0.05 * frame as f32);
            geometry.batches[0].draws[1].world_from_local = rise;
            let mut recorder = Recorder::new(&device, &queue);
            let frame_of = Frame::new(&geometry, &lights, &settings);
            let voxelized = gi.frame(&mut recorder, Frame { lights: None, ..frame_of });
            if frame == 5 {
                device.destroy();
            }
            if frame == 8 {
                // More draws need new buffers, which a lost device cannot create.
                geometry.batches[0].draws.extend([Draw::new(0, 6, 0); 40]);
            }
            // Commands recorded after the loss are dropped.
            let frame_of = Frame::new(&geometry, &lights, &settings);
            let lit = gi.frame(&mut recorder, Frame { geometry: None, ..frame_of });
            recorder.submit();
            if frame < 5 {
                voxelized.expect("it fits");
                lit.expect("valid settings");
            }
        }
        // Errors of resources created on a lost device go to the engine's handler of errors.
        device.on_uncaptured_error(Arc::new(|_| {}));
        let waited = pollster::block_on(gi.voxelize(&geometry, Timing::Off));
        assert!(waited.is_err(), "who waits is told");

        // The scene continues with a new device.
        let (device, queue) = pollster::block_on(open_device()).expect("another device");
        let mut gi = Gi::new(&device, &queue, config).expect("a volume");
        let geometry = self::geometry(&device);
        let voxelized = pollster::block_on(gi.voxelize(&geometry, Timing::Off));
        assert!(voxelized.expect("there are voxels").stats.voxels > 0);
    }
}
