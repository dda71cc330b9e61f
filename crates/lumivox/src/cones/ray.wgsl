// A ray that hits surfaces exactly. Lengths here are in the finest voxels.
//
// A ray walks all voxels along it (Amanatides and Woo 1987, "A fast voxel traversal algorithm for
// ray tracing"; empty blocks in one step) and ends where it crosses a face's plane inside the area
// that the face covers. A plane has no gaps between voxels, so no light leaks through a wall of any
// angle and thickness, and surfaces behind a hit do not count.
//
// A surface is visible from its front, in the light of the visible side (side.wgsl). A single-sided
// surface also blocks from behind, and is black there, unless light passes through it.

import package::cascades::{
    box_size, finest_level, lowest_voxel, outer_high, outer_low, stored_cell,
};
import package::constants::CASCADES;
import package::cones::side::face_seen_at;
import package::gpu::random::hash;
import package::volume::patch::{unpack_patch, unpack_radiance, Patch, BLACK, NOTHING, UNLIT};
import package::volume::surface::{index_texel, patch_texel};
import package::voxels::covered::{across, is_covered};
import package::voxels::index::{first_entry, FACE_BITS};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// The distance past a voxel's end, in edges, at which a ray looks for the next voxel, so that
// rounding cannot keep it in the first one. It is less than BEYOND.
const NUDGE = 0.001;

// The minimum of NUDGE's distance as a share of the travelled distance: a few rounding errors.
const LEAST_NUDGE = 1e-6;

// Step limit; only a ray that creeps along a border reaches it.
const MOST_STEPS = 8192u;

// Distance past the end of a voxel within which a ray may hit its faces, in edges.
const BEYOND = 0.05;

// Distance from its start within which a ray ignores surfaces from behind, in voxels: planes lie
// beside their curved surface.
const OWN = 1.0;

// The first surface on a ray.
struct Hit {
    distance: f32,
    // The face whose light the hit shows; or NOTHING, BLACK or UNLIT.
    face: u32,
    is_parted: bool,
    // The face that was hit; or NOTHING or BLACK.
    struck: u32,
}

// Whether a ray passes through a face with holes, drawn at random: the share of holes passes.
fn passes(direction: vec3f, face: u32, share: f32) -> bool {
    let bits = bitcast<vec3u>(direction);
    let drawn = hash(bits.x + hash(bits.y + hash(bits.z + hash(face)))) >> 8u;
    return f32(drawn) < share * 16777216.0;
}

// The share of light that passes through a face. That of glass is stored without the increase of
// its reflection towards grazing angles (Schlick 1994, "An inexpensive BRDF model for
// physically-based rendering").
fn passing_share(plane: Patch, cosine: f32) -> f32 {
    let share = f32(plane.holes) / 255.0;
    let rest = 1.0 - min(abs(cosine) * inverseSqrt(dot(plane.normal, plane.normal)), 1.0);
    let rest_squared = rest * rest;
    return share * select(1.0, 1.0 - rest_squared * rest_squared * rest, plane.is_glass);
}

// Intersects the faces of a voxel, which has its corner at the origin and an edge of 1, up to a
// distance.
fn hit_faces(
    entry: u32,
    origin: vec3f,
    direction: vec3f,
    own: f32,
    reach: f32,
    passed: ptr<function, Passed>,
) -> Hit {
    var hit = Hit(reach, NOTHING, false, NOTHING);
    let first = entry & ((1u << FACE_BITS) - 1u);
    for (var face = first; face < first + (entry >> FACE_BITS); face++) {
        let texel = patch_texel(face, 0u);
        let plane = unpack_patch(texel.xy, patch_texel(face, 2u).xy);
        let cosine = dot(plane.normal, direction);
        let distance = (plane.offset - dot(plane.normal, origin)) / select(cosine, 1e-9, abs(cosine) < 1e-9);
        let is_back = cosine > 0.0;
        let share = passing_share(plane, cosine);
        let blocks = plane.is_single_sided && distance >= own;
        let is_met = distance > 0.0 && distance < hit.distance && (!is_back || blocks);
        let point = origin + direction * distance;
        let at = across(point, plane.lobe >> 1u);
        if is_met && is_covered(at, texel.zw, patch_texel(face, 1u)) {
            let is_solid = share == 0.0 || ((*passed).draws && !passes(direction, face, share));
            if is_solid {
                let struck = select(face, BLACK, is_back);
                hit = Hit(distance, struck, plane.is_parted && !is_back, struck);
            } else if all(point >= vec3f(0.0)) && all(point < vec3f(1.0)) {
                // A hole outside of this voxel counts in the next one.
                (*passed).share *= share;
            }
        }
    }
    return hit;
}

struct Ray {
    origin_in_grid: vec3f,
    direction: vec3f,
    reach: f32,
    // The level of the voxels of the surface that the ray starts from.
    level: u32,
}

// The voxels and holes that a ray has passed.
struct Passed {
    // Number of voxels and blocks.
    steps: u32,
    // `true` to pass or hit each face with holes at random; `false` to pass all of them, with the
    // light's share through each.
    draws: bool,
    // The product of the shares.
    share: f32,
}

fn trace_ray(ray: Ray, passed: ptr<function, Passed>) -> Hit {
    let low = outer_low();
    let high = outer_high();
    let inverse = 1.0 / select(ray.direction, vec3f(1e-20), abs(ray.direction) < vec3f(1e-20));
    let is_forward = inverse > vec3f(0.0);
    // The ray starts where it enters the grid.
    let to_low = (low - ray.origin_in_grid) * inverse;
    let to_high = (high - ray.origin_in_grid) * inverse;
    let enter = min(to_low, to_high);
    let leave = max(to_low, to_high);
    let end = min(min(leave.x, leave.y), min(leave.z, ray.reach));
    let own = OWN * exp2(f32(ray.level));
    let entries = first_entry();
    let size = vec3i(box_size());
    var distance = max(max(enter.x, enter.y), max(enter.z, 0.0));
    var hit = Hit(3e38, NOTHING, false, NOTHING);
    var is_inside = distance < end;
    var edge = 1.0;
    var voxel = vec3i(0);
    var cascade = 0u;
    var entry = 0u;
    // The coordinate of the next voxel across a wall of this one, known exactly in spite of
    // rounding.
    var is_known = vec3<bool>(false);
    var known = vec3i(0);
    while is_inside {
        // Skip empty space. On wide machines, lanes leave this inner loop one by one and then test
        // faces together.
        var rank = 0u;
        var next = distance;
        loop {
            distance = next;
            is_inside = distance < end && (*passed).steps < MOST_STEPS;
            (*passed).steps += u32(is_inside);
            let nudge = max(NUDGE * edge, LEAST_NUDGE * distance);
            let ahead = ray.origin_in_grid + ray.direction * (distance + nudge);
            cascade = finest_level(ahead, ray.level, 0.0);
            edge = exp2(f32(cascade));
            let lowest = lowest_voxel(cascade);
            voxel = select(vec3i(floor(ahead / edge)), known, is_known);
            voxel = clamp(voxel, lowest, lowest + size - 1);
            let code = morton_encode(stored_cell(voxel, 0u, cascade));
            let pair = index_texel(code / 64u);
            let own_word = select(pair.xy, pair.zw, (code & 32u) != 0u);
            let bits = own_word.x;
            // Blocks of 2 x 2 x 2 are a byte of bits.
            let is_empty = (pair.x | pair.z) == 0u;
            let small = select(1u, 2u, ((bits >> (code & 24u)) & 0xffu) == 0u);
            // Zeros, before anything was voxelized, count as empty.
            var step = i32(select(small, max(pair.y, 4u), is_empty));
            var corner = voxel & vec3i(-step);
            if CASCADES > 0u && (any(corner < lowest) || any(corner + step > lowest + size)) {
                // The block wraps around in storage and includes cells of the box's other end.
                corner = voxel;
                step = 1;
            }
            let wall = select(vec3f(corner), vec3f(corner + step), is_forward) * edge;
            let walls = (wall - ray.origin_in_grid) * inverse;
            let least = min(walls.x, min(walls.y, walls.z));
            // Voxel sizes differ between boxes, so `distance` must grow.
            next = max(least, distance + select(0.0, nudge, CASCADES > 0u));
            is_known = (walls == vec3f(least)) & vec3<bool>(CASCADES == 0u);
            known = select(corner - 1, corner + step, is_forward);
            rank = own_word.y + bits_below(bits, code % 32u);
            let is_occupied = (bits & (1u << (code % 32u))) != 0u;
            continuing {
                break if is_occupied || !is_inside;
            }
        }
        if is_inside {
            entry = index_texel(entries + rank / 4u)[rank % 4u];
            let origin = ray.origin_in_grid / edge - vec3f(voxel);
            // Hits beyond the voxel belong to the next one.
            let reach = min(ray.reach, next + BEYOND * edge) / edge;
            hit = hit_faces(entry, origin, ray.direction, own / edge, reach, passed);
            hit.distance *= edge;
            distance = next;
            is_inside = hit.face == NOTHING && distance < end;
        }
    }
    if hit.is_parted {
        let point = (ray.origin_in_grid + ray.direction * hit.distance) / edge - vec3f(voxel);
        hit.face = face_seen_at(hit.face, entry, point, voxel, cascade);
    }
    return hit;
}

// The radiance that a face emits.
fn emitted_by(face: u32) -> vec3f {
    if face >= UNLIT {
        return vec3f(0.0);
    }
    return unpack_radiance(patch_texel(face, 2u).zw);
}

// The radiance that a face reflects, and emits if asked; black if `face` is not a face.
fn shown_by(face: u32, with_emission: bool) -> vec3f {
    if face >= UNLIT {
        return vec3f(0.0);
    }
    let texel = patch_texel(face, 2u);
    return unpack_radiance(texel.xy) + select(vec3f(0.0), unpack_radiance(texel.zw), with_emission);
}
