// Lines as quads with a width in pixels, optionally hidden by the surfaces of the G-buffer.
//
// A quad is a little larger than its line; fragments compute their distance from the line. All
// lengths are in pixels of the picture. Depths are near / distance as in the G-buffer, which is
// linear along a line on the screen.

import package::trace::surface::octahedral_decode;

struct SegmentView {
    clip_from_world: mat4x4f,
    // The ray through a point (x, y) in clip space is middle + x across + y up, at a fixed depth.
    ray_middle: vec3f,
    wire_is_tested: u32,
    ray_across: vec3f,
    wire_width: f32,
    ray_up: vec3f,
    padding_0: u32,
    size: vec2f,
    padding_1: u32,
    padding_2: u32,
    wire_color: vec4f,
}

@group(0) @binding(0) var<uniform> segment_view: SegmentView;
@group(0) @binding(2) var surface_depth: texture_depth_2d;
@group(0) @binding(3) var surface_normals: texture_2d<f32>;

struct SegmentVertex {
    @builtin(position) position: vec4f,
    // Both ends, in pixels.
    @location(0) @interpolate(flat) ends: vec4f,
    @location(1) @interpolate(flat) depths: vec2f,
    // Half the width; the second component is above 0 if surfaces hide the line.
    @location(2) @interpolate(flat) half_width_and_test: vec2f,
    @location(3) @interpolate(flat) color: vec4f,
}

struct SegmentFragment {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) ends: vec4f,
    @location(1) @interpolate(flat) depths: vec2f,
    @location(2) @interpolate(flat) half_width_and_test: vec2f,
    @location(3) @interpolate(flat) color: vec4f,
}

// Lines are clipped at this multiple of the picture's half size; the excess is more than any width.
const BEYOND: f32 = 1.1;
// The error of depths: the rasterizer's depths of large triangles have a relative error of about
// 1e-5, and storing the normal in half floats turns a plane by 5e-4, seen from a pixel away.
const DEPTH_PRECISION: f32 = 1e-4;
// A line may be behind the surface by this many pixels times the surface's slope: a curved surface
// varies by that within a pixel.
const SLOPE_PIXELS: f32 = 0.5;
// The least cosine for which the slope is used; at steeper angles it is unreliable.
const MIN_COS: f32 = 0.05;

fn to_pixels(clip: vec4f) -> vec2f {
    return (vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5) * segment_view.size;
}

// A corner of two triangles: x selects the end, y the side, from -1 to 1.
fn quad_corner(vertex: u32) -> vec2f {
    let corner = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[vertex % 6u];
    return vec2f(f32(corner >> 1u), f32(corner & 1u)) * 2.0 - 1.0;
}

// A vertex outside the picture, so that nothing is drawn.
fn nowhere() -> SegmentVertex {
    return SegmentVertex(vec4f(2.0, 2.0, 0.5, 1.0), vec4f(0.0), vec2f(0.0), vec2f(0.0), vec4f(0.0));
}

// A corner of the quad of a line between two points in clip space.
fn segment_corner(
    tail: vec4f,
    head: vec4f,
    corner: vec2f,
    width: f32,
    is_tested: bool,
    color: vec4f,
) -> SegmentVertex {
    // Clip to the part in front of the near plane and not far outside the picture (Liang and Barsky
    // 1984, "A new concept and method for line clipping", in homogeneous coordinates).
    var start = 0.0;
    var end = 1.0;
    for (var plane = 0u; plane < 5u; plane++) {
        let axis = (max(plane, 1u) - 1u) >> 1u;
        let side = select(1.0, -1.0, (plane & 1u) == 0u);
        var inside = vec2f(tail.w - tail.z, head.w - head.z);
        if plane > 0u {
            inside = BEYOND * vec2f(tail.w, head.w) + side * vec2f(tail[axis], head[axis]);
        }
        let share = inside.x / (inside.x - inside.y);
        if inside.x < 0.0 {
            start = max(start, share);
        }
        if inside.y < 0.0 {
            end = min(end, share);
        }
        if inside.x < 0.0 && inside.y < 0.0 {
            end = -1.0;
        }
    }
    // NaN also fails this comparison.
    if !(start <= end) {
        return nowhere();
    }
    let near = mix(tail, head, start);
    let far = mix(tail, head, end);
    let a = to_pixels(near);
    let b = to_pixels(far);
    let pixels = distance(a, b);
    var along = vec2f(1.0, 0.0);
    if pixels > 1e-4 {
        along = (b - a) / pixels;
    }
    // Extends the ends for round caps, plus a margin for the rasterizer's grid.
    let reach = 0.5 * width + 0.1;
    let tip = select(a, b, corner.x > 0.0) + reach * (corner.x * along + corner.y * vec2f(-along.y, along.x));
    let ndc = (tip / segment_view.size - 0.5) * vec2f(2.0, -2.0);
    return SegmentVertex(
        vec4f(ndc, 0.5, 1.0),
        vec4f(a, b),
        vec2f(near.z / near.w, far.z / far.w),
        vec2f(0.5 * width, select(0.0, 1.0, is_tested)),
        color,
    );
}

fn ray_through(pixel: vec2f) -> vec3f {
    let ndc = (pixel / segment_view.size - 0.5) * vec2f(2.0, -2.0);
    return segment_view.ray_middle + ndc.x * segment_view.ray_across + ndc.y * segment_view.ray_up;
}

// Whether the surface of a pixel hides a point of the given depth at `place`, within a line's
// width. The point is compared with the surface's plane at that position: the edge of a surface is
// in that plane, however steep it is.
fn is_hidden(pixel: vec2u, place: vec2f, depth: f32) -> bool {
    let surface = textureLoad(surface_depth, pixel, 0);
    let normal = octahedral_decode(textureLoad(surface_normals, pixel, 0).zw);
    let here = ray_through(vec2f(pixel) + 0.5);
    let facing = min(dot(normal, here), -MIN_COS * length(here));
    let plane = surface * (1.0 + dot(normal, ray_through(place) - here) / facing);
    let across = abs(dot(normal, segment_view.ray_across)) / segment_view.size.x
        + abs(dot(normal, segment_view.ray_up)) / segment_view.size.y;
    let slope = surface * 2.0 * across / -facing;
    return depth < plane * (1.0 - DEPTH_PRECISION) - SLOPE_PIXELS * slope;
}

// The colour of a pixel of a line, multiplied by its coverage; 0 outside the line.
fn segment_color(fragment: SegmentFragment) -> vec4f {
    let a = fragment.ends.xy;
    let along = fragment.ends.zw - a;
    let share = saturate(dot(fragment.position.xy - a, along) / max(dot(along, along), 1e-8));
    let nearest = a + share * along;
    let is_on = distance(fragment.position.xy, nearest) <= fragment.half_width_and_test.x;
    let depth = mix(fragment.depths.x, fragment.depths.y, share);
    let is_behind = fragment.half_width_and_test.y > 0.0
        && is_hidden(vec2u(fragment.position.xy), nearest, depth);
    let coverage = select(0.0, fragment.color.a, is_on && !is_behind);
    return vec4f(fragment.color.rgb * coverage, coverage);
}
