//! Materials for rays, and emissive triangles.

use glam::DVec3;
use lumivox_scene::{AlphaMode, Material, Scene, Shading, TextureRef};

use super::atlas::Atlas;
use super::geometry::{Sides, Triangles};
use super::records::{EmitterRecord, TileRecord, TracedMaterialRecord};
use crate::picture::srgb::srgb_decode;
use crate::picture::tone_map::luminance;
use crate::scene::{
    Lighting, MaterialRecord, TEXTURE_COUNT, TEXTURES, colors_of_materials, has_sheen, is_layered,
    material_record, material_textures, reference_white,
};
use crate::{Gpu, RenderError};

type Textures = [Option<TextureRef>; TEXTURE_COUNT];

/// All materials of a scene.
#[derive(Debug)]
pub(super) struct Materials {
    pub(super) records: Vec<TracedMaterialRecord>,
    pub(super) sides: Vec<Sides>,
    pub(super) atlas: Atlas,
    pub(super) has_textures: bool,
    /// Whether any material has layers, or is absent in places.
    pub(super) has_layers: bool,
    pub(super) has_sheen: bool,
}

impl Materials {
    pub(super) fn new(
        gpu: &Gpu,
        scene: &Scene,
        lighting: &Lighting,
        radiance_unit: f32,
    ) -> Result<Self, RenderError> {
        let textures: Vec<_> = scene.materials.iter().map(material_textures).collect();
        let used = textures.iter().flat_map(|textures| {
            let pairs = textures.iter().zip(TEXTURES);
            pairs.filter_map(|(texture, (_, is_color))| texture.map(|texture| (texture, is_color)))
        });
        let atlas = Atlas::new(gpu, scene, used)?;
        let white = reference_white(scene, lighting);
        let colors = colors_of_materials(scene);
        let mut made = Self {
            records: Vec::new(),
            sides: Vec::new(),
            has_textures: textures.iter().flatten().any(Option::is_some),
            has_layers: false,
            has_sheen: false,
            atlas,
        };
        for (material, (textures, colors)) in
            scene.materials.iter().zip(textures.iter().zip(colors))
        {
            let mut shown = material_record(material, radiance_unit, white, colors.has_alpha);
            unmask(material, textures, &mut shown);
            if !is_layered(material, &shown) {
                // Plain materials include the factor in F0.
                shown.specular_factor = 1.0;
            }
            let sides = sides(material, textures, &shown);
            made.has_layers |= sides.is_see_through || is_layered(material, &shown);
            made.has_sheen |= has_sheen(&shown);
            made.sides.push(sides);
            made.records.push(TracedMaterialRecord {
                shown,
                tiles: std::array::from_fn(|which| {
                    textures[which].map_or(TileRecord::default(), |texture| {
                        made.atlas.tile(texture, TEXTURES[which].1)
                    })
                }),
                emitter_density: 0.0,
                phong_exponent: match &material.shading {
                    // Zero means that there is no Phong lobe.
                    Shading::Phong(phong) => phong.shininess.max(1e-3),
                    _ => 0.0,
                },
                padding: [0; 2],
            });
        }
        Ok(made)
    }

    /// The emissive triangles, sampled in proportion to their area times the luminance of their
    /// material's mean emission. Sets the density of each material.
    pub(super) fn emitters(&mut self, scene: &Scene, triangles: &Triangles) -> Vec<EmitterRecord> {
        let means: Vec<f64> = scene.materials.iter().map(|m| mean_emission(m, scene)).collect();
        let mut power = 0.0;
        let mut sums = Vec::new();
        for (index, triangle) in triangles.triangles.iter().enumerate() {
            let material = triangles.material(triangle);
            let mean = means.get(material).copied().unwrap_or(0.0);
            let own = mean * triangle.area_m2();
            if own > 0.0 {
                power += own;
                sums.push((index as u32, power));
            }
        }
        for (record, mean) in self.records.iter_mut().zip(means) {
            record.emitter_density = if power > 0.0 { (mean / power) as f32 } else { 0.0 };
        }
        let record = |(triangle, sum): (u32, f64)| EmitterRecord {
            triangle,
            cumulated: (sum / power) as f32,
        };
        sums.into_iter().map(record).collect()
    }
}

fn opacity(material: &Material) -> f32 {
    match &material.shading {
        Shading::MetallicRoughness(m) => m.base_color.w,
        Shading::Phong(p) => p.opacity,
        Shading::Unlit(u) => u.color.w,
    }
}

/// The rasterizer thresholds a mask's texture and compares it with one half; rays compare its alpha
/// directly.
fn unmask(material: &Material, textures: &Textures, shown: &mut MaterialRecord) {
    if let AlphaMode::Mask { cutoff } = material.alpha
        && (textures[0].is_some() || shown.mask_threshold > 0.0)
    {
        shown.base_color[3] = opacity(material);
        shown.mask_threshold = cutoff;
    }
}

fn sides(material: &Material, textures: &Textures, shown: &MaterialRecord) -> Sides {
    let is_absent = match material.alpha {
        AlphaMode::Opaque => false,
        AlphaMode::Mask { cutoff } => textures[0].is_none() && opacity(material) < cutoff,
        AlphaMode::Blend => opacity(material) <= 0.0,
    };
    Sides {
        is_absent,
        is_plain: material.textures().next().is_none(),
        is_double_sided: material.double_sided,
        is_see_through: material.open_behind
            || shown.is_blended != 0
            || shown.transmission > 0.0
            || shown.mask_threshold > 0.0,
    }
}

/// The luminance of the mean of a material's emission, in cd/m².
fn mean_emission(material: &Material, scene: &Scene) -> f64 {
    let texture = material.emissive_texture.map(|reference| &scene.textures[reference.texture]);
    let mean = texture.map_or(DVec3::ONE, |texture| {
        let linear: [f64; 256] =
            std::array::from_fn(|code| f64::from(srgb_decode(code as f32 / 255.0)));
        let texels = texture.rgba8.chunks_exact(4);
        let count = texels.len().max(1) as f64;
        let color =
            |t: &[u8]| DVec3::from_array([t[0], t[1], t[2]].map(|c| linear[usize::from(c)]));
        texels.map(color).sum::<DVec3>() / count
    });
    let emission = material.emissive.as_dvec3() * mean;
    luminance(emission.as_vec3().to_array())
}
