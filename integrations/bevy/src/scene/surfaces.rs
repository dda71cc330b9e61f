//! Materials in Lumivox's form, with stable numbers.

use bevy::asset::UntypedAssetId;
use bevy::mesh::UvChannel;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::render::render_asset::RenderAssets;
use bevy::render::texture::GpuImage;
use lumivox::{Gloss, SurfaceMaterial, SurfaceTexture};

use crate::scene::material::{GiSurface, GiTexture, Surfaces};
use crate::scene::textures::{Prepared, TextureUse};

/// Numbers of assets. The number of a removed asset is used again.
#[derive(Default)]
struct Numbers {
    by_id: HashMap<UntypedAssetId, u32>,
    /// Assets by number.
    ids: Vec<Option<UntypedAssetId>>,
    free: Vec<u32>,
}

impl Numbers {
    fn add(&mut self, id: UntypedAssetId) -> u32 {
        let number = self.free.pop().unwrap_or(self.ids.len() as u32);
        if number as usize == self.ids.len() {
            self.ids.push(None);
        }
        self.ids[number as usize] = Some(id);
        self.by_id.insert(id, number);
        number
    }

    fn remove(&mut self, number: u32) {
        if let Some(id) = self.ids[number as usize].take() {
            self.by_id.remove(&id);
            self.free.push(number);
        }
    }
}

/// All materials that draws have requested.
#[derive(Resource, Default)]
pub(crate) struct SurfaceTable {
    numbers: Numbers,
    materials: Vec<SurfaceMaterial>,
    are_there: Vec<bool>,
    are_textured: Vec<bool>,
    /// Requested materials whose assets do not exist yet.
    missing: Vec<UntypedAssetId>,
    /// Whether some textures are not loaded yet.
    waits_for_images: bool,
    is_changed: bool,
}

/// The inputs of the table.
pub(crate) struct SurfaceSources<'a> {
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) images: &'a RenderAssets<GpuImage>,
    pub(crate) images_changed: bool,
    /// The camera's exposure, for emission that is relative to it.
    pub(crate) exposure: f32,
    /// Lumivox's unit of radiance, cd/m².
    pub(crate) unit: f32,
    pub(crate) exposure_changed: bool,
}

impl SurfaceTable {
    /// Clears the missing materials, before all draws request their numbers again.
    pub(crate) fn forget_missing(&mut self) {
        self.missing.clear();
    }

    /// The number of a material; `None` until the material exists.
    pub(crate) fn number(&mut self, id: &UntypedAssetId) -> Option<u32> {
        let number = self.numbers.by_id.get(id).copied();
        if number.is_none() && !self.missing.contains(id) {
            self.missing.push(*id);
        }
        number
    }

    pub(crate) fn is_there(&self, number: u32) -> bool {
        self.are_there.get(number as usize).copied().unwrap_or_default()
    }

    /// Whether the material has textures, loaded or not.
    pub(crate) fn is_textured(&self, number: u32) -> bool {
        self.are_textured.get(number as usize).copied().unwrap_or_default()
    }

    pub(crate) fn materials(&self) -> &Vec<SurfaceMaterial> {
        &self.materials
    }

    pub(crate) fn take_changed(&mut self) -> bool {
        std::mem::take(&mut self.is_changed)
    }

    /// Applies changes of materials and images; returns whether draws must be rebuilt.
    pub(crate) fn update(
        &mut self,
        sources: &SurfaceSources<'_>,
        prepared: &mut Prepared<'_>,
    ) -> bool {
        let mut restructures = false;
        for id in std::mem::take(&mut self.missing) {
            if sources.surfaces.get(&id).is_none() {
                self.missing.push(id);
                continue;
            }
            self.numbers.add(id);
            let count = self.numbers.ids.len();
            self.materials.resize_with(count, SurfaceMaterial::default);
            self.are_there.resize(count, false);
            self.are_textured.resize(count, false);
            self.waits_for_images = true;
            restructures = true;
        }
        let is_due = sources.surfaces.are_changed
            || sources.images_changed
            || sources.exposure_changed
            || self.waits_for_images;
        if !is_due {
            return restructures;
        }
        self.waits_for_images = false;
        prepared.begin();
        for number in 0..self.numbers.ids.len() {
            let Some(id) = self.numbers.ids[number] else { continue };
            let (material, is_there, is_textured) = match sources.surfaces.get(&id) {
                Some(surface) => (
                    self.convert(surface, sources, prepared),
                    surface.is_there(),
                    surface.base_color_texture.is_some() || surface.emissive_texture.is_some(),
                ),
                None => {
                    // The rebuilt draws no longer use this number.
                    restructures = true;
                    self.numbers.remove(number as u32);
                    (SurfaceMaterial::default(), false, false)
                }
            };
            restructures |= std::mem::replace(&mut self.are_there[number], is_there) != is_there;
            restructures |=
                std::mem::replace(&mut self.are_textured[number], is_textured) != is_textured;
            if self.materials[number] != material {
                self.materials[number] = material;
                self.is_changed = true;
            }
        }
        prepared.end();
        restructures
    }

    fn convert(
        &mut self,
        surface: &GiSurface,
        sources: &SurfaceSources<'_>,
        prepared: &mut Prepared<'_>,
    ) -> SurfaceMaterial {
        let cutoff = match surface.alpha_mode {
            AlphaMode::Mask(cutoff) => Some(cutoff),
            _ => None,
        };
        let mut texture = |given: &Option<GiTexture>, used| {
            let given = given.as_ref()?;
            let Some(image) = sources.images.get(given.image) else {
                self.waits_for_images = true;
                return None;
            };
            let (view, sampler) = prepared.texture(given.image, image, used)?;
            Some(SurfaceTexture {
                texcoord_set: u32::from(given.channel == UvChannel::Uv1),
                transform: surface.uv_transform,
                ..SurfaceTexture::new(view, sampler)
            })
        };
        let reflectance_texture =
            texture(&surface.base_color_texture, TextureUse::Color { cutoff });
        let emission_texture = texture(&surface.emissive_texture, TextureUse::Emission);
        let weight = surface.emissive_exposure_weight.clamp(0.0, 1.0);
        // As in Bevy's shader, divided by the exposure.
        let luminance = (1.0 - weight) / sources.exposure + weight;
        let emission = surface.emissive.to_vec3().max(Vec3::ZERO) * luminance / sources.unit;
        let color = surface.base_color.to_vec3().clamp(Vec3::ZERO, Vec3::ONE);
        let is_covering = matches!(surface.alpha_mode, AlphaMode::Opaque);
        let alpha = match surface.alpha_mode {
            AlphaMode::Opaque | AlphaMode::Mask(_) => 1.0,
            _ => surface.base_color.alpha.clamp(0.0, 1.0),
        };
        let f0 = 0.16 * surface.reflectance * surface.reflectance;
        let dielectric = 1.0 - surface.metallic.clamp(0.0, 1.0);
        SurfaceMaterial {
            reflectance: color.extend(alpha),
            gloss: Gloss::new(f0, surface.perceptual_roughness).of_share(dielectric),
            emission: if emission.is_finite() { emission } else { Vec3::ZERO },
            transmission: surface.transmission.clamp(0.0, 1.0),
            reflectance_texture,
            emission_texture,
            transmission_texture: None,
            alpha_is_coverage: !is_covering,
            double_sided: surface.double_sided,
            open_behind: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_removed_assets_are_reused() {
        let mut numbers = Numbers::default();
        let mut materials = Assets::<StandardMaterial>::default();
        for _ in 0..10 {
            let handles: Vec<_> = (0..100).map(|_| materials.add(Color::WHITE)).collect();
            let given: Vec<u32> =
                handles.iter().map(|handle| numbers.add(handle.id().untyped())).collect();
            for (handle, number) in handles.iter().zip(given) {
                assert_eq!(numbers.by_id.get(&handle.id().untyped()), Some(&number));
                assert_eq!(numbers.ids[number as usize], Some(handle.id().untyped()));
                numbers.remove(number);
            }
            assert_eq!([numbers.ids.len(), numbers.by_id.len()], [100, 0]);
        }
    }
}
