// The visible surface of a pixel, as a G-buffer module returns it, and the encoding of unit vectors
// in two numbers.

struct Surface {
    position_in_world: vec3f,
    // Positive; 0 if the pixel does not show a surface.
    depth: f32,
    // Unit vectors, both towards the camera.
    shading_normal: vec3f,
    geometric_normal: vec3f,
}

// The specular properties of a pixel's surface.
struct Specular {
    // Reflectance at normal incidence.
    reflectance: vec3f,
    // Perceptual roughness, 0 to 1.
    roughness: f32,
    // The strength of a clear coat on top, 0 (none) to 1, and its perceptual roughness.
    coat: f32,
    coat_roughness: f32,
}

// Whether the surface reflects at all: a matt one does not.
fn is_glossy(specular: Specular) -> bool {
    return any(specular.reflectance > vec3f(0.0)) || specular.coat > 0.0;
}

// Octahedral map: Meyer et al. 2010, "On floating-point normal vectors".
fn octahedral_decode(encoded: vec2f) -> vec3f {
    var normal = vec3f(encoded, 1.0 - abs(encoded.x) - abs(encoded.y));
    let fold = max(-normal.z, 0.0);
    normal.x += select(fold, -fold, normal.x >= 0.0);
    normal.y += select(fold, -fold, normal.y >= 0.0);
    return normalize(normal);
}

fn octahedral_encode(normal: vec3f) -> vec2f {
    let flat = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let sides = vec2f(select(-1.0, 1.0, flat.x >= 0.0), select(-1.0, 1.0, flat.y >= 0.0));
    return select((1.0 - abs(flat.yx)) * sides, flat, normal.z >= 0.0);
}
