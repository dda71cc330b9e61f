// One layer of the shadow maps: the scene's depth as a light sees it, reversed z.

import package::render::draws::draws;
import package::render::material::{
    base_color_sampler, base_color_texture, material, MASK_THRESHOLD,
};

struct ShadowView {
    clip_from_world: mat4x4f,
}

@group(0) @binding(0) var<uniform> shadow_view: ShadowView;

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

struct MaskedVertex {
    @builtin(position) clip: vec4f,
    @location(0) texcoord: vec2f,
}

@vertex
fn masked_vertex(
    @location(0) position: vec3f,
    @location(1) texcoord: vec2f,
    @builtin(instance_index) draw: u32,
) -> MaskedVertex {
    return MaskedVertex(project(position, draw), texcoord);
}

@fragment
fn masked_fragment(vertex: MaskedVertex) {
    let alpha = textureSample(base_color_texture, base_color_sampler, vertex.texcoord).a;
    if alpha * material.base_color.a < MASK_THRESHOLD {
        discard;
    }
}
