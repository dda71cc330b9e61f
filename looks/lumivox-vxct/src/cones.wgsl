// VXCT's three kinds of cones, with VXCT's own steps.

import package::constants::{VXCT_FRONT, VXCT_INTERMEDIATE, VXCT_LAST_LEVEL, VXCT_SIDES};
import package::vxct::uniform::{has, settings, VxctCone};

@group(3) @binding(0) var voxels: texture_3d<f32>;
@group(3) @binding(1) var voxels_sampler: sampler;

// Length of diffuse and specular cones.
const REACH: f32 = 1.0;
// The opacity above which a diffuse cone has hit something.
const FOUND: f32 = 0.01;
// Factor of the mean of the diffuse cones.
const DIFFUSE_GAIN: f32 = 5.0;
// Limit of steps, more than the finest cones take, so that no settings can hang the GPU.
const MOST_STEPS: u32 = 4096u;

fn sample_voxels(position: vec3f, level: f32) -> vec4f {
    return textureSampleLevel(voxels, voxels_sampler, 0.5 * position + 0.5, level);
}

fn level_of(diameter: f32) -> f32 {
    return clamp(log2(diameter * f32(settings.resolution)), 0.0, f32(VXCT_LAST_LEVEL));
}

struct Traced {
    color: vec3f,
    occlusion: f32,
    samples: u32,
}

// The colour of the first thing that a cone meets, undimmed.
fn diffuse_cone(origin: vec3f, direction: vec3f) -> Traced {
    let cone = settings.diffuse;
    var distance = cone.offset;
    var samples = 0u;
    while distance < REACH && samples < MOST_STEPS {
        let diameter = distance * cone.width;
        let seen = sample_voxels(origin + distance * direction, level_of(diameter));
        samples += 1u;
        if seen.a > FOUND {
            return Traced(seen.rgb, 0.0, samples);
        }
        distance += max(diameter * cone.step_per_diameter, 1e-5);
    }
    return Traced(vec3f(0.0), 0.0, samples);
}

// A surface that faces along z has no side directions: VXCT's cones have NaN positions. As a
// software GPU does, this then reads the last cell along each axis.
fn side_cone(origin: vec3f, direction: vec3f, has_sides: bool) -> Traced {
    if has_sides {
        return diffuse_cone(origin, direction);
    }
    return diffuse_cone(vec3f(1.0), vec3f(0.0));
}

fn diffuse_cones(position: vec3f, normal: vec3f) -> Traced {
    let origin = position + settings.origin_offset * normal;
    var sum = vec3f(0.0);
    var count = 0u;
    var samples = 0u;
    if has(VXCT_FRONT) {
        let traced = diffuse_cone(origin, normal);
        sum += traced.color;
        samples += traced.samples;
        count += 1u;
    }
    let x = cross(normal, vec3f(0.0, 0.0, 1.0));
    let has_sides = dot(x, x) > 0.0;
    let side_x = x / max(length(x), 1e-30);
    let side_z = cross(normal, side_x);
    for (var side = 0u; side < 4u; side++) {
        let axis = select(side_x, side_z, side >= 2u) * select(1.0, -1.0, (side & 1u) != 0u);
        if has(VXCT_SIDES) {
            let traced = side_cone(origin, axis, has_sides);
            sum += traced.color;
            samples += traced.samples;
            count += 1u;
        }
        if has(VXCT_INTERMEDIATE) {
            let traced = side_cone(origin, normalize(normal + axis), has_sides);
            sum += traced.color;
            samples += traced.samples;
            count += 1u;
        }
    }
    return Traced(DIFFUSE_GAIN * sum / f32(max(count, 1u)), 0.0, samples);
}

// The share of light blocked between a surface and a light, softly near the surface.
fn occlusion_cone(position: vec3f, direction: vec3f, reach: f32, softness: f32) -> Traced {
    let cone = settings.occlusion;
    var distance = cone.offset;
    var occlusion = 0.0;
    var samples = 0u;
    while distance < reach && samples < MOST_STEPS {
        let diameter = distance * cone.width;
        let seen = sample_voxels(position + distance * direction, level_of(diameter));
        samples += 1u;
        let opacity = seen.a * smoothstep(0.0, softness, sqrt(distance) * settings.shadow_strength);
        occlusion += (1.0 - occlusion) * opacity;
        distance += max(diameter * cone.step_per_diameter, 1e-5);
    }
    return Traced(vec3f(0.0), occlusion, samples);
}

// The mirrored light. The cone is at least as wide as `lobe_width`.
fn specular_cone(position: vec3f, direction: vec3f, lobe_width: f32) -> Traced {
    let cone = settings.specular;
    let width = max(cone.width, lobe_width);
    var distance = cone.offset;
    var color = vec3f(0.0);
    var occlusion = 0.0;
    var samples = 0u;
    while distance < REACH && occlusion < 1.0 && samples < MOST_STEPS {
        let diameter = distance * width;
        let seen = sample_voxels(position + distance * direction, level_of(diameter));
        samples += 1u;
        // As in VXCT, the colour so far is multiplied by the occlusion.
        color = occlusion * color + (1.0 - occlusion) * seen.a * seen.rgb;
        occlusion += (1.0 - occlusion) * seen.a;
        distance += max(diameter * cone.step_per_diameter, 1e-5);
    }
    return Traced(color, occlusion, samples);
}
