// A G-buffer of the inside of a box, drawn by a ray per pixel.

struct Camera {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    // The position; then the picture's width and height.
    position_in_world: vec3f,
    width: f32,
    box_size: vec3f,
    height: f32,
}

@group(0) @binding(0) var<uniform> camera: Camera;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

struct Hit {
    position_in_world: vec3f,
    normal: vec3f,
    depth: f32,
}

// The point where a ray from inside hits the box; a disc in the middle of the picture is empty.
fn hit(pixel: vec2f) -> Hit {
    let uv = pixel / vec2f(camera.width, camera.height);
    if distance(uv, vec2f(0.5)) < 0.1 {
        return Hit(vec3f(0.0), vec3f(0.0, 0.0, 1.0), 0.0);
    }
    let far = camera.world_from_clip * vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0);
    let direction = normalize(far.xyz - far.w * camera.position_in_world);
    let walls = select(vec3f(0.0), camera.box_size, direction > vec3f(0.0));
    let distances = (walls - camera.position_in_world) / direction;
    let nearest = min(distances.x, min(distances.y, distances.z));
    let position = camera.position_in_world + nearest * direction;
    let normal = -sign(direction) * vec3f(distances == vec3f(nearest));
    let clip = camera.clip_from_world * vec4f(position, 1.0);
    return Hit(position, normal, clip.z / clip.w);
}

// Octahedral map: Meyer et al. 2010, "On floating-point normal vectors".
fn octahedral_encode(normal: vec3f) -> vec2f {
    let flat = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    let sides = vec2f(select(-1.0, 1.0, flat.x >= 0.0), select(-1.0, 1.0, flat.y >= 0.0));
    return select((1.0 - abs(flat.yx)) * sides, flat, normal.z >= 0.0);
}

fn shading_normal(surface: Hit) -> vec3f {
    return normalize(surface.normal + 0.2 * sin(20.0 * surface.position_in_world));
}

fn normals_of(surface: Hit) -> vec4f {
    return vec4f(octahedral_encode(shading_normal(surface)), octahedral_encode(surface.normal));
}

fn specular_of(surface: Hit) -> vec4f {
    let roughness = 0.3 + 0.4 * surface.position_in_world.x;
    return vec4f(vec3f(0.5), roughness);
}

// The uncoated share of the surface, and the coat's roughness.
fn coat_of(surface: Hit) -> vec2f {
    return vec2f(select(1.0, 0.4, surface.position_in_world.z > 0.5), 0.2);
}

struct GBuffer {
    @builtin(frag_depth) depth: f32,
    @location(0) normals: vec4f,
    @location(1) diffuse: vec4f,
    @location(2) specular: vec4f,
    @location(3) emission: vec4f,
}

@fragment
fn textures(@builtin(position) pixel: vec4f) -> GBuffer {
    let surface = hit(pixel.xy);
    let coat = coat_of(surface);
    return GBuffer(
        surface.depth,
        normals_of(surface),
        vec4f(vec3f(0.5), coat.x),
        specular_of(surface),
        vec4f(vec3f(0.0), coat.y),
    );
}

// A shadow map with an object near the light in its left half only, in reversed and in normal z.
@fragment
fn shadow(@builtin(position) pixel: vec4f) -> @builtin(frag_depth) f32 {
    return select(0.0, 1.0, pixel.x < 0.5 * camera.width);
}

@fragment
fn forward_shadow(@builtin(position) pixel: vec4f) -> @builtin(frag_depth) f32 {
    return select(1.0, 0.0, pixel.x < 0.5 * camera.width);
}
