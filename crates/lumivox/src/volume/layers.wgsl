// Combines the faces of a lobe in a voxel to the content of a finest cell.
//
// Layers lie behind each other. As in a column of cells (column.wgsl), a layer adds to those in
// front of it up to full coverage.

import package::voxels::list::{Face, lobe_axis, lobe_sign};

struct Layers {
    // Radiance times opacity, and opacity: the area along the lobe.
    value: vec4f,
    // The vector area across the lobe's axis, in cyclic order.
    tilt: vec2f,
}

fn opacity_of(face: Face) -> f32 {
    return abs(face.vector_area[lobe_axis(face.lobe)]);
}

// The position of a face along its lobe's direction.
fn height_of(face: Face) -> f32 {
    return face.position_in_world[lobe_axis(face.lobe)] * lobe_sign(face.lobe);
}

// Adds a layer; `hidden` is the coverage in front of it.
fn with_layer(layers: Layers, face: Face, radiance: vec3f, hidden: f32) -> Layers {
    let axis = lobe_axis(face.lobe);
    let opacity = opacity_of(face);
    let shown = min(opacity, max(1.0 - hidden, 0.0)) / max(opacity, 1e-30);
    let across = vec2f(face.vector_area[(axis + 1u) % 3u], face.vector_area[(axis + 2u) % 3u]);
    return Layers(
        layers.value + shown * vec4f(radiance * opacity, opacity),
        layers.tilt + shown * across,
    );
}
