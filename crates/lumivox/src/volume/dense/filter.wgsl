// Filters the changed cells of one level of the six-direction pyramid from the finer one: the mean
// of the four columns of two cells each (column.wgsl) across a lobe's axis.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::dense::atlas::part_texel;
import package::volume::changes::cells::{changed_cell, level_words};
import package::volume::changes::list::NOTHING;
import package::volume::column::{filter_column, AxisParts};
import package::volume::parts::{part_of, storable, NEGATIVE, POSITIVE, TILT};
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var<storage, read> nodes: array<Node>;
@group(1) @binding(4) var cells_in: texture_3d<f32>;
@group(1) @binding(5) var cells_out: texture_storage_3d<rgba16float, write>;

fn load_child(cell: vec3u, axis: u32) -> AxisParts {
    let level = level_words.level - 1u;
    return AxisParts(
        textureLoad(cells_in, part_texel(cell, part_of(axis, POSITIVE), level), 0),
        textureLoad(cells_in, part_texel(cell, part_of(axis, NEGATIVE), level), 0),
        textureLoad(cells_in, part_texel(cell, part_of(axis, TILT), level), 0),
    );
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.node == NOTHING {
        return;
    }
    let node = nodes[changed.node];
    let cell = morton_decode(node.morton);
    for (var axis = 0u; axis < 3u; axis++) {
        if ((node.lobes >> (2u * axis)) & 3u) == 0u {
            continue;
        }
        var sum = AxisParts(vec4f(0.0), vec4f(0.0), vec4f(0.0));
        for (var i = 0u; i < 4u; i++) {
            var low = 2u * cell;
            low[(axis + 1u) % 3u] += i & 1u;
            low[(axis + 2u) % 3u] += i >> 1u;
            var high = low;
            high[axis] += 1u;
            let column = filter_column(load_child(low, axis), load_child(high, axis));
            sum.positive += column.positive;
            sum.negative += column.negative;
            sum.tilt += column.tilt;
        }
        let level = level_words.level;
        textureStore(cells_out, part_texel(cell, part_of(axis, POSITIVE), level), storable(0.25 * sum.positive));
        textureStore(cells_out, part_texel(cell, part_of(axis, NEGATIVE), level), storable(0.25 * sum.negative));
        textureStore(cells_out, part_texel(cell, part_of(axis, TILT), level), 0.25 * sum.tilt);
    }
}
