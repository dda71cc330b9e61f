// Stores the values of changed cells of the finest level, from the faces of the voxel list.

import package::constants::{ISOTROPIC, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::volume::octree::values::{nodes, owner_at, store_value, Owner};
import package::volume::octree::needs::Needs;
import package::volume::changes::cells::changed_cell;
import package::volume::changes::list::NOTHING;
import package::volume::layers::{Layers, height_of, opacity_of, with_layer};
import package::volume::parts::{part_of, stored_parts, POSITIVE, TILT};
import package::voxels::list::{Face, faces_in, faces_of};

@group(1) @binding(5) var<uniform> needs: Needs;
@group(1) @binding(6) var<storage, read> first_faces: array<u32>;
@group(1) @binding(7) var<storage, read> faces: array<Face>;
@group(1) @binding(8) var<storage, read> radiance: array<vec4f>;

// Combines `count` faces of a lobe, starting at `first`.
fn layers_of(first: u32, count: u32) -> Layers {
    var layers = Layers(vec4f(0.0), vec2f(0.0));
    for (var i = first; i < first + count; i++) {
        var hidden = 0.0;
        for (var j = first; j < first + count; j++) {
            let ahead = height_of(faces[j]) - height_of(faces[i]);
            hidden += select(0.0, opacity_of(faces[j]), ahead > 0.0 || (ahead == 0.0 && j < i));
        }
        layers = with_layer(layers, faces[i], radiance[i].rgb, hidden);
    }
    return layers;
}

fn store_lobes(voxel: u32, lobes: u32, owner: Owner, octant: u32) {
    let parts = stored_parts(lobes);
    var face = first_faces[voxel];
    for (var axis = 0u; axis < 3u; axis++) {
        // A voxel's faces are listed in the order of their lobes.
        var tilt = vec4f(0.0);
        for (var side = 0u; side < 2u; side++) {
            if ((lobes >> (2u * axis + side)) & 1u) == 0u {
                continue;
            }
            let count = faces_in(lobes, 2u * axis + side);
            let layers = layers_of(face, count);
            tilt = select(vec4f(tilt.xy, layers.tilt), vec4f(layers.tilt, tilt.zw), side == 0u);
            store_value(owner, octant, part_of(axis, POSITIVE + side), layers.value);
            face += count;
        }
        if ((parts >> part_of(axis, TILT)) & 1u) != 0u {
            store_value(owner, octant, part_of(axis, TILT), tilt);
        }
    }
}

// The opacity is the surface's area in the voxel, the radiance the mean over that area.
fn store_mean(voxel: u32, lobes: u32, owner: Owner, octant: u32) {
    let first = first_faces[voxel];
    var sum = vec4f(0.0);
    for (var i = 0u; i < faces_of(lobes); i++) {
        let area = length(faces[first + i].vector_area);
        sum += vec4f(radiance[first + i].rgb * area, area);
    }
    store_value(owner, octant, 0u, sum / max(sum.a, 1.0));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = changed_cell(linear_index(invocation, workgroups)).node;
    if voxel == NOTHING || needs.overflow != 0u {
        return;
    }
    let node = nodes[voxel];
    let owner = owner_at(node.morton / 8u, 1u);
    if ISOTROPIC != 0u {
        store_mean(voxel, node.lobes, owner, node.morton % 8u);
    } else {
        store_lobes(voxel, node.lobes, owner, node.morton % 8u);
    }
}
