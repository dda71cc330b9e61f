// Retraces the cones of the last frame's probes in the light of this frame. They reuse the same
// random numbers, so that every difference is change, without noise: Schied et al. 2018, "Gradient
// estimation for real-time adaptive temporal filtering", section 3.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::temporal::probe::{Probe, NO_PROBE};
import package::trace::diffuse::gather_at;

@group(1) @binding(1) var<storage, read_write> probes: array<Probe>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&probes) {
        return;
    }
    let probe = probes[index];
    if probe.pixel == NO_PROBE {
        return;
    }
    let gathered = gather_at(
        probe.position_in_world,
        probe.shading_normal,
        probe.geometric_normal,
        vec2u(probe.pixel & 0xffffu, probe.pixel >> 16u),
        probe.turn,
    );
    probes[index].now = gathered.irradiance.rgb;
}
