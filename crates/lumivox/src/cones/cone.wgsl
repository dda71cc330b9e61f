// One cone: its parameters and its result. Lengths here are in the finest voxels.
//
// The module package::cones::trace_method traces it, with `cone_start` and `trace_cone`: exact hits
// (exact.wgsl), or a march through the volume for a caller's own model (march.wgsl).

// Settings of cones; `TraceSettings` in shader layout.
struct ConeSettings {
    // Edge of the sampled cells as a share of the cone's diameter.
    voxel_per_diameter: f32,
    // Maximum growth per cosine to the surface; 0 disables it.
    clearance: f32,
    normal_offset: f32,
    step_per_voxel: f32,
    min_transmittance: f32,
    // The distance of ambient occlusion, in voxels.
    occlusion_distance: f32,
    padding_0: u32,
    padding_1: u32,
    // The values of the cone model.
    model_values: vec4f,
}

struct Cone {
    origin_in_grid: vec3f,
    direction: vec3f,
    // Edge of the sampled cells per distance.
    growth: f32,
    // The cone's length, in voxels.
    reach: f32,
    // Added to the level before rounding down, in [0, 1); 1/2 rounds to the nearest.
    level_offset: f32,
    // The finest level that the cone reads.
    level: u32,
}

struct Traced {
    // Exact hits: reflected radiance. A march: all of it.
    radiance: vec3f,
    // The share of the cone that hits nothing. In a march it can be negative, down to -SURPLUS,
    // after an oblique wall that counted too much.
    transmittance: f32,
    // The transmittance at the occlusion distance.
    openness: f32,
    samples: u32,
    // The mean distance of the cone's hits, in voxels; the outside counts as far away.
    distance: f32,
    // The radiance emitted by the face that the cone ends on. A march leaves it at zero.
    emission: vec3f,
    // The radiance emitted by the face that the cone hits. Unlike `emission`, it is not zero if
    // other surface in the voxel lies between the hit and the point where the face's light is
    // computed.
    emission_of_face: vec3f,
    // The face whose radiance it is; not below UNLIT (volume/patch.wgsl) if there is none.
    face: u32,
}

// Distance of cones' starts above a surface, in its voxels.
const START: f32 = 0.05;

// Assumed distance of the outside, in sides of the grid.
const OUTSIDE: f32 = 8.0;

// Minimum growth: even the cone of a perfect mirror reads coarser cells far away, which bounds its
// samples.
const MIN_GROWTH: f32 = 0.02;
