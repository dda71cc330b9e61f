// Blends the overlay over the encoded picture. Like tone_map.wgsl, with one more texture.

import package::render::picture::tone_map::{encode, picture, screen};

// The mean over frames: colour times coverage, and coverage.
@group(0) @binding(3) var overlay: texture_2d<f32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= textureDimensions(picture)) {
        return;
    }
    let below = saturate(encode(textureLoad(picture, pixel, 0)));
    let over = textureLoad(overlay, pixel, 0);
    textureStore(screen, pixel, vec4f(saturate(below * (1.0 - over.a) + over.rgb), 1.0));
}
