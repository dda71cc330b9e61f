//! The reports on materials and textures of a scene.

use lumivox_console::report::{Table, bytes};
use lumivox_scene::{AlphaMode, Material, Scene, Shading, Texture, TextureRef};
use serde::Serialize;

/// The report on a material.
#[derive(Clone, Debug, Serialize)]
pub struct MaterialReport {
    pub name: String,
    /// `metallic-roughness`, `Phong` or `unlit`.
    kind: &'static str,
    /// Base colour, diffuse colour (Phong) or shown colour (unlit), linear RGB.
    color: [f32; 3],
    /// Metallic factor, 0 to 1; `None` for Phong and unlit.
    metallic: Option<f32>,
    roughness: Option<f32>,
    /// Emitted radiance, cd/m².
    emissive: [f32; 3],
    /// `opaque`, `mask` or `blend`.
    alpha: &'static str,
    /// The least alpha at which a masked surface is visible.
    alpha_cutoff: Option<f32>,
    double_sided: bool,
    /// Clearcoat factor, 0 to 1.
    clearcoat: f32,
    transmission: f32,
    has_sheen: bool,
    textures: Vec<TextureUse>,
}

/// The use of a texture by a material.
#[derive(Clone, Debug, Serialize)]
struct TextureUse {
    /// `base colour`, `normal` and so on.
    role: &'static str,
    texture: usize,
    /// The set of texture coordinates, from 0.
    uv_set: u32,
}

/// The report on a texture.
#[derive(Clone, Debug, Serialize)]
pub struct TextureReport {
    name: String,
    width: u32,
    height: u32,
    /// Bytes of the finest level, in main memory.
    bytes: u64,
    /// The texture's roles in materials; empty if it is unused.
    roles: Vec<&'static str>,
    /// Number of materials that use the texture.
    materials: usize,
}

/// The textures of a material with their roles.
fn uses(material: &Material) -> impl Iterator<Item = (&'static str, TextureRef)> {
    let shading = match &material.shading {
        Shading::MetallicRoughness(m) => [
            ("base colour", m.base_color_texture),
            ("metallic-roughness", m.metallic_roughness_texture),
            ("specular", m.specular_texture),
        ],
        Shading::Phong(p) => {
            [("diffuse", p.diffuse_texture), ("specular", p.specular_texture), ("", None)]
        }
        Shading::Unlit(u) => [("colour", u.color_texture), ("", None), ("", None)],
    };
    let layers = [
        ("normal", material.normal_texture),
        ("emissive", material.emissive_texture),
        ("clearcoat", material.clearcoat.texture),
        ("sheen", material.sheen.texture),
        ("transmission", material.transmission.texture),
    ];
    shading.into_iter().chain(layers).filter_map(|(role, used)| Some((role, used?)))
}

impl MaterialReport {
    /// The report on a material.
    pub fn new(material: &Material) -> Self {
        let (kind, color, metallic, roughness) = match &material.shading {
            Shading::MetallicRoughness(m) => {
                let color = m.base_color.truncate();
                ("metallic-roughness", color, Some(m.metallic), Some(m.roughness))
            }
            Shading::Phong(p) => ("Phong", p.diffuse, None, None),
            Shading::Unlit(u) => ("unlit", u.color.truncate(), None, None),
        };
        let (alpha, alpha_cutoff) = match material.alpha {
            AlphaMode::Opaque => ("opaque", None),
            AlphaMode::Mask { cutoff } => ("mask", Some(cutoff)),
            AlphaMode::Blend => ("blend", None),
        };
        let textures = uses(material).map(|(role, used)| TextureUse {
            role,
            texture: used.texture,
            uv_set: used.uv_set,
        });
        Self {
            name: material.name.clone(),
            kind,
            color: color.to_array(),
            metallic,
            roughness,
            emissive: material.emissive.to_array(),
            alpha,
            alpha_cutoff,
            double_sided: material.double_sided,
            clearcoat: material.clearcoat.strength,
            transmission: material.transmission.factor,
            has_sheen: material.sheen.color.max_element() > 0.0,
            textures: textures.collect(),
        }
    }

    /// The unusual properties of the material.
    fn traits(&self) -> String {
        let emits = self.emissive.iter().any(|value| *value > 0.0);
        let [r, g, b] = self.emissive;
        let mask = format!("mask {:.2}", self.alpha_cutoff.unwrap_or_default());
        let traits = [
            (emits, format!("emits {r:.1},{g:.1},{b:.1} cd/m2")),
            (self.alpha == "mask", mask),
            (self.alpha == "blend", "blend".to_owned()),
            (self.double_sided, "both sides".to_owned()),
            (self.clearcoat > 0.0, "clearcoat".to_owned()),
            (self.has_sheen, "sheen".to_owned()),
            (self.transmission > 0.0, "transmission".to_owned()),
        ];
        let kept: Vec<String> = traits.into_iter().filter(|(has, _)| *has).map(|t| t.1).collect();
        kept.join(", ")
    }
}

impl TextureReport {
    /// The reports on all textures of a scene.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let mut reports: Vec<Self> = scene.textures.iter().map(Self::new).collect();
        for material in &scene.materials {
            let mut counted = Vec::new();
            for (role, used) in uses(material) {
                let Some(report) = reports.get_mut(used.texture) else { continue };
                if !report.roles.contains(&role) {
                    report.roles.push(role);
                }
                if !counted.contains(&used.texture) {
                    counted.push(used.texture);
                    report.materials += 1;
                }
            }
        }
        reports
    }

    fn new(texture: &Texture) -> Self {
        Self {
            name: texture.name.clone(),
            width: texture.width,
            height: texture.height,
            bytes: texture.rgba8.len() as u64,
            roles: Vec::new(),
            materials: 0,
        }
    }
}

/// A table of materials.
pub fn material_table(materials: &[MaterialReport]) -> Table {
    let heading = ["#", "material", "kind", "colour", "metal", "rough", "textures", "other"];
    let mut table = Table::left(&heading);
    for (index, material) in materials.iter().enumerate() {
        let [r, g, b] = material.color;
        let number = |value: Option<f32>| value.map_or(String::new(), |v| format!("{v:.2}"));
        let textures: Vec<String> = material
            .textures
            .iter()
            .map(|used| format!("{} {}", used.role, used.texture))
            .collect();
        table.row([
            index.to_string(),
            material.name.clone(),
            material.kind.to_owned(),
            format!("{r:.3},{g:.3},{b:.3}"),
            number(material.metallic),
            number(material.roughness),
            textures.join(", "),
            material.traits(),
        ]);
    }
    table
}

/// A table of textures.
pub fn texture_table(textures: &[TextureReport]) -> Table {
    let mut table = Table::left(&["#", "texture", "texels", "memory", "used for", "by materials"]);
    for (index, texture) in textures.iter().enumerate() {
        table.row([
            index.to_string(),
            texture.name.clone(),
            format!("{}x{}", texture.width, texture.height),
            bytes(texture.bytes),
            texture.roles.join(", "),
            texture.materials.to_string(),
        ]);
    }
    table
}
