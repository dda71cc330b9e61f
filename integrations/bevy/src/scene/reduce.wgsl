// Writes a smaller picture whose texels are means of the source's.

struct Reduction {
    source_size: vec2u,
    size: vec2u,
    // Alpha becomes 1 at or above the cutoff, 0 below; if negative, alpha is unchanged.
    cutoff: f32,
    // The most source texels along each axis that are read for a texel.
    max_footprint: u32,
    padding: vec2u,
}

@group(0) @binding(0) var<uniform> reduction: Reduction;
@group(0) @binding(1) var source: texture_2d<f32>;

@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(vec2u(index & 1u, index >> 1u));
    return vec4f(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn reduce(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2u(position.xy);
    let low = texel * reduction.source_size / reduction.size;
    let high = max((texel + 1u) * reduction.source_size / reduction.size, low + 1u);
    let step = (high - low + reduction.max_footprint - 1u) / reduction.max_footprint;
    var sum = vec4f(0.0);
    var count = 0.0;
    for (var y = low.y; y < high.y; y += step.y) {
        for (var x = low.x; x < high.x; x += step.x) {
            var color = textureLoad(source, min(vec2u(x, y), reduction.source_size - 1u), 0);
            if reduction.cutoff >= 0.0 {
                color.a = select(0.0, 1.0, color.a >= reduction.cutoff);
            }
            sum += color;
            count += 1.0;
        }
    }
    return sum / count;
}
