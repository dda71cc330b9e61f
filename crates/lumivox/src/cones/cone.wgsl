// One cone: what it is given, and what it finds. Lengths here are in the finest voxels.
//
// How it is traced is the module package::cones::way, with `cone_start` and `trace_cone`: by exact hits (exact.wgsl), or by a
// march through the volume for a caller's own model (march.wgsl).

// Settings of cones; the shader's side of TraceSettings.
struct ConeSettings {
    // Edge of the cells that are read, over the cone's diameter.
    voxel_per_diameter: f32,
    // Bound of the growth by the cosine against the cone's own plane; 0: none.
    clearance: f32,
    normal_offset: f32,
    step_per_voxel: f32,
    min_transmittance: f32,
    // The distance of occlusion, in voxels.
    occlusion_distance: f32,
    padding_0: u32,
    padding_1: u32,
    // The values of the cone model.
    model_values: vec4f,
}

struct Cone {
    origin_in_grid: vec3f,
    direction: vec3f,
    // Edge of the cells that are read, per distance.
    growth: f32,
    // The cone's length, in voxels.
    reach: f32,
    // In [0, 1): added to the level before rounding down. 1/2 rounds to the nearest.
    level_offset: f32,
    // The finest level that it reads.
    level: u32,
}

struct Traced {
    radiance: vec3f,
    // The share of the cone that met nothing. In a march below zero, by its SURPLUS at most, after an
    // oblique wall that counted too much.
    transmittance: f32,
    // The same share at the occlusion distance.
    openness: f32,
    samples: u32,
    // The mean distance of what it met, in voxels; what is outside counts as far away.
    distance: f32,
    // The radiance that the face at its end emits, whether the volume shows emission or not. A march leaves it at zero.
    emission: vec3f,
}

// Where cones start above a surface, in its voxels.
const START: f32 = 0.05;

// How far away what is outside the grid counts as, in sides of the grid.
const OUTSIDE: f32 = 8.0;

// The least growth: even the cone of a perfect mirror reads coarser cells far away, which bounds
// its samples.
const MIN_GROWTH: f32 = 0.02;
