// What nodes know of themselves and of their neighbours (contents.wgsl, fill_pointers.wgsl): once a voxel list.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::cell_ranks::{occupancy, ranks};
import package::volume::octree::search::find_node;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{tree, NONE};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_decode;

@group(1) @binding(2) var<storage, read> sites: array<Site>;
@group(1) @binding(3) var<storage, read_write> contents: array<vec2u>;
@group(1) @binding(4) var<storage, read_write> next_nodes: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn own_cells(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots || sites[slot].level == 0u || sites[slot].level > grid.levels {
        return;
    }
    let code = 8u * sites[slot].morton;
    let word = tree.levels[sites[slot].level - 1u].z + code / 32u;
    let bits = occupancy[word];
    contents[slot] =
        vec2u(ranks[word] + bits_below(bits, code % 32u), (bits >> (code % 32u)) & 0xffu);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn pointers(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots || sites[slot].level == 0u || sites[slot].level > grid.levels {
        return;
    }
    let level = sites[slot].level;
    let node_cell = morton_decode(sites[slot].morton);
    for (var axis = 0u; axis < 3u; axis++) {
        var next_cell = node_cell;
        next_cell[axis] += 1u;
        var next = NONE;
        if next_cell[axis] < 1u << (tree.root_level - level) {
            next = find_node(next_cell, level);
        }
        next_nodes[3u * slot + axis] = next;
    }
}
