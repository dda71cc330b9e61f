// The mean of all frames so far. It does not use the grid: its own bindings are in group 0.

struct AccumulateSettings {
    // Frames in the mean so far.
    frames: u32,
    // Whether each frame is a mean of those before it.
    are_means: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<uniform> accumulate_settings: AccumulateSettings;
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
    if accumulate_settings.frames == 0u {
        textureStore(new_mean, pixel, value);
        return;
    }
    let old = textureLoad(old_mean, pixel, 0);
    let frames = f32(accumulate_settings.frames);
    let weight = select(1.0 / (frames + 1.0), 2.0 / (frames + 2.0), accumulate_settings.are_means != 0u);
    let mean = old + (value - old) * weight;
    textureStore(new_mean, pixel, mean);
}
