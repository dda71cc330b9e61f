// The compact list of occupied voxels and its content.
//
// Lobes are numbered 2 * axis + (0 for the positive side, 1 for the negative): +x -x +y -y +z -z.

// Light that bounces for ever must lose some at each bounce.
const LARGEST_REFLECTANCE = 0.99;

// An occupied cell of some level. Level 0 comes first in the list, then level 1, and so on.
struct Node {
    // The cell's coordinates, interleaved: x in the lowest bit.
    morton: u32,
    // Bits 0..5: which lobes have coverage here or below. Bits 8..13: which of them are tilted,
    // that is, have a vector area off their axis that survives rounding to 8 bits.
    lobes: u32,
}

// The surface of one lobe in one voxel.
struct Face {
    // Mean position of the surface, weighted by area along the lobe's axis.
    position_in_world: vec3f,
    // The voxel's Morton code.
    cell: u32,
    // Sum of A n / h^2 over the pieces of surface, scaled so that the component along the lobe is
    // at most 1.
    vector_area: vec3f,
    // 0..5, as numbered above.
    lobe: u32,
    // Mean share of the light that enters, which leaves again diffusely.
    reflectance: vec3f,
    // Used while voxelizing (voxelize::face_sums); zero afterwards.
    visible_area: f32,
    // Mean emitted radiance.
    emission: vec3f,
    padding_1: f32,
    // The light that the surface mirrors, and so keeps from entering: mean, grazing, kept_out
    // (light/reflected.wgsl).
    gloss: vec3f,
    padding_2: f32,
}

fn lobe_axis(lobe: u32) -> u32 {
    return lobe >> 1u;
}

fn lobe_sign(lobe: u32) -> f32 {
    return 1.0 - 2.0 * f32(lobe & 1u);
}
