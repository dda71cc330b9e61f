//! Materials.

use std::ops::RangeInclusive;

use glam::Vec3;
use serde::{Deserialize, Serialize};
use tsify::Tsify;

use crate::error::WebError;

/// The greatest radiance, cd/m2, as on the command line.
const BRIGHTEST: f32 = 1e10;
/// The greatest number of a Phong material, as in the console.
const MOST: f32 = 1e6;

/// The shading model of a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "kebab-case")]
pub enum Shading {
    /// glTF's physically based model.
    MetallicRoughness,
    /// Phong's model.
    Phong,
    /// The colour is shown as it is, without lighting.
    Unlit,
}

/// A material. Properties that its shading does not have are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Material {
    /// The name in its file.
    pub name: String,
    /// The shading model, which decides the properties.
    pub shading: Shading,
    /// Whether a texture multiplies its colour.
    pub textured: bool,
    /// Linear red, green and blue, from 0 to 1: the base colour, or Phong's diffuse one.
    #[tsify(type = "[number, number, number]")]
    pub color: Vec3,
    /// Radiance that it emits, in cd/m2.
    #[tsify(type = "[number, number, number]")]
    pub emission: Vec3,
    /// Metalness, from 0 to 1; metallic-roughness only, like the next two.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metallic: Option<f32>,
    /// Roughness, from 0 (a mirror) to 1.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness: Option<f32>,
    /// Factor of a dielectric's reflectance, from 0 to 1.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specular: Option<f32>,
    /// Linear specular colour, from 0 to 1; Phong only, like the next.
    #[tsify(optional, type = "[number, number, number]")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specular_color: Option<Vec3>,
    /// The exponent of the highlight.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shininess: Option<f32>,
}

impl From<&lumivox_scene::Material> for Material {
    fn from(material: &lumivox_scene::Material) -> Self {
        let plain = Self {
            name: material.name.clone(),
            shading: Shading::Unlit,
            textured: false,
            color: Vec3::ONE,
            emission: material.emissive,
            metallic: None,
            roughness: None,
            specular: None,
            specular_color: None,
            shininess: None,
        };
        match &material.shading {
            lumivox_scene::Shading::MetallicRoughness(m) => Self {
                shading: Shading::MetallicRoughness,
                textured: m.base_color_texture.is_some(),
                color: m.base_color.truncate(),
                metallic: Some(m.metallic),
                roughness: Some(m.roughness),
                specular: Some(m.specular),
                ..plain
            },
            lumivox_scene::Shading::Phong(p) => Self {
                shading: Shading::Phong,
                textured: p.diffuse_texture.is_some(),
                color: p.diffuse,
                specular_color: Some(p.specular),
                shininess: Some(p.shininess),
                ..plain
            },
            lumivox_scene::Shading::Unlit(u) => {
                Self { textured: u.color_texture.is_some(), color: u.color.truncate(), ..plain }
            }
        }
    }
}

/// A change of a material; properties that are left out keep their values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(default, deny_unknown_fields)]
pub struct MaterialChange {
    /// Linear colour, from 0 to 1.
    #[tsify(optional, type = "[number, number, number]")]
    pub color: Option<Vec3>,
    /// Emitted radiance in cd/m2, from 0 to 1e10.
    #[tsify(optional, type = "[number, number, number]")]
    pub emission: Option<Vec3>,
    /// Metalness, from 0 to 1; metallic-roughness only, like the next two.
    #[tsify(optional)]
    pub metallic: Option<f32>,
    /// Roughness, from 0 to 1.
    #[tsify(optional)]
    pub roughness: Option<f32>,
    /// Factor of a dielectric's reflectance, from 0 to 1.
    #[tsify(optional)]
    pub specular: Option<f32>,
    /// Linear specular colour, from 0 to 1; Phong only, like the next.
    #[tsify(optional, type = "[number, number, number]")]
    pub specular_color: Option<Vec3>,
    /// The exponent of the highlight, from 0 to 1000000.
    #[tsify(optional)]
    pub shininess: Option<f32>,
}

impl MaterialChange {
    /// The material after this change.
    ///
    /// # Errors
    /// When a number is out of range, or the material's shading has no such property.
    pub fn of(
        &self,
        present: &lumivox_scene::Material,
    ) -> Result<lumivox_scene::Material, WebError> {
        let mut material = present.clone();
        let name = &present.name;
        if let Some(emission) = vector(name, "emission", self.emission, BRIGHTEST)? {
            material.emissive = emission;
        }
        let color = vector(name, "color", self.color, 1.0)?;
        let metallic = number(name, "metallic", self.metallic, 0.0..=1.0)?;
        let roughness = number(name, "roughness", self.roughness, 0.0..=1.0)?;
        let specular = number(name, "specular", self.specular, 0.0..=1.0)?;
        let specular_color = vector(name, "specular_color", self.specular_color, 1.0)?;
        let shininess = number(name, "shininess", self.shininess, 0.0..=MOST)?;
        let of_metal = [("metallic", metallic), ("roughness", roughness), ("specular", specular)];
        let of_phong =
            [("specular_color", specular_color.map(|color| color.x)), ("shininess", shininess)];
        let lacks = |properties: &[(&str, Option<f32>)], shading: &str| match properties
            .iter()
            .find(|(_, value)| value.is_some())
        {
            None => Ok(()),
            Some((property, _)) => Err(WebError::value(format!(
                "the material \"{name}\" has no {property}: its shading is {shading}"
            ))),
        };
        match &mut material.shading {
            lumivox_scene::Shading::MetallicRoughness(m) => {
                lacks(&of_phong, "metallic-roughness")?;
                let alpha = m.base_color.w;
                put(&mut m.base_color, color.map(|color| color.extend(alpha)));
                put(&mut m.metallic, metallic);
                put(&mut m.roughness, roughness);
                put(&mut m.specular, specular);
            }
            lumivox_scene::Shading::Phong(p) => {
                lacks(&of_metal, "phong")?;
                put(&mut p.diffuse, color);
                put(&mut p.specular, specular_color);
                put(&mut p.shininess, shininess);
            }
            lumivox_scene::Shading::Unlit(u) => {
                lacks(&of_metal, "unlit")?;
                lacks(&of_phong, "unlit")?;
                let alpha = u.color.w;
                put(&mut u.color, color.map(|color| color.extend(alpha)));
            }
        }
        if material != *present {
            // Strengths would hide the change in VXCT's look.
            material.strengths = None;
        }
        Ok(material)
    }
}

fn vector(
    name: &str,
    property: &str,
    value: Option<Vec3>,
    most: f32,
) -> Result<Option<Vec3>, WebError> {
    for channel in value.iter().flat_map(Vec3::to_array) {
        number(name, property, Some(channel), 0.0..=most)?;
    }
    Ok(value)
}

fn put<T>(place: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *place = value;
    }
}

fn number(
    name: &str,
    property: &str,
    value: Option<f32>,
    range: RangeInclusive<f32>,
) -> Result<Option<f32>, WebError> {
    match value {
        Some(number) if !range.contains(&number) => Err(WebError::value(format!(
            "{property} of the material \"{name}\" is {number}, but must be from {} to {}",
            range.start(),
            range.end()
        ))),
        value => Ok(value),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec4;
    use lumivox_scene::{Phong, Unlit};

    use super::*;

    fn change(text: &str) -> MaterialChange {
        serde_json::from_str(text).unwrap()
    }

    fn phong() -> lumivox_scene::Material {
        let shading = lumivox_scene::Shading::Phong(Phong::default());
        lumivox_scene::Material { shading, ..Default::default() }
    }

    #[test]
    fn only_named_material_fields_change() {
        let red = lumivox_scene::Material::diffuse("red", Vec3::X);
        let rough = change(r#"{ "roughness": 0.25, "emission": [1, 2, 3] }"#).of(&red).unwrap();
        let told = Material::from(&rough);
        assert_eq!((told.color, told.roughness, told.specular), (Vec3::X, Some(0.25), Some(0.0)));
        assert_eq!((told.emission, told.shininess), (Vec3::new(1.0, 2.0, 3.0), None));
        assert_eq!(change("{}").of(&rough).unwrap(), rough);
        let shiny = change(r#"{ "shininess": 64, "color": [0, 1, 0] }"#).of(&phong()).unwrap();
        let told = Material::from(&shiny);
        assert_eq!((told.shininess, told.color, told.roughness), (Some(64.0), Vec3::Y, None));
    }

    #[test]
    fn changing_the_colour_keeps_alpha() {
        let color = Vec4::new(1.0, 1.0, 1.0, 0.5);
        let shading = lumivox_scene::Shading::Unlit(Unlit { color, color_texture: None });
        let glass = lumivox_scene::Material { shading, ..Default::default() };
        let lumivox_scene::Shading::Unlit(unlit) =
            change(r#"{ "color": [0, 0, 1] }"#).of(&glass).unwrap().shading
        else {
            unreachable!("a change of colour is none of shading")
        };
        assert_eq!(unlit.color, Vec4::new(0.0, 0.0, 1.0, 0.5));
    }

    #[test]
    fn invalid_material_changes_are_refused() {
        let red = lumivox_scene::Material::diffuse("red", Vec3::X);
        let message = |text, material: &_| change(text).of(material).unwrap_err().message;
        assert_eq!(
            message(r#"{ "roughness": 2 }"#, &red),
            "roughness of the material \"red\" is 2, but must be from 0 to 1"
        );
        assert!(message(r#"{ "color": [0, 0, 1.5] }"#, &red).contains("from 0 to 1"));
        assert!(message(r#"{ "emission": [-1, 0, 0] }"#, &red).contains("from 0 to 10000000000"));
        assert!(message(r#"{ "shininess": 3 }"#, &red).contains("no shininess"));
        assert!(message(r#"{ "metallic": 1 }"#, &phong()).contains("no metallic"));
        assert!(serde_json::from_str::<MaterialChange>(r#"{ "colour": [1, 1, 1] }"#).is_err());
    }
}
