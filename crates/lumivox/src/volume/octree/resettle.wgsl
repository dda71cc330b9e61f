// Copies bricks into a larger atlas, in which brick numbers have other places: one thread per
// texel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::tree::{brick_place, tree};

// The previous atlas; `tree` describes the larger one.
struct OldAtlas {
    bricks: u32,
    row_bits: u32,
}

@group(1) @binding(0) var<uniform> old: OldAtlas;
@group(1) @binding(1) var old_atlas: texture_3d<f32>;
@group(1) @binding(2) var atlas_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let thread = linear_index(invocation, workgroups);
    let brick = thread / 27u;
    if brick >= old.bricks {
        return;
    }
    let texel = thread % 27u;
    let offset = vec3u(texel % 3u, (texel / 3u) % 3u, texel / 9u);
    let value = textureLoad(old_atlas, brick_place(brick, old.row_bits) + offset, 0);
    textureStore(atlas_out, brick_place(brick, tree.row_bits) + offset, value);
}
