// At half resolution, traces pixels that no traced neighbour fits: thin objects and silhouettes.
//
// `reconstruct.wgsl` lists them. Each thread handles one element of the list, so that no workgroup
// waits for a few of its threads.

import package::gpu::dispatch::linear_index;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::trace::diffuse::trace_diffuse;
import package::trace::screen::settings;
import package::trace::specular::trace_specular;
import package::trace::view::view;

@group(1) @binding(1) var<storage, read> listed: array<u32>;
@group(1) @binding(2) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(3) var specular_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(4) var diffuse_samples: texture_2d<f32>;

struct Edge {
    is_there: bool,
    pixel: vec2u,
}

fn edge_of(index: u32) -> Edge {
    if index >= listed[0] {
        return Edge(false, vec2u(0u));
    }
    let number = listed[1u + index];
    return Edge(true, vec2u(number % view.size.x, number / view.size.x));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn diffuse(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let edge = edge_of(linear_index(invocation, workgroups));
    if edge.is_there {
        let traced = trace_diffuse(edge.pixel, view.frame, settings.edge_turns);
        textureStore(irradiance_out, edge.pixel, traced.irradiance);
    }
}

// Counts the same number of diffuse samples per turn as for the block's traced pixel.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn specular(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let edge = edge_of(linear_index(invocation, workgroups));
    if edge.is_there {
        let samples = textureLoad(diffuse_samples, edge.pixel / settings.scale, 0).r;
        let turns = f32(settings.edge_turns) / f32(settings.turns);
        let traced = trace_specular(edge.pixel, view.frame, settings.edge_turns, turns * samples);
        textureStore(specular_out, edge.pixel, traced.light);
    }
}
