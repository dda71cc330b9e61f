// The textures of a material's layers, for fragment shaders.

import package::constants::{TEXTURE_COAT, TEXTURE_SHEEN, TEXTURE_SPECULAR, TEXTURE_TRANSMISSION};
import package::render::scene::layers::LayerSamples;
import package::render::scene::material::{
    coat_sampler, coat_texture, material, sheen_albedo, sheen_albedo_sampler, sheen_sampler,
    sheen_texture, specular_sampler, specular_texture, texcoord, transmission_sampler,
    transmission_texture,
};

// Call it only in uniform control flow.
fn sample_layers(texcoords: vec4f, alpha: f32, cos_view: f32) -> LayerSamples {
    let specular = textureSample(
        specular_texture, specular_sampler, texcoord(TEXTURE_SPECULAR, texcoords));
    let coat = textureSample(coat_texture, coat_sampler, texcoord(TEXTURE_COAT, texcoords));
    let sheen = textureSample(sheen_texture, sheen_sampler, texcoord(TEXTURE_SHEEN, texcoords));
    let transmission = textureSample(
        transmission_texture, transmission_sampler, texcoord(TEXTURE_TRANSMISSION, texcoords));
    let sheen_roughness = material.sheen_roughness * sheen.a;
    let f0 = min(material.dielectric_f0 * specular.rgb, vec3f(1.0));
    return LayerSamples(
        f0 * (material.specular_factor * specular.a),
        material.coat_strength * coat.r,
        material.coat_roughness * coat.g,
        material.sheen_color * sheen.rgb,
        sheen_roughness,
        material.transmission * transmission.r,
        textureSampleLevel(
            sheen_albedo, sheen_albedo_sampler, vec2f(cos_view, sheen_roughness), 0.0).r,
        select(1.0, alpha, material.is_blended != 0u),
        select(1.0, 0.0, material.unlit_radiance > 0.0),
    );
}
