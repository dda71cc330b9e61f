//! Materials: the metallic-roughness core and the factors of four extensions.

use glam::{Vec3, Vec4};

use super::{Loader, extras, name_or_index};
use crate::{AlphaMode, Material, MetallicRoughness, SceneError, Shading, TextureRef};

/// Between stone and plaster.
const NO_MATERIAL_ALBEDO: f32 = 0.5;

impl Loader<'_> {
    /// Loads a material once.
    pub(super) fn material(&mut self, material: &gltf::Material<'_>) -> Result<usize, SceneError> {
        if let Some(&known) = self.materials.get(&material.index()) {
            return Ok(known);
        }
        let converted = match material.index() {
            Some(_) => self.convert(material)?,
            None => self.no_material(),
        };
        self.scene.materials.push(converted);
        let index = self.scene.materials.len() - 1;
        self.materials.insert(material.index(), index);
        Ok(index)
    }

    /// What meshes without a material look like. By the letter that is a white rough metal of
    /// reflectance 1 (glTF 2.0, section 3.9.6), in which indirect light would never die out; nobody
    /// who leaves materials out means it.
    fn no_material(&mut self) -> Material {
        self.notes.warn(format!(
            "meshes without a material are shown matte grey with an albedo of {NO_MATERIAL_ALBEDO}"
        ));
        // Such files are mostly bare geometry, wound as it came: seen from both sides nothing is missing.
        Material {
            double_sided: true,
            ..Material::diffuse("no material", Vec3::splat(NO_MATERIAL_ALBEDO))
        }
    }

    fn convert(&mut self, material: &gltf::Material<'_>) -> Result<Material, SceneError> {
        let index = material.index().unwrap_or_default();
        let name = name_or_index(material.name(), "material", index);
        let pbr = material.pbr_metallic_roughness();

        let specular = material.specular();
        if let Some(specular) = &specular {
            let plain = specular.specular_texture().is_none()
                && specular.specular_color_texture().is_none()
                && Vec3::from_array(specular.specular_color_factor()) == Vec3::ONE;
            if !plain {
                self.notes.warn(format!(
                    "material \"{name}\": of KHR_materials_specular only the factor is used, not \
                     its colour and textures"
                ));
            }
        }
        let shading = MetallicRoughness {
            base_color: Vec4::from_array(pbr.base_color_factor())
                .map(|c| self.unit(c, &name, "base colour")),
            base_color_texture: self.texture_info(pbr.base_color_texture(), &name)?,
            metallic: self.unit(pbr.metallic_factor(), &name, "metallic factor"),
            roughness: self.unit(pbr.roughness_factor(), &name, "roughness factor"),
            metallic_roughness_texture: self
                .texture_info(pbr.metallic_roughness_texture(), &name)?,
            specular: self.unit(
                specular.map_or(1.0, |specular| specular.specular_factor()),
                &name,
                "specular factor",
            ),
            ior: material.ior().unwrap_or(1.5),
            ..MetallicRoughness::default()
        };

        let strength = material.emissive_strength().unwrap_or(1.0);
        let emissive = Vec3::from_array(material.emissive_factor()) * strength;
        let (normal_texture, normal_scale) = match material.normal_texture() {
            Some(normal) => {
                self.check_texture_use(
                    &name,
                    normal.tex_coord(),
                    normal.extension_value("KHR_texture_transform").is_some(),
                );
                (self.texture(&normal.texture())?, normal.scale())
            }
            None => (None, 1.0),
        };
        let alpha = match material.alpha_mode() {
            gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
            gltf::material::AlphaMode::Mask => {
                AlphaMode::Mask { cutoff: material.alpha_cutoff().unwrap_or(0.5) }
            }
            gltf::material::AlphaMode::Blend => AlphaMode::Blend,
        };
        Ok(Material {
            shading: extras::restore_phong(Shading::MetallicRoughness(shading), material.extras()),
            emissive,
            emissive_texture: self.texture_info(material.emissive_texture(), &name)?,
            normal_texture,
            normal_scale,
            alpha,
            double_sided: material.double_sided(),
            name,
            ..Material::default()
        })
    }

    fn texture_info(
        &mut self,
        info: Option<gltf::texture::Info<'_>>,
        material: &str,
    ) -> Result<Option<TextureRef>, SceneError> {
        let Some(info) = info else { return Ok(None) };
        let moved = info.texture_transform().is_some();
        self.check_texture_use(material, info.tex_coord(), moved);
        self.texture(&info.texture())
    }

    fn check_texture_use(&mut self, material: &str, set: u32, moved: bool) {
        if set != 0 {
            self.notes.warn(format!(
                "material \"{material}\": a texture wants coordinate set {set}, set 0 is used"
            ));
        }
        if moved {
            self.notes.warn(format!(
                "material \"{material}\": KHR_texture_transform is not supported and was ignored"
            ));
        }
    }

    /// A factor that the format limits to 0..1; some exporters exceed it.
    fn unit(&mut self, value: f32, material: &str, what: &str) -> f32 {
        let clamped = value.clamp(0.0, 1.0);
        if value.is_finite() && !(0.0..=1.0).contains(&value) {
            self.notes.warn(format!(
                "material \"{material}\": its {what} of {value} was limited to {clamped}"
            ));
        }
        // What is not finite stays, for validation to refuse by name.
        if value.is_finite() { clamped } else { value }
    }
}
