// The next level of the voxels: each cell is the mean of eight, colour and opacity alike.

@group(0) @binding(0) var fine: texture_3d<f32>;
@group(0) @binding(1) var coarse: texture_storage_3d<rgba8unorm, write>;

@compute @workgroup_size(4, 4, 4)
fn main(@builtin(global_invocation_id) cell: vec3u) {
    if any(cell >= textureDimensions(coarse)) {
        return;
    }
    var sum = vec4f(0.0);
    for (var child = 0u; child < 8u; child++) {
        let offset = vec3u(child & 1u, (child >> 1u) & 1u, child >> 2u);
        sum += textureLoad(fine, 2u * cell + offset, 0);
    }
    textureStore(coarse, cell, sum / 8.0);
}

// Clears a level; the finer level is not read.
@compute @workgroup_size(4, 4, 4)
fn clear(@builtin(global_invocation_id) cell: vec3u) {
    if all(cell < textureDimensions(coarse)) {
        textureStore(coarse, cell, vec4f(0.0));
    }
}
