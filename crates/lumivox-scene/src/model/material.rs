//! The reflection and emission of surfaces.

use glam::{Vec3, Vec4};

use super::TextureRef;

/// A surface's material. The default is glTF's, except that it is rough and not metallic: a white
/// diffuse surface with a dielectric gloss of full roughness.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A name for lists and messages.
    pub name: String,
    /// The reflection model.
    pub shading: Shading,
    /// Emitted radiance in cd/m² (glTF's emissive factor times `KHR_materials_emissive_strength`),
    /// multiplied by the emissive texture if there is one. Default: zero.
    pub emissive: Vec3,
    /// Colour texture (sRGB-encoded) that multiplies `emissive`.
    pub emissive_texture: Option<TextureRef>,
    /// Tangent-space normals: data texture (linear), x to the right, y up, z out of the surface.
    pub normal_texture: Option<TextureRef>,
    /// Factor of x and y of the normal texture. Default: 1; 0 switches the texture off.
    pub normal_scale: f32,
    /// The use of the base colour's alpha. Default: none (opaque).
    pub alpha: AlphaMode,
    /// Whether the back side is visible, too, with the normal reversed. Default: no.
    pub double_sided: bool,
    /// `true` if light from behind passes a single-sided surface, for stages that are open to one
    /// side. Default: no. Files do not store this; `--open-backs` sets it for a whole scene.
    pub open_behind: bool,
    /// A clear coat. Default: none.
    pub clearcoat: Clearcoat,
    /// The sheen of cloth. Default: none.
    pub sheen: Sheen,
    /// Light that passes the surface as a pane of glass. Default: none.
    pub transmission: Transmission,
    /// The surface's properties in the look of VXCT, if its scene gives them. Default: none; that
    /// look then uses the fields above. Physical renderers ignore it.
    pub strengths: Option<Strengths>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            shading: Shading::default(),
            emissive: Vec3::ZERO,
            emissive_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            open_behind: false,
            clearcoat: Clearcoat::default(),
            sheen: Sheen::default(),
            transmission: Transmission::default(),
            strengths: None,
        }
    }
}

impl Material {
    /// A purely diffuse (Lambertian) surface: roughness 1, no metal, no specular reflection.
    /// `albedo` is linear RGB from 0 to 1.
    #[must_use]
    pub fn diffuse(name: &str, albedo: Vec3) -> Self {
        Self {
            name: name.to_owned(),
            shading: Shading::MetallicRoughness(MetallicRoughness {
                base_color: albedo.extend(1.0),
                specular: 0.0,
                ..MetallicRoughness::default()
            }),
            ..Self::default()
        }
    }

    /// The textures that this material names, in no particular order.
    pub fn textures(&self) -> impl Iterator<Item = TextureRef> {
        let shading = match &self.shading {
            Shading::MetallicRoughness(m) => {
                [m.base_color_texture, m.metallic_roughness_texture, m.specular_texture]
            }
            Shading::Phong(p) => [p.diffuse_texture, p.specular_texture, None],
            Shading::Unlit(u) => [u.color_texture, None, None],
        };
        let layers = [self.clearcoat.texture, self.sheen.texture, self.transmission.texture];
        shading
            .into_iter()
            .chain(layers)
            .chain([self.emissive_texture, self.normal_texture])
            .flatten()
    }
}

/// The reflection model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    /// glTF's physically based model.
    MetallicRoughness(MetallicRoughness),
    /// Phong's (1975) model, for scenes made for it.
    Phong(Phong),
    /// The colour is shown unchanged, without lighting (`KHR_materials_unlit`): for scans with
    /// baked light.
    Unlit(Unlit),
}

impl Default for Shading {
    fn default() -> Self {
        Self::MetallicRoughness(MetallicRoughness::default())
    }
}

/// The metallic-roughness model (glTF 2.0, section 3.9.2 and appendix B).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Linear RGB and alpha, each 0 to 1: the diffuse albedo of a dielectric, the reflectance at
    /// normal incidence of a metal. Default: white, opaque.
    pub base_color: Vec4,
    /// Colour texture (sRGB-encoded, linear alpha) that multiplies `base_color`.
    pub base_color_texture: Option<TextureRef>,
    /// 0 is a dielectric, 1 a metal. Default: 0 (glTF files default to 1).
    pub metallic: f32,
    /// Perceptual roughness from 0 (a mirror) to 1; its square is the width of the microfacet
    /// distribution. Default: 1.
    pub roughness: f32,
    /// Data texture (linear) that multiplies roughness by its green and metallic by its blue.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Factor of the dielectric's reflectance, 0 to 1 (`KHR_materials_specular`). Default: 1; 0
    /// leaves pure Lambert.
    pub specular: f32,
    /// Linear RGB factor, at least 0, of the dielectric's reflectance at normal incidence; the
    /// product is limited to 1 (the colour of `KHR_materials_specular`). Default: white.
    pub specular_color: Vec3,
    /// Texture that multiplies `specular_color` by its colour (sRGB-encoded) and `specular` by its
    /// alpha.
    pub specular_texture: Option<TextureRef>,
    /// Index of refraction of the dielectric, at least 1 (`KHR_materials_ior`). Default: 1.5, a
    /// reflectance of 4 % at normal incidence. 0 means a reflectance of 1, so that only
    /// `specular_color` counts.
    pub ior: f32,
}

impl Default for MetallicRoughness {
    fn default() -> Self {
        Self {
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            specular: 1.0,
            specular_color: Vec3::ONE,
            specular_texture: None,
            ior: 1.5,
        }
    }
}

/// Phong's model: a diffuse part and a lobe `cos^shininess` around the mirror direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Diffuse albedo, linear RGB from 0 to 1. Default: white.
    pub diffuse: Vec3,
    /// Colour texture (sRGB-encoded, linear alpha) that multiplies `diffuse` and `opacity`.
    pub diffuse_texture: Option<TextureRef>,
    /// The alpha of the surface, 0 to 1, for [`Material::alpha`]. Default: 1.
    pub opacity: f32,
    /// Colour of the lobe, linear RGB from 0 to 1. Default: zero.
    pub specular: Vec3,
    /// Colour texture (sRGB-encoded) that multiplies `specular`.
    pub specular_texture: Option<TextureRef>,
    /// Exponent of the lobe, at least 1; higher is sharper. Default: 16.
    pub shininess: f32,
}

impl Default for Phong {
    fn default() -> Self {
        Self {
            diffuse: Vec3::ONE,
            diffuse_texture: None,
            opacity: 1.0,
            specular: Vec3::ZERO,
            specular_texture: None,
            shininess: 16.0,
        }
    }
}

/// A surface as in Phong shaders without physical units: for each light, `color` times (ambient +
/// diffuse cos + specular cos^shininess) is added, and the sum is shown without conversion.
///
/// It may reflect more light than it receives, and its numbers have no limits.
/// [`Strengths::to_phong`] gives the closest possible surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strengths {
    /// Linear RGB. Default: 0.85 each.
    pub color: Vec3,
    /// The share of a light that the surface shows in any orientation. Default: 0.08.
    pub ambient: f32,
    /// The share that is multiplied by the cosine to the light. Default: 1.
    pub diffuse: f32,
    /// The share in the middle of the highlight; also a factor of reflections. Default: 0.5.
    pub specular: f32,
    /// Exponent of the highlight; higher is sharper. Default: 32.
    pub shininess: f32,
    /// Whether normals point away from the mesh's origin, as those of a cube of eight shared
    /// corners do. Default: no, they are the mesh's own.
    pub is_rounded: bool,
}

impl Default for Strengths {
    /// VXCT's default.
    fn default() -> Self {
        Self {
            color: Vec3::splat(0.85),
            ambient: 0.08,
            diffuse: 1.0,
            specular: 0.5,
            shininess: 32.0,
            is_rounded: false,
        }
    }
}

impl Strengths {
    /// Converts to the closest physical surface.
    ///
    /// A lamp that gives a white diffuse surface a radiance of L has an irradiance of E = pi L on a
    /// surface that faces it. The diffuse albedo that gives `diffuse * color * L` is `diffuse *
    /// color`. The lobe of [`Phong`] is normalised (Lafortune and Willems 1994, "Using the modified
    /// Phong reflectance model for physically based rendering"): its peak is `specular (n + 2) / (2
    /// pi)`, which times E is `specular (n + 2) / 2 L`. It equals `specular * L` if the lobe's
    /// colour is 2 / (n + 2) times `specular`. Both are limited to the light that a surface can
    /// reflect, and negative values count as zero.
    pub fn to_phong(&self) -> Phong {
        let shininess = self.shininess.max(0.0);
        let lobe = 2.0 * self.specular / (shininess + 2.0);
        Phong {
            diffuse: (self.color.max(Vec3::ZERO) * self.diffuse).clamp(Vec3::ZERO, Vec3::ONE),
            specular: Vec3::splat(lobe.clamp(0.0, 1.0)),
            shininess,
            ..Phong::default()
        }
    }
}

/// A surface that shows its colour without lighting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unlit {
    /// Linear RGB and alpha, each 0 to 1. Default: white, opaque.
    pub color: Vec4,
    /// Colour texture (sRGB-encoded, linear alpha) that multiplies `color`.
    pub color_texture: Option<TextureRef>,
}

impl Default for Unlit {
    fn default() -> Self {
        Self { color: Vec4::ONE, color_texture: None }
    }
}

/// A thin, clear layer of an index of refraction of 1.5 on top (`KHR_materials_clearcoat`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clearcoat {
    /// The share of the surface that the coat covers, 0 (the default) to 1.
    pub strength: f32,
    /// The coat's perceptual roughness, 0 (the default) to 1.
    pub roughness: f32,
    /// Data texture (linear) that multiplies `strength` by its red and `roughness` by its green.
    pub texture: Option<TextureRef>,
}

/// Light scattered by the fibres of cloth, most at grazing angles (`KHR_materials_sheen`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sheen {
    /// Linear RGB from 0 (the default: none) to 1.
    pub color: Vec3,
    /// Perceptual roughness of the fibres, 0 (the default) to 1.
    pub roughness: f32,
    /// Texture that multiplies `color` by its colour (sRGB-encoded) and `roughness` by its alpha.
    pub texture: Option<TextureRef>,
}

/// Light that passes an infinitely thin surface without being bent (`KHR_materials_transmission`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Transmission {
    /// The share of the light entering the surface that passes, tinted by the base colour, instead
    /// of being reflected diffusely; 0 (the default) to 1.
    pub factor: f32,
    /// Data texture (linear) that multiplies `factor` by its red.
    pub texture: Option<TextureRef>,
}

/// The use of the base colour's alpha (glTF 2.0, section 3.9.4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored; the surface is solid.
    #[default]
    Opaque,
    /// The surface only exists where alpha is at least the cutoff.
    Mask {
        /// The threshold, 0 to 1. glTF's default: 0.5.
        cutoff: f32,
    },
    /// Alpha is the covered fraction.
    Blend,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_the_textures_in_use() {
        let mut material = Material::diffuse("wall", Vec3::splat(0.5));
        assert_eq!(material.textures().count(), 0);
        material.normal_texture = Some(TextureRef::new(3));
        assert_eq!(material.textures().collect::<Vec<_>>(), [TextureRef::new(3)]);
    }
}
