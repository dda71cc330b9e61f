// Writes bricks and masks of all nodes: of renewed nodes from the renewals, of others from the
// previous octree. Also writes the table that searches start from: the nodes of its level and of
// coarser ones.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::renewals::Renewal;
// The previous octree.
import package::volume::octree::search::{find_node, octree};
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{node_word, table_entry, tree, NODE_FIRST_BRICK, NODE_MASKS};
import package::volume::octree::needs::Needs;
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> sites: array<Site>;
@group(1) @binding(2) var<storage, read> renewed: array<u32>;
@group(1) @binding(3) var<storage, read> renewed_ranks: array<u32>;
@group(1) @binding(4) var<storage, read> renewals: array<Renewal>;
@group(1) @binding(5) var<storage, read_write> octree_out: array<u32>;

fn put(slot: u32, first_brick: u32, masks: vec4u) {
    let word = node_word(slot);
    octree_out[word + NODE_FIRST_BRICK] = first_brick;
    for (var i = 0u; i < 4u; i++) {
        octree_out[word + NODE_MASKS + i] = masks[i];
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if needs.overflow != 0u || slot >= 8u * needs.groups {
        return;
    }
    let site = sites[slot];
    // Nodes above the coarsest cells only lead to finer ones and have no bricks.
    if site.level == 0u || site.level > grid.levels {
        put(slot, 0u, vec4u(0u));
        return;
    }
    let node_cell = morton_decode(site.morton);
    if site.level >= tree.table_level {
        octree_out[table_entry(node_cell, site.level)] = slot;
    }
    let word = tree.levels[site.level].x + site.morton / 32u;
    let bits = renewed[word];
    if ((bits >> (site.morton % 32u)) & 1u) != 0u {
        let index = renewed_ranks[word] + bits_below(bits, site.morton % 32u);
        put(slot, renewals[index].first_brick, renewals[index].masks);
        return;
    }
    let old = node_word(find_node(node_cell, site.level));
    let masks = old + NODE_MASKS;
    put(
        slot,
        octree[old + NODE_FIRST_BRICK],
        vec4u(octree[masks], octree[masks + 1u], octree[masks + 2u], octree[masks + 3u]),
    );
}
