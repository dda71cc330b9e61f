// Where the light of a face is found: in the middle of what is seen of it. A thread per voxel.
//
// Of a floor under a box or a wall, a part lies inside of other surface. Light starts where the squares of the face's mask
// are that no back in the voxel covers, and that no front touches; a face without such squares is HIDDEN.

import package::cascades::voxel_of;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::{grid_from_world, world_from_grid};
import package::voxelize::verdict::Verdict;
import package::voxels::covered::{across, is_covered};
import package::voxels::list::{Face, HIDDEN, Node, SINGLE_SIDED, faces_of, lobe_axis};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> verdict: Verdict;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read_write> faces: array<Face>;

// Surfaces that are as close as this touch, in voxels.
const TOUCHING = 0.02;

// As far as a surface is off its plane by rounding.
const ROUNDING = 0.001;

// Where a voxel is: its corner in the grid, and its edge.
struct Place {
    corner: vec3f,
    edge: f32,
}

fn in_voxel(position_in_world: vec3f, place: Place) -> vec3f {
    return grid_from_world(position_in_world) / place.edge - place.corner;
}

// Whether another face of the voxel hides a point of a face.
fn hides(other: u32, point: vec3f, normal: vec3f, is_single_sided: bool, place: Place) -> bool {
    if (faces[other].flags & SINGLE_SIDED) == 0u {
        return false;
    }
    let facing = normalize(faces[other].vector_area);
    let cosine = dot(facing, normal);
    let to = dot(facing, in_voxel(faces[other].position_in_world, place) - point);
    let distance = to / select(cosine, 1e-6, abs(cosine) < 1e-6);
    let is_back = cosine > 0.001 && distance > ROUNDING;
    let is_touching = is_single_sided && cosine < -0.001 && distance > -ROUNDING && distance < TOUCHING;
    let at = across(point + normal * distance, lobe_axis(faces[other].lobe));
    return (is_back || is_touching)
        && is_covered(at, vec2u(faces[other].mask_low, faces[other].mask_high), faces[other].profiles);
}

fn find_start(index: u32, first: u32, count: u32, place: Place) -> vec4f {
    let axis = lobe_axis(faces[index].lobe);
    let normal = normalize(faces[index].vector_area);
    let middle = in_voxel(faces[index].position_in_world, place);
    let is_single_sided = (faces[index].flags & SINGLE_SIDED) != 0u;
    let mask = vec2u(faces[index].mask_low, faces[index].mask_high);
    var seen = vec4f(0.0);
    var hidden = 0.0;
    for (var square = 0u; square < 64u; square++) {
        let uv = (vec2f(vec2u(square % 8u, square / 8u)) + 0.5) / 8.0;
        if ((mask[square / 32u] >> (square % 32u)) & 1u) == 0u || !is_covered(uv, mask, faces[index].profiles) {
            continue;
        }
        var point = vec3f(0.0);
        point[(axis + 1u) % 3u] = uv.x;
        point[(axis + 2u) % 3u] = uv.y;
        point[axis] = dot(normal, middle - point) / normal[axis];
        var is_hidden = false;
        for (var i = 0u; i < count && !is_hidden; i++) {
            let other = first + i;
            is_hidden = other != index && hides(other, point, normal, is_single_sided, place);
        }
        if is_hidden {
            hidden += 1.0;
        } else {
            seen += vec4f(point, 1.0);
        }
    }
    if hidden == 0.0 {
        return vec4f(middle, 1.0);
    }
    return vec4f(seen.xyz / max(seen.w, 1.0), seen.w);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if verdict.no_room != 0u || voxel >= verdict.moving_voxels {
        return;
    }
    let count = faces_of(nodes[voxel].lobes);
    if count < 2u {
        return;
    }
    let first = first_faces[voxel];
    let own = voxel_of(morton_decode(nodes[voxel].morton));
    let place = Place(vec3f(own.voxel), exp2(f32(own.cascade)));
    // A start lies in the face's plane, so that planes stay where they are.
    for (var i = 0u; i < count; i++) {
        let start = find_start(first + i, first, count, place);
        if start.w == 0.0 {
            faces[first + i].flags |= HIDDEN;
        } else {
            faces[first + i].position_in_world = world_from_grid((place.corner + start.xyz) * place.edge);
        }
    }
}
