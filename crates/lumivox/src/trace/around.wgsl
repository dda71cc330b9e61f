// The four traced pixels around a pixel, and their weights.

import package::trace::fit::fit;
import package::trace::guide::{guide_normal, guide_position, is_surface};
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::trace::surface::Surface;

struct Around {
    sources: array<vec2u, 4>,
    // Weights that add up to 1; zeros if none of the pixels shows a surface.
    weights: array<f32, 4>,
    // The largest fit of the four pixels.
    best: f32,
}

// Neighbours with a smaller fit are ignored: those a third of a voxel off the plane, or turned by
// 25 degrees.
const FITS: f32 = 0.66;

// `guides` has the surfaces of the traced pixels (guide.wgsl).
fn traced_around(pixel: vec2u, surface: Surface, guides: texture_2d<u32>) -> Around {
    var around = Around(array<vec2u, 4>(), array<f32, 4>(), 0.0);
    if settings.scale == 1u {
        around.sources[0] = pixel;
        around.weights[0] = 1.0;
        around.best = 1.0;
        return around;
    }
    // Position of this frame's traced pixels, in the coordinates of the small picture.
    let shift = vec2f(traced_pixel(vec2u(0u)));
    let place = (vec2f(pixel) - shift) / f32(settings.scale);
    let corner = vec2i(floor(place));
    let fraction = place - floor(place);
    let last = vec2i(traced_size()) - 1;
    var sum = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = vec2i(i & 1, i >> 1);
        let source = vec2u(clamp(corner + offset, vec2i(0), last));
        let guide = textureLoad(guides, source, 0);
        if !is_surface(guide) {
            continue;
        }
        let bilinear = abs(vec2f(1 - offset) - fraction);
        let between = guide_position(guide) - surface.position_in_world;
        let fits = fit(between, guide_normal(guide), surface);
        // With these floors, a pixel that no neighbour fits gets the mean of its neighbours.
        let weight = (bilinear.x * bilinear.y + 1e-3) * (fits + 1e-4);
        around.best = max(around.best, fits);
        around.sources[i] = source;
        around.weights[i] = weight;
        sum += weight;
    }
    if sum > 0.0 {
        for (var i = 0; i < 4; i++) {
            around.weights[i] /= sum;
        }
    }
    return around;
}
