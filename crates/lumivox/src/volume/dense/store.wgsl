// Writes the faces of the voxel list into the finest level, or zeros over the nodes of any level. One dispatch
// handles one axis: its two lobes, and their tilt.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::mark_masks::LevelRange;
import package::voxels::list::{Face, Node};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> range: LevelRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read> faces: array<Face>;
@group(1) @binding(4) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(5) var positive_out: texture_storage_3d<rgba16float, write>;
@group(1) @binding(6) var negative_out: texture_storage_3d<rgba16float, write>;
@group(1) @binding(7) var tilt_out: texture_storage_3d<rgba8snorm, write>;

// The face of a lobe of a voxel; the lobe must be there.
fn face_of(voxel: u32, lobes: u32, lobe: u32) -> u32 {
    return first_faces[voxel] + countOneBits(lobes & ((1u << lobe) - 1u));
}

fn lobe_texel(voxel: u32, lobes: u32, lobe: u32) -> vec4f {
    if (lobes & (1u << lobe)) == 0u {
        return vec4f(0.0);
    }
    let face = face_of(voxel, lobes, lobe);
    let opacity = abs(faces[face].vector_area[range.axis]);
    return vec4f(radiance[face].rgb * opacity, opacity);
}

fn lobe_tilt(voxel: u32, lobes: u32, lobe: u32) -> vec2f {
    if (lobes & (1u << lobe)) == 0u {
        return vec2f(0.0);
    }
    let area = faces[face_of(voxel, lobes, lobe)].vector_area;
    return vec2f(area[(range.axis + 1u) % 3u], area[(range.axis + 2u) % 3u]);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn store_radiance(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= range.node_count {
        return;
    }
    let node = nodes[voxel];
    if ((node.lobes >> (2u * range.axis)) & 3u) == 0u {
        return;
    }
    let cell = morton_decode(node.morton);
    textureStore(positive_out, cell, lobe_texel(voxel, node.lobes, 2u * range.axis));
    textureStore(negative_out, cell, lobe_texel(voxel, node.lobes, 2u * range.axis + 1u));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn store_tilt(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= range.node_count {
        return;
    }
    let node = nodes[voxel];
    let positive = lobe_tilt(voxel, node.lobes, 2u * range.axis);
    let negative = lobe_tilt(voxel, node.lobes, 2u * range.axis + 1u);
    textureStore(tilt_out, morton_decode(node.morton), vec4f(positive, negative));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn clear(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= range.node_count {
        return;
    }
    let cell = morton_decode(nodes[range.first_node + index].morton);
    textureStore(positive_out, cell, vec4f(0.0));
    textureStore(negative_out, cell, vec4f(0.0));
    textureStore(tilt_out, cell, vec4f(0.0));
}
