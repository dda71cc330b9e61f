// Finds the point at which the light of a face is computed: the middle of its visible part. A
// thread per voxel.
//
// If a box or wall stands on a floor, a part of the floor lies inside of it: the squares of the
// face's mask that a back face in the voxel covers, or that a front face touches. A face without
// other squares is HIDDEN. A wall also separates the floor's squares in front of it from those
// behind it: the point is then on the side with more squares.

import package::cascades::voxel_of;
import package::constants::{HIDDEN, LINEAR_WORKGROUP_SIZE, PARTED, SINGLE_SIDED};
import package::gpu::dispatch::linear_index;
import package::grid::{grid_from_world, world_from_grid};
import package::voxelize::needs::Needs;
import package::voxels::covered::{across, is_covered};
import package::voxels::list::{Face, Node, faces_of, lobe_axis};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read_write> faces: array<Face>;

// Surfaces at most this far apart touch, in voxels.
const TOUCHING = 0.02;

// Maximum distance by which rounding moves a surface off its plane, in voxels.
const ROUNDING = 0.001;

// NEAR is more than half the diagonal of a square. The second constant is the cosine above which
// planes do not cross in a square.
const NEAR = 0.15;
const PARALLEL = 0.99;

// A voxel: its corner in units of its own edge, and its edge in units of the grid.
struct Place {
    corner: vec3f,
    edge: f32,
}

fn in_voxel(position_in_world: vec3f, place: Place) -> vec3f {
    return grid_from_world(position_in_world) / place.edge - place.corner;
}

// Relation of another face of the voxel to a point of a face: the other face hides the point, or
// has it on one of its sides.
struct Beside {
    is_hidden: bool,
    is_behind: bool,
    // Whether the other face may pass through the point's square.
    is_near: bool,
}

fn beside(other: u32, point: vec3f, normal: vec3f, is_single_sided: bool, place: Place) -> Beside {
    let facing = normalize(faces[other].vector_area);
    let to = dot(facing, in_voxel(faces[other].position_in_world, place) - point);
    let cosine = dot(facing, normal);
    let is_near = abs(to) < NEAR && abs(cosine) < PARALLEL;
    if (faces[other].flags & SINGLE_SIDED) == 0u {
        return Beside(false, to > ROUNDING, is_near);
    }
    let distance = to / select(cosine, 1e-6, abs(cosine) < 1e-6);
    let is_back = cosine > 0.001 && distance > ROUNDING;
    let is_touching = is_single_sided && cosine < -0.001 && distance > -ROUNDING && distance < TOUCHING;
    let at = across(point + normal * distance, lobe_axis(faces[other].lobe));
    let is_hidden = (is_back || is_touching)
        && is_covered(at, vec2u(faces[other].mask_low, faces[other].mask_high), faces[other].profiles);
    return Beside(is_hidden, to > ROUNDING, is_near);
}

// A square of a face's mask: whether it is visible, and a bit for each face that it lies behind.
struct Square {
    point: vec3f,
    is_covered: bool,
    is_seen: bool,
    is_parted: bool,
    sides: u32,
}

fn square_of(index: u32, square: u32, first: u32, count: u32, place: Place) -> Square {
    let axis = lobe_axis(faces[index].lobe);
    let mask = vec2u(faces[index].mask_low, faces[index].mask_high);
    let uv = (vec2f(vec2u(square % 8u, square / 8u)) + 0.5) / 8.0;
    var found = Square(vec3f(0.0), false, false, false, 0u);
    if ((mask[square / 32u] >> (square % 32u)) & 1u) == 0u || !is_covered(uv, mask, faces[index].profiles) {
        return found;
    }
    let normal = normalize(faces[index].vector_area);
    let middle = in_voxel(faces[index].position_in_world, place);
    let is_single_sided = (faces[index].flags & SINGLE_SIDED) != 0u;
    found.point[(axis + 1u) % 3u] = uv.x;
    found.point[(axis + 2u) % 3u] = uv.y;
    found.point[axis] = dot(normal, middle - found.point) / normal[axis];
    found.is_covered = true;
    found.is_seen = true;
    for (var i = 0u; i < count && found.is_seen; i++) {
        let other = first + i;
        if other != index {
            let its = beside(other, found.point, normal, is_single_sided, place);
            found.is_seen = !its.is_hidden;
            found.is_parted |= its.is_near;
            found.sides |= select(0u, 1u << (i % 32u), its.is_behind);
        }
    }
    return found;
}

struct Start {
    point: vec3f,
    // HIDDEN, PARTED or 0.
    flags: u32,
}

// The middle of the visible squares on the most frequent combination of sides of the other faces.
fn find_start(index: u32, first: u32, count: u32, place: Place) -> Start {
    var seen = vec4f(0.0);
    var is_whole = true;
    var is_parted = false;
    // Boyer and Moore 1991, "MJRTY: a fast majority vote algorithm".
    var most = 0u;
    var votes = 0;
    for (var i = 0u; i < 64u; i++) {
        let square = square_of(index, i, first, count, place);
        is_parted |= square.is_parted;
        if square.is_seen {
            let is_first = seen.w == 0.0;
            is_whole = is_whole && (is_first || square.sides == most);
            most = select(most, square.sides, votes == 0);
            votes += select(-1, 1, square.sides == most);
            seen += vec4f(square.point, 1.0);
        } else {
            is_whole = is_whole && !square.is_covered;
        }
    }
    if seen.w == 0.0 {
        return Start(vec3f(0.0), HIDDEN);
    }
    if is_whole {
        return Start(in_voxel(faces[index].position_in_world, place), select(0u, PARTED, is_parted));
    }
    var sum = vec4f(0.0);
    for (var i = 0u; i < 64u; i++) {
        let square = square_of(index, i, first, count, place);
        sum += select(vec4f(0.0), vec4f(square.point, 1.0), square.is_seen && square.sides == most);
    }
    return Start(sum.xyz / sum.w, select(0u, PARTED, is_parted || sum.w < seen.w));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if needs.overflow != 0u || voxel >= needs.moving_voxels {
        return;
    }
    let count = faces_of(nodes[voxel].lobes);
    if count < 2u {
        return;
    }
    let first = first_faces[voxel];
    let own = voxel_of(morton_decode(nodes[voxel].morton));
    let place = Place(vec3f(own.voxel), exp2(f32(own.cascade)));
    // The new position lies in the face's plane, so the plane does not change.
    for (var i = 0u; i < count; i++) {
        let start = find_start(first + i, first, count, place);
        faces[first + i].flags |= start.flags;
        if start.flags != HIDDEN {
            faces[first + i].position_in_world = world_from_grid((place.corner + start.point) * place.edge);
        }
    }
}
