// Lines of the caller, six vertices each.

import package::render::passes::overlay::segment::{
    quad_corner, segment_color, segment_corner, segment_view, SegmentFragment, SegmentVertex,
};

struct Line {
    from_in_world: vec3f,
    is_tested: u32,
    to_in_world: vec3f,
    // The width in pixels.
    width: f32,
    color: vec4f,
}

@group(1) @binding(0) var<storage, read> lines: array<Line>;

@vertex
fn line_vertex(@builtin(vertex_index) vertex: u32) -> SegmentVertex {
    let line = lines[vertex / 6u];
    let tail = segment_view.clip_from_world * vec4f(line.from_in_world, 1.0);
    let head = segment_view.clip_from_world * vec4f(line.to_in_world, 1.0);
    return segment_corner(tail, head, quad_corner(vertex), line.width, line.is_tested != 0u, line.color);
}

@fragment
fn line_fragment(fragment: SegmentFragment) -> @location(0) vec4f {
    return segment_color(fragment);
}
