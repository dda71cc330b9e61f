// The direction that a glossy lobe traces, and the far light that rough lobes reflect without
// tracing rays, as gathered by the faces around (near_and_far.wgsl).
//
// Known light does not have noise per pixel, but errors that extend over a few voxels. So the first
// frame of a mean uses it fully, and later ones less.

import package::constants::{FAR_CELLS, PI};
import package::emitters::emitter::strength;
import package::trace::lobe::{draw_in_grid, wind, Drawn, Lobe, DRAWS, GRID};
import package::trace::screen::{settings, share_in_mean};
import package::trace::view::view;
import package::trace::gather_method::known_from;

// Number of frames of a mean that use known light.
const KNOWN_FRAMES: u32 = 12u;

// The share of known light in the far light that a lobe reflects; 0 for lobes narrower than a cell
// of known light.
fn share_of_known(alpha: f32) -> f32 {
    let lobe_solid_angle = 4.0 * PI * alpha * alpha;
    let wide = saturate(lobe_solid_angle / (2.0 * PI / f32(FAR_CELLS)) - 1.0);
    let share = share_in_mean();
    return select(0.0, wide * share * share, settings.shares != 0u && view.frame < KNOWN_FRAMES);
}

// A direction chosen from several draws of a lobe, and the known light that the lobe reflects.
struct Resampled {
    // The direction; its weight includes the probability of the choice.
    drawn: Drawn,
    known: vec3f,
}

// Draws directions in a grid of random numbers, looks up known light in each if `looks_up`, and
// chooses one in proportion to its weight (resampled importance sampling: Talbot et al. 2005,
// "Importance resampling for global illumination"). So the weights of traced light hardly vary, and
// even light has little noise. `cells_from_normal` transforms to the frame whose z is the geometric
// normal; `numbers` are random.
//
// If all weights are equal, the choice is the direction of the first two numbers, otherwise one
// near it, so a sequence of choices stays well spread.
fn resample(lobe: Lobe, cells_from_normal: mat3x3f, numbers: vec3f, looks_up: bool) -> Resampled {
    var chosen = Resampled(Drawn(vec3f(0.0), 0.0, vec3f(0.0)), vec3f(0.0));
    let own = vec2u(numbers.xy * f32(GRID));
    let lot = f32(GRID * own.x + wind(own.y, own.x)) + numbers.z;
    var sum = 0.0;
    var so_far = 0.0;
    // The first half of the turns adds up the weights, the second half chooses.
    for (var turn = 0u; turn < 2u * DRAWS; turn++) {
        let drawn = draw_in_grid(lobe, numbers.xy, turn % DRAWS);
        let local = cells_from_normal * drawn.direction;
        let weight = select(vec3f(0.0), drawn.weight, local.z > 0.0) / f32(DRAWS);
        let brings = strength(weight);
        if turn < DRAWS {
            sum += brings;
            if looks_up {
                chosen.known += known_from(local).radiance * weight;
            }
        } else {
            let is_chosen = brings > 0.0 && so_far * f32(DRAWS) <= lot * sum;
            so_far += brings;
            if is_chosen {
                chosen.drawn = Drawn(drawn.direction, drawn.density, weight * (sum / brings));
            }
        }
    }
    return chosen;
}
