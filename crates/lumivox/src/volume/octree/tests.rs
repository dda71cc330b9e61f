//! The octree against its definition, its builders against each other, and all of it against the dense volume.

mod builders;
mod content;
mod read;
mod search;

pub(crate) use read::read_nodes;

use glam::{Mat4, Vec3};

use super::OctreeOptions;
use crate::gpu::{Pipelines, Recorder, Timing};
use crate::testing::{SceneBuilder, busy_room, device, lambert};
use crate::{Directionality, Geometry, Gi, GiConfig, GiError, Grid, TraceSettings, VolumeKind};

fn octree(options: OctreeOptions) -> VolumeKind {
    VolumeKind::Octree(options)
}

/// A grid that is no cube, and whose levels do not halve to powers of two.
fn odd_grid() -> Grid {
    Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 48, Vec3::new(0.3, 0.6, 0.1)).expect("fits")
}

/// A room with everything in it, turned, so that every lobe is tilted somewhere.
fn turned_room(device: &wgpu::Device) -> Geometry {
    let turn = Mat4::from_rotation_y(0.3) * Mat4::from_scale(Vec3::splat(0.8));
    busy_room().transformed(turn).build(device)
}

fn voxelize(
    (device, queue): &(Pipelines, wgpu::Queue),
    config: GiConfig,
    geometry: &Geometry,
) -> Result<Gi, GiError> {
    let mut gi = Gi::with_pipelines(device, queue, config)?;
    pollster::block_on(gi.voxelize(geometry, Timing::Off))?;
    Ok(gi)
}

fn light((device, queue): &(Pipelines, wgpu::Queue), gi: &mut Gi, bounces: u32) {
    let lights = gi.bind_lights(&[], Vec3::splat(0.2), None);
    let mut recorder = Recorder::new(device, queue);
    gi.light(&mut recorder, &lights, bounces, &TraceSettings::default()).expect("valid settings");
    recorder.submit();
}

/// Sheets in every layer of voxels, larger than the grid: no voxel is free.
fn full(device: &wgpu::Device, grid: &Grid) -> Geometry {
    let far = 10.0;
    (0..grid.dimensions.z)
        .fold(SceneBuilder::default(), |scene, layer| {
            let z = grid.world_from_grid(Vec3::splat(layer as f32 + 0.5)).z;
            let corner = Vec3::new(-far, -far, z);
            let (u, v) = (Vec3::X * 2.0 * far, Vec3::Y * 2.0 * far);
            scene.quad(corner, u, v, lambert(0.5, layer as f32))
        })
        .build(device)
}
