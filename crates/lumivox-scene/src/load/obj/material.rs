//! Conversion of MTL's materials.
//!
//! With `Pr`, `Pm` or another key of physically-based materials the surface has metalness and
//! roughness; otherwise it is Phong's, with `Ks` limited to 1 - `Kd`, so that no surface reflects
//! more than it receives. `Ka` is only used if `Kd` is missing, since renderers compute ambient
//! light. Colours are linear, as reflectivities ("the diffuse reflectivity using RGB values"). MTL
//! has no unit of light: `Ke` 1 is 1 cd/m², like glTF's emissive factor.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::map::Map;
use super::mtl::{Library, Mtl, Scalar, Slot};
use super::texture::{Made, Source, Textures};
use crate::load::files::Reach;
use crate::load::find::find;
use crate::load::text::readable;
use crate::load::{LoadOptions, Notes, stand_in};
use crate::{
    AlphaMode, Clearcoat, Material, MetallicRoughness, Phong, Scene, Shading, Sheen, TextureRef,
    Unlit,
};

/// The diffuse reflectivity of materials without `Kd`, as of missing materials.
const NO_DIFFUSE: f32 = 0.5;
/// The roughness of materials without `Pr`.
const NO_ROUGHNESS: f32 = 0.5;

/// Converts each material once.
pub(super) struct Materials<'s, 'o> {
    file: &'s Path,
    reach: Reach<'s>,
    definitions: Library,
    textures: Textures<'s>,
    options: &'s mut LoadOptions<'o>,
    /// Materials by name, and by whether the vertices have colours.
    known: HashMap<(Option<Vec<u8>>, bool), usize>,
    /// The number of images so far.
    images: u64,
    /// The number of materials with a limited `Ks`.
    limited: u64,
    /// The number of opaque materials whose `illum` is that of glass.
    opaque_glass: u64,
}

impl<'s, 'o> Materials<'s, 'o> {
    pub(super) fn new(
        file: &'s Path,
        reach: Reach<'s>,
        definitions: Library,
        options: &'s mut LoadOptions<'o>,
    ) -> Self {
        let textures = Textures::new(options.budget.texture_bytes, reach);
        let known = HashMap::new();
        let (images, limited, opaque_glass) = (0, 0, 0);
        Self { file, reach, definitions, textures, options, known, images, limited, opaque_glass }
    }

    /// The scene's index of a material. `colored`: the vertices have colours, which replace a
    /// missing material.
    pub(super) fn get(
        &mut self,
        name: Option<&[u8]>,
        colored: bool,
        scene: &mut Scene,
        notes: &mut Notes,
    ) -> usize {
        let said = name.and_then(|name| self.definitions.get(name).cloned());
        let key = (name.map(<[u8]>::to_vec), colored && said.is_none());
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let material = match (said, name) {
            (Some(mtl), Some(name)) => self.convert(&mtl, readable(name), scene, notes),
            (None, Some(name)) => {
                let name = readable(name);
                let shown = if colored { "its vertices' colours" } else { "matte grey" };
                notes.warn(format!(
                    "the material \"{name}\" is in no material library that was found; it is shown \
                     in {shown}"
                ));
                if colored { stand_in::white(&name) } else { stand_in::grey(&name) }
            }
            _ if colored => stand_in::only_colors(notes),
            _ => stand_in::no_material(notes),
        };
        scene.materials.push(material);
        self.known.insert(key, scene.materials.len() - 1);
        scene.materials.len() - 1
    }

    /// Adds the warnings that concern all materials.
    pub(super) fn finish(self, notes: &mut Notes) {
        if self.limited > 0 {
            notes.warn(format!(
                "{} materials would reflect more light than they receive (Kd + Ks above 1): their \
                 Ks was limited",
                self.limited
            ));
        }
        if self.opaque_glass > 0 {
            notes.warn(format!(
                "{} materials are glass by their illum (4, 6, 7 or 9), but not by their d, and are \
                 shown opaque; set d below 1 to see through them",
                self.opaque_glass
            ));
        }
        self.textures.warn(notes);
    }

    fn convert(
        &mut self,
        mtl: &Mtl,
        name: String,
        scene: &mut Scene,
        notes: &mut Notes,
    ) -> Material {
        let total = self.images + mtl.maps.len() as u64;
        self.options.tell("textures", self.images, total);
        let mut this = Conversion { own: self, mtl, name: &name, scene, notes };

        let opacity = this.opacity();
        let (diffuse_texture, made, alpha) = this.diffuse_texture(opacity);
        let diffuse = this.diffuse(diffuse_texture.is_some());
        let (emissive, emissive_texture) = this.emission();
        let (normal_texture, normal_scale) = this.normals();
        let illumination = mtl.scalar(Scalar::Illumination);
        // Maya writes illum 4 and Ni 1 for all materials.
        let is_glass = [4.0, 6.0, 7.0, 9.0].contains(&illumination.unwrap_or_default())
            && mtl.scalar(Scalar::Ior) != Some(1.0);
        this.own.opaque_glass += u64::from(is_glass && alpha == AlphaMode::Opaque);

        let mut material = Material {
            emissive,
            emissive_texture,
            normal_texture,
            normal_scale,
            alpha,
            double_sided: true,
            ..Material::default()
        };
        if illumination == Some(0.0) {
            this.notes.warn(format!(
                "material \"{name}\": illum 0 is a constant colour, without lighting"
            ));
            material.shading = Shading::Unlit(Unlit {
                color: diffuse.extend(opacity),
                color_texture: diffuse_texture,
            });
        } else if is_physical(mtl) {
            let base = MetallicRoughness {
                base_color: diffuse.extend(opacity),
                base_color_texture: diffuse_texture,
                ..MetallicRoughness::default()
            };
            this.physical(&mut material, base);
        } else {
            let reflected = made.map_or(diffuse, |made| diffuse * made.brightest);
            let (specular, specular_texture) = match illumination {
                Some(1.0) => (Vec3::ZERO, None),
                _ => this.specular(reflected),
            };
            let shininess = mtl.scalar(Scalar::Shininess).unwrap_or(Phong::default().shininess);
            material.shading = Shading::Phong(Phong {
                diffuse,
                diffuse_texture,
                opacity,
                specular,
                specular_texture,
                shininess: shininess.max(1.0),
            });
        }
        self.images = total;
        self.options.tell("textures", total, total);
        Material { name, ..material }
    }
}

fn is_physical(mtl: &Mtl) -> bool {
    use Scalar::{Clearcoat, ClearcoatRoughness, Metallic, Roughness, Sheen};
    [Roughness, Metallic, Sheen, Clearcoat, ClearcoatRoughness]
        .iter()
        .any(|&key| mtl.scalar(key).is_some())
        || [Slot::Roughness, Slot::Metallic, Slot::Sheen]
            .iter()
            .any(|&slot| mtl.map(slot).is_some())
}

/// The conversion of one material.
struct Conversion<'c, 's, 'o> {
    own: &'c mut Materials<'s, 'o>,
    mtl: &'c Mtl,
    name: &'c str,
    scene: &'c mut Scene,
    notes: &'c mut Notes,
}

impl Conversion<'_, '_, '_> {
    fn warn(&mut self, sentence: &str) {
        self.notes.warn(format!("material \"{}\": {sentence}", self.name));
    }

    /// A number that the model limits to 0..1.
    fn unit(&mut self, value: f32, what: &str) -> f32 {
        let limited = value.clamp(0.0, 1.0);
        if !(0.0..=1.0).contains(&value) {
            self.warn(&format!("its {what} of {value} was limited to {limited}"));
        }
        limited
    }

    fn unit_color(&mut self, value: Vec3, what: &str) -> Vec3 {
        let limited = value.clamp(Vec3::ZERO, Vec3::ONE);
        if limited != value {
            self.warn(&format!("its {what} of {value} was limited to {limited}"));
        }
        limited
    }

    /// `d`, or 1 minus `Tr`.
    fn opacity(&mut self) -> f32 {
        let opacity =
            match (self.mtl.scalar(Scalar::Opacity), self.mtl.scalar(Scalar::Transparency)) {
                (Some(opacity), _) => opacity,
                (None, Some(1.0)) => {
                    // Exporters do not write invisible surfaces; many take Tr for an opacity.
                    self.warn("Tr 1 without d counts as opaque");
                    1.0
                }
                (None, Some(transparency)) => 1.0 - transparency,
                (None, None) => 1.0,
            };
        let opacity = self.unit(opacity, "opacity");
        if opacity <= 0.0 {
            self.warn("its opacity (d) is zero, it is invisible");
        }
        opacity
    }

    /// `Kd`; images multiply it.
    fn diffuse(&mut self, has_texture: bool) -> Vec3 {
        match self.mtl.diffuse {
            Some(diffuse) if diffuse == Vec3::ZERO && has_texture => {
                self.warn("Kd 0 would make map_Kd black and counts as 1");
                Vec3::ONE
            }
            Some(diffuse) => self.unit_color(diffuse, "Kd"),
            None if has_texture => Vec3::ONE,
            None => match self.mtl.ambient {
                // Exporters write 0 or 1 for an unknown Ka.
                Some(ambient) if ambient != Vec3::ZERO && ambient != Vec3::ONE => {
                    self.warn("it has Ka and no Kd; Ka is its diffuse colour");
                    self.unit_color(ambient, "Ka")
                }
                _ => Vec3::splat(NO_DIFFUSE),
            },
        }
    }

    /// `map_Kd` with `map_d` in its alpha.
    fn diffuse_texture(&mut self, opacity: f32) -> (Option<TextureRef>, Option<Made>, AlphaMode) {
        let blend = if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
        let color = self.mtl.map(Slot::Diffuse).cloned();
        let mut color_file = None;
        if let Some(map) = &color {
            match self.find(map) {
                Ok(file) => color_file = Some(file),
                Err(reason) => return (Some(self.checker(map, &reason)), None, blend),
            }
        }
        if let Some(map) = self.mtl.map(Slot::Opacity).cloned() {
            let placed = color.as_ref().unwrap_or(&map);
            if !placed.lies_like(&map) {
                self.warn("map_d is placed like map_Kd, its own -s, -o and -clamp are ignored");
            }
            let made = self.find(&map).and_then(|opacity| {
                let channel = map.channel;
                let source = Source::Cutout { color: color_file.clone(), opacity, channel };
                self.own.textures.get(source, placed, self.scene)
            });
            match made {
                Ok(made) => {
                    let cuts_out = made.cuts_out && opacity >= 1.0;
                    let alpha =
                        if cuts_out { AlphaMode::Mask { cutoff: 0.5 } } else { AlphaMode::Blend };
                    // Without an image of the colour, the placement is that of the opacity's image.
                    return (Some(placed.reference(made.texture)), Some(made), alpha);
                }
                Err(reason) => self.warn(&format!("map_d is ignored: {reason}")),
            }
        }
        let (Some(map), Some(file)) = (color, color_file) else { return (None, None, blend) };
        match self.own.textures.get(Source::Color(file), &map, self.scene) {
            Ok(made) => {
                if made.unused_alpha {
                    self.warn(
                        "the alpha of its map_Kd is not used; name the image as map_d, too, if it \
                         is meant",
                    );
                }
                (Some(map.reference(made.texture)), Some(made), blend)
            }
            Err(reason) => (Some(self.checker(&map, &reason)), None, blend),
        }
    }

    /// The texture of a colour, or its stand-in.
    fn color_texture(&mut self, slot: Slot) -> Option<TextureRef> {
        let map = self.mtl.map(slot)?.clone();
        let made = self
            .find(&map)
            .and_then(|file| self.own.textures.get(Source::Color(file), &map, self.scene));
        Some(match made {
            Ok(made) => map.reference(made.texture),
            Err(reason) => self.checker(&map, &reason),
        })
    }

    fn emission(&mut self) -> (Vec3, Option<TextureRef>) {
        // Exporters write Ke 0 with an image.
        let said = self.mtl.emission.unwrap_or(Vec3::ZERO).max(Vec3::ZERO);
        let map = self.mtl.map(Slot::Emission).cloned();
        // A missing image is not replaced by a checkerboard, which would glow.
        let texture = map.and_then(|map| {
            let made = self
                .find(&map)
                .and_then(|file| self.own.textures.get(Source::Color(file), &map, self.scene));
            made.map(|made| map.reference(made.texture))
                .map_err(|reason| self.warn(&format!("map_Ke is ignored: {reason}")))
                .ok()
        });
        let emission = if said == Vec3::ZERO && texture.is_some() { Vec3::ONE } else { said };
        (emission, texture)
    }

    /// `norm`, or `bump`, which may hold normals or heights.
    fn normals(&mut self) -> (Option<TextureRef>, f32) {
        let (map, heights) = match (self.mtl.map(Slot::Normal), self.mtl.map(Slot::Bump)) {
            (Some(map), _) => (map.clone(), Some(false)),
            (None, Some(map)) => (map.clone(), None),
            (None, None) => return (None, 1.0),
        };
        let bump_bits = map.bump.to_bits();
        let made = self.find(&map).and_then(|file| {
            let source = Source::Bump { file, bump_bits, heights };
            self.own.textures.get(source, &map, self.scene)
        });
        match made {
            Ok(made) if made.from_heights => {
                self.warn(
                    "its bump map of heights became a normal map; -bm 1 counts as a depth of a \
                     hundredth of the image's width",
                );
                (Some(map.reference(made.texture)), 1.0)
            }
            Ok(made) => (Some(map.reference(made.texture)), map.bump),
            Err(reason) => {
                self.warn(&format!("its bump map is ignored: {reason}"));
                (None, 1.0)
            }
        }
    }

    /// `Ks`, limited to the share that is not reflected diffusely.
    fn specular(&mut self, reflected: Vec3) -> (Vec3, Option<TextureRef>) {
        let texture = self.color_texture(Slot::Specular);
        let default = if texture.is_some() { Vec3::ONE } else { Vec3::ZERO };
        let specular = self.unit_color(self.mtl.specular.unwrap_or(default), "Ks");
        let limited = specular.min(Vec3::ONE - reflected);
        self.own.limited += u64::from(limited != specular);
        (limited, texture)
    }

    /// The keys of physically-based materials.
    fn physical(&mut self, material: &mut Material, mut base: MetallicRoughness) {
        base.metallic_roughness_texture = self.rough_metal();
        let has = |slot| base.metallic_roughness_texture.is_some() && self.mtl.map(slot).is_some();
        let (has_rough, has_metal) = (has(Slot::Roughness), has(Slot::Metallic));
        // Images multiply the numbers, which exporters set to zero if there is an image.
        let factor = |said: Option<f32>, image: bool, otherwise: f32| match said {
            Some(0.0) | None if image => 1.0,
            said => said.unwrap_or(otherwise),
        };
        // The roughness of a microfacet lobe as wide as Phong's (Walter et al. 2007, "Microfacet
        // models for refraction", section 5.2: alpha² = 2 / (n + 2)).
        let from_phong = self
            .mtl
            .scalar(Scalar::Shininess)
            .map_or(NO_ROUGHNESS, |shininess| (2.0 / (shininess.max(0.0) + 2.0)).sqrt().sqrt());
        let rough = factor(self.mtl.scalar(Scalar::Roughness), has_rough, from_phong);
        let metal = factor(self.mtl.scalar(Scalar::Metallic), has_metal, 0.0);
        base.roughness = self.unit(rough, "roughness");
        base.metallic = self.unit(metal, "metallic");
        // Exporters write 1 for an unknown Ni, which would make the surface invisible.
        base.ior = self.mtl.scalar(Scalar::Ior).filter(|&ior| ior > 1.0).unwrap_or(1.5);

        let strength = self.mtl.scalar(Scalar::Clearcoat).unwrap_or(0.0);
        let roughness = self.mtl.scalar(Scalar::ClearcoatRoughness).unwrap_or(0.0);
        material.clearcoat = Clearcoat {
            strength: self.unit(strength, "clearcoat"),
            roughness: self.unit(roughness, "clearcoat roughness"),
            texture: None,
        };
        let texture = self.color_texture(Slot::Sheen);
        let sheen = factor(self.mtl.scalar(Scalar::Sheen), texture.is_some(), 0.0);
        material.sheen = Sheen {
            color: Vec3::splat(self.unit(sheen, "sheen")),
            roughness: if sheen > 0.0 { NO_ROUGHNESS } else { 0.0 },
            texture,
        };
        material.shading = Shading::MetallicRoughness(base);
    }

    /// Combines `map_Pr` and `map_Pm` in one image.
    fn rough_metal(&mut self) -> Option<TextureRef> {
        let maps = [Slot::Roughness, Slot::Metallic].map(|slot| self.mtl.map(slot).cloned());
        let files = [(&maps[0], "map_Pr"), (&maps[1], "map_Pm")].map(|(map, what)| {
            let found = self.find(map.as_ref()?);
            found.map_err(|reason| self.warn(&format!("{what} is ignored: {reason}"))).ok()
        });
        let [rough, metal] = files;
        let placed = match (&rough, &metal) {
            (Some(_), _) => maps[0].as_ref()?,
            (None, Some(_)) => maps[1].as_ref()?,
            (None, None) => return None,
        };
        if let [Some(a), Some(b)] = &maps
            && !a.lies_like(b)
        {
            self.warn("map_Pm is placed like map_Pr, its own -s, -o and -clamp are ignored");
        }
        let channel = |map: &Option<Map>| map.as_ref().map(|map| map.channel).unwrap_or_default();
        let channels = (channel(&maps[0]), channel(&maps[1]));
        let source = Source::RoughMetal { rough, metal, channels };
        match self.own.textures.get(source, placed, self.scene) {
            Ok(made) => Some(placed.reference(made.texture)),
            Err(reason) => {
                self.warn(&format!("map_Pr and map_Pm are ignored: {reason}"));
                None
            }
        }
    }

    /// The file of an image, in the folder of the material library or the scene.
    fn find(&self, map: &Map) -> Result<PathBuf, String> {
        find(&[&self.mtl.file, self.own.file], &map.file, self.own.reach)
    }

    fn checker(&mut self, map: &Map, reason: &str) -> TextureRef {
        self.warn(&format!(
            "an image cannot be shown, a magenta checkerboard replaces it: {reason}"
        ));
        TextureRef::new(self.own.textures.stand_in(&readable(&map.file), self.scene))
    }
}
