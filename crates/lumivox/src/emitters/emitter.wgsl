// Triangles that shine by themselves, as lights.

struct Emitter {
    // A corner and the edges from there, in the grid's coordinates; counter-clockwise seen from the front.
    corner: vec3f,
    // The power of all emitters up to this one: strength times area.
    power_so_far: f32,
    along_ab: vec3f,
    // 1: it shines to the back as well.
    is_double_sided: u32,
    along_ac: vec3f,
    padding_0: u32,
    // The same all over.
    radiance: vec3f,
    padding_1: u32,
}

struct EmitterList {
    count: u32,
    // Not zero: the volume shows emission to all cones, so nothing is drawn. That is so from a change of the voxels to
    // the light after it, and while the volume has no room for the change.
    is_shown: u32,
    power: f32,
    padding: u32,
    emitters: array<Emitter>,
}

// What counts where one of several is drawn: all channels alike. With luminance the rare blue ones would bring thirteen
// times their share, and that is noise.
fn strength(radiance: vec3f) -> f32 {
    return dot(radiance, vec3f(1.0 / 3.0));
}
