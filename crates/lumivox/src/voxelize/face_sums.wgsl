// Converts the sums of a face to its means.

import package::cascades::grid_from_stored;
import package::constants::{HOLES, SINGLE_SIDED};
import package::grid::world_from_grid;
import package::voxelize::footprint::turn_back;
import package::voxelize::plane_keys::plane_of;
import package::voxels::covered::is_covered;
import package::voxels::list::{LARGEST_REFLECTANCE, faces_in, lobe_axis, lobe_sign};
import package::voxels::morton::morton_decode;

// A face before and after the conversion: first integer sums, then the bits of the numbers of
// voxels::list::Face. It is converted in place, since separate sums would be the largest allocation
// of voxelization.
struct FaceSlot {
    // While summing: the position within the voxel.
    position_in_world: vec3i,
    // While summing: the area of holes.
    cell: u32,
    vector_area: vec3i,
    // While summing: the key of the plane (plane_keys.wgsl).
    lobe: u32,
    reflectance: vec3i,
    flags: u32,
    emission: vec3i,
    mask_low: u32,
    gloss: vec3i,
    mask_high: u32,
    profiles: vec4u,
}

struct FaceMeans {
    position_in_voxel: vec3f,
    vector_area: vec3f,
    reflectance: vec3f,
    // Relative to the scale of all materials' emission.
    emission: vec3f,
    gloss: vec3f,
}

// Minimum sum of a reliable normal, in units of the sums: below it, rounding dominates.
const LEAST_SUM = 64.0;

// The normal of a face's plane, from the plane's key.
fn normal_of(key: u32, lobe: u32) -> vec3f {
    let plane = plane_of(key, lobe);
    return turn_back(normalize(vec3f(-plane.slope, 1.0)) * lobe_sign(lobe), lobe_axis(lobe));
}

// `scale` is the factor by which the terms of the sums were scaled.
fn means_of(slot: FaceSlot, scale: f32, lobe: u32) -> FaceMeans {
    // All terms of the area along the lobe have the same sign, so the area is zero only if all of
    // them are too small for the sums.
    let along = f32(slot.vector_area[lobe_axis(lobe)]) * lobe_sign(lobe);
    let weight = max(along, 1.0);
    var area = vec3f(slot.vector_area) / max(scale, along);
    if along < LEAST_SUM {
        area = normal_of(slot.lobe, lobe) * (weight / scale);
    }
    return FaceMeans(
        clamp(vec3f(slot.position_in_world) / weight, vec3f(0.0), vec3f(1.0)),
        area,
        clamp(vec3f(slot.reflectance) / weight, vec3f(0.0), vec3f(LARGEST_REFLECTANCE)),
        max(vec3f(slot.emission) / weight, vec3f(0.0)),
        vec3f(slot.gloss) / weight,
    );
}

// Samples along each side of the voxel: every second bit of a profile.
const COVER_SAMPLES = 16u;

// Whether set bits are one run.
fn is_run(bits: vec4u) -> vec4<bool> {
    return countOneBits(bits & ~(bits << vec4u(1u))) <= vec4u(1u);
}

// The area by which the bits of one surface may exceed it: where profiles bound it, a 32nd along a
// side of the voxel; where the mask does, as at an oblique corner of a wall, half the diagonal of a
// square along two sides.
const MOST_EXCESS = vec2f(0.03125, 0.177);

// The part of a voxel that a face covers by its bits.
struct Covered {
    // As a share of the voxel's side.
    area: f32,
    // Maximum area by which bits of one surface exceed it.
    excess: f32,
}

fn covered_by(slot: FaceSlot) -> Covered {
    let mask = vec2u(slot.mask_low, slot.mask_high);
    var covered = 0u;
    var convex = 0u;
    for (var i = 0u; i < COVER_SAMPLES * COVER_SAMPLES; i++) {
        let at = (vec2f(vec2u(i % COVER_SAMPLES, i / COVER_SAMPLES)) + 0.5) / f32(COVER_SAMPLES);
        covered += u32(is_covered(at, mask, slot.profiles));
        convex += u32(is_covered(at, vec2u(0xffffffffu), slot.profiles));
    }
    let area = f32(covered) / f32(COVER_SAMPLES * COVER_SAMPLES);
    if !all(is_run(slot.profiles)) {
        return Covered(area, MOST_EXCESS.x);
    }
    // One convex piece may have set the bits.
    return Covered(area, select(MOST_EXCESS.y, 1.0, covered == convex));
}

// The share of a face's covered area that is surface, below 1 if leaves, bars or wires are finer
// than its bits.
fn share_of_surface(slot: FaceSlot, area: f32) -> f32 {
    let most = f32(countOneBits(slot.mask_low) + countOneBits(slot.mask_high)) / 64.0;
    if most <= area + MOST_EXCESS.x {
        return 1.0;
    }
    let covered = covered_by(slot);
    return select(1.0, area / covered.area, covered.area > area + covered.excess);
}

// A face's flags after the conversion. `is_backed` if the voxel has surface of the opposite lobe.
fn flags_of(slot: FaceSlot, scale: f32, lobe: u32, is_backed: bool) -> u32 {
    let solid = f32(slot.vector_area[lobe_axis(lobe)]) * lobe_sign(lobe);
    let holes = max(f32(bitcast<i32>(slot.cell)), 0.0);
    let surface = max(solid + holes, 1.0);
    let share = share_of_surface(slot, surface / scale);
    let passing = 1.0 - clamp(solid / surface * share, 0.0, 1.0);
    // The front of a bar already blocks its share; its back may not do so again.
    let own = slot.flags & ~select(0u, SINGLE_SIDED, share < 1.0 && is_backed);
    return own | (u32(255.0 * passing + 0.5) << HOLES);
}

// Whether a vector area has a part off its lobe's axis that survives rounding to 8 bits.
fn is_tilted(vector_area: vec3f, lobe: u32) -> bool {
    var across = vector_area;
    across[lobe_axis(lobe)] = 0.0;
    // Rounded as WebGPU packs 8-bit snorm.
    return any(floor(abs(across) * 127.0 + 0.5) > vec3f(0.0));
}

// The face of a lobe in a voxel with the `lobes`, which is stored as `cell`; `emission_scale` is
// the scale of all materials' emission.
fn face_of(
    sums: FaceSlot,
    scale: f32,
    cell: u32,
    lobes: u32,
    lobe: u32,
    emission_scale: f32,
) -> FaceSlot {
    let means = means_of(sums, scale, lobe);
    let position = grid_from_stored(morton_decode(cell), means.position_in_voxel);
    return FaceSlot(
        bitcast<vec3i>(world_from_grid(position)),
        cell,
        bitcast<vec3i>(means.vector_area),
        lobe,
        bitcast<vec3i>(means.reflectance),
        flags_of(sums, scale, lobe, faces_in(lobes, lobe ^ 1u) > 0u),
        bitcast<vec3i>(means.emission * emission_scale),
        sums.mask_low,
        bitcast<vec3i>(means.gloss),
        sums.mask_high,
        sums.profiles,
    );
}
