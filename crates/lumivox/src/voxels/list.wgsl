// The compact list of occupied voxels and its contents.
//
// Lobes are numbered 2 * axis + (0 for the positive side, 1 for the negative): +x -x +y -y +z -z.

// Light that bounces infinitely often must lose some energy at each bounce.
const LARGEST_REFLECTANCE = 0.99;

// An occupied cell of some level. Level 0 comes first in the list, then level 1, and so on.
struct Node {
    // The cell's coordinates, interleaved: x in the lowest bit.
    morton: u32,
    // Bits 0..5: lobes with coverage here or below. Bits 8..13: lobes that are tilted, that is,
    // have a vector area off their axis that survives rounding to 8 bits. Voxels only: bits 14 to
    // 31 are the number of faces of each lobe, three bits each.
    lobes: u32,
}

// Maximum number of faces of a lobe in a voxel.
const MOST_FACES = 7u;

// The number of faces of a voxel.
fn faces_of(lobes: u32) -> u32 {
    let counts = lobes >> 14u;
    let pairs = (counts & 0x71c7u) + ((counts >> 3u) & 0x71c7u);
    return (pairs & 0x3fu) + ((pairs >> 6u) & 0x3fu) + (pairs >> 12u);
}

// The number of faces before those of a lobe.
fn faces_before(lobes: u32, lobe: u32) -> u32 {
    return faces_of(lobes & ((1u << (14u + 3u * lobe)) - 1u));
}

fn faces_in(lobes: u32, lobe: u32) -> u32 {
    return extractBits(lobes, 14u + 3u * lobe, 3u);
}

// Sets the number of faces of a lobe that had none.
fn with_faces(lobes: u32, lobe: u32, count: u32) -> u32 {
    return lobes | (count << (14u + 3u * lobe));
}

// The surface of one plane in one lobe of a voxel.
struct Face {
    // Mean position of the visible surface, weighted by area along the lobe's axis.
    position_in_world: vec3f,
    // The voxel's Morton code.
    cell: u32,
    // Sum of A n / h^2 over the pieces of surface, scaled so that the component along the lobe is
    // at most 1.
    vector_area: vec3f,
    // The lobe, 0..5, as numbered above.
    lobe: u32,
    // Mean share of entering light that is reflected diffusely.
    reflectance: vec3f,
    // SINGLE_SIDED, HIDDEN, PARTED, GLASS and HOLES.
    flags: u32,
    // Mean emitted radiance.
    emission: vec3f,
    // The covered part of the voxel's side, seen along its lobe's axis (voxelize::cover).
    mask_low: u32,
    // The light that the surface mirrors: mean, grazing, kept_out (light/reflected.wgsl).
    gloss: vec3f,
    mask_high: u32,
    profiles: vec4u,
}

fn lobe_axis(lobe: u32) -> u32 {
    return lobe >> 1u;
}

fn lobe_sign(lobe: u32) -> f32 {
    return 1.0 - 2.0 * f32(lobe & 1u);
}
