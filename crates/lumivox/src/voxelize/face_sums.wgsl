// From the sums of a face to its means.

import package::voxels::list::{LARGEST_REFLECTANCE, lobe_axis, lobe_sign};

// A face before and after: sums as integers, then the numbers of voxels::list::Face as their bits. In place,
// since the two together would be the largest thing that voxelization needs.
struct FaceSlot {
    // Within the voxel at first.
    position_in_world: vec3i,
    cell: u32,
    vector_area: vec3i,
    lobe: u32,
    reflectance: vec3i,
    // The area along the lobe that no other layer hides, where there may be layers. Zero afterwards.
    visible_area: i32,
    emission: vec3i,
    padding_1: u32,
    gloss: vec3i,
    padding_2: u32,
}

// Sums over pieces of surface, multiplied by `scale`; all but the area weighted by the visible area along the lobe.
struct FaceSums {
    scale: f32,
    // Along the lobe: of all pieces, and of what no other layer hides.
    along: f32,
    visible: f32,
    position: vec3f,
    area: vec3f,
    reflectance: vec3f,
    emission: vec3f,
    gloss: vec3f,
}

struct FaceMeans {
    position_in_voxel: vec3f,
    vector_area: vec3f,
    reflectance: vec3f,
    // Relative to the largest of all materials.
    emission: vec3f,
    gloss: vec3f,
}

fn sums_of(slot: FaceSlot, scale: f32, lobe: u32) -> FaceSums {
    // All parts of the area along the lobe have one sign, so that it is zero only where all of them are too small
    // for the sums.
    let along = f32(slot.vector_area[lobe_axis(lobe)]) * lobe_sign(lobe);
    return FaceSums(
        scale,
        along,
        select(along, f32(slot.visible_area), slot.visible_area > 0),
        vec3f(slot.position_in_world),
        vec3f(slot.vector_area),
        vec3f(slot.reflectance),
        vec3f(slot.emission),
        vec3f(slot.gloss),
    );
}

fn means_of(sums: FaceSums) -> FaceMeans {
    let weight = max(sums.visible, 1.0);
    return FaceMeans(
        clamp(sums.position / weight, vec3f(0.0), vec3f(1.0)),
        sums.area / max(sums.scale, sums.along),
        clamp(sums.reflectance / weight, vec3f(0.0), vec3f(LARGEST_REFLECTANCE)),
        max(sums.emission / weight, vec3f(0.0)),
        sums.gloss / weight,
    );
}

// Whether a vector area has a part off its lobe's axis that survives rounding to 8 bits.
fn is_tilted(vector_area: vec3f, lobe: u32) -> bool {
    var across = vector_area;
    across[lobe_axis(lobe)] = 0.0;
    // As WebGPU packs a number into 8 bits with a sign.
    return any(floor(abs(across) * 127.0 + 0.5) > vec3f(0.0));
}

fn face_slot(means: FaceMeans, position_in_world: vec3f, emission: vec3f, cell: u32, lobe: u32) -> FaceSlot {
    return FaceSlot(
        bitcast<vec3i>(position_in_world),
        cell,
        bitcast<vec3i>(means.vector_area),
        lobe,
        bitcast<vec3i>(means.reflectance),
        0,
        bitcast<vec3i>(emission),
        0u,
        bitcast<vec3i>(means.gloss),
        0u,
    );
}
