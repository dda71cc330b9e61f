// A point of a surface: the values of its textures, and its orientation.

import package::constants::{
    TEXTURE_BASE_COLOR, TEXTURE_EMISSION, TEXTURE_METALLIC_ROUGHNESS, TEXTURE_NORMAL,
};
import package::render::scene::material::{
    base_color_sampler, base_color_texture, emission_sampler, emission_texture, material,
    metallic_roughness_sampler, metallic_roughness_texture, normal_sampler, normal_texture,
    texcoord,
};
import package::render::scene::normals::{bend, facing};

// A point of a surface, for all fragment shaders.
struct Point {
    from_camera: vec3f,
    normal: vec3f,
    tangent: vec4f,
    texcoords: vec4f,
    color: vec4f,
}

// The values of a point's textures, multiplied by their factors, and the plane of its triangle.
struct PointSamples {
    base: vec4f,
    emission: vec3f,
    metallic: f32,
    roughness: f32,
    normal: vec3f,
    plane: vec3f,
}

// The orientation of a point.
struct PointFrame {
    to_camera: vec3f,
    shading: vec3f,
    geometric: vec3f,
}

// All samples are taken before the first branch: derivatives need uniform control flow.
fn sample_point(point: Point) -> PointSamples {
    let base = material.base_color * point.color * textureSample(
        base_color_texture, base_color_sampler, texcoord(TEXTURE_BASE_COLOR, point.texcoords));
    let metallic_roughness = textureSample(
        metallic_roughness_texture,
        metallic_roughness_sampler,
        texcoord(TEXTURE_METALLIC_ROUGHNESS, point.texcoords),
    );
    let normal = textureSample(
        normal_texture, normal_sampler, texcoord(TEXTURE_NORMAL, point.texcoords)).xyz;
    let emission = material.emission * textureSample(
        emission_texture, emission_sampler, texcoord(TEXTURE_EMISSION, point.texcoords)).rgb;
    // The screen's y axis points down, so this order faces the camera. The derivatives of a
    // triangle's plane are exact even at its edges, where the rest of a quad is extrapolated.
    let plane = cross(dpdy(point.from_camera), dpdx(point.from_camera));
    return PointSamples(
        base,
        emission + material.unlit_radiance * base.rgb,
        material.metallic * metallic_roughness.b,
        material.roughness * metallic_roughness.g,
        normal,
        plane,
    );
}

fn is_masked_out(base: vec4f) -> bool {
    return base.a < material.mask_threshold;
}

// The vertex normal, bent by the normal texture if there is one.
fn mapped_normal(point: Point, sampled: vec3f) -> vec3f {
    let normal = normalize(point.normal);
    let bent = bend(normal, point.tangent, sampled, material.normal_scale);
    return select(normal, bent, material.has_normal_texture != 0u);
}

fn frame_at(point: Point, samples: PointSamples) -> PointFrame {
    let to_camera = -normalize(point.from_camera);
    let smooth_normal = normalize(point.normal);
    let plane_size = length(samples.plane);
    // If a triangle is too small for its derivatives, use the vertex normal.
    var geometric = select(samples.plane / plane_size, smooth_normal, plane_size < 1e-30);
    geometric = select(-geometric, geometric, dot(geometric, to_camera) >= 0.0);
    // If the surface is seen from behind, the whole shading frame is flipped.
    let side = select(-1.0, 1.0, dot(smooth_normal, geometric) >= 0.0);
    let shading = facing(side * mapped_normal(point, samples.normal), geometric, to_camera);
    return PointFrame(to_camera, shading, geometric);
}
