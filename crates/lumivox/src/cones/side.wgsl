// The face whose light is seen at a hit.
//
// A face has one light, found at its start. What another surface in the voxel parts from the start, as a wall parts the ground
// inside of a house from that outside, has other light: that of the face of the same plane in the next voxel, away from that
// surface.

import package::cascades::{box_size, lowest_voxel, stored_cell};
import package::volume::patch::{start_of, unpack_patch, NOTHING, Patch, PATCH_WORDS, UNLIT};
import package::volume::surface::{index, patches};
import package::voxels::covered::{across, is_covered};
import package::voxels::index::{first_entry, FACE_BITS};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// Voxels that are looked at from that of the hit, along an axis each: as many as surfaces part at a corner.
const MOST_VOXELS = 3u;

// Surface parts what is farther from it than this, in voxels.
const PARTED = 0.02;

// Faces are of the same plane if their normals are as near as this cosine, and their heights as this many voxels.
const SAME_NORMAL = 0.98;
const SAME_HEIGHT = 0.05;

fn patch_of(face: u32) -> Patch {
    return unpack_patch(patches[PATCH_WORDS * face], patches[PATCH_WORDS * face + 4u]);
}

// The surface of a voxel that is between a face's start and a point of it, or NOTHING.
fn parting(entry: u32, face: u32, point: vec3f) -> u32 {
    let start = start_of(patch_of(face), patches[PATCH_WORDS * face].y);
    let first = entry & ((1u << FACE_BITS) - 1u);
    for (var other = first; other < first + (entry >> FACE_BITS); other++) {
        let plane = patch_of(other);
        let ours = dot(plane.normal, start) - plane.offset;
        let its = dot(plane.normal, point) - plane.offset;
        let is_near = min(abs(ours), abs(its)) < PARTED * length(plane.normal);
        if other == face || plane.holes != 0u || is_near || ours * its > 0.0 {
            continue;
        }
        let crossed = mix(start, point, ours / (ours - its));
        let place = PATCH_WORDS * other;
        if is_covered(across(crossed, plane.lobe >> 1u), patches[place + 1u], vec4u(patches[place + 2u], patches[place + 3u])) {
            return other;
        }
    }
    return NOTHING;
}

// The entry of a voxel of the index; zero if it is empty or not there.
fn entry_at(voxel: vec3i, cascade: u32) -> u32 {
    let lowest = lowest_voxel(cascade);
    if any(voxel < lowest) || any(voxel >= lowest + vec3i(box_size())) {
        return 0u;
    }
    let code = morton_encode(stored_cell(voxel, 0u, cascade));
    let bits = index[2u * (code / 32u)];
    if ((bits >> (code % 32u)) & 1u) == 0u {
        return 0u;
    }
    return index[first_entry() + index[2u * (code / 32u) + 1u] + bits_below(bits, code % 32u)];
}

// The face of a voxel that lies in a plane, or NOTHING; the point of the plane is in the voxel's own coordinates.
fn same_plane(entry: u32, plane: Patch, point: vec3f) -> u32 {
    let first = entry & ((1u << FACE_BITS) - 1u);
    for (var face = first; face < first + (entry >> FACE_BITS); face++) {
        let other = patch_of(face);
        let height = (dot(other.normal, point) - other.offset) / length(other.normal);
        let cosine = dot(normalize(other.normal), normalize(plane.normal));
        if other.lobe == plane.lobe && cosine > SAME_NORMAL && abs(height) < SAME_HEIGHT {
            return face;
        }
    }
    return NOTHING;
}

// The face whose light is seen at a point of a face, in the coordinates of its voxel; UNLIT if there is none near.
fn face_seen_at(hit: u32, hit_entry: u32, hit_point: vec3f, hit_voxel: vec3i, cascade: u32) -> u32 {
    var face = hit;
    var entry = hit_entry;
    var point = hit_point;
    var voxel = hit_voxel;
    for (var i = 0u; i <= MOST_VOXELS && face != NOTHING; i++) {
        var wall = NOTHING;
        if patch_of(face).is_parted {
            wall = parting(entry, face, point);
        }
        if wall == NOTHING {
            return face;
        }
        // Away from the wall, along its axis.
        let plane = patch_of(wall);
        let axis = plane.lobe >> 1u;
        let is_beyond = dot(plane.normal, point) > plane.offset;
        let step = select(-1, 1, is_beyond == (plane.normal[axis] > 0.0));
        voxel[axis] += step;
        point[axis] -= f32(step);
        entry = entry_at(voxel, cascade);
        face = same_plane(entry, patch_of(face), point);
    }
    return UNLIT;
}
