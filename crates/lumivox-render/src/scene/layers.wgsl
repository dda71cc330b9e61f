// The layers on top of plain materials: a varying reflectance, clear coat, sheen, glass, and
// coverage by alpha. They are combined into a plain surface with a coat; the surface exists with
// some probability.

import package::trace::brdf::fresnel_schlick;

// The values of the layers' textures, multiplied by their factors.
struct LayerSamples {
    dielectric_f0: vec3f,
    coat_strength: f32,
    coat_roughness: f32,
    sheen_color: vec3f,
    sheen_roughness: f32,
    transmission: f32,
    // The directional albedo towards the viewer of white sheen with this roughness (sheen.rs).
    velvet_albedo: f32,
    // The covered share.
    alpha: f32,
    // 0: unlit.
    lit: f32,
}

// The light that a layered surface sends to the camera, in the parameters of plain materials.
struct Layered {
    diffuse: vec3f,
    f0: vec3f,
    emission: vec3f,
    coat_strength: f32,
    coat_roughness: f32,
    // The probability that the surface exists.
    coverage: f32,
    // The colour of the light that passes if the surface does not exist.
    tint: vec3f,
}

fn mean(color: vec3f) -> f32 {
    return dot(color, vec3f(1.0 / 3.0));
}

fn largest(color: vec3f) -> f32 {
    return max(color.r, max(color.g, color.b));
}

// The share of light that enters a thin pane and passes through it, in the colour channel with the
// largest share.
//
// KHR_materials_transmission: of the light that is not reflected at the surface, the share t passes
// through, tinted by the base colour, instead of being reflected diffusely.
fn passing(base: vec3f, transmission: f32, reflected: f32) -> f32 {
    return clamp((1.0 - reflected) * transmission * largest(base), 0.0, 1.0);
}

fn shade_layers(
    samples: LayerSamples,
    base: vec3f,
    metallic: f32,
    emission: vec3f,
    cos_view: f32,
) -> Layered {
    // Sheen is treated as a diffuse layer that is as bright as it looks to the viewer in uniform
    // light; it dims the surface below (KHR_materials_sheen).
    let velvet = samples.sheen_color * samples.velvet_albedo;
    let below_velvet = 1.0 - largest(velvet);
    let f0 = mix(samples.dielectric_f0, base, metallic) * below_velvet;
    var diffuse = base * ((1.0 - metallic) * samples.lit * below_velvet) + velvet;

    // A pane is drawn or not. With the probability (1 - F) t b it is not drawn, and the objects
    // behind are seen tinted by base / b, where b is the largest component of the base colour.
    // Otherwise the pane is seen, and its reflected light is divided by the probability p = 1 - (1
    // - F) t b. So Schlick's term has to become F / p, and the diffuse albedo base (1 - t) (1 - F)
    // / (p (1 - F / p)) = base (1 - t) / (1 - t b).
    let transmission = samples.transmission * (1.0 - metallic);
    let fresnel = fresnel_schlick(f0, cos_view);
    let pane = 1.0 - passing(base, transmission, mean(fresnel));
    diffuse *= (1.0 - transmission) / max(1.0 - transmission * largest(base), 1e-4);
    let rest = 1.0 - cos_view;
    let rest_5 = rest * rest * rest * rest * rest;
    let pane_f0 = saturate((fresnel / max(pane, 1e-4) - rest_5) / max(1.0 - rest_5, 1e-4));
    let is_pane = transmission > 0.0;

    // If the surface does not exist, holes let light through unchanged, and panes tint it.
    let alpha = samples.alpha;
    let coverage = alpha * pane;
    let glass = base / max(largest(base), 1e-6);
    let tint = (1.0 - alpha + alpha * (1.0 - pane) * glass) / max(1.0 - coverage, 1e-6);

    // The coat of a pane is divided by p, too. Light is lost only if it would exceed a full coat,
    // on coated glass.
    return Layered(
        min(diffuse, vec3f(1.0)),
        select(f0, pane_f0, is_pane),
        emission / max(pane, 1e-3),
        min(samples.coat_strength / max(pane, 1e-3), 1.0),
        samples.coat_roughness,
        coverage,
        select(vec3f(1.0), tint, coverage < 1.0),
    );
}
