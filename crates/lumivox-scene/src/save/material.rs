//! Materials: the metallic-roughness core, and the additions of extensions and extras.

use glam::{Vec3, Vec4};
use serde_json::{Map, Value, json};

use super::Writer;
use super::document::{number, numbers, own_extras};
use crate::load::shorten;
use crate::{AlphaMode, Material, MetallicRoughness, Phong, Shading, Strengths, TextureRef};

/// Builds a JSON object; omits defaults.
#[derive(Default)]
pub(super) struct Object(pub(super) Map<String, Value>);

impl Object {
    pub(super) fn set(&mut self, key: &str, value: Value) {
        self.0.insert(key.to_owned(), value);
    }

    pub(super) fn factor(&mut self, key: &str, value: f32, default: f32) {
        if value.to_bits() != default.to_bits() {
            self.set(key, number(value));
        }
    }

    pub(super) fn color(&mut self, key: &str, value: Vec3, default: Vec3) {
        if value.to_array().map(f32::to_bits) != default.to_array().map(f32::to_bits) {
            self.set(key, numbers(value.as_ref()));
        }
    }
}

fn exact_strengths(strengths: &Strengths) -> Value {
    let Strengths { color, ambient, diffuse, specular, shininess, is_rounded } = *strengths;
    json!({
        "color": numbers(color.as_ref()),
        "ambient": number(ambient),
        "diffuse": number(diffuse),
        "specular": number(specular),
        "shininess": number(shininess),
        "rounded": is_rounded,
    })
}

impl Writer<'_> {
    /// Writes a material of the scene once, and returns its index in the file.
    pub(super) fn material(&mut self, index: usize) -> usize {
        if let Some(known) = self.materials[index] {
            return known;
        }
        let scene = self.scene;
        let json = self.convert(&scene.materials[index]);
        let written = self.document.push("materials", &json);
        self.materials[index] = Some(written);
        written
    }

    fn convert(&mut self, material: &Material) -> Value {
        let mut json = Object::default();
        let mut extensions = Map::new();
        json.set("name", json!(shorten(&material.name)));
        let mut own = Map::new();
        if let Some(strengths) = &material.strengths {
            own.insert("strengths".to_owned(), exact_strengths(strengths));
        }
        match &material.shading {
            Shading::MetallicRoughness(m) => self.core(m, &mut json, &mut extensions),
            Shading::Phong(phong) => {
                self.core(&stand_in(phong), &mut json, &mut extensions);
                let exact = json!({ "shininess": number(phong.shininess) });
                own.insert("phong".to_owned(), exact);
            }
            Shading::Unlit(unlit) => {
                // For programs without the extension, it recommends a rough, nonmetallic material.
                let core = MetallicRoughness {
                    base_color: unlit.color,
                    base_color_texture: unlit.color_texture,
                    ..MetallicRoughness::default()
                };
                self.core(&core, &mut json, &mut extensions);
                self.extension(&mut extensions, "KHR_materials_unlit", Object::default());
            }
        }
        if !own.is_empty() {
            own_extras(&mut json.0, &own);
        }
        if takes_light(material) {
            self.layers(material, &mut extensions);
            self.emission(material, &mut json, &mut extensions);
            if let Some(normal) = material.normal_texture {
                let mut info = Object(self.texture_info(normal));
                info.factor("scale", material.normal_scale, 1.0);
                json.set("normalTexture", Value::Object(info.0));
            }
        }
        match material.alpha {
            AlphaMode::Opaque => {}
            AlphaMode::Mask { cutoff } => {
                json.set("alphaMode", json!("MASK"));
                json.factor("alphaCutoff", cutoff, 0.5);
            }
            AlphaMode::Blend => json.set("alphaMode", json!("BLEND")),
        }
        if material.double_sided {
            json.set("doubleSided", json!(true));
        }
        if !extensions.is_empty() {
            json.set("extensions", Value::Object(extensions));
        }
        Value::Object(json.0)
    }

    fn core(
        &mut self,
        m: &MetallicRoughness,
        json: &mut Object,
        extensions: &mut Map<String, Value>,
    ) {
        let mut pbr = Object::default();
        if m.base_color.to_array().map(f32::to_bits) != Vec4::ONE.to_array().map(f32::to_bits) {
            pbr.set("baseColorFactor", numbers(m.base_color.as_ref()));
        }
        self.map(&mut pbr, "baseColorTexture", m.base_color_texture);
        pbr.factor("metallicFactor", m.metallic, 1.0);
        pbr.factor("roughnessFactor", m.roughness, 1.0);
        self.map(&mut pbr, "metallicRoughnessTexture", m.metallic_roughness_texture);
        json.set("pbrMetallicRoughness", Value::Object(pbr.0));

        let mut specular = Object::default();
        specular.factor("specularFactor", m.specular, 1.0);
        specular.color("specularColorFactor", m.specular_color, Vec3::ONE);
        // One image for both, as in the scene.
        self.map(&mut specular, "specularTexture", m.specular_texture);
        self.map(&mut specular, "specularColorTexture", m.specular_texture);
        if !specular.0.is_empty() {
            self.extension(extensions, "KHR_materials_specular", specular);
        }
        let mut ior = Object::default();
        ior.factor("ior", m.ior, 1.5);
        if !ior.0.is_empty() {
            self.extension(extensions, "KHR_materials_ior", ior);
        }
    }

    /// glTF's emission is a factor up to 1 times a strength. A strength that is a power of two
    /// leaves the factor's digits unchanged.
    fn emission(
        &mut self,
        material: &Material,
        json: &mut Object,
        extensions: &mut Map<String, Value>,
    ) {
        let emissive = material.emissive;
        let mut strength = power_of_two_above(emissive.max_element());
        if emissive.max_element() > strength || emissive / strength * strength != emissive {
            // The strength exceeds the largest power, or the smallest component would lose digits.
            strength = emissive.max_element();
        }
        json.color("emissiveFactor", emissive / strength, Vec3::ZERO);
        if strength > 1.0 {
            let mut object = Object::default();
            object.set("emissiveStrength", number(strength));
            self.extension(extensions, "KHR_materials_emissive_strength", object);
        }
        self.map(json, "emissiveTexture", material.emissive_texture);
    }

    /// Writes a reference to a texture if there is one.
    pub(super) fn map(&mut self, object: &mut Object, key: &str, texture: Option<TextureRef>) {
        if let Some(texture) = texture {
            let info = self.texture_info(texture);
            object.set(key, Value::Object(info));
        }
    }

    pub(super) fn extension(
        &mut self,
        extensions: &mut Map<String, Value>,
        name: &'static str,
        object: Object,
    ) {
        self.document.uses(name);
        extensions.insert(name.to_owned(), Value::Object(object.0));
    }
}

/// Whether the material is lit; of others only the colour counts.
pub(super) fn takes_light(material: &Material) -> bool {
    !matches!(material.shading, Shading::Unlit(_))
}

/// The textures of a material that are written.
pub(super) fn textures(material: &Material) -> Vec<TextureRef> {
    match &material.shading {
        Shading::Unlit(unlit) => unlit.color_texture.into_iter().collect(),
        _ => material.textures().collect(),
    }
}

/// The least power of two that is at least `value` and at least 1; the largest power of f32 if
/// `value` is beyond it.
pub(super) fn power_of_two_above(value: f32) -> f32 {
    let mut power = 1.0_f32;
    while power < value && power < 2.0_f32.powi(127) {
        power *= 2.0;
    }
    power
}

/// The metallic-roughness substitute for a Phong material. The lobe `cos^n` is about as wide as a
/// microfacet distribution of `alpha^2 = 2 / (n + 2)` (Walter, Marschner, Li and Torrance 2007,
/// "Microfacet models for refraction through rough surfaces", section 5.2), and its colour is the
/// reflectance at normal incidence, which needs an index of refraction of 0.
fn stand_in(phong: &Phong) -> MetallicRoughness {
    let alpha = (2.0 / (phong.shininess + 2.0)).sqrt();
    MetallicRoughness {
        base_color: phong.diffuse.extend(phong.opacity),
        base_color_texture: phong.diffuse_texture,
        roughness: alpha.sqrt(),
        // Without a lobe, there is no reflection at grazing angles either.
        specular: if phong.specular == Vec3::ZERO { 0.0 } else { 1.0 },
        specular_color: phong.specular,
        specular_texture: phong.specular_texture,
        ior: 0.0,
        ..MetallicRoughness::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_of_two_above_rounds_up() {
        for (value, power) in [(0.0, 1.0), (1.0, 1.0), (1.5, 2.0), (2.0, 2.0), (17_000.0, 32_768.0)]
        {
            assert_eq!(power_of_two_above(value), power);
        }
        assert_eq!(power_of_two_above(f32::MAX), 2.0_f32.powi(127));
    }
}
