// Inserts the texels of a light's depth maps into the faces of the voxels at their depths.
//
// Each bundle finds its voxel by the occupancy bits, and is split among the voxel's faces by how
// much of the beam they cover, max(0, -d . N). Sums are integers, so the order of the threads does
// not matter. Shares are rounded at random by a hash of the texel, so that many small shares still
// add up.

import package::constants::{FATES, FATE_ABSORBED, FATE_KEPT, FATE_LOST, FATE_NONE, LIGHT_POINT};
import package::gpu::random::hash;
import package::grid::{grid, grid_from_world};
import package::light::lights::{incident_light, is_parallel, lights};
import package::classics::photons::photon_map::photon_map;
import package::light::shadow_map::{cube_face, shadow_layers, shadow_maps, ShadowLayer};
import package::voxels::list::Face;
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

@group(1) @binding(1) var<storage, read> occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> ranks: array<u32>;
@group(1) @binding(3) var<storage, read> first_faces: array<u32>;
@group(1) @binding(4) var<storage, read> faces: array<Face>;
// The light that each face has received, `Taken` with atomic members.
@group(1) @binding(5) var<storage, read_write> sums: array<AtomicTaken>;
// `PhotonFates` (mod.rs): the number of bundles with each fate.
@group(1) @binding(6) var<storage, read_write> fates: array<atomic<u32>, FATES>;

struct AtomicTaken {
    flux: atomic<u32>,
    lead: atomic<u32>,
}

// A voxel: its place in the list, or NO_VOXEL, and its Morton code.
struct Voxel {
    place: u32,
    code: u32,
}

const NO_VOXEL: u32 = 0xffffffffu;

// Offsets that are tried, in voxels along the beam. A surface on the border of two voxels is in one
// of them, and rounding may move the texel's point into the other; the smaller step is 50 times the
// rounding of f32 at 1024 voxels. The larger step is for edges that the rasterizer has moved by a
// fraction of a texel.
const TRIES: u32 = 5u;
const STEPS = array<f32, TRIES>(0.0, 0.015625, -0.015625, 0.125, -0.125);

var<workgroup> own_fates: array<atomic<u32>, FATES>;

fn voxel_at(position_in_grid: vec3f) -> Voxel {
    if any(position_in_grid < vec3f(0.0)) || any(position_in_grid >= vec3f(grid.dimensions)) {
        return Voxel(NO_VOXEL, 0u);
    }
    let code = morton_encode(vec3u(position_in_grid));
    let bits = occupancy[code >> 5u];
    if (bits & (1u << (code & 31u))) == 0u {
        return Voxel(NO_VOXEL, 0u);
    }
    return Voxel(ranks[code >> 5u] + bits_below(bits, code & 31u), code);
}

// The part of a beam that a face covers, in units of a voxel's side.
fn cover(face: u32, direction: vec3f) -> f32 {
    return max(-dot(direction, faces[face].vector_area), 0.0);
}

// The distance of a point in front of a face's plane, in voxels.
fn lead_of(face: u32, position: vec3f) -> f32 {
    let normal = normalize(faces[face].vector_area);
    return dot(position - faces[face].position_in_world, normal) / grid.voxel_size_m;
}

// Faces whose planes are at most this far apart, in voxels, share the arriving light.
const SHARED = 1.0 / 64.0;

// Splits a bundle among the faces of a voxel that it hits: those with the nearest planes.
fn insert(position: vec3f, voxel: Voxel, direction: vec3f, counts: f32, seed: u32) -> u32 {
    let first = first_faces[voxel.place];
    // A voxel's faces, if any, are stored one after another.
    var end = first;
    while end < arrayLength(&faces) && faces[end].cell == voxel.code {
        end++;
    }
    var nearest = 3e38;
    for (var face = first; face < end; face++) {
        nearest = select(nearest, min(nearest, abs(lead_of(face, position))), cover(face, direction) > 0.0);
    }
    var covered = 0.0;
    for (var face = first; face < end; face++) {
        let is_there = abs(lead_of(face, position)) <= nearest + SHARED;
        covered += select(0.0, cover(face, direction), is_there);
    }
    if covered <= 0.0 {
        return select(FATE_ABSORBED, FATE_LOST, first == end);
    }
    for (var face = first; face < end; face++) {
        let lead = lead_of(face, position);
        if abs(lead) > nearest + SHARED {
            continue;
        }
        let share = counts * (cover(face, direction) / covered);
        let dither = f32(hash(seed ^ faces[face].lobe) >> 8u) * (1.0 / 16777216.0);
        let whole = u32(share + dither);
        if whole > 0u {
            atomicAdd(&sums[face].flux, whole);
            // Integers wrap around, so adding a negative number's bits subtracts.
            let weighted = i32(f32(whole) * clamp(0.5 * lead, -1.0, 1.0));
            atomicAdd(&sums[face].lead, bitcast<u32>(weighted));
        }
    }
    return FATE_KEPT;
}

// The cross-section of a texel's bundle, in m2; for perspective layers, per squared metre of
// distance.
fn cross_section(layer: ShadowLayer, texel: vec2u) -> f32 {
    let area = layer.texel_size * layer.texel_size;
    if layer.is_perspective == 0u {
        return area;
    }
    // The texel on the plane at unit distance: its solid angle is its area times the cosine cubed.
    let from_middle = (vec2f(texel) + 0.5 - 0.5 * vec2f(textureDimensions(shadow_maps)))
        * layer.texel_size;
    let squared = 1.0 + dot(from_middle, from_middle);
    return area / (squared * sqrt(squared));
}

fn follow(texel: vec2u, layer_in_light: u32) -> u32 {
    let layer_index = photon_map.first_layer + layer_in_light;
    let depth = textureLoad(shadow_maps, texel, layer_index, 0);
    if depth <= 0.0 {
        return FATE_NONE;
    }
    let uv = (vec2f(texel) + 0.5) / vec2f(textureDimensions(shadow_maps));
    let ndc = vec3f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, depth);
    let world = photon_map.world_from_clip[layer_in_light] * vec4f(ndc, 1.0);
    let position = world.xyz / world.w;

    // Flux is counted for an intensity of one; reflect.wgsl multiplies it by the light's.
    var light = lights[photon_map.light];
    light.intensity = vec3f(1.0);
    let from_light = position - light.position_in_world;
    // The faces of a cube overlap at their borders.
    if light.kind == LIGHT_POINT && cube_face(from_light) != layer_in_light {
        return FATE_NONE;
    }
    let incident = incident_light(light, position);
    var flux = incident.irradiance.x * cross_section(shadow_layers[layer_index], texel);
    var direction = light.direction;
    if !is_parallel(light) {
        flux *= dot(from_light, from_light);
        direction = normalize(from_light);
    }
    if flux <= 0.0 {
        return FATE_NONE;
    }

    let place = grid_from_world(position);
    let seed = hash(texel.x ^ hash(texel.y ^ hash(layer_index)));
    var steps = STEPS;
    var fate = FATE_LOST;
    for (var i = 0u; i < TRIES && fate != FATE_KEPT; i++) {
        let voxel = voxel_at(place + direction * steps[i]);
        if voxel.place != NO_VOXEL {
            let counts = flux * photon_map.counts_per_flux;
            fate = min(fate, insert(position, voxel, direction, counts, seed));
        }
    }
    return fate;
}

@compute @workgroup_size(8, 8)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if local < FATES {
        atomicStore(&own_fates[local], 0u);
    }
    workgroupBarrier();
    if all(invocation.xy < textureDimensions(shadow_maps)) {
        atomicAdd(&own_fates[follow(invocation.xy, invocation.z)], 1u);
    }
    workgroupBarrier();
    if local < FATES {
        atomicAdd(&fates[local], atomicLoad(&own_fates[local]));
    }
}
