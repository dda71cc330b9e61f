// The surface's properties in the look: strengths given by the scene, or the nearest equivalent of
// the material.

import package::constants::{VXCT_OF_EMITTER, VXCT_OF_STRENGTHS};
import package::render::scene::material::material;
import package::render::scene::point::PointSamples;
import package::vxct::uniform::settings;
import package::trace::brdf::alpha_from_roughness;

// A draw of the scene.
struct VxctDraw {
    color: vec3f,
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    // One of VXCT_OF_...
    kind: u32,
    first_index: u32,
    base_vertex: i32,
    // Number of triangles in earlier draws.
    first_triangle: u32,
    // 32-bit words of a vertex's attributes.
    attribute_words: u32,
    // 1: normals point away from the mesh's origin.
    is_rounded: u32,
    // 0: the draw is in no voxel.
    is_voxelized: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(2) var<storage, read> vxct_draws: array<VxctDraw>;

struct VxctMaterial {
    ambient: vec3f,
    diffuse: vec3f,
    // The colour of the highlight.
    specular: vec3f,
    shininess: f32,
    // The factor of mirrored light.
    mirror: vec3f,
    // Diameter per distance of a cone as wide as the lobe; 0: VXCT's own width.
    lobe_width: f32,
    // As a share of white.
    emission: vec3f,
}

const AMBIENT_OF_OTHERS: f32 = 0.08;
// Highlights sharper than this would be missed between pixels.
const MAX_SHININESS: f32 = 4096.0;

fn material_of(draw: u32, samples: PointSamples) -> VxctMaterial {
    let record = vxct_draws[draw];
    if record.kind == VXCT_OF_STRENGTHS || record.kind == VXCT_OF_EMITTER {
        return VxctMaterial(
            record.ambient * record.color,
            record.diffuse * record.color,
            record.specular * record.color,
            record.shininess,
            vec3f(record.specular),
            0.0,
            select(vec3f(0.0), record.color, record.kind == VXCT_OF_EMITTER),
        );
    }
    let color = samples.base.rgb * (1.0 - samples.metallic);
    let f0 = mix(material.dielectric_f0, samples.base.rgb, samples.metallic);
    // A lobe of exponent n is as wide as microfacets of alpha^2 = 2 / (n + 2) (Walter et al. 2007,
    // section 5.2), and reflects the share 2 s / (n + 2) of the light with the strength s.
    let alpha = alpha_from_roughness(samples.roughness);
    let is_lit = material.unlit_radiance == 0.0;
    return VxctMaterial(
        select(vec3f(0.0), AMBIENT_OF_OTHERS * color, is_lit),
        select(vec3f(0.0), color, is_lit),
        select(vec3f(0.0), min(f0 / (alpha * alpha), vec3f(1.0)), is_lit),
        clamp(2.0 / (alpha * alpha) - 2.0, 1.0, MAX_SHININESS),
        select(vec3f(0.0), f0, is_lit),
        2.0 * alpha,
        samples.emission / settings.white,
    );
}
