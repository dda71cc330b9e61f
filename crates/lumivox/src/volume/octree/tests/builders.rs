//! Which nodes there are, by both builders, on input made to trip them.

use std::collections::{BTreeMap, BTreeSet};

use glam::{UVec3, Vec3};

use super::read::{NodeAt, ReadNode, read_nodes};
use super::*;
use crate::testing::{morton_decode, read};
use crate::volume::octree::OctreeBuilder;
use crate::voxels::NodeRecord;

/// The nodes that the definition asks for (`tree.wgsl`): those with an occupied cell among their 27, and the way to
/// them from the root.
fn expected_nodes((device, queue): &(Pipelines, wgpu::Queue), gi: &Gi) -> BTreeSet<NodeAt> {
    let voxels = gi.voxels().expect("there are voxels");
    let grid = gi.grid();
    let count = voxels.level_starts[grid.levels as usize] as usize;
    let nodes: Vec<NodeRecord> = read(device, queue, &voxels.nodes, count);
    let mut expected = BTreeSet::new();
    let root_level = grid.morton_edge(0).ilog2();
    for level in 0..grid.levels {
        for index in voxels.level_nodes(level) {
            let cell = morton_decode(nodes[index as usize].morton).as_ivec3();
            for x in 0..=1 {
                for y in 0..=1 {
                    for z in 0..=1 {
                        let holder =
                            cell.div_euclid(glam::IVec3::splat(2)) - glam::IVec3::new(x, y, z);
                        let last = 2 * holder + 2;
                        if holder.min_element() < 0 || cell.cmpgt(last).any() {
                            continue;
                        }
                        let mut at = holder.as_uvec3();
                        for level in level + 1..=root_level {
                            expected.insert((level, at.to_array()));
                            at /= 2;
                        }
                    }
                }
            }
        }
    }
    expected
}

fn nodes_of(
    gpu: &(Pipelines, wgpu::Queue),
    grid: Grid,
    geometry: &Geometry,
    builder: OctreeBuilder,
) -> (Gi, BTreeMap<NodeAt, ReadNode>) {
    let options = OctreeOptions { builder, ..OctreeOptions::default() };
    let config = GiConfig { volume: octree(options), ..GiConfig::new(grid) };
    let mut gi = voxelize(gpu, config, geometry).expect("it fits");
    light(gpu, &mut gi, 2);
    let nodes = read_nodes(&gpu.0, &gpu.1, &gi);
    (gi, nodes)
}

/// Both builders make the nodes of the definition, with the same masks and, bit for bit, the same bricks.
fn assert_built_alike(gpu: &(Pipelines, wgpu::Queue), grid: Grid, geometry: &Geometry) {
    let (ranked, by_ranks) = nodes_of(gpu, grid, geometry, OctreeBuilder::Ranks);
    let expected = expected_nodes(gpu, &ranked);
    assert_eq!(by_ranks.keys().copied().collect::<BTreeSet<_>>(), expected, "by ranks");
    let (locked, by_locks) = nodes_of(gpu, grid, geometry, OctreeBuilder::Locks);
    assert_eq!(by_locks.keys().copied().collect::<BTreeSet<_>>(), expected, "by locks");
    assert!(by_locks == by_ranks, "masks or bricks differ");
    let stats = locked.octree_stats().expect("an octree");
    let bound = grid.morton_edge(0).ilog2() + 2;
    assert!((1..=bound).contains(&stats.lock_passes), "{stats:?}");
    assert_eq!(stats.groups, ranked.octree_stats().expect("an octree").groups);
}

#[test]
fn a_turned_room_in_a_grid_that_is_no_cube() {
    let gpu = device();
    let geometry = turned_room(&gpu.0);
    assert_built_alike(&gpu, odd_grid(), &geometry);
}

#[test]
fn one_triangle() {
    let gpu = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 64, Vec3::ZERO).expect("fits");
    // A quad of a thousandth of a voxel, in the very corner of the grid.
    let corner = grid.world_from_grid(Vec3::splat(0.25));
    let (u, v) = (Vec3::X * 1e-5, Vec3::Y * 1e-5);
    let geometry = SceneBuilder::default().quad(corner, u, v, lambert(0.5, 1.0)).build(&gpu.0);
    assert_built_alike(&gpu, grid, &geometry);
}

#[test]
fn all_triangles_in_one_voxel() {
    let gpu = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 64, Vec3::ZERO).expect("fits");
    // Even coordinates: eight nodes a level hold the voxel.
    let voxel = Vec3::splat(32.2);
    let geometry = (0..200)
        .fold(SceneBuilder::default(), |scene, i| {
            let offset = Vec3::new((i % 7) as f32, (i % 11) as f32, (i % 13) as f32) * 0.03;
            let corner = grid.world_from_grid(voxel + offset);
            let edge = grid.voxel_size_m * 0.2;
            let u = if i % 2 == 0 { Vec3::X } else { Vec3::Z };
            scene.quad(corner, u * edge, Vec3::Y * edge, lambert(0.5, 1.0))
        })
        .build(&gpu.0);
    assert_built_alike(&gpu, grid, &geometry);
}

#[test]
fn a_full_grid() {
    let gpu = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 32, Vec3::ZERO).expect("fits");
    let geometry = full(&gpu.0, &grid);
    assert_built_alike(&gpu, grid, &geometry);
    let (gi, _) = nodes_of(&gpu, grid, &geometry, OctreeBuilder::Locks);
    let voxels = gi.voxels().expect("there are voxels");
    assert_eq!(u64::from(voxels.voxel_count()), grid.voxel_count());
    // Threads that run in step want the same lock.
    let stats = gi.octree_stats().expect("an octree");
    assert!(stats.deferred > 0 && stats.lock_passes > 1, "nobody had to wait: {stats:?}");
}

#[test]
fn the_same_bits_in_every_run_with_locks_too() {
    let gpu = device();
    let geometry = turned_room(&gpu.0);
    let radiance = |builder| {
        let (gi, _) = nodes_of(&gpu, odd_grid(), &geometry, builder);
        let faces = gi.voxels().expect("there are voxels").face_count as usize;
        let buffer = gi.face_radiance().expect("it is lit");
        read::<[u32; 4]>(&gpu.0, &gpu.1, buffer, faces)
    };
    let first = radiance(OctreeBuilder::Locks);
    assert!(first == radiance(OctreeBuilder::Locks), "two runs differ");
    assert!(first == radiance(OctreeBuilder::Ranks), "the builders differ");
    assert!(first.iter().any(|texel| texel[0] != 0), "there is no light");
}

#[test]
fn expected_nodes_of_one_cell_are_eight_a_level_at_most() {
    let gpu = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 64, Vec3::ZERO).expect("fits");
    let corner = grid.world_from_grid(UVec3::splat(32).as_vec3() + 0.4);
    let (u, v) = (Vec3::X * 1e-5, Vec3::Y * 1e-5);
    let geometry = SceneBuilder::default().quad(corner, u, v, lambert(0.5, 1.0)).build(&gpu.0);
    let (gi, nodes) = nodes_of(&gpu, grid, &geometry, OctreeBuilder::Ranks);
    assert_eq!(gi.voxels().expect("there is one").voxel_count(), 1);
    let at_level = |level: u32| nodes.keys().filter(|(l, _)| *l == level).count();
    assert_eq!(at_level(1), 8, "cell 32 is the first of its two along each axis");
    assert_eq!(at_level(grid.levels), 8);
}
