//! Materials: the metallic-roughness core and the extensions that change its numbers. Layers and
//! the specular-glossiness model are in separate files.

mod layers;
mod spec_gloss;

use glam::{Vec3, Vec4};
use gltf::Semantic;

use super::texture::TextureUse;
use super::{Loader, extras, name_or_index};
use crate::load::image::Encoding;
use crate::load::stand_in;
use crate::{AlphaMode, Material, MetallicRoughness, SceneError, Shading, Unlit};

/// The material of a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// One of the file's materials.
    Material(usize),
    /// No material, but vertex colours.
    OnlyColors,
    /// Neither a material nor vertex colours.
    Nothing,
}

impl Loader<'_> {
    /// Loads the material of a primitive once.
    pub(super) fn material(
        &mut self,
        primitive: &gltf::Primitive<'_>,
    ) -> Result<usize, SceneError> {
        let material = primitive.material();
        let key = match material.index() {
            Some(index) => Key::Material(index),
            None if primitive.get(&Semantic::Colors(0)).is_some() => Key::OnlyColors,
            None => Key::Nothing,
        };
        if let Some(&known) = self.materials.get(&key) {
            return Ok(known);
        }
        let converted = match key {
            Key::Material(_) => self.convert(&material)?,
            Key::OnlyColors => stand_in::only_colors(&mut self.notes),
            Key::Nothing => stand_in::no_material(&mut self.notes),
        };
        self.scene.materials.push(converted);
        let index = self.scene.materials.len() - 1;
        self.materials.insert(key, index);
        Ok(index)
    }

    fn convert(&mut self, material: &gltf::Material<'_>) -> Result<Material, SceneError> {
        let index = material.index().unwrap_or_default();
        let name = name_or_index(material.name(), "material", index);
        let alpha = match material.alpha_mode() {
            gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
            gltf::material::AlphaMode::Mask => {
                AlphaMode::Mask { cutoff: material.alpha_cutoff().unwrap_or(0.5) }
            }
            gltf::material::AlphaMode::Blend => AlphaMode::Blend,
        };
        let plain = Material {
            alpha,
            double_sided: material.double_sided(),
            strengths: extras::strengths(material.extras()),
            ..Material::default()
        };
        // The other values of an unlit material are for programs without the extension
        // (`KHR_materials_unlit`).
        if material.unlit() {
            return Ok(Material { shading: self.unlit(material, &name)?, name, ..plain });
        }
        let shading = match material.pbr_specular_glossiness() {
            Some(model) => self.specular_glossiness(&model, &name)?,
            None => self.metallic_roughness(material, &name)?,
        };
        let normal = material.normal_texture();
        let normal_use = normal.as_ref().map(TextureUse::normal);
        let (emissive, emissive_texture) = self.emission(material, &name)?;
        Ok(Material {
            shading: extras::restore_phong(Shading::MetallicRoughness(shading), material.extras()),
            emissive,
            emissive_texture,
            normal_texture: self.plain_texture(normal_use, &name, Encoding::Data)?,
            normal_scale: normal.map_or(1.0, |normal| normal.scale()),
            clearcoat: self.clearcoat(material, &name)?,
            sheen: self.sheen(material, &name)?,
            transmission: self.transmission(material, &name)?,
            name,
            ..plain
        })
    }

    fn unlit(&mut self, material: &gltf::Material<'_>, name: &str) -> Result<Shading, SceneError> {
        let pbr = material.pbr_metallic_roughness();
        let color = pbr.base_color_texture();
        Ok(Shading::Unlit(Unlit {
            color: self.unit_color(pbr.base_color_factor(), name, "base colour"),
            color_texture: self.color_texture(color.as_ref().map(TextureUse::new), name)?,
        }))
    }

    fn metallic_roughness(
        &mut self,
        material: &gltf::Material<'_>,
        name: &str,
    ) -> Result<MetallicRoughness, SceneError> {
        let pbr = material.pbr_metallic_roughness();
        let color = pbr.base_color_texture().as_ref().map(TextureUse::new);
        let rough = pbr.metallic_roughness_texture().as_ref().map(TextureUse::new);
        let shading = MetallicRoughness {
            base_color: self.unit_color(pbr.base_color_factor(), name, "base colour"),
            base_color_texture: self.color_texture(color, name)?,
            metallic: self.unit(pbr.metallic_factor(), name, "metallic factor"),
            roughness: self.unit(pbr.roughness_factor(), name, "roughness factor"),
            metallic_roughness_texture: self.plain_texture(rough, name, Encoding::Data)?,
            ior: self.ior(material.ior(), name),
            ..MetallicRoughness::default()
        };
        self.specular(shading, material, name)
    }

    /// Raises indices of refraction below 1, except 0, which means a reflectance of 1 at normal
    /// incidence (`KHR_materials_ior`).
    fn ior(&mut self, ior: Option<f32>, name: &str) -> f32 {
        match ior {
            None => 1.5,
            Some(ior) if ior > 0.0 && ior < 1.0 => {
                self.notes.warn(format!(
                    "material \"{name}\": its index of refraction of {ior} was raised to 1"
                ));
                1.0
            }
            Some(ior) => ior,
        }
    }

    fn emission(
        &mut self,
        material: &gltf::Material<'_>,
        name: &str,
    ) -> Result<(Vec3, Option<crate::TextureRef>), SceneError> {
        let strength = material.emissive_strength().unwrap_or(1.0);
        let emissive = Vec3::from_array(material.emissive_factor()) * strength;
        let wanted = material.emissive_texture().as_ref().map(TextureUse::new);
        let is_textured = wanted.is_some();
        let texture = self.plain_texture(wanted, name, Encoding::Color)?;
        // Without its emissive texture, the whole surface would emit.
        if is_textured && texture.is_none() {
            return Ok((Vec3::ZERO, None));
        }
        Ok((emissive, texture))
    }

    fn unit_color<const N: usize>(&mut self, color: [f32; N], material: &str, what: &str) -> Vec4 {
        let mut all = [1.0; 4];
        for (all, value) in all.iter_mut().zip(color) {
            *all = self.unit(value, material, what);
        }
        Vec4::from_array(all)
    }

    /// Clamps a factor to 0..1, which some exporters exceed.
    fn unit(&mut self, value: f32, material: &str, what: &str) -> f32 {
        let clamped = value.clamp(0.0, 1.0);
        if value.is_finite() && !(0.0..=1.0).contains(&value) {
            self.notes.warn(format!(
                "material \"{material}\": its {what} of {value} was limited to {clamped}"
            ));
        }
        // Values that are not finite are kept, so that validation reports them by name.
        if value.is_finite() { clamped } else { value }
    }
}
