// Filters the changed cells of one level of the isotropic pyramid: each is the mean of its eight
// children.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::changes::cells::changed_cell;
import package::volume::changes::list::NOTHING;
import package::voxels::morton::morton_decode;

@group(1) @binding(4) var cells_in: texture_3d<f32>;
@group(1) @binding(5) var cells_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.node == NOTHING {
        return;
    }
    let cell = morton_decode(changed.morton);
    var sum = vec4f(0.0);
    for (var child = 0u; child < 8u; child++) {
        let corner = vec3u(child & 1u, (child >> 1u) & 1u, child >> 2u);
        sum += textureLoad(cells_in, 2u * cell + corner, 0);
    }
    textureStore(cells_out, cell, 0.125 * sum);
}
