// Irradiance at points: each thread gathers some frames of one point and adds them to the earlier
// frames' mean.

import package::cascades::drawn_level;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::cones::cone::ConeSettings;
import package::cones::gather::gather;
import package::emitters::gather::gather_emitters;
import package::gpu::dispatch::linear_index;
import package::gpu::random::{hash, random_pair};
import package::light::lights::{incident_light, light_globals, lights};
import package::light::visibility::light_visibility;

struct PointSettings {
    cones: ConeSettings,
    cone_count: u32,
    point_count: u32,
    // Frames of this pass.
    frames: u32,
    // Whether to add direct light of lamps and suns.
    has_direct: u32,
}

struct GatheredPoint {
    // The mean over the frames so far.
    indirect: vec3f,
    openness: f32,
    direct: vec3f,
    // Number of frames gathered so far.
    frames: u32,
}

@group(1) @binding(0) var<uniform> settings: PointSettings;
// Positions in the world; the fourth components are not read.
@group(1) @binding(1) var<storage, read> positions: array<vec4f>;
@group(1) @binding(2) var<storage, read> normals: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> gathered: array<GatheredPoint>;

fn direct_irradiance(position_in_world: vec3f, normal: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < light_globals.light_count; i++) {
        let incident = incident_light(lights[i], position_in_world);
        let cosine = dot(normal, incident.direction);
        if cosine > 0.0 {
            sum += incident.irradiance * cosine
                * light_visibility(lights[i], incident, position_in_world, normal);
        }
    }
    return sum;
}

// A point's offset in the jitter sequence, independent of its index in the list.
fn start_of(position: vec3f, normal: vec3f) -> vec2f {
    let place = bitcast<vec3u>(position);
    let direction = bitcast<vec3u>(normal);
    return random_pair(
        place.x ^ hash(place.y ^ hash(place.z)), direction.x ^ hash(direction.y ^ hash(direction.z)));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= settings.point_count {
        return;
    }
    let position = positions[index].xyz;
    let normal = normalize(normals[index].xyz);
    let start = start_of(position, normal);
    var sum = gathered[index];
    for (var i = 0u; i < settings.frames; i++) {
        let level = drawn_level(position, fract(start.x + 0.618034 * f32(sum.frames & 0xffffu)));
        let once = gather(
            position, normal, normal, level, settings.cone_count, start, sum.frames, settings.cones);
        let lit = gather_emitters(
            position, normal, normal, level, start.yx, sum.frames, 1u, settings.cones);
        sum.frames += 1u;
        let share = 1.0 / f32(sum.frames);
        sum.indirect = mix(sum.indirect, once.irradiance + lit.irradiance, share);
        sum.openness = mix(sum.openness, once.openness, share);
    }
    if settings.has_direct != 0u {
        sum.direct = direct_irradiance(position, normal);
    }
    gathered[index] = sum;
}
