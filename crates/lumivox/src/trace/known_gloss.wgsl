// Reflection of light from afar that the faces around have gathered (near_and_far.wgsl): a rough
// lobe takes it without tracing rays.
//
// It has no noise from pixel to pixel, but an error that is the same for a few voxels. So the first
// frame of a mean takes all of it, and later ones less.

import package::gpu::random::sequence_pair;
import package::trace::brdf::PI;
import package::trace::lobe::{draw_direction, Lobe};
import package::trace::screen::{settings, share_in_mean};
import package::trace::view::view;
import package::trace::way::known_from;
import package::volume::far_light::FAR_CELLS;

// Directions in which a frame looks up known light for a pixel.
const DIRECTIONS: u32 = 8u;

// Frames of a mean that take known light.
const KNOWN_FRAMES: u32 = 12u;

// The share of known light in what a lobe reflects from afar. A lobe narrower than a cell of known
// light takes none.
fn share_of_known(alpha: f32) -> f32 {
    let lobe_solid_angle = 4.0 * PI * alpha * alpha;
    let wide = saturate(lobe_solid_angle / (2.0 * PI / f32(FAR_CELLS)) - 1.0);
    let share = share_in_mean();
    return select(0.0, wide * share * share, settings.shares != 0u && view.frame < KNOWN_FRAMES);
}

// The known light that a lobe reflects. `cells_from_normal` transforms to the frame whose z is the
// surface's own normal.
fn reflect_known(lobe: Lobe, cells_from_normal: mat3x3f, start: vec2f, turn: u32) -> vec3f {
    let first = sequence_pair(start, turn);
    var sum = vec3f(0.0);
    for (var i = 0u; i < DIRECTIONS; i++) {
        let numbers = fract(first + vec2f(f32(i) / f32(DIRECTIONS), 0.618034 * f32(i)));
        let drawn = draw_direction(lobe, numbers);
        let local = cells_from_normal * drawn.direction;
        sum += select(vec3f(0.0), known_from(local).radiance * drawn.weight, local.z > 0.0);
    }
    return sum / f32(DIRECTIONS);
}
