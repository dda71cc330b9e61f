// Rasterizes the G-buffer that package::trace::gbuffer declares.

import package::render::scene::draws::draws;
import package::render::scene::layer_textures::sample_layers;
import package::render::scene::layers::{shade_layers, Layered};
import package::render::scene::material::material;
import package::render::scene::point::{frame_at, is_masked_out, sample_point, Point, PointFrame, PointSamples};
import package::render::passes::screen_door::{is_there, surface_seed};
import package::trace::surface::octahedral_encode;

struct RasterView {
    clip_from_world: mat4x4f,
    position_in_world: vec3f,
    // The index of the sample within the pixels.
    sample: u32,
    // The offset of the sample from the pixels' centres, in pixels.
    jitter: vec2f,
    padding: vec2f,
}

@group(0) @binding(0) var<uniform> raster_view: RasterView;

struct Vertex {
    // Invariant across pipelines, since their depths are compared.
    @builtin(position) @invariant clip: vec4f,
    // Relative to the camera, not to the origin: f32 then resolves the small steps between near
    // pixels. Their derivatives give the geometric normal.
    @location(0) from_camera: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) texcoord: vec2f,
    @location(4) texcoord_1: vec2f,
    @location(5) color: vec4f,
    @location(6) @interpolate(flat) draw: u32,
}

// The inputs of plain materials, for vertices with one set of texture coordinates.
struct PlainFragment {
    @location(0) from_camera: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) texcoord: vec2f,
}

// For vertices with two sets, and colours.
struct ColoredFragment {
    @location(0) from_camera: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) texcoord: vec2f,
    @location(4) texcoord_1: vec2f,
    @location(5) color: vec4f,
}

struct LayeredFragment {
    @builtin(position) pixel: vec4f,
    @builtin(front_facing) is_front: bool,
    @location(0) from_camera: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) texcoord: vec2f,
    @location(4) texcoord_1: vec2f,
    @location(5) color: vec4f,
    @location(6) @interpolate(flat) draw: u32,
}

struct Targets {
    @location(0) normals: vec4f,
    @location(1) diffuse: vec4f,
    @location(2) specular: vec4f,
    @location(3) emission: vec4f,
}

fn transform(
    position: vec3f,
    normal: vec3f,
    tangent: vec4f,
    texcoord: vec2f,
    texcoord_1: vec2f,
    color: vec4f,
    draw: u32,
) -> Vertex {
    let world = draws[draw].world_from_local * vec4f(position, 1.0);
    return Vertex(
        raster_view.clip_from_world * world,
        world.xyz - raster_view.position_in_world,
        (draws[draw].normal_from_local * vec4f(normal, 0.0)).xyz,
        vec4f((draws[draw].world_from_local * vec4f(tangent.xyz, 0.0)).xyz, tangent.w),
        texcoord,
        texcoord_1,
        color,
        draw,
    );
}

// Vertices with one set of texture coordinates, which also serves as the second.
@vertex
fn plain_vertex(
    @location(0) position: vec3f,
    @location(1) texcoord: vec2f,
    @location(2) normal: vec3f,
    @location(3) tangent: vec4f,
    @builtin(instance_index) draw: u32,
) -> Vertex {
    return transform(position, normal, tangent, texcoord, texcoord, vec4f(1.0), draw);
}

// Vertices with two sets, and colours.
@vertex
fn colored_vertex(
    @location(0) position: vec3f,
    @location(1) texcoord: vec2f,
    @location(2) normal: vec3f,
    @location(3) tangent: vec4f,
    @location(4) texcoord_1: vec2f,
    @location(5) color: vec4f,
    @builtin(instance_index) draw: u32,
) -> Vertex {
    return transform(position, normal, tangent, texcoord, texcoord_1, color, draw);
}

fn encode_normals(frame: PointFrame) -> vec4f {
    return vec4f(octahedral_encode(frame.shading), octahedral_encode(frame.geometric));
}

fn plain_targets(point: Point) -> Targets {
    let samples = sample_point(point);
    if is_masked_out(samples.base) {
        discard;
    }
    let lit = select(1.0, 0.0, material.unlit_radiance > 0.0);
    let diffuse = samples.base.rgb * ((1.0 - samples.metallic) * lit);
    let f0 = mix(material.dielectric_f0, samples.base.rgb, samples.metallic);
    return Targets(
        encode_normals(frame_at(point, samples)),
        vec4f(diffuse, 1.0),
        vec4f(f0, samples.roughness),
        vec4f(samples.emission, 1.0),
    );
}

@fragment
fn plain_fragment(fragment: PlainFragment) -> Targets {
    return plain_targets(Point(
        fragment.from_camera,
        fragment.normal,
        fragment.tangent,
        fragment.texcoord.xyxy,
        vec4f(1.0),
    ));
}

@fragment
fn colored_fragment(fragment: ColoredFragment) -> Targets {
    return plain_targets(Point(
        fragment.from_camera,
        fragment.normal,
        fragment.tangent,
        vec4f(fragment.texcoord, fragment.texcoord_1),
        fragment.color,
    ));
}

struct LayeredPoint {
    samples: PointSamples,
    frame: PointFrame,
    layered: Layered,
}

fn layered_point(fragment: LayeredFragment) -> LayeredPoint {
    let point = Point(
        fragment.from_camera,
        fragment.normal,
        fragment.tangent,
        vec4f(fragment.texcoord, fragment.texcoord_1),
        fragment.color,
    );
    let samples = sample_point(point);
    let frame = frame_at(point, samples);
    let cos_view = saturate(dot(frame.shading, frame.to_camera));
    let layers = sample_layers(point.texcoords, samples.base.a, cos_view);
    let layered = shade_layers(layers, samples.base.rgb, samples.metallic, samples.emission, cos_view);
    return LayeredPoint(samples, frame, layered);
}

@fragment
fn layered_fragment(fragment: LayeredFragment) -> Targets {
    let point = layered_point(fragment);
    let layered = point.layered;
    // At the pixel's centre, independent of the frame's jitter: a surface whose seed changed from
    // frame to frame would exist at random, instead of evenly spread over the frames.
    let distance = length(fragment.from_camera);
    let in_middle =
        distance + dot(vec2f(dpdx(distance), dpdy(distance)), raster_view.jitter);
    let seed = surface_seed(fragment.draw, fragment.is_front, in_middle);
    if is_masked_out(point.samples.base)
        || !is_there(layered.coverage, vec2u(fragment.pixel.xy), seed, raster_view.sample) {
        discard;
    }
    return Targets(
        encode_normals(point.frame),
        vec4f(layered.diffuse, 1.0 - layered.coat_strength),
        vec4f(layered.f0, point.samples.roughness),
        vec4f(
            layered.emission,
            select(1.0, layered.coat_roughness, layered.coat_strength > 0.0),
        ),
    );
}

// This pass runs after the G-buffer. A surface nearer than the pixel's visible one did not exist in
// this frame, or the pixel would show it. So the light passed through it.
@fragment
fn tint_fragment(fragment: LayeredFragment) -> @location(0) vec4f {
    let point = layered_point(fragment);
    if is_masked_out(point.samples.base) {
        discard;
    }
    return vec4f(point.layered.tint, 1.0);
}
