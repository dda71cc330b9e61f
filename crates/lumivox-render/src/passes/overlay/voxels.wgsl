// Wire cubes of one level over the picture, up to the surface or through it.

import package::grid::grid;
import package::render::passes::voxel_view::wire_walk::wires_along;
import package::trace::gbuffer::gbuffer_depth;
import package::trace::view::{position_from_depth, view};

struct WireSettings {
    color: vec4f,
    // The initial content of the overlay.
    background: vec4f,
    level: u32,
    is_hidden_by_surfaces: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> wire_settings: WireSettings;
@group(1) @binding(1) var overlay: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = wire_settings.level;
    var end = 3e38;
    let depth = textureLoad(gbuffer_depth, pixel, 0);
    if wire_settings.is_hidden_by_surfaces != 0u && depth > 0.0 {
        let distance_m = distance(position_from_depth(pixel, depth), view.position_in_world);
        // The margin keeps faces visible that coincide with the surface.
        end = 1.0001 * distance_m / (grid.voxel_size_m * exp2(f32(level))) + 0.01;
    }
    let wires = wires_along(pixel, level, end);
    let color = wire_settings.color;
    let coverage = wires.coverage * color.a;
    let background = wire_settings.background * (1.0 - coverage);
    textureStore(overlay, pixel, background + vec4f(color.rgb * coverage, coverage));
}
