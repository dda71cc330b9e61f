// The scattering of a surface: the BRDF, and directions sampled in proportion to its lobes.
//
// Three lobes: diffuse below the gloss, gloss, and clear coat over both. The gloss is a GGX
// microfacet lobe (see package::trace::brdf) or, for Phong materials, Phong's lobe normalized for
// energy (Lafortune and Willems 1994, "Using the modified Phong reflectance model for physically
// based rendering").

import package::constants::PI;
import package::render::reference::random::{random, random_2};
import package::trace::brdf::{
    fresnel_schlick, ggx_distribution, ggx_visibility, mirrored_density, of_all_microfacets,
    sample_visible_normal,
};
import package::trace::coat::{below_coat, coat_fresnel, Coat};
import package::cones::hemisphere::basis;

// A point where a path meets a surface; normals are on the side of the incoming path.
struct Surface {
    position: vec3f,
    geometric: vec3f,
    shading: vec3f,
    // The direction that the path comes from.
    toward: vec3f,
    diffuse: vec3f,
    f0: vec3f,
    // Width of the microfacets' distribution.
    alpha: f32,
    // Exponent of a Phong lobe; 0: microfacets.
    phong_exponent: f32,
    coat: Coat,
}

struct Scattered {
    // BRDF times cosine.
    value: vec3f,
    // Density of `draw_direction`, per steradian.
    density: f32,
}

fn average(color: vec3f) -> f32 {
    return dot(color, vec3f(1.0 / 3.0));
}

fn cos_toward(surface: Surface) -> f32 {
    // Avoids grazing angles: the visibility term is 0 / 0 there.
    return max(dot(surface.shading, surface.toward), 1e-4);
}

// Reflectance of the gloss for light at a given cosine to the microfacets.
fn gloss_fresnel(surface: Surface, cosine: f32) -> vec3f {
    return select(fresnel_schlick(surface.f0, cosine), surface.f0, surface.phong_exponent > 0.0);
}

// The probabilities of the lobes: diffuse, gloss, clear coat. They sum to one, or are all zero if
// nothing is reflected.
fn lobe_shares(surface: Surface) -> vec3f {
    let cosine = cos_toward(surface);
    let below = below_coat(surface.coat, cosine);
    let gloss = average(gloss_fresnel(surface, cosine));
    // Even at grazing angles, some diffuse light leaves the surface.
    let diffuse = average(surface.diffuse) * max(1.0 - gloss, 0.1);
    let weights = vec3f(below * diffuse, below * gloss, coat_fresnel(surface.coat, cosine));
    let sum = weights.x + weights.y + weights.z;
    return select(vec3f(0.0), weights / sum, sum > 0.0);
}

fn scatter(surface: Surface, direction: vec3f) -> Scattered {
    let n_dot_l = dot(surface.shading, direction);
    // The geometric normal is tested as well: a bent normal must not receive light from behind the
    // surface.
    if n_dot_l <= 0.0 || dot(surface.geometric, direction) <= 0.0 {
        return Scattered(vec3f(0.0), 0.0);
    }
    let n_dot_v = cos_toward(surface);
    let shares = lobe_shares(surface);
    let half_vector = normalize(direction + surface.toward);
    let n_dot_h = saturate(dot(surface.shading, half_vector));
    let h_dot_v = dot(half_vector, surface.toward);
    let fresnel = gloss_fresnel(surface, h_dot_v);
    let below = below_coat(surface.coat, n_dot_v);

    let diffuse = below * (1.0 - fresnel) * surface.diffuse / PI;
    var gloss: vec3f;
    var gloss_density: f32;
    if surface.phong_exponent > 0.0 {
        let mirrored = reflect(-surface.toward, surface.shading);
        let lobe = pow(max(dot(mirrored, direction), 0.0), surface.phong_exponent) / (2.0 * PI);
        gloss = below * fresnel * (surface.phong_exponent + 2.0) * lobe;
        gloss_density = (surface.phong_exponent + 1.0) * lobe;
    } else {
        gloss = below * fresnel * ggx_distribution(n_dot_h, surface.alpha)
            * ggx_visibility(n_dot_v, n_dot_l, surface.alpha)
            * of_all_microfacets(surface.f0, n_dot_v, surface.alpha);
        gloss_density = mirrored_density(n_dot_v, n_dot_h, surface.alpha);
    }
    let varnish = coat_fresnel(surface.coat, h_dot_v) * ggx_distribution(n_dot_h, surface.coat.alpha)
        * ggx_visibility(n_dot_v, n_dot_l, surface.coat.alpha);
    let varnish_density = mirrored_density(n_dot_v, n_dot_h, surface.coat.alpha);
    let densities = vec3f(n_dot_l / PI, gloss_density, varnish_density);
    return Scattered((diffuse + gloss + varnish) * n_dot_l, dot(shares, densities));
}

// A direction with the density that `scatter` returns; it may point below the surface, where
// `scatter` returns zero.
fn draw_direction(surface: Surface) -> vec3f {
    let shares = lobe_shares(surface);
    let choice = random();
    let place = random_2();
    let is_gloss = choice >= shares.x && choice < shares.x + shares.y;
    let world_from_normal = basis(surface.shading);
    // Malley's method: uniform on the disc is cosine-weighted on the hemisphere (Pharr, Jakob and
    // Humphreys 2016, 13.6.3).
    let radius = sqrt(place.x);
    let turn = 2.0 * PI * place.y;
    let disc = vec2f(cos(turn), sin(turn));
    if choice < shares.x {
        return world_from_normal * vec3f(radius * disc, sqrt(1.0 - place.x));
    }
    if is_gloss && surface.phong_exponent > 0.0 {
        let cosine = pow(place.x, 1.0 / (surface.phong_exponent + 1.0));
        let sine = sqrt(max(1.0 - cosine * cosine, 0.0));
        return basis(reflect(-surface.toward, surface.shading)) * vec3f(sine * disc, cosine);
    }
    var view = surface.toward * world_from_normal;
    view.z = max(view.z, 1e-4);
    view = normalize(view);
    let alpha = select(surface.coat.alpha, surface.alpha, is_gloss);
    return world_from_normal * reflect(-view, sample_visible_normal(view, alpha, place));
}
