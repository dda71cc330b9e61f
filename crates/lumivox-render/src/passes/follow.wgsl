// Adds a frame to the mean of earlier frames while the picture moves: the mean is looked up at the
// former position of the pixel's surface.
//
// Each frame samples another position within the pixel, so the mean smooths edges. The old mean is
// clamped to the range of the frame's own 3x3 pixels (Karis 2014, "High-quality temporal
// supersampling"). The range is wide at edges but narrow within a surface, so changes of light and
// shadow appear at once. When light has changed, the mean is scaled by the change of the 3x3
// pixels, as far as it exceeds what their edges can explain (James and Stein 1961, as in
// temporal/blend.wgsl).

import package::render::passes::accumulate::{accumulate_settings, frame, new_mean, old_mean};
import package::trace::gbuffer::{load_motion, load_surface};
import package::trace::view::view;

// Positions this near to a texel's centre are snapped to it, in texels: matrices are rounded.
const SAME_TEXEL: f32 = 0.01;

// The pixel's position in the previous frame, in texels with whole numbers at their centres. It
// uses the motion of the nearest surface of the 3x3 pixels, so that the edge of an object moves
// with the object.
fn former_place(pixel: vec2u) -> vec2f {
    var nearest = pixel;
    var nearest_depth = -1.0;
    for (var i = 0; i < 9; i++) {
        let place = around(pixel, i);
        let depth = load_surface(place).depth;
        if depth > nearest_depth {
            nearest_depth = depth;
            nearest = place;
        }
    }
    let motion = load_motion(nearest, load_surface(nearest).position_in_world);
    return vec2f(pixel) - motion * vec2f(view.size);
}

fn around(pixel: vec2u, i: i32) -> vec2u {
    let place = vec2i(pixel) + vec2i(i % 3 - 1, i / 3 - 1);
    return vec2u(clamp(place, vec2i(0), vec2i(view.size) - 1));
}

// The weight of one of 3x3 pixels in their mean. A box filter inverts the sign of patterns that
// alternate from pixel to pixel, so repeated scaling by it would make rings around edges. This
// filter removes them.
fn binomial(i: i32) -> f32 {
    return f32((2 - abs(i % 3 - 1)) * (2 - abs(i / 3 - 1))) / 16.0;
}

// The sum of the squared weights.
const BINOMIAL_SQUARES: f32 = 36.0 / 256.0;

// Weights of the four texels around a position, `t` beyond the second texel: Catmull and Rom 1974,
// which stays sharp over repeated lookups.
fn cubic(t: f32) -> vec4f {
    return vec4f(
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    );
}

fn look_up(place: vec2f) -> vec4f {
    let nearest = round(place);
    if all(abs(place - nearest) < vec2f(SAME_TEXEL)) {
        return textureLoad(old_mean, vec2u(nearest), 0);
    }
    let corner = floor(place);
    let columns = cubic(place.x - corner.x);
    let rows = cubic(place.y - corner.y);
    var sum = vec4f(0.0);
    for (var i = 0; i < 16; i++) {
        let texel = vec2i(corner) + vec2i(i % 4 - 1, i / 4 - 1);
        let inside = clamp(texel, vec2i(0), vec2i(view.size) - 1);
        sum += columns[i % 4] * rows[i / 4] * textureLoad(old_mean, inside, 0);
    }
    return sum;
}

fn sum(color: vec3f) -> f32 {
    return color.r + color.g + color.b;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let value = textureLoad(frame, pixel, 0);
    let place = former_place(pixel);
    // Also false for NaN.
    let was_on_screen = all(place > vec2f(-0.5)) && all(place < vec2f(view.size) - 0.5);
    if !was_on_screen {
        textureStore(new_mean, pixel, value);
        return;
    }
    var least = value;
    var most = value;
    var squares = 0.0;
    var now = vec3f(0.0);
    var before = vec3f(0.0);
    let former = vec2u(clamp(round(place), vec2f(0.0), vec2f(view.size) - 1.0));
    for (var i = 0; i < 9; i++) {
        let other = textureLoad(frame, around(pixel, i), 0);
        least = min(least, other);
        most = max(most, other);
        let weight = binomial(i);
        now += weight * other.rgb;
        squares += weight * sum(other.rgb) * sum(other.rgb);
        before += weight * textureLoad(old_mean, around(former, i), 0).rgb;
    }
    var scale = 1.0;
    if accumulate_settings.is_relit != 0u {
        let variance = max(squares - sum(now) * sum(now), 0.0) * BINOMIAL_SQUARES;
        let difference = sum(now) - sum(before);
        let certain = saturate(1.0 - variance / max(difference * difference, 1e-20));
        scale = mix(1.0, sum(now) / max(sum(before), 1e-20), certain);
    }
    let old = clamp(vec4f(scale, scale, scale, 1.0) * look_up(place), least, most);
    textureStore(new_mean, pixel, old + (value - old) * accumulate_settings.weight);
}
