//! The parameters of a material for the passes that rasterize.

use bytemuck::{Pod, Zeroable};
use glam::{Affine2, Vec3};
use lumivox_scene::{AlphaMode, Material, Shading, TextureRef};

/// The textures of a material: the names of their indices in shaders, and whether they contain
/// colours.
pub(crate) const TEXTURES: [(&str, bool); TEXTURE_COUNT] = [
    ("TEXTURE_BASE_COLOR", true),
    ("TEXTURE_METALLIC_ROUGHNESS", false),
    ("TEXTURE_NORMAL", false),
    ("TEXTURE_EMISSION", true),
    ("TEXTURE_SPECULAR", true),
    ("TEXTURE_COAT", false),
    ("TEXTURE_SHEEN", true),
    ("TEXTURE_TRANSMISSION", false),
];
pub(crate) const TEXTURE_COUNT: usize = 8;

/// `TexturePlace` of `material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct TexturePlace {
    pub(crate) u_row: [f32; 3],
    pub(crate) texcoord_set: u32,
    pub(crate) v_row: [f32; 3],
    padding: u32,
}

/// `Material` of `material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct MaterialRecord {
    pub(crate) base_color: [f32; 4],
    pub(crate) emission: [f32; 3],
    pub(crate) normal_scale: f32,
    pub(crate) dielectric_f0: [f32; 3],
    pub(crate) roughness: f32,
    pub(crate) sheen_color: [f32; 3],
    pub(crate) sheen_roughness: f32,
    pub(crate) metallic: f32,
    pub(crate) has_normal_texture: u32,
    pub(crate) mask_threshold: f32,
    pub(crate) unlit_radiance: f32,
    pub(crate) specular_factor: f32,
    pub(crate) coat_strength: f32,
    pub(crate) coat_roughness: f32,
    pub(crate) transmission: f32,
    pub(crate) is_blended: u32,
    padding: [u32; 3],
    pub(crate) places: [TexturePlace; TEXTURE_COUNT],
}

/// The alpha at the edge of a thresholded mask texture.
const TEXTURE_MASK_THRESHOLD: f32 = 0.5;

impl TexturePlace {
    pub(crate) fn new(reference: Option<TextureRef>) -> Self {
        let transform = reference.map_or(Affine2::IDENTITY, |reference| reference.transform);
        Self {
            u_row: transform.matrix2.row(0).extend(transform.translation.x).to_array(),
            texcoord_set: reference.map_or(0, |reference| reference.uv_set),
            v_row: transform.matrix2.row(1).extend(transform.translation.y).to_array(),
            padding: 0,
        }
    }
}

/// The textures of a material, in the order of [`TEXTURES`].
pub(crate) fn textures(material: &Material) -> [Option<TextureRef>; TEXTURE_COUNT] {
    let (base, metallic_roughness, specular) = match &material.shading {
        Shading::MetallicRoughness(m) => {
            (m.base_color_texture, m.metallic_roughness_texture, m.specular_texture)
        }
        Shading::Phong(p) => (p.diffuse_texture, None, p.specular_texture),
        Shading::Unlit(u) => (u.color_texture, None, None),
    };
    // Unlit surfaces have no reflecting layers.
    let is_lit = !matches!(material.shading, Shading::Unlit(_));
    [
        base,
        metallic_roughness,
        material.normal_texture,
        material.emissive_texture,
        specular,
        material.clearcoat.texture.filter(|_| is_lit),
        material.sheen.texture.filter(|_| is_lit),
        material.transmission.texture.filter(|_| is_lit),
    ]
}

/// Whether the material has sheen.
pub(crate) fn has_sheen(record: &MaterialRecord) -> bool {
    record.sheen_color.iter().any(|component| *component > 0.0)
}

/// Whether a material needs features that the plain fragment shader lacks.
pub(crate) fn is_layered(material: &Material, record: &MaterialRecord) -> bool {
    record.is_blended != 0
        || record.transmission > 0.0
        || record.coat_strength > 0.0
        || has_sheen(record)
        || textures(material)[4].is_some()
}

/// The reflectance at normal incidence of a dielectric, before it is clamped to 1 and scaled
/// (`KHR_materials_ior`, `KHR_materials_specular`). An index of 0 means a reflectance of 1.
fn dielectric_f0(ior: f32, color: Vec3) -> Vec3 {
    color * ((ior - 1.0) / (ior + 1.0)).powi(2)
}

/// The parameters of a material, with radiance in multiples of `radiance_unit`; `white` is the
/// radiance of white on unlit surfaces, in cd/m².
///
/// Metallic-roughness (glTF 2.0, appendix B.3): the diffuse albedo is base colour times (1 -
/// metallic), and F0 is interpolated from the dielectric's to the base colour. Phong: the lobe's
/// colour becomes F0, and its exponent n becomes the width alpha of a microfacet distribution by
/// alpha² = 2 / (n + 2) (Walter et al. 2007, "Microfacet models for refraction through rough
/// surfaces", section 5.2).
pub(crate) fn record(
    material: &Material,
    radiance_unit: f32,
    white: f32,
    has_vertex_alpha: bool,
) -> MaterialRecord {
    let textures = textures(material);
    let common = MaterialRecord {
        emission: (material.emissive / radiance_unit).to_array(),
        normal_scale: material.normal_scale,
        has_normal_texture: u32::from(material.normal_texture.is_some()),
        sheen_color: material.sheen.color.to_array(),
        sheen_roughness: material.sheen.roughness,
        specular_factor: 1.0,
        coat_strength: material.clearcoat.strength,
        coat_roughness: material.clearcoat.roughness,
        transmission: material.transmission.factor,
        places: textures.map(TexturePlace::new),
        ..MaterialRecord::zeroed()
    };
    let (mut record, color, alpha) = match &material.shading {
        Shading::MetallicRoughness(m) => {
            let f0 = dielectric_f0(m.ior, m.specular_color);
            let record = MaterialRecord {
                dielectric_f0: f0.to_array(),
                specular_factor: m.specular,
                roughness: m.roughness,
                metallic: m.metallic,
                ..common
            };
            (record, m.base_color.truncate(), m.base_color.w)
        }
        Shading::Phong(p) => {
            let record = MaterialRecord {
                dielectric_f0: p.specular.to_array(),
                roughness: (2.0 / (p.shininess + 2.0)).sqrt().sqrt(),
                ..common
            };
            (record, p.diffuse, p.opacity)
        }
        Shading::Unlit(u) => {
            let record = MaterialRecord {
                unlit_radiance: white / radiance_unit,
                roughness: 1.0,
                sheen_color: [0.0; 3],
                coat_strength: 0.0,
                transmission: 0.0,
                ..common
            };
            (record, u.color.truncate(), u.color.w)
        }
    };
    let has_texture = textures[0].is_some();
    match material.alpha {
        AlphaMode::Opaque => record.base_color = color.extend(1.0).to_array(),
        // The factor was included when the texture was thresholded.
        AlphaMode::Mask { .. } if has_texture => {
            record.base_color = color.extend(1.0).to_array();
            record.mask_threshold = TEXTURE_MASK_THRESHOLD;
        }
        AlphaMode::Mask { cutoff } => {
            record.base_color = color.extend(alpha).to_array();
            record.mask_threshold = if has_vertex_alpha { cutoff } else { 0.0 };
        }
        AlphaMode::Blend => {
            record.base_color = color.extend(alpha).to_array();
            record.is_blended = u32::from(has_texture || has_vertex_alpha || alpha < 1.0);
        }
    }
    if !is_layered(material, &record) {
        // The plain shader does not clamp or scale the reflectance.
        let f0 = Vec3::from(record.dielectric_f0).min(Vec3::ONE) * record.specular_factor;
        record.dielectric_f0 = f0.to_array();
    }
    record
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;
    use lumivox_scene::{MetallicRoughness, Phong, Transmission, Unlit};

    fn plain(material: &Material) -> MaterialRecord {
        let record = record(material, 1.0, 1.0, false);
        assert!(!is_layered(material, &record), "{}", material.name);
        record
    }

    fn with(shading: MetallicRoughness) -> Material {
        Material { shading: Shading::MetallicRoughness(shading), ..Material::default() }
    }

    #[test]
    fn glass_reflects_four_per_cent_and_lambert_nothing() {
        let glass = plain(&Material::default());
        assert!((glass.dielectric_f0[0] - 0.04).abs() < 1e-6);
        let lambert = plain(&Material::diffuse("paint", Vec3::splat(0.5)));
        assert_eq!(lambert.dielectric_f0, [0.0; 3]);
    }

    #[test]
    fn specular_colour_is_limited_before_the_factor_scales_it() {
        let color = Vec3::new(10.0, 50.0, 0.0);
        let shading =
            MetallicRoughness { specular: 0.5, specular_color: color, ..Default::default() };
        let tinted = plain(&with(shading));
        let expected = Vec3::new(0.2, 0.5, 0.0);
        assert!((Vec3::from(tinted.dielectric_f0) - expected).abs().max_element() < 1e-6);
        // With an index of 0, as from specular-glossiness, the colour is the reflectance.
        let color = Vec3::new(0.9, 0.6, 0.2);
        let gloss = plain(&with(MetallicRoughness { ior: 0.0, specular_color: color, ..shading }));
        assert!((Vec3::from(gloss.dielectric_f0) - 0.5 * color).abs().max_element() < 1e-6);
    }

    #[test]
    fn higher_shininess_gives_lower_roughness() {
        let roughness = |shininess| {
            let phong = Phong { shininess, ..Phong::default() };
            let material = Material { shading: Shading::Phong(phong), ..Material::default() };
            plain(&material).roughness
        };
        // alpha² = 2 / (n + 2): n = 30 gives alpha = 1/4, a roughness of 1/2.
        assert!((roughness(30.0) - 0.5).abs() < 1e-6);
        assert!(roughness(200.0) < roughness(30.0));
    }

    #[test]
    fn emission_is_divided_by_the_unit() {
        let material = Material { emissive: Vec3::splat(64.0), ..Material::default() };
        assert_eq!(record(&material, 32.0, 1.0, false).emission, [2.0; 3]);
        let unlit = Material { shading: Shading::Unlit(Unlit::default()), ..Material::default() };
        assert_eq!(record(&unlit, 32.0, 80.0, false).unlit_radiance, 2.5);
    }

    /// Vertex alpha is cut at the cutoff, a texture's alpha at its thresholded edge. If alpha is
    /// constant, the surface is drawn everywhere or nowhere.
    #[test]
    fn mask_thresholds_apply_only_where_alpha_varies() {
        let threshold = |texture, has_vertex_alpha| {
            let shading = MetallicRoughness { base_color_texture: texture, ..Default::default() };
            let material = Material { alpha: AlphaMode::Mask { cutoff: 0.3 }, ..with(shading) };
            record(&material, 1.0, 1.0, has_vertex_alpha).mask_threshold
        };
        assert_eq!(threshold(None, true), 0.3);
        assert_eq!(threshold(None, false), 0.0);
        let texture = Some(TextureRef::new(0));
        assert_eq!([false, true].map(|alpha| threshold(texture, alpha)), [0.5; 2]);
    }

    #[test]
    fn only_surfaces_that_are_not_opaque_are_blended() {
        let blend = |alpha, has_vertex_alpha| {
            let base_color = Vec4::new(1.0, 1.0, 1.0, alpha);
            let material = Material {
                alpha: AlphaMode::Blend,
                ..with(MetallicRoughness { base_color, ..Default::default() })
            };
            record(&material, 1.0, 1.0, has_vertex_alpha).is_blended == 1
        };
        assert!(!blend(1.0, false));
        assert!(blend(0.9, false) && blend(1.0, true));
        let glass = Material {
            transmission: Transmission { factor: 0.5, texture: None },
            ..Material::default()
        };
        assert!(is_layered(&glass, &record(&glass, 1.0, 1.0, false)));
    }
}
