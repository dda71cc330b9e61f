// One cone as a ray that meets surface exactly: the module package::cones::way. Lengths here are in the finest voxels.
//
// A ray walks all voxels in its way (Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing"; empty blocks
// in one step) and ends where it crosses a face's plane inside of what the face covers. A plane has no holes from voxel to voxel, so
// that nothing leaks through a wall, whatever its angle and thickness, and nothing behind a hit counts. Cones of a point are jittered
// over their solid angles, so that their mean is that of the cones.
//
// A surface is seen from its front. A single-sided one blocks from behind, and is black there.

import package::cascades::{
    box_size, finest_level, lowest_voxel, outer_high, outer_low, stored_cell,
};
import package::constants::CASCADES;
import package::cones::cone::{Cone, ConeSettings, OUTSIDE, START, Traced};
import package::grid::grid_from_world;
import package::volume::patch::{unpack_patch, unpack_radiance, PATCH_WORDS};
import package::volume::surface::{index, patches};
import package::voxels::covered::{across, is_covered};
import package::voxels::index::{first_block, first_entry, FACE_BITS};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// How far a ray looks beyond the end of a voxel, in its edges, to be in the next one. What it passes over by that is less than
// the tolerance of hits.
const NUDGE = 0.001;

// How far from its start a ray may meet its own surface from behind, in voxels: where that is curved, planes are beside it.
const OWN = 1.0;

fn cone_start(position_in_world: vec3f, normal: vec3f, level: u32, settings: ConeSettings) -> vec3f {
    return grid_from_world(position_in_world) + normal * (START * exp2(f32(level)));
}

// What a ray meets first.
struct Hit {
    // 3e38: nothing.
    distance: f32,
    radiance: vec3f,
}

// The faces of a voxel with its corner at the origin and an edge of 1, in front of what was met so far.
fn hit_faces(entry: u32, origin: vec3f, direction: vec3f, own: f32, so_far: Hit) -> Hit {
    var hit = so_far;
    let first = entry & ((1u << FACE_BITS) - 1u);
    for (var face = first; face < first + (entry >> FACE_BITS); face++) {
        let place = PATCH_WORDS * face;
        let light = patches[place + 4u];
        let plane = unpack_patch(patches[place], light);
        let cosine = dot(plane.normal, direction);
        let distance = (plane.offset - dot(plane.normal, origin)) / select(cosine, 1e-9, abs(cosine) < 1e-9);
        let is_back = cosine > 0.0;
        let is_met = distance > 0.0 && distance < hit.distance
            && !(is_back && (!plane.is_single_sided || distance < own));
        let at = across(origin + direction * distance, plane.lobe >> 1u);
        if is_met && is_covered(at, patches[place + 1u], vec4u(patches[place + 2u], patches[place + 3u])) {
            hit = Hit(distance, select(unpack_radiance(light), vec3f(0.0), is_back));
        }
    }
    return hit;
}

fn trace_cone(cone: Cone, settings: ConeSettings) -> Traced {
    let low = outer_low();
    let high = outer_high();
    let extent = high - low;
    let side = max(extent.x, max(extent.y, extent.z));
    let inverse = 1.0 / select(cone.direction, vec3f(1e-20), abs(cone.direction) < vec3f(1e-20));
    let is_forward = cone.direction > vec3f(0.0);

    // From where the ray enters the grid.
    let enter = min((low - cone.origin_in_grid) * inverse, (high - cone.origin_in_grid) * inverse);
    let leave = max((low - cone.origin_in_grid) * inverse, (high - cone.origin_in_grid) * inverse);
    var distance = max(max(enter.x, enter.y), max(enter.z, 0.0));
    let end = min(min(leave.x, leave.y), min(leave.z, cone.reach));
    var traced = Traced(vec3f(0.0), 1.0, 1.0, 0u, 0.0);
    let own = OWN * exp2(f32(cone.level));
    var hit = Hit(3e38, vec3f(0.0));
    while distance < end && hit.distance == 3e38 {
        traced.samples++;
        let ahead = cone.origin_in_grid + cone.direction * (distance + NUDGE);
        let cascade = finest_level(ahead, cone.level, 0.0);
        let edge = exp2(f32(cascade));
        let lowest = lowest_voxel(cascade);
        let size = vec3i(box_size());
        let voxel = clamp(vec3i(floor(ahead / edge)), lowest, lowest + size - 1);
        let code = morton_encode(stored_cell(voxel, 0u, cascade));
        let word = code / 32u;
        let block = code / 512u;
        var step = 1;
        if (index[first_block() + block / 32u] & (1u << (block % 32u))) == 0u {
            step = 8;
        } else if (index[2u * (word & ~1u)] | index[2u * (word | 1u)]) == 0u {
            step = 4;
        }
        var corner = voxel & vec3i(-step);
        if CASCADES > 0u && (any(corner < lowest) || any(corner + step > lowest + size)) {
            // Where it is stored, cells of the box's other end are in the block.
            corner = voxel;
            step = 1;
        }
        let bits = index[2u * word];
        if (bits & (1u << (code % 32u))) != 0u {
            let entry = index[first_entry() + index[2u * word + 1u] + bits_below(bits, code % 32u)];
            let origin = cone.origin_in_grid / edge - vec3f(voxel);
            hit = hit_faces(entry, origin, cone.direction, own / edge, Hit(3e38, vec3f(0.0)));
            hit.distance = select(hit.distance * edge, 3e38, hit.distance == 3e38);
        }
        let wall = select(vec3f(corner), vec3f(corner + step), is_forward) * edge;
        let walls = (wall - cone.origin_in_grid) * inverse;
        distance = max(min(walls.x, min(walls.y, walls.z)), distance + NUDGE);
    }
    let is_met = hit.distance < min(cone.reach, 3e38);
    traced.radiance = select(vec3f(0.0), hit.radiance, is_met);
    traced.transmittance = select(1.0, 0.0, is_met);
    traced.openness = select(1.0, 0.0, is_met && hit.distance < settings.occlusion_distance);
    traced.distance = select(OUTSIDE * side, hit.distance, is_met);
    return traced;
}
