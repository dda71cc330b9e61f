//! Reads nodes with their masks and bricks, as samplers of the volume see them.

use std::collections::BTreeMap;

use glam::{UVec3, UVec4};
use lumivox::Gi;
use lumivox::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Pipelines, Recorder, storage_buffer, upload,
};

use crate::testing::nodes::NodeAt;
use crate::testing::read;

const FIND_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::search::{find_node, node_parts};

@group(1) @binding(0) var<storage, read> asked: array<vec4u>;
@group(1) @binding(1) var<storage, read_write> found: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index < arrayLength(&found) {
        found[index] = node_parts(find_node(asked[index].xyz, asked[index].w));
    }
}";

/// The four words of the masks, then nine bricks of 27 texels, empty ones included.
const NODE_WORDS: usize = 4 + 9 * 27 * 2;

const READ_WGSL: &str = "
import package::constants::{LINEAR_WORKGROUP_SIZE, NODE_CONTENT_WORDS};
import package::gpu::dispatch::linear_index;
import package::volume::cells::atlas;
import package::volume::octree::search::{brick_of, find_node, node_parts, octree};
import package::volume::octree::tree::{brick_origin, node_word, NODE_MASKS};

@group(1) @binding(0) var<storage, read> asked: array<vec4u>;
@group(1) @binding(1) var<storage, read_write> content: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&asked) {
        return;
    }
    let node = find_node(asked[index].xyz, asked[index].w);
    let first = index * NODE_CONTENT_WORDS;
    for (var i = 0u; i < 4u; i++) {
        content[first + i] = octree[node_word(node) + NODE_MASKS + i];
    }
    for (var part = 0u; part < 9u; part++) {
        if ((node_parts(node) >> part) & 1u) == 0u {
            continue;
        }
        let origin = brick_origin(brick_of(node, part));
        for (var i = 0u; i < 27u; i++) {
            let texel = textureLoad(atlas, origin + vec3u(i % 3u, i / 3u % 3u, i / 9u), 0);
            let word = first + 4u + 2u * (27u * part + i);
            content[word] = pack2x16float(texel.xy);
            content[word + 1u] = pack2x16float(texel.zw);
        }
    }
}";

/// The content of all nodes with bricks: nodes of the grid's levels.
pub(super) fn read_bricks(gpu: &(Pipelines, wgpu::Queue), gi: &Gi) -> BTreeMap<NodeAt, Vec<u32>> {
    let grid = gi.grid();
    let root_level = grid.morton_edge(0).ilog2();
    let asked: Vec<UVec4> = (1..=grid.levels)
        .flat_map(|level| {
            let edge = 1_u32 << (root_level - level);
            (0..edge.pow(3)).map(move |i| {
                UVec3::new(i % edge, i / edge % edge, i / (edge * edge)).extend(level)
            })
        })
        .collect();
    let parts = run(gpu, gi, FIND_WGSL, &asked, 1);
    let there: Vec<UVec4> =
        asked.into_iter().zip(parts).filter(|(_, parts)| *parts != 0).map(|(at, _)| at).collect();
    let content = run(gpu, gi, READ_WGSL, &there, NODE_WORDS);
    let content = content.chunks_exact(NODE_WORDS).map(<[u32]>::to_vec);
    there.iter().map(|at| (at.w, at.truncate().to_array())).zip(content).collect()
}

/// Runs a kernel that writes `words` words for each of the `asked` nodes.
fn run(
    (device, queue): &(Pipelines, wgpu::Queue),
    gi: &Gi,
    wgsl: &'static str,
    asked: &[UVec4],
    words: usize,
) -> Vec<u32> {
    let mut shaders = gi.shaders().clone();
    shaders.add("test::nodes", wgsl).constant_u32("NODE_CONTENT_WORDS", words as u32);
    let layout = LayoutBuilder::compute().storage().storage_mut().build(device, "nodes");
    let layouts = [gi.cell_globals_layout(), &layout];
    let kernel = Kernel::new(device, &shaders, "test::nodes", "main", &layouts).expect("links");
    let input = upload(device, "asked", asked);
    let output = storage_buffer(device, "content", (asked.len() * words * 4) as u64);
    let group =
        BindGroupBuilder::new(&layout).buffer(&input).buffer(&output).build(device, "nodes");
    let mut recorder = Recorder::new(device, queue);
    kernel.run_linear(&mut recorder, &[gi.cell_globals(), &group], asked.len() as u64);
    recorder.submit();
    read(device, queue, &output, asked.len() * words)
}
