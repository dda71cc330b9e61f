// The cells of one level as wire cubes in the colour of their light, seen through each other.

import package::cascades::{shown_cascade, stored_from_corner};
import package::render::passes::voxel_view::view::{picture, voxel_view_settings, MIN_OPACITY};
import package::render::passes::voxel_view::wire_walk::wires_along;
import package::trace::view::view;
import package::volume::load_cell;

// The light that a cell emits, over all sides; `cell` is relative to its box's corner.
fn light_of(cell: vec3u, level: u32) -> vec3f {
    let cascade = shown_cascade(level);
    let stored = stored_from_corner(cell, level - cascade, cascade);
    var sum = vec4f(0.0);
    for (var side = 0u; side < 6u; side++) {
        var inwards = vec3f(0.0);
        inwards[side >> 1u] = select(1.0, -1.0, (side & 1u) == 0u);
        sum += load_cell(stored, level - cascade, inwards);
    }
    return select(vec3f(0.0), sum.rgb / max(sum.a, MIN_OPACITY), sum.a > MIN_OPACITY);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = voxel_view_settings.level;
    let wires = wires_along(pixel, level, 3e38);
    var shown = vec4f(0.0);
    if wires.coverage > 0.0 {
        shown = vec4f(light_of(wires.cell, level), 1.0) * wires.coverage;
    }
    textureStore(picture, pixel, shown);
}
