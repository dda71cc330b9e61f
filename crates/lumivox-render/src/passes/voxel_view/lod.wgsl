// The content of one level of the volume at the visible surfaces, filtered as cones sample it,
// looking against the surface's normal; radiance is not weighted by opacity.

import package::grid::grid_from_world;
import package::render::passes::voxel_view::view::{picture, voxel_view_settings, MIN_OPACITY};
import package::trace::gbuffer::load_surface;
import package::trace::view::view;
import package::volume::{is_empty, probe_volume, sample_probe};

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    let inwards = -surface.geometric_normal;
    let position = grid_from_world(surface.position_in_world);
    let probe = probe_volume(position, voxel_view_settings.level, inwards);
    var shown = vec4f(0.0, 0.0, 0.0, select(0.0, 1.0, surface.depth > 0.0));
    if surface.depth > 0.0 && !is_empty(probe) {
        let seen = sample_probe(probe, inwards);
        if seen.a > MIN_OPACITY {
            shown = vec4f(seen.rgb / seen.a, 1.0);
        }
    }
    textureStore(picture, pixel, shown);
}
