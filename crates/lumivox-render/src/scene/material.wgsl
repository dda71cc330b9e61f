// The material of a draw: group 1 of the passes that rasterize.

import package::constants::TEXTURE_COUNT;

// The mapping of a vertex's coordinates to a texture.
struct TexturePlace {
    // The rows of the affine transform from the vertex's coordinates to the image's.
    u_row: vec3f,
    // The set of the vertex's coordinates: 0 or 1.
    texcoord_set: u32,
    v_row: vec3f,
    padding: u32,
}

struct Material {
    // Metallic-roughness: base colour. Phong: diffuse albedo, with metallic = 0. Alpha in w.
    base_color: vec4f,
    emission: vec3f,
    // Multiplies x and y of the normal texture.
    normal_scale: f32,
    // Reflectance at normal incidence of the non-metallic part; in layered materials, before the
    // specular texture and `specular_factor`.
    dielectric_f0: vec3f,
    // Perceptual: the width of the microfacet distribution is its square.
    roughness: f32,
    sheen_color: vec3f,
    sheen_roughness: f32,
    metallic: f32,
    has_normal_texture: u32,
    // The surface exists where alpha is at least this; 0 means everywhere.
    mask_threshold: f32,
    // Above 0: the surface shows its base colour times this radiance, without lighting.
    unlit_radiance: f32,
    // The following members are only for layered materials.
    specular_factor: f32,
    coat_strength: f32,
    coat_roughness: f32,
    // The transmitted share of the light that enters.
    transmission: f32,
    // 1: alpha is the covered share.
    is_blended: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
    // Indexed by TEXTURE_...
    places: array<TexturePlace, TEXTURE_COUNT>,
}

// Do not branch only on its members; use select(). Mesa 22.3 (lavapipe) clones a shader for each
// value of the uniforms that decide its branches, and never frees the clones. (A storage buffer
// would read as zero in pixels beside a triangle's edge, which spoils derivatives.)
@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var base_color_sampler: sampler;
@group(1) @binding(3) var metallic_roughness_texture: texture_2d<f32>;
@group(1) @binding(4) var metallic_roughness_sampler: sampler;
@group(1) @binding(5) var normal_texture: texture_2d<f32>;
@group(1) @binding(6) var normal_sampler: sampler;
@group(1) @binding(7) var emission_texture: texture_2d<f32>;
@group(1) @binding(8) var emission_sampler: sampler;
@group(1) @binding(9) var specular_texture: texture_2d<f32>;
@group(1) @binding(10) var specular_sampler: sampler;
// Strength in r, roughness in g.
@group(1) @binding(11) var coat_texture: texture_2d<f32>;
@group(1) @binding(12) var coat_sampler: sampler;
// Colour in rgb, roughness in a.
@group(1) @binding(13) var sheen_texture: texture_2d<f32>;
@group(1) @binding(14) var sheen_sampler: sampler;
@group(1) @binding(15) var transmission_texture: texture_2d<f32>;
@group(1) @binding(16) var transmission_sampler: sampler;
// The directional albedo of sheen (sheen.rs): cosine along u, roughness along v.
@group(1) @binding(17) var sheen_albedo: texture_2d<f32>;
@group(1) @binding(18) var sheen_albedo_sampler: sampler;

// The coordinates on a texture; `texcoords` has the vertex's two sets, in xy and zw.
fn texcoord_at(place: TexturePlace, texcoords: vec4f) -> vec2f {
    let own = vec3f(select(texcoords.xy, texcoords.zw, place.texcoord_set == 1u), 1.0);
    return vec2f(dot(place.u_row, own), dot(place.v_row, own));
}

// The coordinates on one of the textures of the draw's material.
fn texcoord(which: u32, texcoords: vec4f) -> vec2f {
    return texcoord_at(material.places[which], texcoords);
}
