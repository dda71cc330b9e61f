// Adjacent faces: whether they belong to the same surface, and whether another surface separates
// them.

import package::cascades::{box_size, lowest_voxel, stored_cell};
import package::volume::patch::{start_of, unpack_patch, NOTHING, Patch};
import package::volume::surface::{index_texel, patch_texel};
import package::voxels::covered::{across, is_covered};
import package::voxels::index::{first_entry, FACE_BITS};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// Surfaces nearer than this to one of two points do not separate them, in voxels.
const LEAST_DISTANCE = 0.002;

fn patch_of(face: u32) -> Patch {
    return unpack_patch(patch_texel(face, 0u).xy, patch_texel(face, 2u).xy);
}

fn start_of_face(face: u32) -> vec3f {
    return start_of(patch_of(face), patch_texel(face, 0u).y);
}

// The entry of a voxel in the index; zero if the voxel is empty or outside its box.
fn entry_at(voxel: vec3i, cascade: u32) -> u32 {
    let lowest = lowest_voxel(cascade);
    if any(voxel < lowest) || any(voxel >= lowest + vec3i(box_size())) {
        return 0u;
    }
    let code = morton_encode(stored_cell(voxel, 0u, cascade));
    let pair = index_texel(code / 64u);
    let own_word = select(pair.xy, pair.zw, (code & 32u) != 0u);
    if ((own_word.x >> (code % 32u)) & 1u) == 0u {
        return 0u;
    }
    let rank = own_word.y + bits_below(own_word.x, code % 32u);
    return index_texel(first_entry() + rank / 4u)[rank % 4u];
}

// The first face of a voxel, except `but`, that lies between two points in the voxel's coordinates;
// or NOTHING.
fn face_between(entry: u32, but: u32, start: vec3f, end: vec3f) -> u32 {
    let first = entry & ((1u << FACE_BITS) - 1u);
    for (var other = first; other < first + (entry >> FACE_BITS); other++) {
        let plane = patch_of(other);
        let ours = dot(plane.normal, start) - plane.offset;
        let its = dot(plane.normal, end) - plane.offset;
        let is_near = min(abs(ours), abs(its)) < LEAST_DISTANCE * length(plane.normal);
        if other == but || plane.holes != 0u || is_near || ours * its > 0.0 {
            continue;
        }
        let crossed = mix(start, end, ours / (ours - its));
        let mask = patch_texel(other, 0u).zw;
        if is_covered(across(crossed, plane.lobe >> 1u), mask, patch_texel(other, 1u)) {
            return other;
        }
    }
    return NOTHING;
}

// Limits of faces of one surface: minimum cosine between their normals, and maximum height of one
// over the other, in voxels.
struct Likeness {
    least_cosine: f32,
    most_height: f32,
}

// The face of a voxel that is nearest to a point of a surface; or NOTHING.
fn face_like(entry: u32, lobe: u32, normal: vec3f, point: vec3f, likeness: Likeness) -> u32 {
    var found = NOTHING;
    var least = likeness.most_height;
    let first = entry & ((1u << FACE_BITS) - 1u);
    for (var face = first; face < first + (entry >> FACE_BITS); face++) {
        let other = patch_of(face);
        let size = length(other.normal);
        let height = abs(dot(other.normal, point) - other.offset) / size;
        let cosine = dot(other.normal, normal) / size;
        if other.lobe == lobe && cosine > likeness.least_cosine && height < least {
            found = face;
            least = height;
        }
    }
    return found;
}

// Whether another surface lies between two points of a surface, in voxels of a cascade. The test is
// done ABOVE the surface, where rays start, to find objects on it, in the voxels of both points and
// of the middle.
fn is_parted(start: vec3f, end: vec3f, normal: vec3f, cascade: u32) -> bool {
    let first = start + ABOVE * normal;
    let last = end + ABOVE * normal;
    let at_first = vec3i(floor(first));
    let at_last = vec3i(floor(last));
    let at_middle = vec3i(floor(mix(first, last, 0.5)));
    // Each voxel is searched once.
    let is_last_other = any(at_last != at_first);
    let is_middle_other = any(at_middle != at_first) && any(at_middle != at_last);
    let count = 1u + u32(is_last_other) + u32(is_middle_other);
    var parted = false;
    var i = 0u;
    loop {
        let voxel = select(select(at_middle, at_last, i == 1u), at_first, i == 0u);
        let corner = vec3f(voxel);
        let between = face_between(entry_at(voxel, cascade), NOTHING, first - corner, last - corner);
        parted = parted || between != NOTHING;
        continuing {
            i++;
            break if parted || i >= count;
        }
    }
    return parted;
}

const ABOVE = 0.05;

// A face, and the point where its light is gathered, in voxels of a cascade.
struct Spot {
    face: u32,
    start: vec3f,
}

// Limits of faces that share far light: a curved surface may turn and rise this much from voxel to
// voxel.
const SHARED = Likeness(0.9, 0.4);

// The face of a surface at a point of the surface.
fn spot_at(point: vec3f, lobe: u32, normal: vec3f, cascade: u32) -> Spot {
    let voxel = vec3i(floor(point));
    let corner = vec3f(voxel);
    let face = face_like(entry_at(voxel, cascade), lobe, normal, point - corner, SHARED);
    if face == NOTHING {
        return Spot(NOTHING, point);
    }
    return Spot(face, corner + start_of_face(face));
}
