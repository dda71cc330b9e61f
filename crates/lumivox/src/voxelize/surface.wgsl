// What a triangle's surface looks like at a point: its material's factors times its textures.

import package::voxelize::triangles::{draws, texcoords};
import package::voxelize::walk::Walk;

// Textures are white where the material has none.
@group(3) @binding(1) var reflectance_texture: texture_2d<f32>;
@group(3) @binding(2) var emission_texture: texture_2d<f32>;
@group(3) @binding(3) var surface_sampler: sampler;

struct Surface {
    reflectance: vec3f,
    coverage: f32,
    // Relative to the largest of all materials.
    emission: vec3f,
}

// Texture coordinates over the triangle, and how dense they are.
struct TexcoordMap {
    at_a: vec2f,
    along_ab: vec2f,
    along_ac: vec2f,
    // Area in texture space over area in voxels, as a power of 4: the mip level of a texture of one texel
    // whose texel is as large as a voxel's side.
    level: f32,
}

fn texcoord_map(walk: ptr<function, Walk>) -> TexcoordMap {
    let a = texcoords[(*walk).vertices.x];
    let ab = texcoords[(*walk).vertices.y] - a;
    let ac = texcoords[(*walk).vertices.z] - a;
    let density = abs(ab.x * ac.y - ab.y * ac.x) / length((*walk).normal);
    return TexcoordMap(a, ab, ac, 0.5 * log2(clamp(density, 1e-30, 1e30)));
}

fn sample_at(image: texture_2d<f32>, texcoord: vec2f, level: f32) -> vec4f {
    let size = vec2f(textureDimensions(image));
    // A texel as large as the voxel: finer ones would alias, and shift colours.
    let mip = max(level + 0.5 * log2(size.x * size.y), 0.0);
    return textureSampleLevel(image, surface_sampler, texcoord, mip);
}

// The surface at a point of the triangle, in the walk's coordinates. `is_textured` is a constant of the kernel:
// a software GPU samples even where a branch says not to.
fn surface_at(walk: ptr<function, Walk>, map: TexcoordMap, point: vec3f, is_textured: bool) -> Surface {
    let draw = (*walk).draw;
    var reflectance = draws[draw].reflectance;
    var emission = draws[draw].emission;
    if is_textured {
        // Barycentric coordinates, seen along the dominant axis.
        let p = point.xy - (*walk).a.xy;
        let ab = (*walk).b.xy - (*walk).a.xy;
        let ac = (*walk).c.xy - (*walk).a.xy;
        let of_b = clamp((p.x * ac.y - p.y * ac.x) / (*walk).normal.z, 0.0, 1.0);
        let of_c = clamp((ab.x * p.y - ab.y * p.x) / (*walk).normal.z, 0.0, 1.0);
        let texcoord = map.at_a + of_b * map.along_ab + of_c * map.along_ac;
        reflectance *= sample_at(reflectance_texture, texcoord, map.level);
        emission *= sample_at(emission_texture, texcoord, map.level).rgb;
    }
    let range = vec3f(1.0);
    return Surface(
        clamp(reflectance.rgb, vec3f(0.0), range),
        clamp(reflectance.a, 0.0, 1.0),
        clamp(emission, vec3f(0.0), range),
    );
}
