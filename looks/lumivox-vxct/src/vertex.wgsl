// The corners of triangles, pulled from the scene's buffers by their number: voxelization needs all
// three corners of a triangle at each of them.

import package::render::scene::draws::draws;
import package::vxct::material::vxct_draws;

// Three floats a vertex.
@group(2) @binding(0) var<storage, read> positions: array<f32>;
// Per vertex two floats, or four floats and four 16-bit numbers.
@group(2) @binding(1) var<storage, read> attributes: array<u32>;
// Normal and tangent, seven floats a vertex.
@group(2) @binding(2) var<storage, read> frames: array<f32>;
@group(2) @binding(3) var<storage, read> indices: array<u32>;

struct Corner {
    position_in_world: vec3f,
    // Not of unit length.
    normal: vec3f,
    tangent: vec4f,
    texcoords: vec4f,
    color: vec4f,
}

fn vertex_of(draw: u32, corner: u32) -> u32 {
    let record = vxct_draws[draw];
    return u32(i32(indices[record.first_index + corner]) + record.base_vertex);
}

fn local_position(vertex: u32) -> vec3f {
    return vec3f(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
}

fn position_of(draw: u32, corner: u32) -> vec3f {
    return (draws[draw].world_from_local * vec4f(local_position(vertex_of(draw, corner)), 1.0)).xyz;
}

fn corner_of(draw: u32, corner: u32) -> Corner {
    let vertex = vertex_of(draw, corner);
    let local = local_position(vertex);
    let at = 7u * vertex;
    var normal = vec3f(frames[at], frames[at + 1u], frames[at + 2u]);
    if vxct_draws[draw].is_rounded != 0u {
        normal = local;
    }
    let tangent = vec3f(frames[at + 3u], frames[at + 4u], frames[at + 5u]);
    let words = vxct_draws[draw].attribute_words;
    let first = words * vertex;
    let set_0 = vec2f(bitcast<f32>(attributes[first]), bitcast<f32>(attributes[first + 1u]));
    var texcoords = set_0.xyxy;
    var color = vec4f(1.0);
    if words > 2u {
        texcoords.z = bitcast<f32>(attributes[first + 2u]);
        texcoords.w = bitcast<f32>(attributes[first + 3u]);
        color = vec4f(
            unpack2x16unorm(attributes[first + 4u]),
            unpack2x16unorm(attributes[first + 5u]),
        );
    }
    return Corner(
        (draws[draw].world_from_local * vec4f(local, 1.0)).xyz,
        (draws[draw].normal_from_local * vec4f(normal, 0.0)).xyz,
        vec4f((draws[draw].world_from_local * vec4f(tangent, 0.0)).xyz, frames[at + 6u]),
        texcoords,
        color,
    );
}
