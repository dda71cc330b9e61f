// Adds a frame to the mean of earlier frames at the same pixel. It does not use the grid: its own
// bindings are in group 0.

struct AccumulateSettings {
    // The frame's share of the new mean; 1 discards the old mean.
    weight: f32,
    // Whether the light is still changing.
    is_relit: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<storage, read> accumulate_settings: AccumulateSettings;
@group(0) @binding(1) var frame: texture_2d<f32>;
@group(0) @binding(2) var old_mean: texture_2d<f32>;
@group(0) @binding(3) var new_mean: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= textureDimensions(frame)) {
        return;
    }
    let value = textureLoad(frame, pixel, 0);
    if accumulate_settings.weight >= 1.0 {
        textureStore(new_mean, pixel, value);
        return;
    }
    let old = textureLoad(old_mean, pixel, 0);
    let mean = old + (value - old) * accumulate_settings.weight;
    textureStore(new_mean, pixel, mean);
}
