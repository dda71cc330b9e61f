//! Whether a scene has any light.

use crate::{EnvironmentMap, Light, Material, Scene, Shading, Texture};

/// Texels up to this code (of 255) count as black: compression makes black images a little grey.
const BLACK: u8 = 8;

pub(super) fn shines(scene: &Scene) -> bool {
    scene.lights.iter().any(light_shines)
        || surroundings_shine(scene)
        || used(scene).any(|material| emits(material, &scene.textures))
        || is_unlit(scene)
}

/// Whether the scene's own emission is its only light.
pub(super) fn by_emission_alone(scene: &Scene) -> bool {
    !scene.lights.iter().any(light_shines)
        && !surroundings_shine(scene)
        && !is_unlit(scene)
        && used(scene).any(|material| emits(material, &scene.textures))
}

fn used(scene: &Scene) -> impl Iterator<Item = &Material> {
    let materials = scene.shown().map(|instance| instance.material);
    materials.filter_map(|index| scene.materials.get(index))
}

/// Whether all surfaces are unlit.
pub(super) fn is_unlit(scene: &Scene) -> bool {
    let mut unlit = used(scene).map(|material| matches!(material.shading, Shading::Unlit(_)));
    scene.triangle_count() > 0 && unlit.all(|is_unlit| is_unlit)
}

pub(super) fn surroundings_shine(scene: &Scene) -> bool {
    let is_black =
        |map: &EnvironmentMap| map.rgb.as_flattened().iter().all(|&channel| channel <= 0.0);
    let environment = &scene.environment;
    environment.radiance.max_element() > 0.0 && !environment.map.as_deref().is_some_and(is_black)
}

fn light_shines(light: &Light) -> bool {
    light.intensity * light.color.max_element() > 0.0
}

/// Whether a material emits. Exporters often switch emission on, and leave the dark to a black
/// texture.
fn emits(material: &Material, textures: &[Texture]) -> bool {
    let is_lit = |texel: &[u8]| texel[..3].iter().any(|&channel| channel > BLACK);
    let texture = material.emissive_texture.and_then(|t| textures.get(t.texture));
    material.emissive.max_element() > 0.0
        && texture.is_none_or(|texture| texture.rgba8.chunks_exact(4).any(is_lit))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{TextureRef, Unlit, builtin};

    fn dark() -> Scene {
        let mut scene = builtin::scene("cornell").unwrap();
        scene.lights.clear();
        scene.materials.iter_mut().for_each(|material| material.emissive = Vec3::ZERO);
        scene
    }

    #[test]
    fn shines_considers_every_kind_of_light() {
        assert!(!dark().shines());
        let mut scene = dark();
        scene.environment.radiance = Vec3::new(0.0, 0.0, 1e-6);
        assert!(scene.shines());
        let mut scene = dark();
        scene.lights.push(Light::default());
        assert!(scene.shines());
        scene.lights[0].color = Vec3::ZERO;
        assert!(!scene.shines());
        let mut scene = dark();
        scene.materials[0].emissive = Vec3::X;
        assert!(scene.shines());
        let mut scene = dark();
        let unlit = Shading::Unlit(Unlit::default());
        scene.materials[0].shading = unlit;
        assert!(!scene.shines());
        scene.materials.iter_mut().for_each(|material| material.shading = unlit);
        assert!(scene.shines());
    }

    #[test]
    fn scenes_lit_only_by_emission_are_recognized() {
        assert!(!dark().is_lit_by_emission_alone());
        let mut glowing = dark();
        glowing.materials[0].emissive = Vec3::X;
        assert!(glowing.is_lit_by_emission_alone());
        let mut scene = glowing.clone();
        scene.lights.push(Light::default());
        assert!(!scene.is_lit_by_emission_alone());
        scene.lights[0].color = Vec3::ZERO;
        assert!(scene.is_lit_by_emission_alone());
        let mut scene = glowing.clone();
        scene.environment.radiance = Vec3::splat(1e-3);
        assert!(!scene.is_lit_by_emission_alone());
        let unlit = Shading::Unlit(Unlit::default());
        glowing.materials.iter_mut().for_each(|material| material.shading = unlit);
        assert!(!glowing.is_lit_by_emission_alone());
    }

    #[test]
    fn emission_with_a_black_texture_does_not_count() {
        let mut scene = dark();
        let mut rgba8 = [3, 0, 5, 255].repeat(4);
        let texture = Texture {
            name: String::new(),
            width: 2,
            height: 2,
            rgba8: rgba8.clone(),
            sampler: crate::Sampler::default(),
        };
        scene.textures.push(texture);
        scene.materials[0].emissive = Vec3::ONE;
        scene.materials[0].emissive_texture = Some(TextureRef::new(scene.textures.len() - 1));
        assert!(!scene.shines());
        rgba8[5] = 100;
        scene.textures.last_mut().unwrap().rgba8 = rgba8;
        assert!(scene.shines());
    }
}
