// The surface where a ray hits a triangle. Materials are evaluated with the rasterizer's code.

import package::constants::{
    REFERENCE_HAS_LAYERS, REFERENCE_HAS_TEXTURES, TEXTURE_BASE_COLOR, TEXTURE_COAT,
    TEXTURE_EMISSION, TEXTURE_METALLIC_ROUGHNESS, TEXTURE_NORMAL, TEXTURE_SHEEN, TEXTURE_SPECULAR,
    TEXTURE_TRANSMISSION,
};
import package::render::scene::layers::{shade_layers, LayerSamples};
import package::render::scene::normals::{bend, facing};
import package::render::reference::intersect::{Hit, Ray};
import package::render::reference::scatter::Surface;
import package::render::reference::texels::sample_texture;
import package::render::reference::world::{materials, triangle_at, vertices, VERTEX_INDEX};
import package::trace::brdf::alpha_from_roughness;
import package::trace::coat::Coat;

// The directional albedo of sheen: cosine along u, roughness along v (scene/sheen.rs).
@group(0) @binding(11) var sheen_albedo: texture_2d<f32>;

struct Met {
    surface: Surface,
    emission: vec3f,
    // The probability that the surface exists, and the colour of the light that passes if it does
    // not.
    coverage: f32,
    tint: vec3f,
    emitter_density: f32,
}

fn velvet_albedo(cosine: f32, roughness: f32) -> f32 {
    let size = vec2f(textureDimensions(sheen_albedo));
    let at = clamp(vec2f(cosine, roughness) * size - 0.5, vec2f(0.0), size - 1.0);
    let low = vec2i(at);
    let high = min(low + 1, vec2i(size) - 1);
    let share = fract(at);
    return mix(
        mix(
            textureLoad(sheen_albedo, low, 0).r,
            textureLoad(sheen_albedo, vec2i(high.x, low.y), 0).r,
            share.x,
        ),
        mix(
            textureLoad(sheen_albedo, vec2i(low.x, high.y), 0).r,
            textureLoad(sheen_albedo, high, 0).r,
            share.x,
        ),
        share.y,
    );
}

fn texture_at(material: u32, which: u32, texcoords: vec4f) -> vec4f {
    if REFERENCE_HAS_TEXTURES == 0u {
        return vec4f(1.0);
    }
    return sample_texture(material, which, texcoords);
}

// `is_seen`: the camera sees the hit directly. There, an unlit surface shows its colour; to other
// surfaces it is diffuse, as in the voxels.
fn meet(ray: Ray, hit: Hit, is_seen: bool) -> Met {
    let triangle = triangle_at(hit.triangle);
    let weights = vec3f(1.0 - hit.weights.x - hit.weights.y, hit.weights);
    let first = triangle.vertex_0 & VERTEX_INDEX;
    let material = vertices[first].material;
    let texcoords = weights.x * vertices[first].texcoords
        + weights.y * vertices[triangle.vertex_1].texcoords
        + weights.z * vertices[triangle.vertex_2].texcoords;
    let smooth_normal = normalize(weights.x * vertices[first].normal
        + weights.y * vertices[triangle.vertex_1].normal
        + weights.z * vertices[triangle.vertex_2].normal);
    let toward = -ray.direction;

    let base = materials[material].shown.base_color
        * vertex_color(first, triangle.vertex_1, triangle.vertex_2, weights)
        * texture_at(material, TEXTURE_BASE_COLOR, texcoords);
    let metallic_roughness = texture_at(material, TEXTURE_METALLIC_ROUGHNESS, texcoords);
    let metallic = materials[material].shown.metallic * metallic_roughness.b;
    let roughness = materials[material].shown.roughness * metallic_roughness.g;
    let unlit_radiance = materials[material].shown.unlit_radiance;
    var emission = materials[material].shown.emission * texture_at(material, TEXTURE_EMISSION, texcoords).rgb;
    let is_lit = unlit_radiance <= 0.0 || !is_seen;
    if !is_lit {
        emission += unlit_radiance * base.rgb;
    }

    // Computed from the corner and the edges: the distance along the ray is less precise.
    let position = triangle.corner + hit.weights.x * triangle.edge_1 + hit.weights.y * triangle.edge_2;
    var geometric = normalize(cross(triangle.edge_1, triangle.edge_2));
    geometric = select(-geometric, geometric, dot(geometric, toward) >= 0.0);
    // If the ray hits the back, the whole shading frame is flipped.
    let side = select(-1.0, 1.0, dot(smooth_normal, geometric) >= 0.0);
    var shading = smooth_normal;
    if REFERENCE_HAS_TEXTURES != 0u && materials[material].shown.has_normal_texture != 0u {
        let tangent = weights.x * vertices[first].tangent
            + weights.y * vertices[triangle.vertex_1].tangent
            + weights.z * vertices[triangle.vertex_2].tangent;
        shading = bend(
            smooth_normal,
            vec4f(tangent.xyz, vertices[first].tangent.w),
            texture_at(material, TEXTURE_NORMAL, texcoords).xyz,
            materials[material].shown.normal_scale,
        );
    }
    shading = facing(side * shading, geometric, toward);
    // Normals that cancel each other out and tangents along the normal are undefined; use the
    // triangle's normal.
    shading = select(geometric, shading, abs(dot(shading, shading) - 1.0) < 0.01);

    var met: Met;
    let lit = select(0.0, 1.0, is_lit);
    if REFERENCE_HAS_LAYERS == 0u {
        let f0 = mix(materials[material].shown.dielectric_f0, base.rgb, metallic);
        met.surface.diffuse = base.rgb * ((1.0 - metallic) * lit);
        met.surface.f0 = f0;
        met.emission = emission;
        met.coverage = 1.0;
        met.tint = vec3f(1.0);
        met.surface.coat = Coat(0.0, 1.0);
    } else {
        let specular = texture_at(material, TEXTURE_SPECULAR, texcoords);
        let coat = texture_at(material, TEXTURE_COAT, texcoords);
        let sheen = texture_at(material, TEXTURE_SHEEN, texcoords);
        let f0 = min(materials[material].shown.dielectric_f0 * specular.rgb, vec3f(1.0));
        let sheen_roughness = materials[material].shown.sheen_roughness * sheen.a;
        let cos_view = saturate(dot(shading, toward));
        let samples = LayerSamples(
            f0 * (materials[material].shown.specular_factor * specular.a),
            materials[material].shown.coat_strength * coat.r,
            materials[material].shown.coat_roughness * coat.g,
            materials[material].shown.sheen_color * sheen.rgb,
            sheen_roughness,
            materials[material].shown.transmission
                * texture_at(material, TEXTURE_TRANSMISSION, texcoords).r,
            velvet_albedo(cos_view, sheen_roughness),
            select(1.0, base.a, materials[material].shown.is_blended != 0u),
            lit,
        );
        let layered = shade_layers(samples, base.rgb, metallic, emission, cos_view);
        met.surface.diffuse = layered.diffuse;
        met.surface.f0 = layered.f0;
        met.surface.coat = Coat(layered.coat_strength, alpha_from_roughness(layered.coat_roughness));
        met.emission = layered.emission;
        met.coverage = layered.coverage;
        met.tint = layered.tint;
    }
    if base.a < materials[material].shown.mask_threshold {
        met.coverage = 0.0;
        met.tint = vec3f(1.0);
    }
    met.surface.position = position;
    met.surface.geometric = geometric;
    met.surface.shading = shading;
    met.surface.toward = toward;
    met.surface.alpha = alpha_from_roughness(roughness);
    met.surface.phong_exponent = materials[material].phong_exponent;
    met.emitter_density = materials[material].emitter_density;
    return met;
}

fn vertex_color(a: u32, b: u32, c: u32, weights: vec3f) -> vec4f {
    return weights.x * color_of(a) + weights.y * color_of(b) + weights.z * color_of(c);
}

fn color_of(vertex: u32) -> vec4f {
    let packed = vertices[vertex].color;
    return vec4f(unpack2x16unorm(packed.x), unpack2x16unorm(packed.y));
}
