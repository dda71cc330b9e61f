// Draws the canvas: one picture, or two beside each other.

struct Split {
    // Where the right picture begins, px from the left edge.
    at: f32,
    // Half the width of the line between the two, px.
    half_line: f32,
    // Width and height of the canvas, px: a first picture has fewer.
    size: vec2<f32>,
}

@group(0) @binding(0) var left: texture_2d<f32>;
@group(0) @binding(1) var right: texture_2d<f32>;
@group(0) @binding(2) var<uniform> split: Split;

// One triangle that covers everything.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4<f32>(corner, 0.0, 1.0);
}

fn color(picture: texture_2d<f32>, position: vec2<f32>) -> vec4<f32> {
    let size = textureDimensions(picture);
    let texel = vec2<u32>(position * vec2<f32>(size) / split.size);
    return vec4<f32>(textureLoad(picture, min(texel, size - 1u), 0).rgb, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let distance = position.x - split.at;
    if abs(distance) < split.half_line {
        return vec4<f32>(1.0);
    }
    if distance < 0.0 {
        return color(left, position.xy);
    }
    return color(right, position.xy);
}
