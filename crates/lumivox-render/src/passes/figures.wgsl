// Sums over one pixel of each 8x8: the cost of cones, and the age of the pixel's light.

import package::constants::FIGURE_SPACING;
import package::temporal::record::decode_record;

// Cone samples; pixels that have a record; the frames in their means.
@group(0) @binding(0) var<storage, read_write> sums: array<atomic<u32>, 3>;
// Cone samples in a.
@group(0) @binding(1) var specular: texture_2d<f32>;
// One zero texel if there are no records.
@group(0) @binding(2) var records: texture_2d<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let size = textureDimensions(specular);
    let pixel = FIGURE_SPACING * invocation.xy;
    if any(pixel >= size) {
        return;
    }
    atomicAdd(&sums[0], u32(round(textureLoad(specular, pixel, 0).a)));
    if any(pixel >= textureDimensions(records)) {
        return;
    }
    let frames = decode_record(textureLoad(records, pixel, 0).xy).frames;
    if frames > 0.0 {
        atomicAdd(&sums[1], 1u);
        atomicAdd(&sums[2], u32(frames));
    }
}
