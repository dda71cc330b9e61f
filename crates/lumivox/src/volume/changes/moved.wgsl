// The voxels of a new list that have another surface than in the earlier one, or were not in it:
// their cells, and the cells above them, are outdated. A thread per voxel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::list::{Face, Node};
import package::voxels::lookup::bits_below;

struct MovedParams {
    voxel_count: u32,
    // Words of the finest level's bits.
    finest_words: u32,
    // 1: the earlier list was never stored, and so all has changed.
    all: u32,
}

@group(1) @binding(0) var<uniform> params: MovedParams;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read> faces: array<Face>;
@group(1) @binding(4) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(5) var<storage, read> old_ranks: array<u32>;
@group(1) @binding(6) var<storage, read> old_first_faces: array<u32>;
@group(1) @binding(7) var<storage, read> old_faces: array<Face>;
@group(1) @binding(8) var<storage, read_write> changed: array<atomic<u32>>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= params.voxel_count {
        return;
    }
    let word = nodes[voxel].morton / 32u;
    let bit = nodes[voxel].morton % 32u;
    let bits = old_occupancy[word];
    var is_same = (bits & (1u << bit)) != 0u;
    if is_same {
        let old_voxel = old_ranks[word] + bits_below(bits, bit);
        let old_first = old_first_faces[old_voxel];
        let first = first_faces[voxel];
        let count = first_faces[voxel + 1u] - first;
        is_same = old_first_faces[old_voxel + 1u] - old_first == count;
        for (var i = 0u; is_same && i < count; i++) {
            // Bits, since a zero has a sign that the volume stores.
            let old_area = bitcast<vec3u>(old_faces[old_first + i].vector_area);
            let area = bitcast<vec3u>(faces[first + i].vector_area);
            is_same = all(old_area == area) && old_faces[old_first + i].lobe == faces[first + i].lobe;
        }
    }
    if !is_same {
        atomicOr(&changed[word], 1u << bit);
    }
}
