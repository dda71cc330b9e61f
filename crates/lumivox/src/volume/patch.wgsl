// A face for rays, in PATCH_TEXELS texels: the plane and the mask of its surface; the mask's
// profiles; and its reflected radiance with properties, and its emission.

import package::constants::{GLASS, HOLES, LARGEST_HALF, PARTED, SINGLE_SIDED};

struct Patch {
    // The plane, in the voxel's coordinates: dot(normal, p) = offset. The normal has any length.
    normal: vec3f,
    offset: f32,
    lobe: u32,
    is_single_sided: bool,
    // The share of light that passes through, times 255; of glass, at normal incidence.
    holes: u32,
    is_parted: bool,
    is_glass: bool,
}

// Placeholders for a face's light: no surface, a single-sided surface from behind, or a surface
// whose light is unknown.
const NOTHING = 0xffffffffu;
const BLACK = 0xfffffffeu;
const UNLIT = 0xfffffffdu;

// Maximum absolute offset. Offsets have 20 bits; the start, the point where the face's light is
// gathered, has six bits along each side.
const MOST_OFFSET = 1.05;
const OFFSET_STEPS = 1048575.0;

fn pack_offset(offset: f32, start: vec2f) -> u32 {
    let steps = round((clamp(offset / MOST_OFFSET, -1.0, 1.0) * 0.5 + 0.5) * OFFSET_STEPS);
    let place = vec2u(clamp(floor(64.0 * start), vec2f(0.0), vec2f(63.0)));
    return u32(steps) | (place.x << 20u) | (place.y << 26u);
}

fn unpack_offset(packed: u32) -> f32 {
    return (f32(packed & 0xfffffu) / OFFSET_STEPS * 2.0 - 1.0) * MOST_OFFSET;
}

// Octahedral (Cigolle et al. 2014, "A survey of efficient representations for independent unit
// vectors").
fn pack_normal(normal: vec3f) -> u32 {
    let size = abs(normal.x) + abs(normal.y) + abs(normal.z);
    let flat = normal.xy / size;
    let folded = (1.0 - abs(flat.yx)) * select(vec2f(-1.0), vec2f(1.0), flat >= vec2f(0.0));
    return pack2x16snorm(select(flat, folded, normal.z < 0.0));
}

// The normal, of any length.
fn unpack_normal(packed: u32) -> vec3f {
    let flat = unpack2x16snorm(packed);
    let z = 1.0 - abs(flat.x) - abs(flat.y);
    let folded = (1.0 - abs(flat.yx)) * select(vec2f(-1.0), vec2f(1.0), flat >= vec2f(0.0));
    return vec3f(select(flat, folded, z < 0.0), z);
}

fn pack_light(radiance: vec3f, lobe: u32, flags: u32) -> vec2u {
    let stored = min(radiance, vec3f(LARGEST_HALF));
    let look = lobe
        | select(0u, 8u, (flags & SINGLE_SIDED) != 0u)
        | select(0u, 0x1000u, (flags & PARTED) != 0u)
        | select(0u, 0x2000u, (flags & GLASS) != 0u)
        | (extractBits(flags, HOLES, 8u) << 4u);
    return vec2u(pack2x16float(stored.rg), pack2x16float(vec2f(stored.b, 0.0)) | (look << 16u));
}

fn pack_emission(emission: vec3f) -> vec2u {
    let stored = min(emission, vec3f(LARGEST_HALF));
    return vec2u(pack2x16float(stored.rg), pack2x16float(vec2f(stored.b, 0.0)));
}

fn unpack_radiance(light: vec2u) -> vec3f {
    return vec3f(unpack2x16float(light.x), unpack2x16float(light.y).x);
}

fn unpack_patch(plane: vec2u, light: vec2u) -> Patch {
    let look = light.y >> 16u;
    return Patch(
        unpack_normal(plane.x),
        unpack_offset(plane.y),
        look & 7u,
        (look & 8u) != 0u,
        (look >> 4u) & 0xffu,
        (look & 0x1000u) != 0u,
        (look & 0x2000u) != 0u,
    );
}

// The point where the light of a face is gathered; `packed` is the second word of its patch.
fn start_of(plane: Patch, packed: u32) -> vec3f {
    let axis = plane.lobe >> 1u;
    let uv = (vec2f(vec2u(extractBits(packed, 20u, 6u), packed >> 26u)) + 0.5) / 64.0;
    var start = vec3f(0.0);
    start[(axis + 1u) % 3u] = uv.x;
    start[(axis + 2u) % 3u] = uv.y;
    start[axis] = (plane.offset - dot(plane.normal, start)) / plane.normal[axis];
    return start;
}
