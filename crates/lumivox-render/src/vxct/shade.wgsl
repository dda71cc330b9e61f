// One frame's picture in the look of VXCT, or one view of it: Phong's light, shadows, reflections and diffuse light by
// cones, all in one kernel (the cones are in leaving.wgsl).
//
// The picture is emission, plus for each light (Phong + specular) (1 - occlusion), plus diffuse (1 - the least
// occlusion). Lights that are not VXCT's own shade Phong's terms alone: what the cones bring does not come from there.

import package::constants::{
    VIEW_ALBEDO, VIEW_COST, VIEW_DEPTH, VIEW_DIFFUSE, VIEW_DIRECT, VIEW_FINAL, VIEW_INDIRECT,
    VIEW_NORMAL, VIEW_OCCLUSION, VIEW_SHADOW, VIEW_SPECULAR, VXCT_ALL, VXCT_DIFFUSE, VXCT_PHONG,
    VXCT_SHADOWS, VXCT_SPECULAR, VXCT_TERM_AMBIENT, VXCT_TERM_DIFFUSE, VXCT_TERM_DIFFUSE_CONES,
    VXCT_TERM_HIGHLIGHTS, VXCT_TERM_OCCLUSION_CONES, VXCT_TERM_SPECULAR_CONES,
};
import package::light::environment::environment_background;
import package::light::lights::{light_globals, lights};
import package::render::vxct::leaving::{
    diffuse_cones, occlusion_cone, specular_cone, DiffuseCones, Reflection,
};
import package::render::vxct::lights::arriving_light;
import package::render::vxct::material::{load_material, reflectance_towards, VxctMaterial};
import package::render::vxct::uniform::{has, settings};
import package::trace::gbuffer::{load_surface, ray_direction, view, Surface};

// What coloured glass in front lets through, in rgb; one white texel where the scene has none.
@group(1) @binding(2) var tint: texture_2d<f32>;
@group(1) @binding(3) var picture: texture_storage_2d<rgba32float, write>;

fn luminance(color: vec3f) -> f32 {
    // ITU-R BT.709-6, section 3.2.
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

struct Lit {
    phong: vec3f,
    // What the specular cone's light is multiplied by, over all lights.
    reflected_share: f32,
    least_occlusion: f32,
    // The share of the lights' light that arrives.
    visibility: f32,
    samples: u32,
}

fn lit_by_all(surface: Surface, material: VxctMaterial, to_camera: vec3f) -> Lit {
    let normal = surface.shading_normal;
    var lit = Lit(vec3f(0.0), 0.0, 1.0, 1.0, 0u);
    var vxct_lights = 0u;
    var sent = 0.0;
    var arrived = 0.0;
    for (var index = 0u; index < light_globals.light_count; index++) {
        let arriving = arriving_light(index, surface.position_in_world);
        let brightness = luminance(arriving.radiance);
        if brightness <= 0.0 {
            continue;
        }
        let n_dot_l = dot(normal, arriving.direction);
        // What faces away is dark by its cosine; nothing else needs to shade it.
        let faces = n_dot_l > 0.0 && dot(surface.geometric_normal, arriving.direction) > 0.0;
        var occlusion = 0.0;
        if faces && has(VXCT_TERM_OCCLUSION_CONES) {
            let light = lights[index];
            let is_parallel = arriving.distance_m > 1e30;
            let radius_m = select(light.radius, 0.0, is_parallel);
            let traced = occlusion_cone(
                surface, arriving.direction, arriving.distance_m, radius_m, is_parallel);
            occlusion = 1.0 - traced.transmittance;
            lit.samples += traced.samples;
        }
        var shown = vec3f(0.0);
        if has(VXCT_TERM_AMBIENT) {
            shown += material.albedo * material.ambient;
        }
        if faces && has(VXCT_TERM_DIFFUSE) {
            shown += material.albedo * n_dot_l;
        }
        if faces && has(VXCT_TERM_HIGHLIGHTS) {
            let mirrored = reflect(-arriving.direction, normal);
            let cosine = max(dot(mirrored, to_camera), 0.0);
            shown += material.specular * pow(max(cosine, 1e-6), material.shininess);
        }
        lit.phong += shown * arriving.radiance * (1.0 - occlusion);
        vxct_lights += u32(arriving.is_vxct);
        lit.reflected_share += select(0.0, 1.0 - occlusion, arriving.is_vxct);
        lit.least_occlusion = min(lit.least_occlusion, select(1.0, occlusion, arriving.is_vxct));
        sent += brightness;
        arrived += select(0.0, brightness * (1.0 - occlusion), faces);
    }
    lit.least_occlusion = select(0.0, lit.least_occlusion, vxct_lights > 0u);
    lit.reflected_share = select(1.0, lit.reflected_share, vxct_lights > 0u);
    lit.visibility = select(1.0, arrived / sent, sent > 0.0);
    return lit;
}

fn is_light(shown: u32) -> bool {
    return shown == VIEW_FINAL || shown == VIEW_DIRECT || shown == VIEW_INDIRECT
        || shown == VIEW_SPECULAR;
}

fn shade(pixel: vec2u, surface: Surface) -> vec3f {
    let material = load_material(pixel);
    let shown = settings.shown;
    switch shown {
        case VIEW_ALBEDO: {
            return material.albedo;
        }
        case VIEW_NORMAL: {
            return surface.shading_normal;
        }
        case VIEW_DEPTH: {
            return vec3f(distance(surface.position_in_world, view.position_in_world));
        }
        default: {}
    }
    let to_camera = normalize(view.position_in_world - surface.position_in_world);
    let components = settings.components;
    let is_all = shown == VIEW_COST
        || (shown == VIEW_FINAL && components == VXCT_ALL) || shown == VIEW_INDIRECT;

    var lit = Lit(vec3f(0.0), 1.0, 0.0, 1.0, 0u);
    if is_light(shown) || shown == VIEW_SHADOW || shown == VIEW_COST {
        lit = lit_by_all(surface, material, to_camera);
    }
    var reflection = Reflection(vec3f(0.0), 0u);
    let wants_reflection = is_all || shown == VIEW_SPECULAR
        || (shown == VIEW_FINAL && components == VXCT_SPECULAR);
    let reflectance = reflectance_towards(material, dot(surface.shading_normal, to_camera));
    if wants_reflection && has(VXCT_TERM_SPECULAR_CONES) && any(reflectance > vec3f(0.0)) {
        reflection = specular_cone(surface, material, to_camera);
    }
    var gathered = DiffuseCones(vec3f(0.0), 1.0, 0u);
    let wants_diffuse = is_all || shown == VIEW_DIFFUSE || shown == VIEW_OCCLUSION
        || (shown == VIEW_FINAL && components == VXCT_DIFFUSE);
    if wants_diffuse && has(VXCT_TERM_DIFFUSE_CONES) {
        gathered = diffuse_cones(surface);
    }

    let direct = material.emission + lit.phong;
    let specular = reflectance * reflection.radiance * lit.reflected_share;
    let diffuse = material.albedo * gathered.radiance * (1.0 - lit.least_occlusion);
    switch shown {
        case VIEW_DIRECT: {
            return direct;
        }
        case VIEW_INDIRECT: {
            return specular + diffuse;
        }
        case VIEW_DIFFUSE: {
            return gathered.radiance;
        }
        case VIEW_SPECULAR: {
            return specular;
        }
        case VIEW_OCCLUSION: {
            return vec3f(gathered.openness);
        }
        case VIEW_SHADOW: {
            return vec3f(lit.visibility);
        }
        case VIEW_COST: {
            return vec3f(f32(lit.samples + reflection.samples + gathered.samples));
        }
        default: {}
    }
    switch components {
        case VXCT_PHONG: {
            return direct;
        }
        case VXCT_SHADOWS: {
            return vec3f(lit.visibility * settings.white);
        }
        case VXCT_SPECULAR: {
            return specular;
        }
        case VXCT_DIFFUSE: {
            return diffuse;
        }
        default: {
            return direct + specular + diffuse;
        }
    }
}

// Whether what is seen is light that comes to the camera, which panes in front of it tint.
fn is_tinted() -> bool {
    return is_light(settings.shown)
        && !(settings.shown == VIEW_FINAL && settings.components == VXCT_SHADOWS);
}

// The sky is seen wherever emission is.
fn shows_environment() -> bool {
    let is_whole = settings.components == VXCT_ALL || settings.components == VXCT_PHONG;
    return settings.shown == VIEW_DIRECT || (settings.shown == VIEW_FINAL && is_whole);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    var color = vec4f(0.0);
    let surface = load_surface(pixel);
    if surface.depth > 0.0 {
        color = vec4f(shade(pixel, surface), 1.0);
    } else if shows_environment() {
        color = vec4f(environment_background(ray_direction(pixel)), 0.0);
    }
    let glass = textureLoad(tint, min(pixel, textureDimensions(tint) - 1u), 0).rgb;
    color = vec4f(color.rgb * select(vec3f(1.0), glass, vec3<bool>(is_tinted())), color.a);
    textureStore(picture, pixel, color);
}
