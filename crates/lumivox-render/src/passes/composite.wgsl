// One frame's picture, or one view of it: radiance or a quantity in rgb, and in a 1 where there is
// a surface.

import package::constants::{
    PI, VIEW_ALBEDO, VIEW_COST, VIEW_DEPTH, VIEW_DIFFUSE, VIEW_DIRECT, VIEW_DISOCCLUSION,
    VIEW_HISTORY, VIEW_INDIRECT, VIEW_NORMAL, VIEW_OCCLUSION, VIEW_SHADOW, VIEW_SPECULAR,
};
import package::environment::environment_background;
import package::temporal::record::decode_record;
import package::trace::brdf::fresnel_of_even_light;
import package::trace::coat::{below_coat, load_coat};
import package::trace::gbuffer::{
    gbuffer_diffuse, gbuffer_emission, gbuffer_specular, load_surface,
};
import package::trace::fit::fit;
import package::trace::surface::{octahedral_decode, octahedral_encode, Surface};
import package::trace::view::{position_at, ray_direction, view};

struct CompositeSettings {
    // One of VIEW_...
    shown: u32,
    // Whether cones were traced for this frame; if not, their textures contain an earlier frame's
    // light.
    has_cones: u32,
    // The sample's share in the mean of illuminances; 1 discards the old mean.
    weight: f32,
    // 1 if the G-buffer shows a further sample of the pixels, not the traced one.
    is_further: u32,
    // Offset from that sample's position in the pixel to the traced sample's, in pixels.
    to_traced: vec2f,
    padding: vec2u,
}

@group(1) @binding(0) var<storage, read> composite_settings: CompositeSettings;
// Reflected radiance in rgb; visibility of the lights in a.
@group(1) @binding(1) var direct_diffuse: texture_2d<f32>;
// Reflected radiance in rgb; illuminance in a.
@group(1) @binding(2) var direct_specular: texture_2d<f32>;
// Irradiance in rgb, openness in a.
@group(1) @binding(3) var irradiance: texture_2d<f32>;
// Reflected radiance in rgb, cone samples in a.
@group(1) @binding(4) var specular: texture_2d<f32>;
// The transmittance of coloured glass in front, in rgb; one white texel if the scene has none.
@group(1) @binding(5) var tint: texture_2d<f32>;
// The records of the surfaces; one zero texel if there are none.
@group(1) @binding(6) var records: texture_2d<u32>;
@group(1) @binding(7) var picture: texture_storage_2d<rgba32float, write>;
// The mean over frames of the illuminance at the surface; negative without a surface.
@group(1) @binding(8) var illuminance: texture_storage_2d<r32float, read_write>;

// The depth of the traced sample, and its octahedral shading normal in two 16-bit halves; stored
// for further samples.
@group(1) @binding(9) var traced_depth: texture_storage_2d<r32float, read_write>;
@group(1) @binding(10) var traced_normal: texture_storage_2d<r32uint, read_write>;

// If the weights of 3 x 3 traced samples add up to less, none of them matches: without a match, a
// weight is a ten thousandth of the proximity, and proximities add up to one.
const LEAST_MATCH: f32 = 2e-4;

// Irradiance in rgb, openness in a.
var<private> traced_irradiance: vec4f;
// Reflected radiance in rgb, cone samples in a.
var<private> traced_specular: vec4f;

// The mean light of traced samples around a pixel, weighted by proximity and by how well they match
// the surface: of 3 x 3 samples, and if none of them matches, of samples further away.
fn take_traced_around(pixel: vec2u, surface: Surface) {
    traced_irradiance = vec4f(0.0);
    traced_specular = vec4f(0.0);
    // For the background no samples are searched.
    var weights = select(1.0, 0.0, surface.depth > 0.0);
    for (var reach = 1; reach <= 16 && weights < LEAST_MATCH; reach *= 2) {
        for (var i = 0; i < 9; i++) {
            let away = reach * (vec2i(i % 3, i / 3) - 1);
            let place = clamp(vec2i(pixel) + away, vec2i(0), vec2i(view.size) - 1);
            let depth = textureLoad(traced_depth, place).r;
            if depth <= 0.0 {
                continue;
            }
            let seen = vec2f(place) + composite_settings.to_traced;
            let offset = position_at(seen + 0.5, depth) - surface.position_in_world;
            let normal = octahedral_decode(unpack2x16snorm(textureLoad(traced_normal, place).r));
            let near = max(1.0 - abs(seen - vec2f(pixel)), vec2f(0.0));
            // The floors give the plain mean if nothing matches.
            let weight = (near.x * near.y + 1e-3) * (fit(offset, normal, surface) + 1e-4);
            traced_irradiance += weight * textureLoad(irradiance, place, 0);
            traced_specular += weight * textureLoad(specular, place, 0);
            weights += weight;
        }
    }
    traced_irradiance /= max(weights, 1e-20);
    traced_specular /= max(weights, 1e-20);
}

fn take_light(pixel: vec2u, surface: Surface) {
    if composite_settings.has_cones == 0u {
        traced_irradiance = vec4f(0.0, 0.0, 0.0, 1.0);
        traced_specular = vec4f(0.0);
    } else if composite_settings.is_further != 0u {
        take_traced_around(pixel, surface);
    } else {
        traced_irradiance = textureLoad(irradiance, pixel, 0);
        traced_specular = textureLoad(specular, pixel, 0);
    }
}

fn cos_view(surface: Surface) -> f32 {
    let to_camera = normalize(view.position_in_world - surface.position_in_world);
    return saturate(dot(surface.shading_normal, to_camera));
}

fn direct_light(pixel: vec2u, surface: Surface) -> vec3f {
    return textureLoad(gbuffer_emission, pixel, 0).rgb * below_coat(load_coat(pixel), cos_view(surface))
        + textureLoad(direct_diffuse, pixel, 0).rgb
        + textureLoad(direct_specular, pixel, 0).rgb;
}

fn indirect_light(pixel: vec2u, surface: Surface) -> vec3f {
    let albedo = textureLoad(gbuffer_diffuse, pixel, 0).rgb;
    let f0 = textureLoad(gbuffer_specular, pixel, 0).rgb;
    let fresnel = fresnel_of_even_light(f0, cos_view(surface));
    let below = below_coat(load_coat(pixel), cos_view(surface));
    let diffuse = traced_irradiance.rgb * albedo / PI * (1.0 - fresnel) * below;
    return diffuse + traced_specular.rgb;
}

fn shade(pixel: vec2u, surface: Surface) -> vec3f {
    switch composite_settings.shown {
        case VIEW_DIRECT: {
            return direct_light(pixel, surface);
        }
        case VIEW_INDIRECT: {
            return indirect_light(pixel, surface);
        }
        case VIEW_DIFFUSE: {
            return traced_irradiance.rgb / PI;
        }
        case VIEW_SPECULAR: {
            return traced_specular.rgb;
        }
        case VIEW_OCCLUSION: {
            return vec3f(traced_irradiance.a);
        }
        case VIEW_SHADOW: {
            return vec3f(textureLoad(direct_diffuse, pixel, 0).a);
        }
        case VIEW_ALBEDO: {
            return textureLoad(gbuffer_diffuse, pixel, 0).rgb;
        }
        case VIEW_NORMAL: {
            return surface.shading_normal;
        }
        case VIEW_DEPTH: {
            return vec3f(distance(surface.position_in_world, view.position_in_world));
        }
        case VIEW_COST: {
            return vec3f(traced_specular.a);
        }
        case VIEW_HISTORY: {
            return vec3f(decode_record(textureLoad(records, pixel, 0).xy).frames);
        }
        case VIEW_DISOCCLUSION: {
            return vec3f(f32(decode_record(textureLoad(records, pixel, 0).xy).is_new));
        }
        default: {
            return direct_light(pixel, surface) + indirect_light(pixel, surface);
        }
    }
}

// The tint, for views that show light arriving at the camera.
fn tint_at(pixel: vec2u) -> vec3f {
    switch composite_settings.shown {
        case VIEW_DIFFUSE, VIEW_OCCLUSION, VIEW_SHADOW, VIEW_ALBEDO, VIEW_NORMAL, VIEW_DEPTH, VIEW_COST,
            VIEW_HISTORY, VIEW_DISOCCLUSION: {
            return vec3f(1.0);
        }
        default: {
            return textureLoad(tint, min(pixel, textureDimensions(tint) - 1u), 0).rgb;
        }
    }
}

// The sky is a light source, so views that include emission show it.
fn shows_environment() -> bool {
    switch composite_settings.shown {
        case VIEW_INDIRECT, VIEW_DIFFUSE, VIEW_SPECULAR, VIEW_OCCLUSION, VIEW_SHADOW,
            VIEW_ALBEDO, VIEW_NORMAL, VIEW_DEPTH, VIEW_COST, VIEW_HISTORY, VIEW_DISOCCLUSION: {
            return false;
        }
        default: {
            return true;
        }
    }
}

// The illuminance of the surface from all directions.
fn arriving(pixel: vec2u) -> f32 {
    // ITU-R BT.709-6, section 3.2.
    let indirect = dot(traced_irradiance.rgb, vec3f(0.2126, 0.7152, 0.0722));
    return textureLoad(direct_specular, pixel, 0).a + indirect;
}

fn accumulate_illuminance(pixel: vec2u, is_surface: bool) {
    let is_first = composite_settings.weight >= 1.0;
    if is_surface {
        let value = arriving(pixel);
        let old = textureLoad(illuminance, pixel).r;
        let mean = old + (value - old) * composite_settings.weight;
        textureStore(illuminance, pixel, vec4f(select(mean, value, is_first || old < 0.0)));
    } else if is_first {
        textureStore(illuminance, pixel, vec4f(-1.0));
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    take_light(pixel, surface);
    if composite_settings.is_further == 0u {
        let normal = octahedral_encode(surface.shading_normal);
        textureStore(traced_depth, pixel, vec4f(surface.depth));
        textureStore(traced_normal, pixel, vec4u(pack2x16snorm(normal)));
    }
    accumulate_illuminance(pixel, surface.depth > 0.0);
    if surface.depth > 0.0 {
        textureStore(picture, pixel, vec4f(shade(pixel, surface) * tint_at(pixel), 1.0));
    } else if shows_environment() {
        let background = environment_background(ray_direction(pixel));
        textureStore(picture, pixel, vec4f(background * tint_at(pixel), 0.0));
    } else {
        textureStore(picture, pixel, vec4f(0.0));
    }
}
