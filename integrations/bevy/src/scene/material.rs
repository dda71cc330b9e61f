//! Materials as voxels use them: Bevy's, and custom ones through a trait.

use bevy::asset::UntypedAssetId;
use bevy::color::LinearRgba;
use bevy::math::Affine2;
use bevy::mesh::UvChannel;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::render::Extract;

/// A texture of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct GiTexture {
    /// The image, decoded by its format.
    pub image: AssetId<Image>,
    /// The mesh's set of texture coordinates.
    pub channel: UvChannel,
}

/// Optical properties of a surface for voxels: the mean over its details.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_lumivox::GiSurface;
/// let red = GiSurface { base_color: LinearRgba::rgb(0.6, 0.1, 0.1), ..GiSurface::default() };
/// assert_eq!(red.emissive, LinearRgba::BLACK);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GiSurface {
    /// Reflectance, with coverage in alpha. Default: white.
    pub base_color: LinearRgba,
    /// Texture that multiplies the base colour. Default: none.
    pub base_color_texture: Option<GiTexture>,
    /// Emitted light, in the unit of [`StandardMaterial::emissive`]. Default: none.
    pub emissive: LinearRgba,
    /// As [`StandardMaterial::emissive_exposure_weight`]: at 1 `emissive` is a luminance in cd/m²;
    /// at 0 (the default) it is that luminance times the camera's exposure.
    pub emissive_exposure_weight: f32,
    /// Texture that multiplies the emissive colour. Default: none.
    pub emissive_texture: Option<GiTexture>,
    /// Transform from the mesh's texture coordinates to the textures'. Default: identity.
    pub uv_transform: Affine2,
    /// Share of the surface that is metal, which has no dielectric gloss, 0 to 1. Default: 0.
    pub metallic: f32,
    /// 0 to 1. Default: 0.5.
    pub perceptual_roughness: f32,
    /// As [`StandardMaterial::reflectance`]. Default: 0.5, which is 4 % at normal incidence.
    pub reflectance: f32,
    /// Share of light that passes straight through, as through glass, 0 to 1. Default: 0.
    pub transmission: f32,
    /// How alpha is used. Surfaces with `Add` or `Multiply` are left out of the voxels. Default:
    /// opaque.
    pub alpha_mode: AlphaMode,
    /// Whether the back is a surface, too. Default: false.
    pub double_sided: bool,
}

impl Default for GiSurface {
    fn default() -> Self {
        Self {
            base_color: LinearRgba::WHITE,
            base_color_texture: None,
            emissive: LinearRgba::BLACK,
            emissive_exposure_weight: 0.0,
            emissive_texture: None,
            uv_transform: Affine2::IDENTITY,
            metallic: 0.0,
            perceptual_roughness: 0.5,
            reflectance: 0.5,
            transmission: 0.0,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
        }
    }
}

impl GiSurface {
    /// Whether the surface is voxelized.
    pub(crate) fn is_there(&self) -> bool {
        let covers = match self.alpha_mode {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => {
                self.base_color_texture.is_some() || self.base_color.alpha >= cutoff
            }
            AlphaMode::Blend | AlphaMode::Premultiplied | AlphaMode::AlphaToCoverage => {
                self.base_color.alpha > 0.0
            }
            AlphaMode::Add | AlphaMode::Multiply => false,
        };
        covers && self.base_color.alpha.is_finite()
    }
}

/// A material that takes part in global illumination, as [`StandardMaterial`] does. Add other types
/// with [`LumivoxMaterialPlugin`](crate::LumivoxMaterialPlugin).
///
/// On screen, a material receives indirect light if its shader uses Bevy's own lighting
/// (`apply_pbr_lighting`), deferred or forward, as an
/// [`ExtendedMaterial`](bevy::pbr::ExtendedMaterial) of `StandardMaterial` does.
///
/// ```
/// use bevy::pbr::{ExtendedMaterial, MaterialExtension};
/// use bevy::prelude::*;
/// use bevy::render::render_resource::AsBindGroup;
/// use bevy_lumivox::{GiSurface, LumivoxMaterial};
///
/// #[derive(Asset, AsBindGroup, Clone, TypePath)]
/// struct Lava {
///     #[uniform(100)]
///     heat: f32,
/// }
///
/// impl MaterialExtension for Lava {}
///
/// #[derive(Asset, AsBindGroup, Clone, TypePath)]
/// struct Rock {
///     #[uniform(0)]
///     color: LinearRgba,
/// }
///
/// impl Material for Rock {}
///
/// impl LumivoxMaterial for Rock {
///     fn surface(&self) -> GiSurface {
///         GiSurface { base_color: self.color, ..GiSurface::default() }
///     }
/// }
/// ```
pub trait LumivoxMaterial: Material {
    /// The surface for the voxels. It is called once after each change of the asset.
    fn surface(&self) -> GiSurface;
}

impl LumivoxMaterial for StandardMaterial {
    fn surface(&self) -> GiSurface {
        let texture = |image: &Option<Handle<Image>>, channel: &UvChannel| {
            image.as_ref().map(|image| GiTexture { image: image.id(), channel: channel.clone() })
        };
        let base_color = self.base_color.to_linear();
        let mut surface = GiSurface {
            base_color,
            base_color_texture: texture(&self.base_color_texture, &self.base_color_channel),
            emissive: self.emissive,
            emissive_exposure_weight: self.emissive_exposure_weight,
            emissive_texture: texture(&self.emissive_texture, &self.emissive_channel),
            uv_transform: self.uv_transform,
            metallic: self.metallic,
            perceptual_roughness: self.perceptual_roughness,
            reflectance: self.reflectance,
            transmission: self.specular_transmission,
            alpha_mode: self.alpha_mode,
            double_sided: self.double_sided,
        };
        if self.unlit {
            // An unlit surface looks the same in any light: it emits its colour and reflects
            // nothing.
            surface.emissive = base_color;
            surface.emissive_exposure_weight = 0.0;
            surface.emissive_texture = surface.base_color_texture.take();
            surface.base_color = LinearRgba::BLACK.with_alpha(base_color.alpha);
            surface.reflectance = 0.0;
        }
        surface
    }
}

/// The surfaces of all materials, in the render world.
#[derive(Resource, Default)]
pub(crate) struct Surfaces {
    by_id: HashMap<UntypedAssetId, GiSurface>,
    /// Whether any have changed since the last frame.
    pub(crate) are_changed: bool,
}

impl Surfaces {
    pub(crate) fn get(&self, id: &UntypedAssetId) -> Option<&GiSurface> {
        self.by_id.get(id)
    }
}

/// Extracts materials of one type as they change.
pub(crate) fn extract_surfaces<M: LumivoxMaterial>(
    mut surfaces: ResMut<Surfaces>,
    mut events: Extract<MessageReader<AssetEvent<M>>>,
    assets: Extract<Res<Assets<M>>>,
) {
    for event in events.read() {
        match event {
            AssetEvent::Added { id } | AssetEvent::Modified { id } => {
                let Some(material) = assets.get(*id) else { continue };
                surfaces.by_id.insert(id.untyped(), material.surface());
            }
            AssetEvent::Removed { id } => {
                surfaces.by_id.remove(&id.untyped());
            }
            _ => continue,
        }
        surfaces.are_changed = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unlit_surfaces_shine_and_reflect_nothing() {
        let material = StandardMaterial {
            base_color: Color::linear_rgb(0.2, 0.4, 0.6),
            unlit: true,
            ..StandardMaterial::default()
        };
        let surface = material.surface();
        assert_eq!(surface.base_color, LinearRgba::BLACK);
        assert_eq!(surface.emissive, LinearRgba::rgb(0.2, 0.4, 0.6));
    }

    #[test]
    fn alpha_decides_if_a_surface_is_present() {
        let with = |alpha, alpha_mode| {
            let base_color = LinearRgba::WHITE.with_alpha(alpha);
            GiSurface { base_color, alpha_mode, ..GiSurface::default() }.is_there()
        };
        assert!(with(0.0, AlphaMode::Opaque));
        assert!(with(0.5, AlphaMode::Mask(0.5)) && !with(0.4, AlphaMode::Mask(0.5)));
        assert!(with(0.1, AlphaMode::Blend) && !with(0.0, AlphaMode::Blend));
        assert!(!with(1.0, AlphaMode::Add) && !with(1.0, AlphaMode::Multiply));
    }
}
