// The engine's own G-buffer pass.

struct Camera {
    clip_from_world: mat4x4f,
    // The transform of each instance.
    world_from_local: array<mat4x4f, 2>,
}

@group(0) @binding(0) var<uniform> camera: Camera;

struct Varyings {
    @builtin(position) position: vec4f,
    @location(0) normal: vec3f,
    @location(1) albedo: vec3f,
}

@vertex
fn vertex(
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) albedo: vec3f,
) -> Varyings {
    let transform = camera.world_from_local[instance];
    let in_world = transform * vec4f(position, 1.0);
    let turned = transform * vec4f(normal, 0.0);
    return Varyings(camera.clip_from_world * in_world, turned.xyz, albedo);
}

struct GBuffer {
    @location(0) normals: vec4f,
    @location(1) diffuse: vec4f,
    @location(2) specular: vec4f,
    @location(3) emission: vec4f,
}

// Octahedral map: Meyer et al. 2010, "On floating-point normal vectors".
fn octahedral_encode(normal: vec3f) -> vec2f {
    let flat = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let sides = vec2f(select(-1.0, 1.0, flat.x >= 0.0), select(-1.0, 1.0, flat.y >= 0.0));
    return select((1.0 - abs(flat.yx)) * sides, flat, normal.z >= 0.0);
}

@fragment
fn fragment(varyings: Varyings) -> GBuffer {
    let normal = octahedral_encode(normalize(varyings.normal));
    // This engine has flat Lambert surfaces: both normals are the same, nothing is glossy, nothing
    // glows.
    return GBuffer(vec4f(normal, normal), vec4f(varyings.albedo, 1.0), vec4f(0.0), vec4f(0.0));
}
