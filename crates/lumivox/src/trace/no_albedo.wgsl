// A caller's own G-buffer has no function for the diffuse albedo: the module
// package::trace::albedo_method.

const KNOWS_ALBEDO = false;

fn load_albedo(pixel: vec2u) -> vec3f {
    return vec3f(0.0);
}
