// A pixel's material in Phong's terms.

import package::trace::brdf::alpha_from_roughness;
import package::trace::gbuffer::{gbuffer_diffuse, gbuffer_emission, gbuffer_specular};

struct VxctMaterial {
    albedo: vec3f,
    emission: vec3f,
    ambient: f32,
    // The highlight's strength in its middle, at most 1.
    specular: vec3f,
    shininess: f32,
    // Reflectance at normal incidence.
    f0: vec3f,
    roughness: f32,
    // The width of the microfacets' distribution.
    alpha: f32,
    // Diameter per distance of a cone as wide as the lobe; 0: VXCT's own.
    lobe_width: f32,
    // Whether it is one that VXCT could have made.
    is_vxct: bool,
}

// Highlights sharper than this would be missed between pixels.
const MAX_SHININESS: f32 = 4096.0;

// A lobe reflects the share rho = 2 s / (n + 2) of the light, with the strength s and the exponent n; its width is that of
// microfacets of alpha^2 = 2 / (n + 2) (Walter et al. 2007, section 5.2). So s = rho / alpha^2. It has to be found again
// from 8 bits each, so it may come out a little above 1.
const LARGEST_STRENGTH: f32 = 1.1;

fn load_material(pixel: vec2u) -> VxctMaterial {
    let diffuse = textureLoad(gbuffer_diffuse, pixel, 0);
    let specular = textureLoad(gbuffer_specular, pixel, 0);
    let emission = textureLoad(gbuffer_emission, pixel, 0);
    let alpha = alpha_from_roughness(specular.a);
    let strength = specular.rgb / (alpha * alpha);
    let is_phong = emission.a < 0.0;
    let is_vxct = is_phong && all(strength <= vec3f(LARGEST_STRENGTH));
    return VxctMaterial(
        diffuse.rgb,
        emission.rgb,
        select(0.0, -emission.a, is_phong),
        min(strength, vec3f(1.0)),
        clamp(2.0 / (alpha * alpha) - 2.0, 1.0, MAX_SHININESS),
        specular.rgb,
        specular.a,
        alpha,
        select(2.0 * alpha, 0.0, is_vxct),
        is_vxct,
    );
}

// What a specular cone's light is multiplied by. VXCT's materials reflect with their strength; for others it is Schlick's
// term, less at grazing angles the rougher they are (Lagarde 2011, "Adopting a physically based shading model").
fn reflectance_towards(material: VxctMaterial, cos_view: f32) -> vec3f {
    let rest = saturate(1.0 - cos_view);
    let rest_2 = rest * rest;
    // Below 2 % it is switched off as a whole (package::trace::brdf).
    let most = (1.0 - material.roughness) * saturate(dot(material.f0, vec3f(50.0 * 0.33)));
    let schlick = material.f0
        + max(vec3f(most) - material.f0, vec3f(0.0)) * (rest_2 * rest_2 * rest);
    return select(schlick, material.specular, vec3<bool>(material.is_vxct));
}
