// The reflection of a traced pixel in two forms (share_reflections.wgsl).

struct Reflections {
    // The pixel's own, without the part that one ray hit by chance.
    own: vec3f,
    // The mean over pixels around.
    wide: vec3f,
    // Number of cone samples.
    samples: f32,
}

fn brightness(light: vec3f) -> f32 {
    return dot(light, vec3f(1.0 / 3.0));
}

fn pack_reflections(reflections: Reflections) -> vec4u {
    return vec4u(
        pack2x16float(reflections.own.rg),
        pack2x16float(vec2f(reflections.own.b, reflections.samples)),
        pack2x16float(reflections.wide.rg),
        pack2x16float(vec2f(reflections.wide.b, 0.0)),
    );
}

fn unpack_reflections(packed: vec4u) -> Reflections {
    let blue_and_samples = unpack2x16float(packed.y);
    return Reflections(
        vec3f(unpack2x16float(packed.x), blue_and_samples.x),
        vec3f(unpack2x16float(packed.z), unpack2x16float(packed.w).x),
        blue_and_samples.y,
    );
}

// The reflection in rgb, the samples in a; `share` is the weight of the mean over pixels around.
fn blended(reflections: Reflections, share: f32) -> vec4f {
    return vec4f(mix(reflections.own, reflections.wide, share), reflections.samples);
}
