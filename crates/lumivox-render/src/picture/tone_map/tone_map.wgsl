// From radiance or data to the screen's 8 bits a channel. It does not use the grid: its own
// bindings are in group 0.

import package::constants::{
    ENCODE_COLOR, ENCODE_HEAT, ENCODE_LOG_HEAT, TONE_MAP_ACES, TONE_MAP_NEUTRAL, TONE_MAP_RAW,
};

struct ToneMapSettings {
    // ENCODE_COLOR, ENCODE_DATA, ENCODE_HEAT or ENCODE_LOG_HEAT.
    encoding: u32,
    // For ENCODE_COLOR: one of TONE_MAP_...
    curve: u32,
    // Multiplies the colour or the data.
    scale: f32,
    // For ENCODE_DATA: added where there is a surface.
    offset: f32,
}

@group(0) @binding(0) var<uniform> tone_map_settings: ToneMapSettings;
@group(0) @binding(1) var picture: texture_2d<f32>;
@group(0) @binding(2) var screen: texture_storage_2d<rgba8unorm, write>;

// Khronos 2024, "Khronos PBR Neutral Tone Mapper", section "Implementation".
fn neutral(linear: vec3f) -> vec3f {
    let start_compression = 0.8 - 0.04;
    let desaturation = 0.15;
    let least = min(linear.r, min(linear.g, linear.b));
    let fresnel = select(0.04, least - 6.25 * least * least, least < 0.08);
    let color = linear - fresnel;
    let peak = max(color.r, max(color.g, color.b));
    if peak < start_compression {
        return color;
    }
    let headroom = 1.0 - start_compression;
    let new_peak = 1.0 - headroom * headroom / (peak + headroom - start_compression);
    let white = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(color * (new_peak / peak), vec3f(new_peak), white);
}

// Narkowicz 2015, "ACES filmic tone mapping curve".
fn aces(color: vec3f) -> vec3f {
    return color * (2.51 * color + 0.03) / (color * (2.43 * color + 0.59) + 0.14);
}

// IEC 61966-2-1:1999, section 5.2.
fn srgb_encode(linear: vec3f) -> vec3f {
    let bounded = saturate(linear);
    let curve = 1.055 * pow(bounded, vec3f(1.0 / 2.4)) - 0.055;
    return select(curve, 12.92 * bounded, bounded <= vec3f(0.0031308));
}

// The colour map viridis (van der Walt and Smith 2015), as the polynomial of degree 6 that Zucker
// fitted to it (2019); encoded for the screen.
fn viridis(x: f32) -> vec3f {
    let c0 = vec3f(0.2777273, 0.0054073, 0.3340998);
    let c1 = vec3f(0.1050930, 1.4046135, 1.3845902);
    let c2 = vec3f(-0.3308618, 0.2148476, 0.0950952);
    let c3 = vec3f(-4.6342305, -5.7991010, -19.3324410);
    let c4 = vec3f(6.2282699, 14.1799334, 56.6905526);
    let c5 = vec3f(4.7763850, -13.7451454, -65.3530326);
    let c6 = vec3f(-5.4354559, 4.6458526, 26.3124352);
    return c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * (c5 + x * c6)))));
}

fn encode(value: vec4f) -> vec3f {
    switch tone_map_settings.encoding {
        case ENCODE_COLOR: {
            let color = max(value.rgb * tone_map_settings.scale, vec3f(0.0));
            if tone_map_settings.curve == TONE_MAP_NEUTRAL {
                return srgb_encode(neutral(color));
            }
            if tone_map_settings.curve == TONE_MAP_ACES {
                return srgb_encode(aces(color));
            }
            if tone_map_settings.curve == TONE_MAP_RAW {
                return color;
            }
            return srgb_encode(color);
        }
        case ENCODE_HEAT: {
            return viridis(saturate(value.r * tone_map_settings.scale));
        }
        case ENCODE_LOG_HEAT: {
            return viridis(saturate(log2(1.0 + value.r) * tone_map_settings.scale));
        }
        default: {
            return tone_map_settings.scale * value.rgb + tone_map_settings.offset * value.a;
        }
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= textureDimensions(picture)) {
        return;
    }
    let value = textureLoad(picture, pixel, 0);
    textureStore(screen, pixel, vec4f(saturate(encode(value)), 1.0));
}
