// Writes zeros to the changed cells of a level.

import package::constants::{CELL_PARTS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::volume::dense::atlas::part_texel;
import package::volume::changes::cells::{changed_cell, level_words};
import package::volume::changes::list::NOTHING;
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var cells_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn six_lobes(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.morton == NOTHING {
        return;
    }
    let cell = morton_decode(changed.morton);
    for (var part = 0u; part < CELL_PARTS; part++) {
        textureStore(cells_out, part_texel(cell, part, level_words.level), vec4f(0.0));
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn isotropic(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.morton == NOTHING {
        return;
    }
    textureStore(cells_out, morton_decode(changed.morton), vec4f(0.0));
}
