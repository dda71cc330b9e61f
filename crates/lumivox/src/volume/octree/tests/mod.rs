//! Compares the octree with its definition and with the dense volume.

mod content;
mod nodes;
mod read;
mod search;

pub(crate) use read::read_nodes;

use glam::Vec3;

use crate::gpu::{Pipelines, Recorder, Timing};
use crate::testing::nodes::{odd_grid, turned_room};
use crate::testing::{SceneBuilder, device, lambert};
use crate::{Directionality, Geometry, Gi, GiConfig, GiError, Grid, TraceSettings, VolumeKind};

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
