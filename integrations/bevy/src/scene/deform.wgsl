// Positions of vertices that joints and morph targets move, as Bevy's vertex shader computes them.

import package::constants::NO_JOINTS;

struct Deformation {
    vertex_count: u32,
    // In a slab of vertices: the first one, and the stride and attribute offsets in words.
    first_vertex: u32,
    stride: u32,
    position: u32,
    // NO_JOINTS: no joints.
    joint_indices: u32,
    joint_weights: u32,
    first_joint: u32,
    // Morph targets, one after the other.
    first_target: u32,
    target_count: u32,
    first_weight: u32,
    // The first position in the result.
    first_position: u32,
    padding: u32,
}

// Words per vertex of a morph target: three vectors of four.
const TARGET_WORDS: u32 = 12u;

@group(0) @binding(0) var<storage, read> deformation: Deformation;
@group(0) @binding(1) var<storage, read> vertices: array<u32>;
@group(0) @binding(2) var<storage, read> joints: array<mat4x4f>;
@group(0) @binding(3) var<storage, read> targets: array<f32>;
@group(0) @binding(4) var<storage, read> weights: array<f32>;
@group(0) @binding(5) var<storage, read_write> positions: array<f32>;

fn load_vec4(word: u32) -> vec4f {
    return vec4f(
        bitcast<f32>(vertices[word]),
        bitcast<f32>(vertices[word + 1u]),
        bitcast<f32>(vertices[word + 2u]),
        bitcast<f32>(vertices[word + 3u]),
    );
}

fn morphed(local: vec3f, index: u32) -> vec3f {
    var position = local;
    for (var target_index = 0u; target_index < deformation.target_count; target_index++) {
        let weight = weights[deformation.first_weight + target_index];
        let row = deformation.first_target + target_index * deformation.vertex_count + index;
        let word = TARGET_WORDS * row;
        position += weight * vec3f(targets[word], targets[word + 1u], targets[word + 2u]);
    }
    return position;
}

fn skinned(local: vec3f, vertex: u32) -> vec3f {
    if deformation.joint_indices == NO_JOINTS {
        return local;
    }
    let low = vertices[vertex + deformation.joint_indices];
    let high = vertices[vertex + deformation.joint_indices + 1u];
    let indices = vec4u(low & 0xffffu, low >> 16u, high & 0xffffu, high >> 16u);
    let shares = load_vec4(vertex + deformation.joint_weights);
    var position = vec3f(0.0);
    for (var joint = 0u; joint < 4u; joint++) {
        let world_from_local = joints[deformation.first_joint + indices[joint]];
        position += shares[joint] * (world_from_local * vec4f(local, 1.0)).xyz;
    }
    return position;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let index = invocation.x;
    if index >= deformation.vertex_count {
        return;
    }
    let vertex = deformation.stride * (deformation.first_vertex + index);
    let local = load_vec4(vertex + deformation.position).xyz;
    let position = skinned(morphed(local, index), vertex);
    let word = 3u * (deformation.first_position + index);
    positions[word] = position.x;
    positions[word + 1u] = position.y;
    positions[word + 2u] = position.z;
}
