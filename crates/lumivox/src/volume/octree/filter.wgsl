// Filters the values of the cells of one level from those of the finer one, by the rule of all
// volumes (column.wgsl): a thread for each changed cell.

import package::constants::{ISOTROPIC, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::volume::octree::values::{load_value, nodes, owner_at, store_value, Owner};
import package::volume::octree::needs::Needs;
import package::volume::changes::cells::{changed_cell, level_words};
import package::volume::changes::list::NOTHING;
import package::volume::column::{filter_column, AxisParts};
import package::volume::parts::{part_of, stored_parts, NEGATIVE, POSITIVE, TILT};

@group(1) @binding(5) var<uniform> needs: Needs;

fn load(children: Owner, octant: u32, axis: u32) -> AxisParts {
    return AxisParts(
        load_value(children, octant, part_of(axis, POSITIVE)),
        load_value(children, octant, part_of(axis, NEGATIVE)),
        load_value(children, octant, part_of(axis, TILT)),
    );
}

fn filter_lobes(owner: Owner, octant: u32, lobes: u32, children: Owner) {
    let parts = stored_parts(lobes);
    for (var axis = 0u; axis < 3u; axis++) {
        if ((lobes >> (2u * axis)) & 3u) == 0u {
            continue;
        }
        var sum = AxisParts(vec4f(0.0), vec4f(0.0), vec4f(0.0));
        for (var i = 0u; i < 4u; i++) {
            let low = ((i & 1u) << ((axis + 1u) % 3u)) | ((i >> 1u) << ((axis + 2u) % 3u));
            let column =
                filter_column(load(children, low, axis), load(children, low | (1u << axis), axis));
            sum.positive += column.positive;
            sum.negative += column.negative;
            sum.tilt += column.tilt;
        }
        if ((parts >> part_of(axis, POSITIVE)) & 1u) != 0u {
            store_value(owner, octant, part_of(axis, POSITIVE), 0.25 * sum.positive);
        }
        if ((parts >> part_of(axis, NEGATIVE)) & 1u) != 0u {
            store_value(owner, octant, part_of(axis, NEGATIVE), 0.25 * sum.negative);
        }
        if ((parts >> part_of(axis, TILT)) & 1u) != 0u {
            store_value(owner, octant, part_of(axis, TILT), 0.25 * sum.tilt);
        }
    }
}

fn filter_mean(owner: Owner, octant: u32, children: Owner) {
    var sum = vec4f(0.0);
    for (var child = 0u; child < 8u; child++) {
        sum += load_value(children, child, 0u);
    }
    store_value(owner, octant, 0u, 0.125 * sum);
}

// The children of a cell are the own cells of the node at the cell's position.
fn filter_cell(cell: u32, morton: u32) {
    let children = owner_at(morton, level_words.level);
    let owner = owner_at(morton / 8u, level_words.level + 1u);
    if ISOTROPIC != 0u {
        filter_mean(owner, morton % 8u, children);
    } else {
        filter_lobes(owner, morton % 8u, nodes[cell].lobes, children);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.node != NOTHING && needs.overflow == 0u {
        filter_cell(changed.node, changed.morton);
    }
}
