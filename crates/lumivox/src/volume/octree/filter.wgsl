// The values of the cells of one level from those of the finer one, by the rule of all volumes (column.wgsl), over lists.
//
// `main` has a thread for each cell that has changed. `every_cell` has one for each possible cell of the level, as the first
// octree renderers did, and most of them find nothing to do: it is there to be measured.

import package::constants::{ISOTROPIC, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::volume::octree::tree::tree;
import package::volume::octree::values::{load_value, nodes, store_value};
import package::volume::changes::cells::{changed_cell, level_words};
import package::volume::changes::list::NOTHING;
import package::volume::column::{filter_column, AxisParts};
import package::volume::parts::{part_of, stored_parts, NEGATIVE, POSITIVE, TILT};
import package::voxels::lookup::bits_below;

@group(1) @binding(6) var<storage, read> occupancy: array<u32>;
@group(1) @binding(7) var<storage, read> ranks: array<u32>;

// The children of a cell: the first one's place in the list, and a bit for each that there is.
struct Children {
    first: u32,
    bits: u32,
}

// A child with the parts that it has; none if it is empty.
struct Child {
    cell: u32,
    parts: u32,
}

fn children_of(morton: u32, level: u32) -> Children {
    let code = morton * 8u;
    let word = tree.levels[level - 1u].z + code / 32u;
    let bits = occupancy[word];
    return Children(ranks[word] + bits_below(bits, code % 32u), (bits >> (code % 32u)) & 0xffu);
}

fn child_at(children: Children, octant: u32) -> Child {
    if ((children.bits >> octant) & 1u) == 0u {
        return Child(0u, 0u);
    }
    let cell = children.first + bits_below(children.bits, octant);
    return Child(cell, stored_parts(nodes[cell].lobes));
}

fn load(child: Child, axis: u32) -> AxisParts {
    return AxisParts(
        load_value(child.cell, child.parts, part_of(axis, POSITIVE)),
        load_value(child.cell, child.parts, part_of(axis, NEGATIVE)),
        load_value(child.cell, child.parts, part_of(axis, TILT)),
    );
}

fn filter_lobes(cell: u32, lobes: u32, children: Children) {
    let parts = stored_parts(lobes);
    for (var axis = 0u; axis < 3u; axis++) {
        if ((lobes >> (2u * axis)) & 3u) == 0u {
            continue;
        }
        var sum = AxisParts(vec4f(0.0), vec4f(0.0), vec4f(0.0));
        for (var i = 0u; i < 4u; i++) {
            let octant = ((i & 1u) << ((axis + 1u) % 3u)) | ((i >> 1u) << ((axis + 2u) % 3u));
            let low = load(child_at(children, octant), axis);
            let high = load(child_at(children, octant | (1u << axis)), axis);
            let column = filter_column(low, high);
            sum.positive += column.positive;
            sum.negative += column.negative;
            sum.tilt += column.tilt;
        }
        if ((parts >> part_of(axis, POSITIVE)) & 1u) != 0u {
            store_value(cell, parts, part_of(axis, POSITIVE), 0.25 * sum.positive);
        }
        if ((parts >> part_of(axis, NEGATIVE)) & 1u) != 0u {
            store_value(cell, parts, part_of(axis, NEGATIVE), 0.25 * sum.negative);
        }
        if ((parts >> part_of(axis, TILT)) & 1u) != 0u {
            store_value(cell, parts, part_of(axis, TILT), 0.25 * sum.tilt);
        }
    }
}

fn filter_mean(cell: u32, children: Children) {
    var sum = vec4f(0.0);
    for (var octant = 0u; octant < 8u; octant++) {
        let child = child_at(children, octant);
        sum += load_value(child.cell, child.parts, 0u);
    }
    store_value(cell, 1u, 0u, 0.125 * sum);
}

fn filter_cell(cell: u32, morton: u32) {
    let children = children_of(morton, level_words.level);
    if ISOTROPIC != 0u {
        filter_mean(cell, children);
    } else {
        filter_lobes(cell, nodes[cell].lobes, children);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.node != NOTHING {
        filter_cell(changed.node, changed.morton);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn every_cell(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let code = linear_index(invocation, workgroups);
    let edge_bits = tree.root_level - level_words.level;
    if code >= 1u << (3u * edge_bits) {
        return;
    }
    let word = tree.levels[level_words.level].z + code / 32u;
    let bits = occupancy[word];
    if (bits & (1u << (code % 32u))) != 0u {
        filter_cell(ranks[word] + bits_below(bits, code % 32u), code);
    }
}
