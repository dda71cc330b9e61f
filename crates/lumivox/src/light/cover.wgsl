// What the volume shows of each face: its radiance, but where a layer in the next voxel hides it that layer's.
//
// A look-up between two voxels mixes both. Of a lamp one voxel below a ceiling it would take the lamp's light and the
// dark ceiling's by halves, though nothing is seen of the ceiling: a sixth of the lamp would be lost (the mean of
// x - x^2 over where a step falls). What the column of the two voxels has beyond full coverage is the hidden share
// of the one behind; a single sheet, however it straddles them, has no more than that. The coverage stays, so that
// nothing leaks past the lamp's edge.

import package::cascades::{box_size, lowest_voxel, stored_cell, voxel_of, BoxVoxel};
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::counts::ListCounts;
import package::voxels::list::{Face, Node, lobe_axis, lobe_sign};
import package::voxels::lookup::bits_below;
import package::voxels::morton::{morton_decode, morton_encode};

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> nodes: array<Node>;
// The index of each voxel's first face.
@group(1) @binding(3) var<storage, read> first_faces: array<u32>;
// Of the finest level, which comes first: a bit per cell, and the rank of each word.
@group(1) @binding(4) var<storage, read> occupancy: array<u32>;
@group(1) @binding(5) var<storage, read> ranks: array<u32>;
@group(1) @binding(6) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(7) var<storage, read_write> shown: array<vec4f>;

const NO_FACE = 0xffffffffu;

// The face of a lobe in a voxel.
fn face_in(cell: BoxVoxel, lobe: u32) -> u32 {
    let from_lowest = cell.voxel - lowest_voxel(cell.cascade);
    if any(from_lowest < vec3i(0)) || any(from_lowest >= vec3i(box_size())) {
        return NO_FACE;
    }
    let code = morton_encode(stored_cell(cell.voxel, 0u, cell.cascade));
    let bits = occupancy[code / 32u];
    if (bits & (1u << (code % 32u))) == 0u {
        return NO_FACE;
    }
    let voxel = ranks[code / 32u] + bits_below(bits, code % 32u);
    let lobes = nodes[voxel].lobes & 0x3fu;
    if (lobes & (1u << lobe)) == 0u {
        return NO_FACE;
    }
    return first_faces[voxel] + bits_below(lobes, lobe);
}

// What a face covers along its lobe's axis.
fn coverage_of(face: u32, axis: u32) -> f32 {
    if face == NO_FACE {
        return 0.0;
    }
    return abs(faces[face].vector_area[axis]);
}

// The radiance that a face sends out, with its emission or without.
fn sent_out(face: u32, has_emission: bool) -> vec4f {
    if has_emission {
        return radiance[face];
    }
    return vec4f(max(radiance[face].rgb - faces[face].emission, vec3f(0.0)), radiance[face].a);
}

fn show(index: u32, has_emission: bool) {
    if index >= counts.faces {
        return;
    }
    let own = faces[index];
    let axis = lobe_axis(own.lobe);
    var cell = voxel_of(morton_decode(own.cell));
    cell.voxel[axis] += i32(lobe_sign(own.lobe));
    let front = face_in(cell, own.lobe);
    var result = sent_out(index, has_emission);
    let covered = coverage_of(index, axis);
    var hiding = coverage_of(front, axis);
    if hiding + covered > 1.0 {
        for (var side = 0u; side < 4u; side++) {
            var beside = cell;
            beside.voxel[(axis + 1u + side / 2u) % 3u] += select(-1, 1, (side & 1u) != 0u);
            hiding = min(hiding, coverage_of(face_in(beside, own.lobe), axis));
        }
        let hidden = clamp((hiding + covered - 1.0) / covered, 0.0, 1.0);
        result = mix(result, sent_out(front, has_emission), hidden);
    }
    shown[index] = result;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    show(linear_index(invocation, workgroups), true);
}

// For cones of those who draw emitters.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn without_emission(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    show(linear_index(invocation, workgroups), false);
}
