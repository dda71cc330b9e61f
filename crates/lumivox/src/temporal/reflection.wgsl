// The known reflection of the surface at a pixel, read at the place of its mirror image in the last
// frame's picture. That image moves differently from the surface.

import package::grid::grid;
import package::temporal::past::{former_place, past_size, past_specular, texel_fit, SAME_SURFACE};
import package::trace::around::{traced_around, Around};
import package::trace::fit::fit;
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::surface::Surface;
import package::trace::view::{camera_motion, view};
import package::voxelize::reproducible::is_finite;

// Distance of the reflected surface, in voxels.
@group(1) @binding(9) var reflected_distance: texture_2d<f32>;
// The surfaces of the traced pixels.
@group(1) @binding(10) var guides: texture_2d<u32>;

// Distance of the mirror image behind the surface, m: that of the reflected object in front of it
// for a flat mirror, less for rougher surfaces (Lagarde and de Rousiers 2014, "Moving Frostbite to
// physically based rendering", section 4.9.3), and less for convex ones (the mirror equation).
fn image_distance(pixel: vec2u, surface: Surface, around: Around) -> f32 {
    var distance = 0.0;
    for (var i = 0; i < 4; i++) {
        if around.weights[i] > 0.0 {
            distance += around.weights[i] * textureLoad(reflected_distance, around.sources[i], 0).r;
        }
    }
    let smoothness = 1.0 - load_specular(pixel).roughness;
    let dominant = smoothness * (sqrt(smoothness) + 1.0 - smoothness);
    let ahead = distance * grid.voxel_size_m;
    return dominant * ahead / (1.0 + 2.0 * curvature(pixel, surface) * ahead);
}

// The curvature of the surface, estimated from the adjacent pixels, in 1/m: positive if convex.
fn curvature(pixel: vec2u, surface: Surface) -> f32 {
    var most = 0.0;
    for (var i = 0u; i < 2u; i++) {
        let beside = min(pixel + vec2u(1u - i, i), view.size - 1u);
        let other = load_surface(beside);
        let offset = other.position_in_world - surface.position_in_world;
        let squared = dot(offset, offset);
        if other.depth > 0.0 && squared > 0.0 && fit(offset, other.shading_normal, surface) > SAME_SURFACE {
            most += 0.5 * max(dot(other.shading_normal - surface.shading_normal, offset) / squared, 0.0);
        }
    }
    return most;
}

// The known reflection at the place of its image in the last frame (Stachowiak and Uludag 2015,
// "Stochastic screen-space reflections", on temporal reprojection) in rgb; in a the share of the
// texels there that show the surface.
fn recall_reflection(pixel: vec2u, surface: Surface, own_motion: vec2f, slack: f32) -> vec4f {
    let material = load_specular(pixel);
    if all(material.reflectance <= vec3f(0.0)) && material.coat <= 0.0 {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let ray = normalize(surface.position_in_world - view.position_in_world);
    let distance = image_distance(pixel, surface, traced_around(pixel, surface, guides));
    let image = surface.position_in_world + distance * ray;
    let place = former_place(pixel, camera_motion(pixel, image) + own_motion);
    if !(all(place > vec2f(-1.0)) && all(place < past_size())) {
        return vec4f(0.0);
    }
    let corner = vec2i(floor(place));
    let fraction = place - floor(place);
    var sum = vec4f(0.0);
    var tap = 0;
    loop {
        let offset = vec2i(tap & 1, tap >> 1);
        let share = abs(vec2f(1 - offset) - fraction);
        let weight = share.x * share.y * texel_fit(corner + offset, surface, slack);
        let specular = textureLoad(past_specular, clamp(corner + offset, vec2i(0), vec2i(past_size()) - 1), 0).rgb;
        if weight > 1e-3 && is_finite(specular) {
            sum += weight * vec4f(specular, 1.0);
        }
        tap += 1;
        continuing {
            break if tap >= 4;
        }
    }
    return vec4f(sum.rgb / max(sum.a, 1e-6), sum.a);
}
