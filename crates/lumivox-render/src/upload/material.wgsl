// The material of a draw: group 1 of the passes that rasterize.

struct Material {
    // Metallic-roughness: base colour. Phong: diffuse albedo, with metallic = 0. Alpha in w.
    base_color: vec4f,
    emission: vec3f,
    // Multiplies x and y of the normal texture.
    normal_scale: f32,
    // Reflectance at normal incidence of the part that is no metal.
    dielectric_f0: vec3f,
    // Perceptual: the width of the microfacet distribution is its square.
    roughness: f32,
    metallic: f32,
    has_normal_texture: u32,
    // 1: the surface exists where alpha is at least MASK_THRESHOLD.
    is_masked: u32,
    padding: u32,
}

// Alpha of masked textures was thresholded at upload, so that its mips hold the covered share: half of a texel
// is where the edge runs.
const MASK_THRESHOLD: f32 = 0.5;

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var base_color_sampler: sampler;
@group(1) @binding(3) var metallic_roughness_texture: texture_2d<f32>;
@group(1) @binding(4) var metallic_roughness_sampler: sampler;
@group(1) @binding(5) var normal_texture: texture_2d<f32>;
@group(1) @binding(6) var normal_sampler: sampler;
@group(1) @binding(7) var emission_texture: texture_2d<f32>;
@group(1) @binding(8) var emission_sampler: sampler;
