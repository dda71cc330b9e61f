// Writes the faces of the voxel list into the finest level, where they have changed.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::dense::atlas::part_texel;
import package::volume::changes::cells::changed_cell;
import package::volume::changes::list::NOTHING;
import package::volume::parts::{part_of, storable, POSITIVE, TILT};
import package::voxels::list::{Face, Node};
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var<storage, read> nodes: array<Node>;
@group(1) @binding(4) var<storage, read> first_faces: array<u32>;
@group(1) @binding(5) var<storage, read> faces: array<Face>;
@group(1) @binding(6) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(7) var cells_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn store(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = changed_cell(linear_index(invocation, workgroups)).node;
    if voxel == NOTHING {
        return;
    }
    let node = nodes[voxel];
    let cell = morton_decode(node.morton);
    var face = first_faces[voxel];
    for (var axis = 0u; axis < 3u; axis++) {
        let lobes = (node.lobes >> (2u * axis)) & 3u;
        if lobes == 0u {
            continue;
        }
        // A voxel's faces are listed in the order of their lobes.
        var tilt = vec4f(0.0);
        for (var side = 0u; side < 2u; side++) {
            if (lobes & (1u << side)) == 0u {
                continue;
            }
            let area = faces[face].vector_area;
            let opacity = abs(area[axis]);
            let across = vec2f(area[(axis + 1u) % 3u], area[(axis + 2u) % 3u]);
            tilt = select(vec4f(tilt.xy, across), vec4f(across, tilt.zw), side == 0u);
            textureStore(
                cells_out,
                part_texel(cell, part_of(axis, POSITIVE + side), 0u),
                storable(vec4f(radiance[face].rgb * opacity, opacity)),
            );
            face++;
        }
        textureStore(cells_out, part_texel(cell, part_of(axis, TILT), 0u), tilt);
    }
}
