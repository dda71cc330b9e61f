// Decides whether the new list's nodes and bricks fit the octree's capacities; if so, updates the
// free bricks. One thread.
//
// On overflow the octree is not written: it shows the earlier list until it has grown.

import package::constants::{
    CELL_PARTS, LINEAR_WORKGROUP_SIZE, MAX_WORKGROUPS, OVERFLOW_BRICKS, OVERFLOW_PLACES,
    OVERFLOW_RENEWALS, RUN_KINDS,
};
import package::volume::octree::renewals::Renewal;
import package::volume::octree::tree::tree;

// Arrays are indexed by the length of a run, 1 to 9; element 0 is not used.
struct Needs {
    // Bits OVERFLOW_*; zero if everything fits.
    overflow: u32,
    // Needed groups of nodes, including the root's.
    groups: u32,
    renewals: u32,
    // Needed places for bricks, including those of free runs.
    brick_places: u32,
    // Bricks in use.
    bricks: u32,
    // The first place that no brick has ever used, before this list.
    first_place: u32,
    padding_0: u32,
    padding_1: u32,
    // Workgroups of dispatches over places of nodes, over renewals, and over renewals times 8 and
    // times 27.
    node_groups: vec3u,
    padding_2: u32,
    renewal_groups: vec3u,
    padding_3: u32,
    cell_groups: vec3u,
    padding_4: u32,
    texel_groups: vec3u,
    padding_5: u32,
    // Numbers of runs, by length: free before this list, and needed by it.
    free: array<vec4u, 3>,
    needed: array<vec4u, 3>,
}

// The places of bricks, kept from list to list.
struct Places {
    // The first place that no brick has ever used.
    first_place: u32,
    // Number of free runs, by length.
    free: array<u32, 10>,
}

@group(1) @binding(0) var<storage, read> group_ranks: array<u32>;
@group(1) @binding(1) var<storage, read> renewed_ranks: array<u32>;
@group(1) @binding(2) var<storage, read> renewals: array<Renewal>;
@group(1) @binding(3) var<storage, read> run_starts: array<u32>;
@group(1) @binding(4) var<storage, read_write> places: Places;
@group(1) @binding(5) var<storage, read_write> needs: Needs;

fn groups_of(threads: u32) -> vec3u {
    let needed = (threads + LINEAR_WORKGROUP_SIZE - 1u) / LINEAR_WORKGROUP_SIZE;
    let rows = (needed + MAX_WORKGROUPS - 1u) / MAX_WORKGROUPS;
    return vec3u((needed + max(rows, 1u) - 1u) / max(rows, 1u), rows, select(0u, 1u, needed > 0u));
}

@compute @workgroup_size(1)
fn main() {
    var now: Needs;
    now.groups = 1u + group_ranks[tree.levels[tree.root_level].x];
    now.renewals = renewed_ranks[arrayLength(&renewed_ranks) - 1u];
    now.overflow |= select(0u, OVERFLOW_PLACES, 8u * now.groups > tree.slots);
    now.overflow |= select(0u, OVERFLOW_RENEWALS, now.renewals > arrayLength(&renewals));
    now.first_place = places.first_place;
    now.brick_places = places.first_place;
    let blocks = (arrayLength(&run_starts) - 1u) / RUN_KINDS;
    var free = places.free;
    var idle = 0u;
    for (var length = 1u; length <= CELL_PARTS; length++) {
        let kind = length - 1u;
        let needed = run_starts[(kind + 1u) * blocks] - run_starts[kind * blocks];
        let returned = run_starts[(kind + CELL_PARTS + 1u) * blocks] - run_starts[(kind + CELL_PARTS) * blocks];
        now.free[length / 4u][length % 4u] = free[length];
        now.needed[length / 4u][length % 4u] = needed;
        // Released runs become free with the next list: until then their values are still read.
        now.brick_places += length * (needed - min(needed, free[length]));
        free[length] += returned - min(needed, free[length]);
        idle += length * free[length];
    }
    now.bricks = now.brick_places - idle;
    now.overflow |= select(0u, OVERFLOW_BRICKS, now.brick_places > tree.bricks);
    if now.overflow == 0u {
        places.first_place = now.brick_places;
        places.free = free;
        now.node_groups = groups_of(8u * now.groups);
        now.renewal_groups = groups_of(now.renewals);
        now.cell_groups = groups_of(8u * now.renewals);
        now.texel_groups = groups_of(27u * now.renewals);
    }
    needs = now;
}
