//! Compares nodes built by locks with their definition and with nodes built by ranks: the same
//! nodes, masks and bricks.

mod moves;
mod read;
mod watched;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3;
use lumivox::gpu::{Pipelines, Recorder, Timing};
use lumivox::{Frame, Geometry, Gi, GiConfig, GiError, Grid, TraceSettings, VolumeKind};
use lumivox_classics::locks::locks;

use crate::testing::nodes::{
    crowded_voxel, expected_nodes, full_grid, odd_grid, speck, turned_room,
};
use crate::testing::{device, read, wait_until_read};
use read::read_bricks;
use watched::Watched;

fn by_ranks(grid: Grid) -> GiConfig {
    GiConfig { volume: VolumeKind::Octree, ..GiConfig::new(grid) }
}

fn by_locks(grid: Grid) -> GiConfig {
    GiConfig { octree_builder: Some(locks()), ..by_ranks(grid) }
}

fn lit((device, queue): &(Pipelines, wgpu::Queue), config: GiConfig, geometry: &Geometry) -> Gi {
    let mut gi = Gi::with_pipelines(device, queue, config).expect("a device");
    pollster::block_on(gi.voxelize(geometry, Timing::Off)).expect("there are voxels");
    let lights = gi.bind_lights(&[], Vec3::splat(0.2), None);
    let mut recorder = Recorder::new(device, queue);
    gi.light(&mut recorder, &lights, 2, &TraceSettings::default()).expect("valid settings");
    recorder.submit();
    gi
}

/// A counter of the builder, by its name.
fn count_of(gi: &Gi, name: &str) -> u64 {
    let counts = gi.octree_stats().expect("an octree").counts;
    let found = counts.iter().find(|(other, _)| *other == name);
    found.unwrap_or_else(|| panic!("no {name} in {counts:?}")).1
}

/// The faces' radiance, in bits.
fn radiance((device, queue): &(Pipelines, wgpu::Queue), gi: &Gi) -> Vec<[u32; 4]> {
    let faces = gi.voxels().expect("there are voxels").face_count as usize;
    read(device, queue, gi.face_radiance().expect("it is lit"), faces)
}

/// Nodes built by locks match the definition; their masks and bricks equal those built by ranks, to
/// the bit.
fn assert_built_alike(gpu: &(Pipelines, wgpu::Queue), grid: Grid, geometry: &Geometry) -> Gi {
    let ranked = lit(gpu, by_ranks(grid), geometry);
    let watched = Watched::new(locks());
    let config = GiConfig { octree_builder: Some(watched.clone()), ..by_ranks(grid) };
    let locked = lit(gpu, config, geometry);
    let nodes: BTreeSet<_> = watched.nodes(gpu, &grid).into_keys().collect();
    assert_eq!(nodes, expected_nodes(&gpu.0, &gpu.1, &locked));
    let bricks = read_bricks(gpu, &locked);
    let with_bricks = nodes.iter().filter(|(level, _)| *level <= grid.levels);
    assert!(bricks.keys().eq(with_bricks), "searches find other nodes");
    assert!(bricks == read_bricks(gpu, &ranked), "masks or bricks differ");
    let passes = count_of(&locked, "lock_passes");
    assert!((1..=u64::from(grid.morton_edge(0).ilog2()) + 2).contains(&passes), "{passes} passes");
    let groups = |gi: &Gi| gi.octree_stats().expect("an octree").groups;
    assert_eq!(groups(&locked), groups(&ranked));
    locked
}

#[test]
#[ignore = "slow: over three seconds"]
fn locks_match_ranks_for_a_turned_room() {
    let gpu = device();
    let geometry = turned_room(&gpu.0);
    assert_built_alike(&gpu, odd_grid(), &geometry);
}

#[test]
fn locks_match_ranks_for_one_triangle() {
    let gpu = device();
    let (grid, geometry) = speck(&gpu.0);
    assert_built_alike(&gpu, grid, &geometry);
}

#[test]
fn locks_match_ranks_for_one_crowded_voxel() {
    let gpu = device();
    let (grid, geometry) = crowded_voxel(&gpu.0);
    assert_built_alike(&gpu, grid, &geometry);
}

#[test]
#[ignore = "slow: over three seconds"]
fn locks_match_ranks_for_a_full_grid() {
    let gpu = device();
    let (grid, geometry) = full_grid(&gpu.0);
    let locked = assert_built_alike(&gpu, grid, &geometry);
    let voxels = locked.voxels().expect("there are voxels");
    assert_eq!(u64::from(voxels.voxel_count()), grid.voxel_count());
    // Threads that run in lockstep want the same lock.
    let (passes, deferred) = (count_of(&locked, "lock_passes"), count_of(&locked, "deferred"));
    assert!(deferred > 0 && passes > 1, "nobody had to wait: {passes} passes, {deferred} deferred");
}

/// A frame that only voxelizes.
fn voxels_of<'a>(geometry: &'a Geometry, settings: &'a TraceSettings) -> Frame<'a> {
    Frame { geometry: Some(geometry), lights: None, settings, faces_per_frame: None }
}

/// `voxelize` reports missing nodes at once, `frame` a frame later.
#[test]
fn missing_nodes_are_an_error() {
    let gpu = device();
    let (device, queue) = &gpu;
    let geometry = turned_room(device);
    let config = || {
        let blamed: Arc<Watched> = Watched::blamed(locks(), 1);
        GiConfig { octree_builder: Some(blamed), ..by_ranks(odd_grid()) }
    };
    let assert_told = |error: GiError| {
        assert!(matches!(error, GiError::Device { .. }), "{error}");
        assert!(error.to_string().contains("groups of nodes"), "{error}");
    };
    let mut gi = Gi::with_pipelines(device, queue, config()).expect("a device");
    let waited = pollster::block_on(gi.voxelize(&geometry, Timing::Off));
    assert_told(waited.expect_err("a group is missing"));

    let mut gi = Gi::with_pipelines(device, queue, config()).expect("a device");
    let frames = (0..16).find_map(|_| {
        let settings = TraceSettings::default();
        let mut recorder = Recorder::new(device, queue);
        let frame = gi.frame(&mut recorder, voxels_of(&geometry, &settings));
        recorder.submit();
        wait_until_read(device, &gi);
        frame.err()
    });
    assert_told(frames.expect("a group is missing"));
}

/// The builder's buffers count as the octree's memory while the octree may change, and are freed
/// once nothing moves.
#[test]
fn octree_memory_includes_the_lock_builders_buffers() {
    let gpu = device();
    let (device, queue) = &gpu;
    let geometry = |is_static: bool| {
        let mut geometry = turned_room(device);
        geometry.batches[0].draws.iter_mut().for_each(|draw| draw.is_static = is_static);
        geometry
    };
    let bytes = |is_static: bool| {
        let mut gi = Gi::with_pipelines(device, queue, by_locks(odd_grid())).expect("a device");
        let geometry = geometry(is_static);
        let voxelized = gi.voxelize(&geometry, Timing::Off);
        pollster::block_on(voxelized).expect("there are voxels");
        let memory = gi.memory();
        let own = memory.iter().find(|(name, _)| *name == "volume: locks of nodes");
        let nodes = 8 * u64::from(gi.octree_stats().expect("an octree").groups);
        (own.expect("it is in the account").1, nodes)
    };
    let (moving, nodes) = bytes(false);
    // Children, a lock and a site for each place, and two lists of threads.
    assert!(moving > 16 * nodes, "{moving} bytes for {nodes} nodes");
    // Only the counters: twelve words at most.
    assert!(bytes(true).0 <= 48, "{} bytes stay", bytes(true).0);
}
