// A clear coat on the surface of a pixel: a dielectric with a reflectance of 4 %
// (KHR_materials_clearcoat).
//
// It covers the share `strength` of the surface. The layer below is dimmed by the light that the
// coat reflects towards the camera, to 1 - strength * F(n . v): the extension's own approximation,
// in which light enters without loss.

import package::trace::brdf::{alpha_from_roughness, fresnel_schlick};
import package::trace::gbuffer::load_specular;
import package::trace::surface::Specular;

const COAT_F0: f32 = 0.04;

struct Coat {
    // Strength, 0 to 1; 0 for no coat.
    strength: f32,
    alpha: f32,
}

fn coat_of(specular: Specular) -> Coat {
    return Coat(specular.coat, alpha_from_roughness(specular.coat_roughness));
}

// The alpha of the narrower lobe: of the coat or of the surface below.
fn narrowest_alpha(specular: Specular) -> f32 {
    let below = alpha_from_roughness(specular.roughness);
    let coat = alpha_from_roughness(specular.coat_roughness);
    return select(below, min(below, coat), specular.coat > 0.0);
}

fn load_coat(pixel: vec2u) -> Coat {
    return coat_of(load_specular(pixel));
}

// The share of light that the coat reflects at a cosine.
fn coat_fresnel(coat: Coat, cos_theta: f32) -> f32 {
    return coat.strength * fresnel_schlick(vec3f(COAT_F0), cos_theta).x;
}

// The share of the light from below that the coat transmits towards the camera.
fn below_coat(coat: Coat, n_dot_v: f32) -> f32 {
    return 1.0 - coat_fresnel(coat, n_dot_v);
}
