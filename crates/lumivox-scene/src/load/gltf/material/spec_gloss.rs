//! Converts the older model, `KHR_materials_pbrSpecularGlossiness`, to the newer one.
//!
//! Its surface is a dielectric whose parts are independent: a diffuse colour, a reflectance at
//! normal incidence for each of red, green and blue, and a glossiness. That is metallic-roughness
//! with no metal, an index of refraction of 0 (which leaves the reflectance to the specular
//! colour), the unchanged specular colour, a roughness of 1 - glossiness, and a base colour from
//! which the extension subtracts the reflected share: diffuse * (1 - max(specular)). Textures are
//! converted by the same formulas.

use glam::Vec3;

use super::super::Loader;
use super::super::texture::TextureUse;
use crate::load::image::Encoding;
use crate::load::textures::Mix;
use crate::{MetallicRoughness, SceneError};

impl Loader<'_> {
    pub(super) fn specular_glossiness(
        &mut self,
        model: &gltf::material::PbrSpecularGlossiness<'_>,
        name: &str,
    ) -> Result<MetallicRoughness, SceneError> {
        let diffuse_factor = self.unit_color(model.diffuse_factor(), name, "diffuse factor");
        let specular = self.unit_color(model.specular_factor(), name, "specular factor").truncate();
        let glossiness = self.unit(model.glossiness_factor(), name, "glossiness factor");
        let diffuse_use = model.diffuse_texture().as_ref().map(TextureUse::new);
        let diffuse = self.place(diffuse_use, name)?;
        let gloss_use = model.specular_glossiness_texture().as_ref().map(TextureUse::new);
        let gloss = self.place(gloss_use, name)?;

        let mut shading = MetallicRoughness {
            base_color: diffuse_factor,
            base_color_texture: diffuse.map(|placed| self.whole(placed, Encoding::Color)),
            metallic: 0.0,
            roughness: 1.0 - glossiness,
            specular_color: specular,
            ior: 0.0,
            ..MetallicRoughness::default()
        };
        let is_missing = diffuse_use.is_some() && diffuse.is_none();
        if is_missing {
            shading.base_color_texture = Some(self.stand_in());
        }
        let Some(gloss) = gloss else {
            let rest = (1.0 - specular.max_element()).clamp(0.0, 1.0);
            let color: Vec3 = diffuse_factor.truncate() * rest;
            return Ok(MetallicRoughness { base_color: color.extend(diffuse_factor.w), ..shading });
        };
        if !is_missing {
            if diffuse.is_some_and(|diffuse| !diffuse.matches(&gloss)) {
                self.notes.warn(format!(
                    "material \"{name}\": its diffuse and specular textures lie differently on the \
                     surface; what the second takes from the first was placed like the first"
                ));
            }
            let images = diffuse.iter().chain([&gloss]).map(|placed| placed.image).collect();
            let mix = Mix::SpecularDiffuse { specular: specular.to_array().map(Into::into) };
            let placed = diffuse.unwrap_or(gloss);
            shading.base_color_texture = Some(self.mixed(placed, images, mix, Encoding::Color));
        }
        let color = [Some((0, 0)), Some((0, 1)), Some((0, 2)), None];
        let mix = Mix::Channels(color);
        shading.specular_texture = Some(self.mixed(gloss, vec![gloss.image], mix, Encoding::Color));
        let mix = Mix::GlossToRoughness { glossiness: glossiness.into() };
        shading.metallic_roughness_texture =
            Some(self.mixed(gloss, vec![gloss.image], mix, Encoding::Data));
        shading.roughness = 1.0;
        Ok(shading)
    }
}
