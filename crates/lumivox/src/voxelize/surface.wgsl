// The appearance of a triangle's surface at a point: its material's factors times its textures and
// colours.

import package::constants::{ALPHA_IS_COVERAGE, HAS_BYTE_COLORS, HAS_COLORS, HAS_FLOAT_COLORS};
import package::voxelize::triangles::{attributes, draws, TexturePlace};
import package::voxelize::walk::Walk;

// White if the material has no texture.
@group(3) @binding(1) var reflectance_texture: texture_2d<f32>;
@group(3) @binding(2) var reflectance_sampler: sampler;
@group(3) @binding(3) var emission_texture: texture_2d<f32>;
@group(3) @binding(4) var emission_sampler: sampler;
@group(3) @binding(5) var transmission_texture: texture_2d<f32>;
@group(3) @binding(6) var transmission_sampler: sampler;

struct Surface {
    // Reflectance of the covered part.
    reflectance: vec3f,
    // The covered share, which blocks light.
    coverage: f32,
    // Relative to the scale of all materials' emission.
    emission: vec3f,
}

// Texture coordinates over the triangle, and their density.
struct TexcoordMap {
    at_a: vec2f,
    along_ab: vec2f,
    along_ac: vec2f,
    // log4 of a sample's area in texture space. log4 of the texture's number of texels is added for
    // the mip level whose texels are as large as the sample.
    level: f32,
}

// The textures' coordinates, which vary over the triangle.
struct SurfaceMap {
    reflectance: TexcoordMap,
    emission: TexcoordMap,
    transmission: TexcoordMap,
    color_at_a: vec4f,
    color_along_ab: vec4f,
    color_along_ac: vec4f,
}

// The detail that a kernel samples: constants, since a software GPU samples even in branches that
// are not taken.
//
// UNIFORM: the same appearance everywhere, and no holes. VARIED: textures or colours. PIERCED:
// textures, colours, and light that passes through.
const UNIFORM: u32 = 0;
const VARIED: u32 = 1;
const PIERCED: u32 = 2;

fn texcoord_at(vertex: u32, draw: u32, place: TexturePlace) -> vec2f {
    let word = vertex * draws[draw].vertex_words + place.word;
    let own = vec3f(bitcast<f32>(attributes[word]), bitcast<f32>(attributes[word + 1u]), 1.0);
    return vec2f(dot(place.u_row, own), dot(place.v_row, own));
}

fn texcoord_map(vertices: vec3u, draw: u32, place: TexturePlace, footprints: f32) -> TexcoordMap {
    let a = texcoord_at(vertices.x, draw, place);
    let ab = texcoord_at(vertices.y, draw, place) - a;
    let ac = texcoord_at(vertices.z, draw, place) - a;
    let density = abs(ab.x * ac.y - ab.y * ac.x) / footprints;
    return TexcoordMap(a, ab, ac, 0.5 * log2(clamp(density, 1e-30, 1e30)));
}

fn color_at(vertex: u32, draw: u32) -> vec4f {
    if (draws[draw].flags & HAS_COLORS) == 0u {
        return vec4f(1.0);
    }
    let word = vertex * draws[draw].vertex_words + draws[draw].color_word;
    if (draws[draw].flags & HAS_FLOAT_COLORS) != 0u {
        let words = vec4u(
            attributes[word], attributes[word + 1u], attributes[word + 2u], attributes[word + 3u]);
        return bitcast<vec4f>(words);
    }
    if (draws[draw].flags & HAS_BYTE_COLORS) != 0u {
        return unpack4x8unorm(attributes[word]);
    }
    return vec4f(unpack2x16unorm(attributes[word]), unpack2x16unorm(attributes[word + 1u]));
}

// `footprints` is twice the triangle's area divided by the area of a sample.
fn triangle_map(vertices: vec3u, draw: u32, footprints: f32) -> SurfaceMap {
    let color = color_at(vertices.x, draw);
    return SurfaceMap(
        texcoord_map(vertices, draw, draws[draw].reflectance_place, footprints),
        texcoord_map(vertices, draw, draws[draw].emission_place, footprints),
        texcoord_map(vertices, draw, draws[draw].transmission_place, footprints),
        color,
        color_at(vertices.y, draw) - color,
        color_at(vertices.z, draw) - color,
    );
}

// The map for samples as large as a voxel's side.
fn surface_map(walk: ptr<function, Walk>) -> SurfaceMap {
    return triangle_map((*walk).vertices, (*walk).draw, length((*walk).normal));
}

fn sample_at(image: texture_2d<f32>, image_sampler: sampler, map: TexcoordMap, at: vec2f) -> vec4f {
    let size = vec2f(textureDimensions(image));
    // Texels as large as the sample: finer ones would alias, and shift colours.
    let mip = max(map.level + 0.5 * log2(size.x * size.y), 0.0);
    let texcoord = map.at_a + at.x * map.along_ab + at.y * map.along_ac;
    return textureSampleLevel(image, image_sampler, texcoord, mip);
}

// The surface at a point of the triangle, in the walk's coordinates. `detail` is UNIFORM, VARIED or
// PIERCED.
fn surface_at(walk: ptr<function, Walk>, map: SurfaceMap, point: vec3f, detail: u32) -> Surface {
    // Barycentric coordinates, seen along the dominant axis.
    let p = point.xy - (*walk).a.xy;
    let ab = (*walk).b.xy - (*walk).a.xy;
    let ac = (*walk).c.xy - (*walk).a.xy;
    let of_b = clamp((p.x * ac.y - p.y * ac.x) / (*walk).normal.z, 0.0, 1.0);
    let of_c = clamp((ab.x * p.y - ab.y * p.x) / (*walk).normal.z, 0.0, 1.0);
    return surface_of((*walk).draw, map, vec2f(of_b, of_c), detail);
}

// The surface at barycentric coordinates: the weights of b and c.
fn surface_of(draw: u32, map: SurfaceMap, at: vec2f, detail: u32) -> Surface {
    var reflectance = draws[draw].reflectance;
    var emission = draws[draw].emission;
    var coverage = 1.0;
    if detail != UNIFORM {
        let color = map.color_at_a + at.x * map.color_along_ab + at.y * map.color_along_ac;
        reflectance *= color
            * sample_at(reflectance_texture, reflectance_sampler, map.reflectance, at);
        emission *= sample_at(emission_texture, emission_sampler, map.emission, at).rgb;
    }
    reflectance = clamp(reflectance, vec4f(0.0), vec4f(1.0));
    if detail == PIERCED {
        // The share t of the entering light passes through, coloured by the reflectance r; the rest
        // is reflected. Voxels block all colours alike, so the luminance Y passes through, and the
        // remaining, blocking part reflects r (1 - t) / (1 - t Y): no more than arrives.
        let share = draws[draw].transmission
            * sample_at(transmission_texture, transmission_sampler, map.transmission, at).r;
        // ITU-R BT.709-6, section 3.2.
        let luminance = dot(reflectance.rgb, vec3f(0.2126, 0.7152, 0.0722));
        let blocked = 1.0 - clamp(share * luminance, 0.0, 1.0);
        let alpha = select(1.0, reflectance.a, (draws[draw].flags & ALPHA_IS_COVERAGE) != 0u);
        coverage = alpha * blocked;
        let kept = (1.0 - share) / max(blocked, 1e-6);
        reflectance = clamp(reflectance * kept, vec4f(0.0), vec4f(1.0));
    }
    return Surface(reflectance.rgb, coverage, clamp(emission, vec3f(0.0), vec3f(1.0)));
}
