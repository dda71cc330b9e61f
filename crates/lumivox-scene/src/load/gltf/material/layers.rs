//! Extensions that add layers or change the reflection: specular colour, clearcoat, sheen,
//! transmission. If an extension has two textures, they are combined into the single texture of the
//! scene's material.

use glam::Vec3;
use serde_json::Value;

use super::super::Loader;
use super::super::texture::TextureUse;
use crate::load::image::Encoding;
use crate::{Clearcoat, MetallicRoughness, SceneError, Sheen, Transmission};

const COLOR: [bool; 4] = [true, true, true, false];
const ALPHA: [bool; 4] = [false, false, false, true];
const RED: [bool; 4] = [true, false, false, false];
const GREEN: [bool; 4] = [false, true, false, false];

impl Loader<'_> {
    /// `KHR_materials_specular`: the reflectance and the reflected colour of a dielectric.
    pub(super) fn specular(
        &mut self,
        shading: MetallicRoughness,
        material: &gltf::Material<'_>,
        name: &str,
    ) -> Result<MetallicRoughness, SceneError> {
        let Some(specular) = material.specular() else { return Ok(shading) };
        let color = specular.specular_color_texture().as_ref().map(TextureUse::new);
        let strength = specular.specular_texture().as_ref().map(TextureUse::new);
        Ok(MetallicRoughness {
            specular: self.unit(specular.specular_factor(), name, "specular factor"),
            specular_color: Vec3::from_array(specular.specular_color_factor()),
            specular_texture: self.pair(
                name,
                "specular",
                [(color, COLOR), (strength, ALPHA)],
                Encoding::Color,
            )?,
            ..shading
        })
    }

    /// `KHR_materials_clearcoat`.
    pub(super) fn clearcoat(
        &mut self,
        material: &gltf::Material<'_>,
        name: &str,
    ) -> Result<Clearcoat, SceneError> {
        let Some(coat) = material.extension_value("KHR_materials_clearcoat") else {
            return Ok(Clearcoat::default());
        };
        let part = format!("material \"{name}\", its KHR_materials_clearcoat");
        if !coat["clearcoatNormalTexture"].is_null() {
            self.notes.warn(format!(
                "material \"{name}\": the clearcoat's own normal texture is not supported, it is \
                 smooth"
            ));
        }
        let strength = self.texture_use(&coat["clearcoatTexture"], &part);
        let roughness = self.texture_use(&coat["clearcoatRoughnessTexture"], &part);
        Ok(Clearcoat {
            strength: self.unit_in(coat, "clearcoatFactor", name),
            roughness: self.unit_in(coat, "clearcoatRoughnessFactor", name),
            texture: self.pair(
                name,
                "clearcoat",
                [(strength, RED), (roughness, GREEN)],
                Encoding::Data,
            )?,
        })
    }

    /// `KHR_materials_sheen`.
    pub(super) fn sheen(
        &mut self,
        material: &gltf::Material<'_>,
        name: &str,
    ) -> Result<Sheen, SceneError> {
        let Some(sheen) = material.extension_value("KHR_materials_sheen") else {
            return Ok(Sheen::default());
        };
        let part = format!("material \"{name}\", its KHR_materials_sheen");
        let color = self.texture_use(&sheen["sheenColorTexture"], &part);
        let roughness = self.texture_use(&sheen["sheenRoughnessTexture"], &part);
        let factor = match sheen["sheenColorFactor"].as_array().map(Vec::as_slice) {
            Some([r, g, b]) => [r, g, b].map(|c| c.as_f64().map_or(f32::NAN, |c| c as f32)),
            _ => [0.0; 3],
        };
        Ok(Sheen {
            color: self.unit_color(factor, name, "sheen colour").truncate(),
            roughness: self.unit_in(sheen, "sheenRoughnessFactor", name),
            texture: self.pair(
                name,
                "sheen",
                [(color, COLOR), (roughness, ALPHA)],
                Encoding::Color,
            )?,
        })
    }

    /// `KHR_materials_transmission`.
    pub(super) fn transmission(
        &mut self,
        material: &gltf::Material<'_>,
        name: &str,
    ) -> Result<Transmission, SceneError> {
        let Some(transmission) = material.transmission() else {
            return Ok(Transmission::default());
        };
        let texture = transmission.transmission_texture().as_ref().map(TextureUse::new);
        let factor = transmission.transmission_factor();
        Ok(Transmission {
            factor: self.unit(factor, name, "transmission factor"),
            texture: self.plain_texture(texture, name, Encoding::Data)?,
        })
    }

    /// Reads a factor from 0 to 1 from an extension's JSON; 0 if it is missing.
    fn unit_in(&mut self, extension: &Value, key: &str, material: &str) -> f32 {
        let value = extension[key].as_f64().unwrap_or(0.0) as f32;
        self.unit(value, material, key)
    }
}
