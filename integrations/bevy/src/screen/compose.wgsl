// Adds the light of the cones to Bevy's picture.

import package::constants::PI;
import package::trace::brdf::fresnel_of_even_light;
import package::trace::coat::{below_coat, load_coat};
import package::trace::gbuffer::{load_albedo, load_specular, load_surface, place};
import package::trace::view::view;

struct ComposeSettings {
    // From Lumivox's unit of radiance to the values of the picture.
    picture_from_radiance: f32,
    padding_0: f32,
    padding_1: f32,
    padding_2: f32,
}

@group(1) @binding(0) var<uniform> compose_settings: ComposeSettings;
// Irradiance in rgb.
@group(1) @binding(1) var irradiance: texture_2d<f32>;
// Reflected radiance in rgb.
@group(1) @binding(2) var specular: texture_2d<f32>;

// One triangle over the whole viewport.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(vec2u(index & 1u, index >> 1u));
    return vec4f(4.0 * corner - 1.0, 0.0, 1.0);
}

@fragment
fn add(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy) - place.origin;
    let surface = load_surface(pixel);
    if any(pixel >= view.size) || surface.depth <= 0.0 {
        return vec4f(0.0);
    }
    let to_camera = normalize(view.position_in_world - surface.position_in_world);
    let cosine = saturate(dot(surface.shading_normal, to_camera));
    let albedo = load_albedo(pixel);
    let enters = 1.0 - fresnel_of_even_light(load_specular(pixel).reflectance, cosine);
    let below = below_coat(load_coat(pixel), cosine);
    let gathered = textureLoad(irradiance, pixel, 0).rgb * albedo.rgb / PI * enters * below * albedo.a;
    let mirrored = textureLoad(specular, pixel, 0).rgb;
    return vec4f((gathered + mirrored) * compose_settings.picture_from_radiance, 0.0);
}
