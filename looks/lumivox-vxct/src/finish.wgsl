// Turns drawn fragments into the picture: adds the background, and converts display values to
// radiance.

import package::constants::{
    VIEW_DIFFUSE, VIEW_DIRECT, VIEW_FINAL, VIEW_INDIRECT, VIEW_LOD, VIEW_SPECULAR,
};
import package::environment::environment_background;
import package::vxct::uniform::settings;
import package::trace::view::{ray_direction, view};

// Premultiplied by the coverage in alpha.
@group(1) @binding(0) var drawn: texture_2d<f32>;
@group(1) @binding(1) var picture: texture_storage_2d<rgba32float, write>;

// The background, as a share of white.
fn background(pixel: vec2u) -> vec3f {
    if settings.has_environment != 0u {
        return environment_background(ray_direction(pixel)) / settings.white;
    }
    return settings.background;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let shown = settings.shown;
    let seen = textureLoad(drawn, pixel, 0);
    let is_light = shown == VIEW_FINAL || shown == VIEW_DIRECT || shown == VIEW_INDIRECT
        || shown == VIEW_DIFFUSE || shown == VIEW_SPECULAR || shown == VIEW_LOD;
    var color = seen.rgb;
    if is_light {
        color = (color + (1.0 - seen.a) * background(pixel)) * settings.white;
    }
    textureStore(picture, pixel, vec4f(color, ceil(seen.a)));
}
