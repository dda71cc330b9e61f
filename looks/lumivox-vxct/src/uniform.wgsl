// The shared data of the look's passes: its settings, and the place of its cube.
//
// Positions and lengths are in the cube from -1 to 1 that VXCT's scenes fill. A cell of the voxels
// is 2 / resolution wide.

struct VxctCone {
    // Diameter per distance.
    width: f32,
    offset: f32,
    step_per_diameter: f32,
    padding: u32,
}

struct VxctUniform {
    clip_from_world: mat4x4f,
    camera_in_world: vec3f,
    // The radiance that the screen shows as 1.
    white: f32,
    // The middle of the cube, and half of its edge, m.
    center_in_world: vec3f,
    unit_m: f32,
    // The background's colour, as a share of white.
    background: vec3f,
    // 1: the scene's surroundings replace the background.
    has_environment: u32,
    diffuse: VxctCone,
    occlusion: VxctCone,
    specular: VxctCone,
    // One of VIEW_...
    shown: u32,
    // Bits of VXCT_...
    terms: u32,
    light_count: u32,
    resolution: u32,
    origin_offset: f32,
    shadow_strength: f32,
    shininess_falloff: f32,
    // The level of the voxels that views of them show.
    level: f32,
}

@group(0) @binding(0) var<uniform> settings: VxctUniform;

fn has(term: u32) -> bool {
    return (settings.terms & term) != 0u;
}

fn in_cube(position_in_world: vec3f) -> vec3f {
    return (position_in_world - settings.center_in_world) / settings.unit_m;
}
