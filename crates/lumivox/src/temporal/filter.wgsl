// One step of a filter over traced pixels: the mean of 3x3 pixels, `step` apart, weighted by their
// fit to the pixel's surface. Steps of 1, 2, 4 and 8 in sequence are a wide filter with few
// look-ups: Dammertz et al. 2010, "Edge-avoiding a-trous wavelet transform for fast global
// illumination filtering".

import package::cascades::finest_level;
import package::temporal::guide::guide_normal;

struct FilterStep {
    step: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> filter_step: FilterStep;
@group(1) @binding(1) var guides: texture_2d<f32>;
@group(1) @binding(2) var light: texture_2d<f32>;
@group(1) @binding(3) var change: texture_2d<f32>;
@group(1) @binding(4) var light_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(5) var change_out: texture_storage_2d<rgba16float, write>;

// Distance over which light varies, in the finest voxels at the place.
const REACH: f32 = 16.0;

// The share of their light that two places have in common, 0 to 1. `between` is the offset between
// them in voxels, `normal` and `other` are their normals. 0 beyond `reach` voxels.
fn share(between: vec3f, normal: vec3f, other: vec3f, reach: f32) -> f32 {
    let facing = max(dot(other, normal), 0.0);
    let facing_2 = facing * facing;
    let near = max(1.0 - dot(between, between) / (reach * reach), 0.0);
    return max(1.0 - abs(dot(between, normal)), 0.0) * facing_2 * facing_2 * near;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let size = vec2i(textureDimensions(light));
    let place = vec2i(invocation.xy);
    if any(place >= size) {
        return;
    }
    let guide = textureLoad(guides, place, 0);
    if guide.w < 0.0 {
        textureStore(light_out, place, vec4f(0.0));
        textureStore(change_out, place, vec4f(0.0));
        return;
    }
    let normal = guide_normal(guide);
    let voxels = exp2(-f32(finest_level(guide.xyz, 0u, 0.5)));
    var light_sum = 0.25 * textureLoad(light, place, 0);
    var change_sum = 0.25 * textureLoad(change, place, 0);
    var weights = 0.25;
    for (var i = 0; i < 9; i++) {
        let offset = vec2i(i % 3 - 1, i / 3 - 1);
        let tap = place + i32(filter_step.step) * offset;
        if i == 4 || any(tap < vec2i(0)) || any(tap >= size) {
            continue;
        }
        let other = textureLoad(guides, tap, 0);
        if other.w < 0.0 {
            continue;
        }
        let kernel = select(0.125, 0.0625, offset.x != 0 && offset.y != 0);
        let between = voxels * (other.xyz - guide.xyz);
        let weight = kernel * share(between, normal, guide_normal(other), REACH);
        if weight > 0.0 {
            light_sum += weight * textureLoad(light, tap, 0);
            change_sum += weight * textureLoad(change, tap, 0);
            weights += weight;
        }
    }
    var filtered = light_sum / weights;
    // The fewer pixels contribute, the more noise remains.
    filtered.a /= weights;
    textureStore(light_out, place, filtered);
    textureStore(change_out, place, change_sum / weights);
}
