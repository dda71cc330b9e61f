// One layer of the shadow maps: the scene's depth seen from a light, reversed z.

import package::constants::{TEXTURE_BASE_COLOR, TEXTURE_TRANSMISSION};
import package::render::scene::draws::draws;
import package::render::scene::material::{
    base_color_sampler, base_color_texture, material, texcoord, transmission_sampler,
    transmission_texture,
};
import package::render::passes::screen_door::{is_there, surface_seed};

struct ShadowView {
    clip_from_world: mat4x4f,
}

@group(0) @binding(0) var<uniform> shadow_view: ShadowView;

struct Vertex {
    @builtin(position) clip: vec4f,
    @location(0) texcoords: vec4f,
    @location(1) color: vec4f,
    @location(2) @interpolate(flat) draw: u32,
}

struct MaskedFragment {
    @location(0) texcoords: vec4f,
    @location(1) color: vec4f,
}

struct PartialFragment {
    @builtin(position) texel: vec4f,
    @builtin(front_facing) is_front: bool,
    @location(0) texcoords: vec4f,
    @location(1) color: vec4f,
    @location(2) @interpolate(flat) draw: u32,
}

fn project(position: vec3f, draw: u32) -> vec4f {
    return shadow_view.clip_from_world * (draws[draw].world_from_local * vec4f(position, 1.0));
}

@vertex
fn solid_vertex(
    @location(0) position: vec3f,
    @builtin(instance_index) draw: u32,
) -> @builtin(position) vec4f {
    return project(position, draw);
}

@vertex
fn plain_vertex(
    @location(0) position: vec3f,
    @location(1) texcoord: vec2f,
    @builtin(instance_index) draw: u32,
) -> Vertex {
    return Vertex(project(position, draw), texcoord.xyxy, vec4f(1.0), draw);
}

@vertex
fn colored_vertex(
    @location(0) position: vec3f,
    @location(1) texcoord: vec2f,
    @location(4) texcoord_1: vec2f,
    @location(5) color: vec4f,
    @builtin(instance_index) draw: u32,
) -> Vertex {
    return Vertex(project(position, draw), vec4f(texcoord, texcoord_1), color, draw);
}

fn base_at(texcoords: vec4f, color: vec4f) -> vec4f {
    return material.base_color * color * textureSample(
        base_color_texture, base_color_sampler, texcoord(TEXTURE_BASE_COLOR, texcoords));
}

@fragment
fn masked_fragment(fragment: MaskedFragment) {
    if base_at(fragment.texcoords, fragment.color).a < material.mask_threshold {
        discard;
    }
}

// Blocks a share of the map's texels: after filtering, the same share of the light.
//
// Light of all colours shares the map, so a tinted pane transmits the luminance of its tint. Its
// reflectance is approximated by that at normal incidence.
@fragment
fn partial_fragment(fragment: PartialFragment) {
    let base = base_at(fragment.texcoords, fragment.color);
    let transmission = textureSample(
        transmission_texture,
        transmission_sampler,
        texcoord(TEXTURE_TRANSMISSION, fragment.texcoords),
    ).r;
    let entering = 1.0 - min(material.dielectric_f0, vec3f(1.0)) * material.specular_factor;
    // ITU-R BT.709-6, section 3.2.
    let passing = dot(entering * base.rgb, vec3f(0.2126, 0.7152, 0.0722))
        * (material.transmission * transmission * (1.0 - material.metallic));
    let alpha = select(1.0, base.a, material.is_blended != 0u);
    let coverage = alpha * (1.0 - saturate(passing));
    let seed = surface_seed(fragment.draw, fragment.is_front, fragment.texel.z);
    let is_masked_out = base.a < material.mask_threshold;
    if is_masked_out || !is_there(coverage, vec2u(fragment.texel.xy), seed, 0u) {
        discard;
    }
}
