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
    // The factor of the surface below the coat: the share of its light that the coat transmits, and
    // the light of further microfacets.
    below: vec3f,
    // The probability of drawing the coat.
    coat_share: f32,
}

fn fresnel_of(lobe: Lobe, cosine: f32) -> vec3f {
    if lobe.is_coat {
        return vec3f(coat_fresnel(lobe.coat, cosine) / lobe.coat_share);
    }
    return fresnel_schlick(lobe.reflectance, cosine) * (lobe.below / (1.0 - lobe.coat_share));
}

struct Drawn {
    // The unit vector to the light.
    direction: vec3f,
    // The density, 1/sr.
    density: f32,
    // The reflected share of light from the direction, divided by the density: F G2 / G1.
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

// A frame draws GRID x GRID directions.
const GRID: u32 = 4u;
const DRAWS: u32 = GRID * GRID;

// The place in a column of the grid; odd columns run backwards.
fn wind(place: u32, column: u32) -> u32 {
    return select(place, GRID - 1u - place, (column & 1u) != 0u);
}

// Direction `place` of DRAWS, each drawn from its own cell of a grid of random numbers, all at the
// place of `numbers` in its cell. The order of the grid is a winding line, so that consecutive
// directions are near each other.
fn draw_in_grid(lobe: Lobe, numbers: vec2f, place: u32) -> Drawn {
    let within = fract(numbers * f32(GRID));
    let column = place / GRID;
    let row = wind(place % GRID, column);
    // Every other column is mirrored, so that the errors of two columns cancel.
    let is_mirrored = ((column ^ u32(numbers.x * f32(GRID))) & 1u) != 0u;
    let up = select(within.y, 1.0 - within.y, is_mirrored);
    return draw_direction(lobe, vec2f(f32(column) + within.x, f32(row) + up) / f32(GRID));
}
