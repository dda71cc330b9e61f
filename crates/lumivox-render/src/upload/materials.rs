//! Materials and their textures on the GPU, for the rasterizer and for the voxels.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};
use lumivox::SurfaceMaterial;
use lumivox::gpu::{BindGroupBuilder, LayoutBuilder, uniform_buffer};
use lumivox_scene::{AlphaMode, Filter, Material, Sampler, Scene, Shading, TextureRef, Wrap};

use super::mips::{Encoding, Level, mip_chain};
use crate::Gpu;

/// `Material` of `material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct MaterialRecord {
    pub(crate) base_color: [f32; 4],
    pub(crate) emission: [f32; 3],
    pub(crate) normal_scale: f32,
    pub(crate) dielectric_f0: [f32; 3],
    pub(crate) roughness: f32,
    pub(crate) metallic: f32,
    pub(crate) has_normal_texture: u32,
    pub(crate) is_masked: u32,
    pub(crate) padding: u32,
}

/// A material as the passes that rasterize need it.
#[derive(Debug)]
pub(crate) struct GpuMaterial {
    /// Group 1 of those passes.
    pub(crate) group: wgpu::BindGroup,
    /// Where the surface is there at all.
    pub(crate) presence: Presence,
    /// Whether it is seen from behind.
    pub(crate) is_double_sided: bool,
    /// Whether it stops light: less than half opaque blends do not.
    pub(crate) is_solid: bool,
}

/// Where a surface is there at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Presence {
    /// Everywhere.
    Whole,
    /// Where the alpha of its texture says so.
    Masked,
    /// Nowhere: its alpha has no texture and is below the cutoff.
    Absent,
}

/// Group 1 of the passes that rasterize.
pub(crate) fn material_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let layout = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT).uniform();
    (0..4).fold(layout, |layout, _| layout.texture_2d().sampler()).build(device, "material")
}

/// The numbers of a material, in multiples of `radiance_unit`.
///
/// Metallic-roughness (glTF 2.0, appendix B.3): the diffuse albedo is base colour times
/// (1 - metallic), and F0 goes from the dielectric's ((ior - 1) / (ior + 1))² times `specular` to the
/// base colour. Phong: the lobe's colour becomes F0, and its exponent n the width alpha of a
/// microfacet distribution by alpha² = 2 / (n + 2) (Walter et al. 2007, "Microfacet models for
/// refraction through rough surfaces", section 5.2).
fn record(material: &Material, radiance_unit: f32) -> MaterialRecord {
    let common = MaterialRecord {
        emission: (material.emissive / radiance_unit).to_array(),
        normal_scale: material.normal_scale,
        has_normal_texture: u32::from(material.normal_texture.is_some()),
        ..MaterialRecord::zeroed()
    };
    match &material.shading {
        Shading::MetallicRoughness(m) => {
            let f0 = ((m.ior - 1.0) / (m.ior + 1.0)).powi(2) * m.specular;
            MaterialRecord {
                base_color: m.base_color.truncate().extend(1.0).to_array(),
                dielectric_f0: [f0; 3],
                roughness: m.roughness,
                metallic: m.metallic,
                ..common
            }
        }
        Shading::Phong(p) => MaterialRecord {
            base_color: p.diffuse.extend(1.0).to_array(),
            dielectric_f0: p.specular.to_array(),
            roughness: (2.0 / (p.shininess + 2.0)).sqrt().sqrt(),
            metallic: 0.0,
            ..common
        },
        Shading::Unlit(u) => MaterialRecord {
            base_color: u.color.truncate().extend(1.0).to_array(),
            roughness: 1.0,
            ..common
        },
    }
}

/// Base colour with alpha, its texture, and the metallic-roughness texture.
fn base_of(material: &Material) -> (Vec4, Option<TextureRef>, Option<TextureRef>) {
    match &material.shading {
        Shading::MetallicRoughness(m) => {
            (m.base_color, m.base_color_texture, m.metallic_roughness_texture)
        }
        Shading::Phong(p) => (p.diffuse.extend(p.opacity), p.diffuse_texture, None),
        Shading::Unlit(u) => (u.color, u.color_texture, None),
    }
}

/// Uploads a scene's materials, each texture once per use.
#[derive(Debug)]
pub(crate) struct MaterialUpload<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    radiance_unit: f32,
    layout: &'a wgpu::BindGroupLayout,
    white: wgpu::TextureView,
    /// By texture, encoding and the bits of the mask's cutoff.
    textures: HashMap<(usize, Encoding, Option<u32>), wgpu::TextureView>,
    samplers: HashMap<Sampler, wgpu::Sampler>,
    /// Bytes of all textures so far.
    pub(crate) texture_bytes: u64,
}

impl<'a> MaterialUpload<'a> {
    pub(crate) fn new(
        gpu: &'a Gpu,
        scene: &'a Scene,
        radiance_unit: f32,
        layout: &'a wgpu::BindGroupLayout,
    ) -> Self {
        let white = Level { width: 1, height: 1, rgba8: vec![255; 4] };
        let white = create_texture(gpu, "white", Encoding::Data, &[white]);
        Self {
            gpu,
            scene,
            radiance_unit,
            layout,
            white,
            textures: HashMap::new(),
            samplers: HashMap::new(),
            texture_bytes: 4,
        }
    }

    /// Uploads one material, for the rasterizer and for the voxels.
    pub(crate) fn upload(&mut self, material: &Material) -> (GpuMaterial, SurfaceMaterial) {
        let (base_color, base_texture, metallic_roughness) = base_of(material);
        let mut record = record(material, self.radiance_unit);
        let mut cutoff = None;
        let (mut presence, mut is_solid) = (Presence::Whole, true);
        match material.alpha {
            AlphaMode::Mask { cutoff: least } if base_texture.is_some() => {
                // The texture's alpha is compared after the factor multiplied it. Where the factor is
                // zero, nothing reaches a cutoff above zero.
                presence = Presence::Masked;
                cutoff = Some(if least <= 0.0 { 0.0 } else { least / base_color.w });
            }
            AlphaMode::Mask { cutoff: least } if base_color.w < least => {
                presence = Presence::Absent;
            }
            AlphaMode::Opaque | AlphaMode::Mask { .. } => {}
            AlphaMode::Blend => {
                is_solid = base_color.w >= 0.5;
                if !is_solid {
                    tracing::warn!(
                        "material \"{}\" is {:.0} % transparent: it is drawn opaque, and casts no \
                         shadow and reflects no light onto others",
                        material.name,
                        100.0 * (1.0 - base_color.w)
                    );
                }
            }
        }
        record.is_masked = u32::from(cutoff.is_some());

        let base = self.texture(base_texture, Encoding::Color, cutoff);
        let emission = self.texture(material.emissive_texture, Encoding::Color, None);
        let textures = [
            base.clone(),
            self.texture(metallic_roughness, Encoding::Data, None),
            self.texture(material.normal_texture, Encoding::Data, None),
            emission.clone(),
        ];
        let references =
            [base_texture, metallic_roughness, material.normal_texture, material.emissive_texture];
        let samplers = references.map(|reference| self.sampler(reference));
        let uniform = uniform_buffer(&self.gpu.device, &material.name, &record);
        let group = textures
            .iter()
            .zip(&samplers)
            .fold(
                BindGroupBuilder::new(self.layout).buffer(&uniform),
                |builder, (texture, sampler)| builder.view(texture).sampler(sampler),
            )
            .build(&self.gpu.device, &material.name);
        let for_raster =
            GpuMaterial { group, presence, is_double_sided: material.double_sided, is_solid };

        // The voxels reflect diffusely alone: what a metal reflects as gloss counts as well, which
        // makes it the base colour whatever the metalness. One sampler serves both textures.
        let has_texture = base_texture.or(material.emissive_texture);
        let for_voxels = SurfaceMaterial {
            reflectance: Vec3::from_slice(&record.base_color).extend(1.0),
            emission: Vec3::from_array(record.emission),
            reflectance_texture: base_texture.map(|_| base),
            emission_texture: material.emissive_texture.map(|_| emission),
            sampler: has_texture.map(|reference| self.sampler(Some(reference))),
            alpha_is_coverage: cutoff.is_some(),
            double_sided: material.double_sided,
        };
        (for_raster, for_voxels)
    }

    /// A texture with its mips; white where there is none.
    fn texture(
        &mut self,
        reference: Option<TextureRef>,
        encoding: Encoding,
        cutoff: Option<f32>,
    ) -> wgpu::TextureView {
        let Some(reference) = reference else { return self.white.clone() };
        let key = (reference.texture, encoding, cutoff.map(f32::to_bits));
        if let Some(view) = self.textures.get(&key) {
            return view.clone();
        }
        let texture = &self.scene.textures[reference.texture];
        let mut levels = mip_chain(texture, encoding, cutoff);
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let skipped = levels.iter().position(|level| level.width.max(level.height) <= most);
        let skipped = skipped.unwrap_or(levels.len() - 1);
        if skipped > 0 {
            tracing::warn!(
                "texture \"{}\" of {}x{} is shown at {}x{}: this device has no textures above {most}",
                texture.name,
                texture.width,
                texture.height,
                levels[skipped].width,
                levels[skipped].height
            );
            levels.drain(..skipped);
        }
        self.texture_bytes += levels.iter().map(|level| level.rgba8.len() as u64).sum::<u64>();
        let view = create_texture(self.gpu, &texture.name, encoding, &levels);
        self.textures.insert(key, view.clone());
        view
    }

    /// The sampler of a texture; where there is none, any.
    fn sampler(&mut self, reference: Option<TextureRef>) -> wgpu::Sampler {
        let sampler =
            reference.map_or(Sampler::default(), |r| self.scene.textures[r.texture].sampler);
        let device = &self.gpu.device;
        self.samplers.entry(sampler).or_insert_with(|| create_sampler(device, sampler)).clone()
    }
}

fn create_texture(
    gpu: &Gpu,
    label: &str,
    encoding: Encoding,
    levels: &[Level],
) -> wgpu::TextureView {
    let extent = |level: &Level| wgpu::Extent3d {
        width: level.width,
        height: level.height,
        depth_or_array_layers: 1,
    };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: extent(&levels[0]),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: match encoding {
            Encoding::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
            Encoding::Data => wgpu::TextureFormat::Rgba8Unorm,
        },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (index, level) in levels.iter().enumerate() {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: index as u32,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            &level.rgba8,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.width),
                rows_per_image: None,
            },
            extent(level),
        );
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn create_sampler(device: &wgpu::Device, sampler: Sampler) -> wgpu::Sampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
    };
    let filter = |filter| match filter {
        Filter::Nearest => wgpu::FilterMode::Nearest,
        Filter::Linear => wgpu::FilterMode::Linear,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture"),
        address_mode_u: wrap(sampler.wrap_u),
        address_mode_v: wrap(sampler.wrap_v),
        mag_filter: filter(sampler.magnify),
        min_filter: filter(sampler.minify),
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_scene::{MetallicRoughness, Phong};

    #[test]
    fn glass_reflects_four_per_cent_and_lambert_nothing() {
        let glass = record(&Material::default(), 1.0);
        assert!((glass.dielectric_f0[0] - 0.04).abs() < 1e-6);
        let lambert = record(&Material::diffuse("paint", Vec3::splat(0.5)), 1.0);
        assert_eq!(lambert.dielectric_f0, [0.0; 3]);
    }

    #[test]
    fn a_sharper_phong_lobe_is_smoother() {
        let roughness = |shininess| {
            let phong = Phong { shininess, ..Phong::default() };
            let material = Material { shading: Shading::Phong(phong), ..Material::default() };
            record(&material, 1.0).roughness
        };
        // alpha² = 2 / (n + 2): n = 30 gives alpha = 1/4, a roughness of 1/2.
        assert!((roughness(30.0) - 0.5).abs() < 1e-6);
        assert!(roughness(200.0) < roughness(30.0));
    }

    #[test]
    fn emission_is_in_multiples_of_the_unit() {
        let material = Material {
            emissive: Vec3::splat(64.0),
            shading: Shading::MetallicRoughness(MetallicRoughness::default()),
            ..Material::default()
        };
        assert_eq!(record(&material, 32.0).emission, [2.0; 3]);
    }
}
