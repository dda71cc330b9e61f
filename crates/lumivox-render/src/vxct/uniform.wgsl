// What the shading of the look and its cones are set to.

struct VxctShape {
    // Diameter per distance.
    width: f32,
    // Voxels.
    offset: f32,
    step_per_diameter: f32,
    padding: u32,
}

struct VxctUniform {
    diffuse: VxctShape,
    occlusion: VxctShape,
    specular: VxctShape,
    // One of VIEW_...
    shown: u32,
    // One of VXCT_...
    components: u32,
    // Bits of VXCT_TERM_...
    terms: u32,
    // Voxels in VXCT's unit, half the longest edge of the box that the grid is fitted to.
    unit_voxels: f32,
    // Voxels.
    origin_offset: f32,
    shadow_strength: f32,
    shininess_falloff: f32,
    // The radiance that the screen shows as 1.
    white: f32,
}

@group(1) @binding(0) var<uniform> settings: VxctUniform;

fn has(term: u32) -> bool {
    return (settings.terms & term) != 0u;
}
