// The glossy lobe of a surface, and directions drawn from it. Vectors are in the frame whose z is
// the normal.

import package::cones::model::glossy_half_vector;
import package::trace::brdf::{
    fresnel_schlick, ggx_masking, ggx_visibility, mirrored_density, sample_visible_normal,
};
import package::trace::coat::{coat_fresnel, Coat};
import package::trace::screen::settings;

struct Lobe {
    // The unit vector to the camera.
    view: vec3f,
    alpha: f32,
    is_coat: bool,
    reflectance: vec3f,
    coat: Coat,
    // The share of light from below that the coat transmits, and the probability of drawing the
    // coat.
    below: f32,
    coat_share: f32,
}

fn fresnel_of(lobe: Lobe, cosine: f32) -> vec3f {
    if lobe.is_coat {
        return vec3f(coat_fresnel(lobe.coat, cosine) / lobe.coat_share);
    }
    return fresnel_schlick(lobe.reflectance, cosine) * (lobe.below / (1.0 - lobe.coat_share));
}

struct Drawn {
    // To the light.
    direction: vec3f,
    // Per steradian.
    density: f32,
    // The share of the light from there that is reflected, divided by the density: F G2 / G1.
    weight: vec3f,
}

// Draws from the distribution of visible normals.
fn draw_direction(lobe: Lobe, numbers: vec2f) -> Drawn {
    let half_vector =
        glossy_half_vector(sample_visible_normal(lobe.view, lobe.alpha, numbers), settings.cones.model_values);
    let direction = reflect(-lobe.view, half_vector);
    let both = ggx_visibility(lobe.view.z, direction.z, lobe.alpha) * 4.0 * lobe.view.z * direction.z;
    let weight = fresnel_of(lobe, dot(lobe.view, half_vector)) * (both / ggx_masking(lobe.view.z, lobe.alpha));
    return Drawn(
        direction,
        mirrored_density(lobe.view.z, half_vector.z, lobe.alpha),
        select(vec3f(0.0), weight, direction.z > 0.0),
    );
}
