// The change of light at each traced pixel of the last frame: the means of the old and of the new
// light of the probes around it, weighted by their fit to its surface.

import package::cascades::finest_level;
import package::constants::PROBE_SPACING;
import package::grid::grid_from_world;
import package::temporal::filter::share;
import package::temporal::guide::guide_normal;
import package::temporal::probe::{probes_size, Probe, NO_PROBE};

// Guides of the last frame.
@group(1) @binding(0) var guides: texture_2d<f32>;
@group(1) @binding(1) var<storage, read> probes: array<Probe>;
// Irradiance in rgb; in a of `was_out` 1, or 0 if no probe is near.
@group(1) @binding(2) var was_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(3) var now_out: texture_storage_2d<rgba16float, write>;

// Distance over which global changes of light vary, in voxels: more than that of light itself.
const REACH: f32 = 48.0;

// Search radius in probes.
const RADIUS: i32 = 2;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let traced_size = textureDimensions(guides);
    if any(invocation.xy >= traced_size) {
        return;
    }
    let guide = textureLoad(guides, invocation.xy, 0);
    var was = vec3f(0.0);
    var now = vec3f(0.0);
    var weights = 0.0;
    if guide.w >= 0.0 {
        let normal = guide_normal(guide);
        let voxels = exp2(-f32(finest_level(guide.xyz, 0u, 0.5)));
        let size = vec2i(probes_size(traced_size));
        let centre = vec2i(invocation.xy / PROBE_SPACING);
        for (var y = max(centre.y - RADIUS, 0); y <= min(centre.y + RADIUS, size.y - 1); y++) {
            for (var x = max(centre.x - RADIUS, 0); x <= min(centre.x + RADIUS, size.x - 1); x++) {
                let probe = probes[y * size.x + x];
                if probe.pixel == NO_PROBE {
                    continue;
                }
                let between = voxels * (grid_from_world(probe.position_in_world) - guide.xyz);
                let weight = share(between, normal, probe.shading_normal, REACH);
                was += weight * probe.was;
                now += weight * probe.now;
                weights += weight;
            }
        }
    }
    let is_known = weights > 1e-6;
    let scale = select(0.0, 1.0 / weights, is_known);
    textureStore(was_out, invocation.xy, vec4f(scale * was, select(0.0, 1.0, is_known)));
    textureStore(now_out, invocation.xy, vec4f(scale * now, 0.0));
}
