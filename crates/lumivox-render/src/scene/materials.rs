//! Materials and their textures on the GPU, for the rasterizer and for the voxels.

use glam::Vec3;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, TextureView, uniform_buffer,
};
use lumivox::{Gloss, SurfaceMaterial, SurfaceTexture};
use lumivox_scene::{AlphaMode, Material, Scene, Shading, TextureRef};

use super::material_record::{
    MaterialRecord, TEXTURE_COUNT, has_sheen, is_layered, record, textures,
};
use super::mips::{Alpha, Encoding};
use super::textures::TextureUpload;
use crate::Gpu;

/// A material for the passes that rasterize.
#[derive(Debug)]
pub struct GpuMaterial {
    /// Bind group 1 of the passes that rasterize.
    pub group: BindGroup,
    /// Buffer of its parameters, a [`MaterialRecord`].
    uniform: Buffer,
    /// The uses for which its textures were uploaded.
    textures: TextureUse,
    /// Where the surface exists.
    pub(crate) presence: Presence,
    /// Whether it is visible from behind.
    pub is_double_sided: bool,
    /// Whether it needs the fragment shader with all layers.
    pub(crate) is_layered: bool,
    /// Whether it may change the colour of transmitted light.
    pub(crate) is_tinted: bool,
}

/// The properties of a material that determine the uploaded textures.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TextureUse {
    references: [Option<TextureRef>; TEXTURE_COUNT],
    /// The use of the first texture's alpha.
    alpha: Alpha,
    has_sheen: bool,
    /// Whether the voxels read the transmission texture.
    has_transmission: bool,
}

/// Where a surface exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Presence {
    /// Everywhere.
    Whole,
    /// Where its alpha reaches the cutoff.
    Masked,
    /// Everywhere, with a coverage: the surface is blended or transmits light.
    Partial,
    /// Nowhere: its alpha has no texture and is zero or below the cutoff.
    Absent,
}

/// The colours of the vertices on which a material is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VertexColors {
    /// Whether any vertex has a colour.
    pub(crate) has_colors: bool,
    /// Whether any colour has an alpha below 1.
    pub(crate) has_alpha: bool,
}

/// Layout of group 1 of the passes that rasterize: 9 of WebGPU's 16 textures and samplers.
pub(crate) fn material_layout(device: &Pipelines) -> wgpu::BindGroupLayout {
    let layout = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT).uniform();
    (0..=TEXTURE_COUNT)
        .fold(layout, |layout, _| layout.texture_2d().sampler())
        .build(device, "material")
}

/// Uploads a scene's materials.
#[derive(Debug)]
pub(crate) struct MaterialUpload<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    radiance_unit: f32,
    white: f32,
    layout: &'a wgpu::BindGroupLayout,
    textures: TextureUpload<'a>,
}

impl<'a> MaterialUpload<'a> {
    /// Starts the upload; `white` is the radiance of white on unlit surfaces, in cd/m².
    pub(crate) fn new(
        gpu: &'a Gpu,
        scene: &'a Scene,
        radiance_unit: f32,
        white: f32,
        layout: &'a wgpu::BindGroupLayout,
    ) -> Self {
        let textures = TextureUpload::new(gpu, scene);
        Self { gpu, scene, radiance_unit, white, layout, textures }
    }

    /// Bytes of all textures so far.
    pub(crate) fn texture_bytes(&self) -> u64 {
        self.textures.bytes
    }

    /// Uploads one material, for the rasterizer and for the voxels. `colors` describes the vertices
    /// on which it is used.
    pub(crate) fn upload(
        &mut self,
        material: &Material,
        colors: VertexColors,
    ) -> (GpuMaterial, SurfaceMaterial) {
        let record = record(material, self.radiance_unit, self.white, colors.has_alpha);
        let used = TextureUse::of(material, &record);
        let TextureUse { references, alpha, has_sheen, has_transmission } = used;
        let encodings = [
            (Encoding::Color, alpha),
            (Encoding::Data, Alpha::Data),
            (Encoding::Data, Alpha::Data),
            (Encoding::Color, Alpha::Data),
            (Encoding::Color, Alpha::Data),
            (Encoding::Data, Alpha::Data),
            (Encoding::Color, Alpha::Data),
            (Encoding::Data, Alpha::Data),
        ];
        let views: [TextureView; TEXTURE_COUNT] = std::array::from_fn(|i| {
            let (encoding, alpha) = encodings[i];
            self.textures.texture(references[i], encoding, alpha)
        });
        let samplers = references.map(|reference| self.textures.sampler(reference));
        let (sheen_albedo, sheen_sampler) = self.textures.sheen_albedo(has_sheen);
        let uniform = uniform_buffer(&self.gpu.device, &material.name, &record);
        let group = views
            .iter()
            .zip(&samplers)
            .chain([(&sheen_albedo, &sheen_sampler)])
            .fold(
                BindGroupBuilder::new(self.layout).buffer(&uniform),
                |builder, (texture, sampler)| builder.view(texture).sampler(sampler),
            )
            .build(&self.gpu.device, &material.name);
        let mut for_raster = GpuMaterial {
            group,
            uniform,
            textures: used,
            presence: Presence::Whole,
            is_double_sided: false,
            is_layered: false,
            is_tinted: false,
        };
        for_raster.set_flags(material, &record, colors);

        let surface_texture = |index: usize| {
            references[index].map(|reference| SurfaceTexture {
                view: wgpu::TextureView::clone(&views[index]),
                sampler: samplers[index].clone(),
                texcoord_set: reference.uv_set,
                transform: reference.transform,
            })
        };
        let mut for_voxels = SurfaceMaterial {
            reflectance_texture: surface_texture(0),
            emission_texture: surface_texture(3),
            transmission_texture: surface_texture(7).filter(|_| has_transmission),
            ..SurfaceMaterial::default()
        };
        set_factors(&mut for_voxels, material, &record, self.scene);
        (for_raster, for_voxels)
    }
}

impl TextureUse {
    fn of(material: &Material, record: &MaterialRecord) -> Self {
        Self {
            references: textures(material),
            alpha: alpha_of_base(material, record),
            has_sheen: has_sheen(record),
            has_transmission: record.transmission > 0.0,
        }
    }
}

impl GpuMaterial {
    /// Updates the parameters if the textures do not change; otherwise returns `false` and changes
    /// nothing.
    ///
    /// `radiance_unit` and `white` are as in [`MaterialUpload::new`], `colors` as in
    /// [`MaterialUpload::upload`].
    pub(crate) fn set(
        &mut self,
        queue: &wgpu::Queue,
        scene: &Scene,
        material: &Material,
        (radiance_unit, white): (f32, f32),
        colors: VertexColors,
        for_voxels: &mut SurfaceMaterial,
    ) -> bool {
        let record = record(material, radiance_unit, white, colors.has_alpha);
        if TextureUse::of(material, &record) != self.textures {
            return false;
        }
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&record));
        self.set_flags(material, &record, colors);
        set_factors(for_voxels, material, &record, scene);
        true
    }

    fn set_flags(&mut self, material: &Material, record: &MaterialRecord, colors: VertexColors) {
        self.presence = presence(material, record);
        self.is_double_sided = material.double_sided;
        self.is_layered = is_layered(material, record);
        let is_colored = colors.has_colors || has_color(record, &self.textures.references);
        self.is_tinted = record.transmission > 0.0 && is_colored;
    }
}

/// Sets a material's parameters in the voxels, except its textures.
///
/// Voxels only reflect diffusely. The gloss of a metal counts as diffuse, so its albedo is the base
/// colour whatever the metalness; the gloss of a dielectric has separate parameters. On
/// transmitting surfaces, the part that does not pass counts as reflected. Clear coat and sheen
/// hardly change that sum, and are ignored.
fn set_factors(
    surface: &mut SurfaceMaterial,
    material: &Material,
    record: &MaterialRecord,
    scene: &Scene,
) {
    surface.reflectance = record.base_color.into();
    surface.gloss = gloss(material, record, scene);
    surface.emission = Vec3::from_array(record.emission);
    surface.transmission = mean_transmission(material, record, scene);
    surface.alpha_is_coverage = record.is_blended != 0 || record.mask_threshold > 0.0;
    surface.double_sided = material.double_sided;
    surface.open_behind = material.open_behind;
}

/// The gloss of a material's dielectric, non-transmitting part, treated as uniform and colourless.
/// Textures of roughness, metalness and specular reflectance are averaged.
fn gloss(material: &Material, record: &MaterialRecord, scene: &Scene) -> Gloss {
    let [_, metallic_roughness, _, _, specular, ..] = textures(material);
    let [_, roughness, metalness, _] = mean_texel(metallic_roughness, scene);
    let mean_f0 = mean_f0(material, record) * mean_texel(specular, scene)[3];
    let share = (1.0 - record.metallic * metalness) * (1.0 - record.transmission);
    Gloss::new(mean_f0, record.roughness * roughness).of_share(share)
}

/// The dielectric's reflectance at normal incidence, without its texture, 0 to 1; averaged over the
/// colour channels.
fn mean_f0(material: &Material, record: &MaterialRecord) -> f32 {
    // In plain records, F0 is already scaled.
    let factor = if is_layered(material, record) { record.specular_factor } else { 1.0 };
    (Vec3::from(record.dielectric_f0).min(Vec3::ONE) * factor).element_sum() / 3.0
}

/// Means of a texture's channels, 0 to 1, from a sample of its texels; 1 without a texture.
fn mean_texel(reference: Option<TextureRef>, scene: &Scene) -> [f32; 4] {
    const ENOUGH_TEXELS: usize = 1 << 16;
    let Some(reference) = reference else { return [1.0; 4] };
    let texels = scene.textures[reference.texture].rgba8.chunks_exact(4);
    // Odd, so that it does not align with rows or tiles, which are powers of two.
    let step = (texels.len() / ENOUGH_TEXELS) | 1;
    let mut sums = [0_u64; 4];
    let mut count = 0_u64;
    for texel in texels.step_by(step) {
        sums.iter_mut().zip(texel).for_each(|(sum, channel)| *sum += u64::from(*channel));
        count += 255;
    }
    sums.map(|sum| (sum as f64 / count.max(1) as f64) as f32)
}

/// The share of light at normal incidence that a material transmits: without the part reflected at
/// the surface, and without the metallic part. A texture of metalness is averaged.
fn mean_transmission(material: &Material, record: &MaterialRecord, scene: &Scene) -> f32 {
    if record.transmission <= 0.0 {
        return 0.0;
    }
    let [_, _, metalness, _] = mean_texel(textures(material)[1], scene);
    let entering = 1.0 - mean_f0(material, record);
    record.transmission * (1.0 - record.metallic * metalness) * entering
}

/// Whether a material's base colour may be other than grey.
fn has_color(record: &MaterialRecord, references: &[Option<TextureRef>; TEXTURE_COUNT]) -> bool {
    let [r, g, b, _] = record.base_color;
    references[0].is_some() || r.to_bits() != g.to_bits() || g.to_bits() != b.to_bits()
}

/// The use of the alpha of the base colour's texture.
fn alpha_of_base(material: &Material, record: &MaterialRecord) -> Alpha {
    let factor = match &material.shading {
        Shading::MetallicRoughness(m) => m.base_color.w,
        Shading::Phong(p) => p.opacity,
        Shading::Unlit(u) => u.color.w,
    };
    match material.alpha {
        // The texture's alpha is compared after it is multiplied by the factor. With a factor of
        // zero, no texel reaches a cutoff above zero.
        AlphaMode::Mask { cutoff } if cutoff <= 0.0 => Alpha::Mask(0.0),
        AlphaMode::Mask { cutoff } => Alpha::Mask(cutoff / factor),
        AlphaMode::Blend if record.is_blended != 0 => Alpha::Coverage,
        AlphaMode::Blend | AlphaMode::Opaque => Alpha::Data,
    }
}

fn presence(material: &Material, record: &MaterialRecord) -> Presence {
    let has_texture = textures(material)[0].is_some();
    let alpha = record.base_color[3];
    match material.alpha {
        AlphaMode::Mask { cutoff } if !has_texture && alpha < cutoff => Presence::Absent,
        AlphaMode::Blend if alpha <= 0.0 => Presence::Absent,
        _ if record.is_blended != 0 || record.transmission > 0.0 => Presence::Partial,
        _ if record.mask_threshold > 0.0 => Presence::Masked,
        _ => Presence::Whole,
    }
}
