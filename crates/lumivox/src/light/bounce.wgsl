// One bounce: every face gathers what the volume holds and sends the reflected share out on top of its direct
// light. Reflectance stays below one, so the repetition converges.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::gpu::random::{hash, random_pair};
import package::light::reflected::reflected_from_all_around;
import package::cones::cone::ConeSettings;
import package::cones::gather::gather;
import package::voxels::list::{Face, Node};

struct BounceSettings {
    cones: ConeSettings,
    cone_count: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> settings: BounceSettings;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> nodes: array<Node>;
@group(1) @binding(3) var<storage, read> direct: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> radiance: array<vec4f>;

const PI: f32 = 3.14159265359;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&direct) {
        return;
    }
    let face = faces[index];
    let normal = normalize(face.vector_area);
    // A face keeps its jitter from bounce to bounce, so that the bounces converge to a fixed point.
    let start = random_pair(nodes[face.voxel].morton, hash(face.lobe));
    let gathered = gather(
        face.position_in_world, normal, normal, settings.cone_count, start, 0u, settings.cones);
    // A few cones may sum up below zero (cone.wgsl).
    let irradiance = max(gathered.irradiance, vec3f(0.0));
    let leaving = direct[index].rgb + reflected_from_all_around(face) / PI * irradiance;
    radiance[index] = vec4f(leaving, 1.0);
}
