// Writes the faces of the voxel list into the changed cells of the finest level.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::dense::atlas::part_texel;
import package::volume::changes::cells::changed_cell;
import package::volume::changes::list::NOTHING;
import package::volume::layers::{Layers, height_of, opacity_of, with_layer};
import package::volume::parts::{part_of, storable, POSITIVE, TILT};
import package::voxels::list::{Face, Node, faces_in};
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var<storage, read> nodes: array<Node>;
@group(1) @binding(4) var<storage, read> first_faces: array<u32>;
@group(1) @binding(5) var<storage, read> faces: array<Face>;
@group(1) @binding(6) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(7) var cells_out: texture_storage_3d<rgba16float, write>;

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
            let count = faces_in(node.lobes, 2u * axis + side);
            let layers = layers_of(face, count);
            tilt = select(vec4f(tilt.xy, layers.tilt), vec4f(layers.tilt, tilt.zw), side == 0u);
            let texel = part_texel(cell, part_of(axis, POSITIVE + side), 0u);
            textureStore(cells_out, texel, storable(layers.value));
            face += count;
        }
        textureStore(cells_out, part_texel(cell, part_of(axis, TILT), 0u), tilt);
    }
}
