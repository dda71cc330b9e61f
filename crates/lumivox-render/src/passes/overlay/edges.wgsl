// The edges of the scene's triangles: six vertices an edge, pulled from the buffers of positions
// and indices.

import package::render::scene::draws::draws;
import package::render::passes::overlay::segment::{
    nowhere, quad_corner, segment_color, segment_corner, segment_view, to_pixels, SegmentFragment, SegmentVertex,
};

// The range of a draw's triangles.
struct EdgeRange {
    first_index: u32,
    base_vertex: u32,
    // Back-facing triangles are left out.
    is_single_sided: u32,
    padding: u32,
}

@group(0) @binding(4) var<storage, read> ranges: array<EdgeRange>;
@group(1) @binding(0) var<storage, read> positions: array<f32>;
@group(1) @binding(1) var<storage, read> indices: array<u32>;

// A line is at most this share of a small triangle's height wide, and at least `MIN_WIDTH`. A line
// thinner than a pixel covers a share of the pixel's samples, so dense lines fade instead of
// filling the surface.
const SHARE_OF_HEIGHT: f32 = 0.2;
const MIN_WIDTH: f32 = 0.1;

fn corner_in_clip(draw: u32, index: u32) -> vec4f {
    let first = 3u * (indices[index] + ranges[draw].base_vertex);
    let local = vec3f(positions[first], positions[first + 1u], positions[first + 2u]);
    return segment_view.clip_from_world * (draws[draw].world_from_local * vec4f(local, 1.0));
}

@vertex
fn edge_vertex(
    @builtin(vertex_index) vertex: u32,
    @builtin(instance_index) draw: u32,
) -> SegmentVertex {
    let edge = vertex / 6u;
    let first = ranges[draw].first_index + edge / 3u * 3u;
    let a = corner_in_clip(draw, first + edge % 3u);
    let b = corner_in_clip(draw, first + (edge + 1u) % 3u);
    let c = corner_in_clip(draw, first + (edge + 2u) % 3u);
    // Positive if the triangle is counter-clockwise on the screen.
    let facing = dot(a.xyw, cross(b.xyw, c.xyw));
    if ranges[draw].is_single_sided != 0u && segment_view.wire_is_tested != 0u && facing < 0.0 {
        return nowhere();
    }
    var width = segment_view.wire_width;
    if all(vec3f(a.w, b.w, c.w) > vec3f(a.z, b.z, c.z)) {
        let to_b = to_pixels(b) - to_pixels(a);
        let to_c = to_pixels(c) - to_pixels(a);
        let twice_area = abs(to_b.x * to_c.y - to_b.y * to_c.x);
        let longest = max(length(to_b), max(length(to_c), distance(to_b, to_c)));
        width = clamp(SHARE_OF_HEIGHT * twice_area / max(longest, 1e-6), MIN_WIDTH, width);
    }
    let is_tested = segment_view.wire_is_tested != 0u;
    return segment_corner(a, b, quad_corner(vertex), width, is_tested, segment_view.wire_color);
}

@fragment
fn edge_fragment(fragment: SegmentFragment) -> @location(0) vec4f {
    return segment_color(fragment);
}
