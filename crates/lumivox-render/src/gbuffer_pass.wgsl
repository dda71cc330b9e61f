// The G-buffer: what package::trace::gbuffer declares, rasterized.

import package::render::draws::draws;
import package::render::material::{
    base_color_sampler, base_color_texture, emission_sampler, emission_texture, material,
    metallic_roughness_sampler, metallic_roughness_texture, normal_sampler, normal_texture,
    MASK_THRESHOLD,
};
import package::trace::gbuffer::octahedral_encode;

struct RasterView {
    clip_from_world: mat4x4f,
    position_in_world: vec3f,
    padding: u32,
}

@group(0) @binding(0) var<uniform> raster_view: RasterView;

struct Vertex {
    @builtin(position) clip: vec4f,
    // From the camera, not from the origin: f32 then resolves the small steps between near pixels, whose
    // derivatives the geometric normal comes from.
    @location(0) from_camera: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) texcoord: vec2f,
}

struct Targets {
    @location(0) normals: vec4f,
    @location(1) diffuse: vec4f,
    @location(2) specular: vec4f,
    @location(3) emission: vec4f,
}

@vertex
fn vertex_main(
    @location(0) position: vec3f,
    @location(1) texcoord: vec2f,
    @location(2) normal: vec3f,
    @location(3) tangent: vec4f,
    @builtin(instance_index) draw: u32,
) -> Vertex {
    let world = draws[draw].world_from_local * vec4f(position, 1.0);
    return Vertex(
        raster_view.clip_from_world * world,
        world.xyz - raster_view.position_in_world,
        (draws[draw].normal_from_local * vec4f(normal, 0.0)).xyz,
        vec4f((draws[draw].world_from_local * vec4f(tangent.xyz, 0.0)).xyz, tangent.w),
        texcoord,
    );
}

// The vertex normal, bent by the normal texture if there is one.
fn mapped_normal(vertex: Vertex, sampled: vec3f) -> vec3f {
    let normal = normalize(vertex.normal);
    if material.has_normal_texture == 0u {
        return normal;
    }
    let local = (2.0 * sampled - 1.0) * vec3f(material.normal_scale, material.normal_scale, 1.0);
    // glTF 2.0, section 3.7.2.1; the interpolated tangent is made orthogonal to the normal again.
    let tangent = normalize(vertex.tangent.xyz - normal * dot(normal, vertex.tangent.xyz));
    let bitangent = vertex.tangent.w * cross(normal, tangent);
    return normalize(local.x * tangent + local.y * bitangent + local.z * normal);
}

// Towards the camera side. A smooth or mapped normal may point away from the camera where the surface itself
// does not; nothing is seen from below, so it is lifted to the horizon.
fn facing(normal: vec3f, to_camera: vec3f) -> vec3f {
    let below = min(dot(normal, to_camera), 0.0);
    return normalize(normal - below * to_camera);
}

@fragment
fn fragment_main(vertex: Vertex) -> Targets {
    // All samples come before the first branch: derivatives need uniform control flow.
    let base = material.base_color
        * textureSample(base_color_texture, base_color_sampler, vertex.texcoord);
    let metallic_roughness = textureSample(
        metallic_roughness_texture, metallic_roughness_sampler, vertex.texcoord);
    let sampled_normal = textureSample(normal_texture, normal_sampler, vertex.texcoord).xyz;
    let emission = material.emission
        * textureSample(emission_texture, emission_sampler, vertex.texcoord).rgb;
    // The screen's y points down, so this order faces the camera: a triangle's plane is exact in its
    // derivatives, at its edges too, where the rest of a quad is extrapolated.
    let plane = cross(dpdy(vertex.from_camera), dpdx(vertex.from_camera));
    if material.is_masked != 0u && base.a < MASK_THRESHOLD {
        discard;
    }

    let to_camera = -normalize(vertex.from_camera);
    let smooth_normal = normalize(vertex.normal);
    let plane_size = length(plane);
    // Where a triangle is too small for its derivatives, the vertex normal has to do.
    var geometric = select(plane / plane_size, smooth_normal, plane_size < 1e-30);
    geometric = select(-geometric, geometric, dot(geometric, to_camera) >= 0.0);
    // Seen from behind, the whole shading frame turns over.
    let side = select(-1.0, 1.0, dot(smooth_normal, geometric) >= 0.0);
    let shading = facing(side * mapped_normal(vertex, sampled_normal), to_camera);

    let metallic = material.metallic * metallic_roughness.b;
    let roughness = material.roughness * metallic_roughness.g;
    var targets: Targets;
    targets.normals = vec4f(octahedral_encode(shading), octahedral_encode(geometric));
    targets.diffuse = vec4f(base.rgb * (1.0 - metallic), 1.0);
    targets.specular = vec4f(mix(material.dielectric_f0, base.rgb, metallic), roughness);
    targets.emission = vec4f(emission, 1.0);
    return targets;
}
