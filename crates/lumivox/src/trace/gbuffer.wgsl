// The caller's G-buffer: group 3 of every pass over the screen.

struct CameraView {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    position_in_world: vec3f,
    // Counts the frames that are accumulated; it moves the jitter.
    frame: u32,
    size: vec2u,
    padding_0: u32,
    padding_1: u32,
}

// A storage buffer, not a uniform: lavapipe 22.3 crashes when it inlines uniforms into kernels that march cones
// from here.
@group(3) @binding(0) var<storage, read> view: CameraView;
// Reversed z: 1 at the near plane, 0 infinitely far and where there is nothing.
@group(3) @binding(1) var gbuffer_depth: texture_depth_2d;
// Octahedral unit vectors in [-1, 1]: shading normal in xy, geometric normal in zw; both face the camera.
@group(3) @binding(2) var gbuffer_normals: texture_2d<f32>;
// Diffuse albedo in rgb; in a 1 - the strength of a clear coat.
@group(3) @binding(3) var gbuffer_diffuse: texture_2d<f32>;
// Specular reflectance at normal incidence in rgb, perceptual roughness in a.
@group(3) @binding(4) var gbuffer_specular: texture_2d<f32>;
// Emitted radiance in rgb; the coat's perceptual roughness in a.
@group(3) @binding(5) var gbuffer_emission: texture_2d<f32>;

struct Surface {
    position_in_world: vec3f,
    // 0 where the pixel shows no surface.
    depth: f32,
    shading_normal: vec3f,
    geometric_normal: vec3f,
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

// World position of a pixel's centre at a depth.
fn position_from_depth(pixel: vec2u, depth: f32) -> vec3f {
    let uv = (vec2f(pixel) + 0.5) / vec2f(view.size);
    let ndc = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    let world = view.world_from_clip * vec4f(ndc, depth, 1.0);
    return world.xyz / world.w;
}

// The unit vector from the camera through a pixel's centre, from where it meets infinity: points nearby would
// lose its digits to the camera's own position.
fn ray_direction(pixel: vec2u) -> vec3f {
    let uv = (vec2f(pixel) + 0.5) / vec2f(view.size);
    let ndc = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    let far = view.world_from_clip * vec4f(ndc, 0.0, 1.0);
    return normalize(far.xyz - far.w * view.position_in_world);
}

fn load_surface(pixel: vec2u) -> Surface {
    let depth = textureLoad(gbuffer_depth, pixel, 0);
    let normals = textureLoad(gbuffer_normals, pixel, 0);
    return Surface(
        position_from_depth(pixel, max(depth, 1e-7)),
        depth,
        octahedral_decode(normals.xy),
        octahedral_decode(normals.zw),
    );
}
