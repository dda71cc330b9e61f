// The microfacet BRDF: Trowbridge-Reitz (GGX) distribution, height-correlated Smith masking and
// shadowing, Schlick's Fresnel term. alpha is the square of the perceptual roughness (Burley 2012,
// section 5.4).

import package::constants::PI;

// Minimum alpha: below it f32 cannot represent the distribution's peak.
const MIN_ALPHA: f32 = 0.001;

fn alpha_from_roughness(perceptual_roughness: f32) -> f32 {
    return max(perceptual_roughness * perceptual_roughness, MIN_ALPHA);
}

// Schlick 1994. The reflectance at grazing angles, f90, is 1, and fades to 0 for an F0 below 2 %,
// less than that of any real dielectric (Lagarde and de Rousiers 2014, section 3.1.3): F0 = 0
// disables reflection.
fn fresnel_schlick(f0: vec3f, cos_theta: f32) -> vec3f {
    let f90 = saturate(dot(f0, vec3f(50.0 * 0.33)));
    let rest = saturate(1.0 - cos_theta);
    let rest_2 = rest * rest;
    return f0 + (vec3f(f90) - f0) * (rest_2 * rest_2 * rest);
}

// Mean of fresnel_schlick at the half vectors to a camera, over uniform light from the hemisphere,
// weighted by its cosine. The polynomial is fitted to numeric integrals of (1 - cosine)^5, within
// 0.00001.
fn fresnel_of_even_light(f0: vec3f, n_dot_v: f32) -> vec3f {
    let f90 = saturate(dot(f0, vec3f(50.0 * 0.33)));
    let x = 1.0 - saturate(n_dot_v);
    let mean = (((0.00901218 * x + 0.00769301) * x + 0.00936738) * x + 0.00200958) * x + 0.0000827514;
    return f0 + (vec3f(f90) - f0) * mean;
}

// Walter et al. 2007, equation 33.
fn ggx_distribution(n_dot_h: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let d = n_dot_h * n_dot_h * (a2 - 1.0) + 1.0;
    return a2 / (PI * d * d);
}

// G2 / (4 n.v n.l): Heitz 2014, equation 99.
fn ggx_visibility(n_dot_v: f32, n_dot_l: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let view = n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - a2) + a2);
    let light = n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - a2) + a2);
    return 0.5 / max(view + light, 1e-7);
}

// G1 of one direction: Heitz 2014, equations 43 and 72.
fn ggx_masking(n_dot_v: f32, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    return 2.0 * n_dot_v / (n_dot_v + sqrt(a2 + (1.0 - a2) * n_dot_v * n_dot_v));
}

// The share of even light that a surface with a Fresnel term of 1 loses, since light that meets a
// second microfacet is not followed. A polynomial in the roughness and the root of the cosine,
// fitted from below to numeric integrals of G2 / G1 over visible normals. A surface that regains it
// reflects 97 to 100 % for cosines above 0.3, and at least 89 %.
fn lost_in_microfacets(n_dot_v: f32, alpha: f32) -> f32 {
    let r = sqrt(alpha);
    let s = sqrt(n_dot_v);
    let powers = vec4f(1.0, s, n_dot_v, n_dot_v * s);
    return saturate(r * (dot(vec4f(0.0527, -0.239, -1.255, 1.4782), powers)
        + r * (dot(vec4f(-2.0794, 17.0211, -21.7604, 5.5204), powers)
        + r * (dot(vec4f(3.7227, -32.5647, 52.1889, -19.0986), powers)
        + r * dot(vec4f(-1.8146, 17.1002, -29.7901, 12.2108), powers)))));
}

// The factor of the gloss that adds the light of further microfacets: Turquin 2019, "Practical
// multiple scattering compensation for microfacet models", equation 15. A white metal reflects all
// light.
fn of_all_microfacets(f0: vec3f, n_dot_v: f32, alpha: f32) -> vec3f {
    let lost = lost_in_microfacets(n_dot_v, alpha);
    return 1.0 + f0 * (lost / (1.0 - lost));
}

// Density, 1/sr, of a direction reflected at a visible normal.
fn mirrored_density(n_dot_v: f32, n_dot_h: f32, alpha: f32) -> f32 {
    return ggx_masking(n_dot_v, alpha) * ggx_distribution(n_dot_h, alpha) / (4.0 * n_dot_v);
}

// A half vector from the distribution of visible normals, in the frame whose z is the normal: Dupuy
// and Benyoub 2023, "Sampling visible GGX normals with spherical caps", listing 3.
fn sample_visible_normal(view: vec3f, alpha: f32, random: vec2f) -> vec3f {
    let stretched = normalize(vec3f(view.xy * alpha, view.z));
    let phi = 6.28318530718 * random.x;
    let z = (1.0 - random.y) * (1.0 + stretched.z) - stretched.z;
    let sine = sqrt(saturate(1.0 - z * z));
    let half_vector = vec3f(sine * cos(phi), sine * sin(phi), z) + stretched;
    return normalize(vec3f(half_vector.xy * alpha, max(half_vector.z, 0.0)));
}
