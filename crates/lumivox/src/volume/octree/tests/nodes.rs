//! Checks the set of nodes on input that is hard for builders.

use std::collections::BTreeSet;

use glam::UVec3;

use super::read::read_nodes;
use super::*;
use crate::testing::nodes::{NodeAt, crowded_voxel, expected_nodes, full_grid, speck};

fn nodes_of(
    gpu: &(Pipelines, wgpu::Queue),
    grid: Grid,
    geometry: &Geometry,
) -> (Gi, BTreeSet<NodeAt>) {
    let config = GiConfig { volume: VolumeKind::Octree, ..GiConfig::new(grid) };
    let mut gi = voxelize(gpu, config, geometry).expect("it fits");
    light(gpu, &mut gi, 2);
    let nodes = read_nodes(&gpu.0, &gpu.1, &gi).into_keys().collect();
    (gi, nodes)
}

/// Asserts that the nodes are those of the definition.
fn assert_defined(gpu: &(Pipelines, wgpu::Queue), grid: Grid, geometry: &Geometry) -> Gi {
    let (gi, nodes) = nodes_of(gpu, grid, geometry);
    assert_eq!(nodes, expected_nodes(&gpu.0, &gpu.1, &gi));
    assert!(gi.octree_stats().expect("an octree").counts.is_empty(), "nobody counts");
    gi
}

#[test]
fn nodes_match_their_definition_for_a_turned_room() {
    let gpu = device();
    let geometry = turned_room(&gpu.0);
    assert_defined(&gpu, odd_grid(), &geometry);
}

#[test]
fn nodes_match_their_definition_for_one_triangle() {
    let gpu = device();
    let (grid, geometry) = speck(&gpu.0);
    assert_defined(&gpu, grid, &geometry);
}

#[test]
fn nodes_match_their_definition_for_a_crowded_voxel() {
    let gpu = device();
    let (grid, geometry) = crowded_voxel(&gpu.0);
    assert_defined(&gpu, grid, &geometry);
}

#[test]
fn nodes_match_their_definition_for_a_full_grid() {
    let gpu = device();
    let (grid, geometry) = full_grid(&gpu.0);
    let gi = assert_defined(&gpu, grid, &geometry);
    let voxels = gi.voxels().expect("there are voxels");
    assert_eq!(u64::from(voxels.voxel_count()), grid.voxel_count());
}

#[test]
fn one_cell_has_at_most_eight_nodes_per_level() {
    let gpu = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 64, Vec3::ZERO).expect("fits");
    let corner = grid.world_from_grid(UVec3::splat(32).as_vec3() + 0.4);
    let (u, v) = (Vec3::X * 1e-5, Vec3::Y * 1e-5);
    let geometry = SceneBuilder::default().quad(corner, u, v, lambert(0.5, 1.0)).build(&gpu.0);
    let (gi, nodes) = nodes_of(&gpu, grid, &geometry);
    assert_eq!(gi.voxels().expect("there is one").voxel_count(), 1);
    let at_level = |level: u32| nodes.iter().filter(|(l, _)| *l == level).count();
    assert_eq!(at_level(1), 8, "cell 32 is the first of its two along each axis");
    assert_eq!(at_level(grid.levels), 8);
}
