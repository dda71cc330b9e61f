//! Compares searches with the list of nodes.

use std::collections::HashSet;

use glam::{UVec2, UVec3, UVec4, Vec3};

use super::read::read_nodes;
use super::*;
use crate::gpu::{BindGroupBuilder, Kernel, LayoutBuilder, storage_buffer, upload};
use crate::testing::read;

const SEARCH_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::volume::octree::search::{find_node, node_parts};
@group(1) @binding(0) var<storage, read> wanted: array<vec4u>;
@group(1) @binding(1) var<storage, read_write> found: array<vec2u>;
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&found) { return; }
    let cell = wanted[id.x].xyz;
    let level = wanted[id.x].w;
    let node = find_node(cell, level);
    found[id.x] = vec2u(node, node_parts(node));
}";

/// Searches find each node, and no parts elsewhere. In a grid of more than 128 voxels the table
/// ends above the finest nodes.
#[test]
fn searches_find_the_nodes_and_nothing_else() {
    let gpu = device();
    let (device, queue) = &gpu;
    let size = Vec3::new(1.0, 0.05, 0.05);
    let grid = Grid::fit(Vec3::ZERO, size, 136, Vec3::ZERO).expect("fits");
    let config = GiConfig { volume: VolumeKind::Octree, ..GiConfig::new(grid) };
    let geometry = SceneBuilder::default().room(Vec3::ZERO, size, &lambert(0.5, 0.0)).build(device);
    let gi = voxelize(&gpu, config, &geometry).expect("it fits");
    let nodes = read_nodes(device, queue, &gi);

    let root_level = grid.morton_edge(0).ilog2();
    let wanted: Vec<UVec4> = (1..=grid.levels)
        .flat_map(|level| {
            let edge = 1 << (root_level - level);
            let end = ((grid.dimensions >> level) + 2).min(UVec3::splat(edge));
            (0..end.element_product())
                .map(move |i| UVec4::new(i % end.x, i / end.x % end.y, i / (end.x * end.y), level))
        })
        .collect();
    let mut shaders = gi.shaders().clone();
    shaders.add("test::search", SEARCH_WGSL);
    let layout = LayoutBuilder::compute().storage().storage_mut().build(device, "searches");
    let layouts = [gi.cell_globals_layout(), &layout];
    let kernel = Kernel::new(device, &shaders, "test::search", "main", &layouts).expect("links");
    let input = upload(device, "wanted", &wanted);
    let output = storage_buffer(device, "found", wanted.len() as u64 * 8);
    let group =
        BindGroupBuilder::new(&layout).buffer(&input).buffer(&output).build(device, "searches");
    let mut recorder = Recorder::new(device, queue);
    kernel.run_linear(&mut recorder, &[gi.cell_globals(), &group], wanted.len() as u64);
    recorder.submit();
    let found: Vec<UVec2> = read(device, queue, &output, wanted.len());

    let mut met = HashSet::new();
    for (wanted, found) in wanted.iter().zip(&found) {
        let node = nodes.get(&(wanted.w, wanted.truncate().to_array()));
        let parts = node.map_or(0, |node| node.bricks.keys().fold(0, |all, part| all | 1 << part));
        assert_eq!(found.y, parts, "{wanted}");
        if node.is_some() {
            assert!(met.insert(found.x), "{wanted}: another cell has the node {}", found.x);
        }
    }
    assert_eq!(met.len(), nodes.keys().filter(|(level, _)| *level <= grid.levels).count());
}
