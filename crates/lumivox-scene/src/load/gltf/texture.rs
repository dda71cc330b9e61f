//! Textures: the image, its mapping to the surface, and its sampling.
//!
//! If a texture names images both by an extension and by the core format, the extension's is tried
//! first, and the other is used if the first cannot be read. A scene with a missing or broken image
//! is still loaded, with a warning: a colour is replaced by a board of magenta and black; other
//! textures are dropped. Occlusion textures are not read: renderers compute occlusion, so it would
//! count twice.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::{Affine2, Vec2};
use gltf::texture::{MagFilter, MinFilter, WrappingMode};
use serde_json::Value;

use super::{Loader, dangling, extras, name_or_index};
use crate::load::files::{self, Located};
use crate::load::image::{Encoding, Fault, Source};
use crate::load::textures::{ImageId, Mix, Recipe};
use crate::{Filter, Sampler, SceneError, TextureRef, Wrap};

/// Extensions that name an image in a format beyond the core's, in order of preference.
const IMAGE_EXTENSIONS: [&str; 2] = ["KHR_texture_basisu", "EXT_texture_webp"];

/// A material's reference to one of its textures.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextureUse {
    texture: usize,
    uv_set: u32,
    transform: Affine2,
}

impl TextureUse {
    pub(super) fn new(info: &gltf::texture::Info<'_>) -> Self {
        let moved = info.texture_transform();
        Self {
            texture: info.texture().index(),
            uv_set: moved
                .as_ref()
                .and_then(gltf::texture::TextureTransform::tex_coord)
                .unwrap_or(info.tex_coord()),
            transform: moved.map_or(Affine2::IDENTITY, |t| {
                extras::texture_transform(t.extras())
                    .unwrap_or_else(|| uv_transform(t.offset(), t.rotation(), t.scale()))
            }),
        }
    }

    pub(super) fn normal(normal: &gltf::material::NormalTexture<'_>) -> Self {
        let (set, transform) =
            json_transform(normal.extension_value("KHR_texture_transform"), normal.tex_coord());
        Self { texture: normal.texture().index(), uv_set: set, transform }
    }
}

/// The transform from a mesh's coordinates to the image's: translation * rotation * scale, where
/// the rotation is counter-clockwise as seen on the image, whose v points down
/// (`KHR_texture_transform`; the matrix in its text rotates the other way, see issue 1563 of the
/// specification).
fn uv_transform(offset: [f32; 2], rotation_rad: f32, scale: [f32; 2]) -> Affine2 {
    Affine2::from_scale_angle_translation(
        Vec2::from_array(scale),
        -rotation_rad,
        Vec2::from_array(offset),
    )
}

/// The coordinate set and texture transform of JSON that the glTF library does not read.
fn json_transform(value: Option<&Value>, set: u32) -> (u32, Affine2) {
    let Some(value) = value else { return (set, Affine2::IDENTITY) };
    let pair = |key: &str, default: [f32; 2]| match value[key].as_array().map(Vec::as_slice) {
        Some([x, y]) => [x, y].map(|n| n.as_f64().map_or(f32::NAN, |n| n as f32)),
        _ => default,
    };
    let rotation = value["rotation"].as_f64().unwrap_or(0.0) as f32;
    let transform = extras::exact_transform(&value["extras"][crate::EXTRAS]).unwrap_or_else(|| {
        uv_transform(pair("offset", [0.0; 2]), rotation, pair("scale", [1.0; 2]))
    });
    let set = value["texCoord"].as_u64().map_or(set, |set| u32::try_from(set).unwrap_or(u32::MAX));
    (set, transform)
}

/// A texture with an existing image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placed {
    pub(super) image: ImageId,
    sampler: Sampler,
    uv_set: u32,
    transform: Affine2,
}

impl Placed {
    /// Whether both have the same coordinates and sampling, so that one image can contain both.
    pub(super) fn matches(&self, other: &Self) -> bool {
        Self { image: other.image, ..*self } == *other
    }
}

/// An image, or the reason why it is missing.
pub(super) type Listed = Result<ImageId, String>;

impl<'a> Loader<'a> {
    /// The JSON of an extension that refers to a texture.
    pub(super) fn texture_use(&mut self, info: &Value, part: &str) -> Option<TextureUse> {
        if info.is_null() {
            return None;
        }
        let texture = info["index"].as_u64().and_then(|index| usize::try_from(index).ok());
        let Some(texture) = texture.filter(|&index| index < self.root().textures.len()) else {
            self.notes.warn(format!("{part} names a texture that does not exist; it was left out"));
            return None;
        };
        let set = info["texCoord"].as_u64().unwrap_or(0);
        let set = u32::try_from(set).unwrap_or(u32::MAX);
        let moved = &info["extensions"]["KHR_texture_transform"];
        let (uv_set, transform) = json_transform(Some(moved).filter(|m| m.is_object()), set);
        Some(TextureUse { texture, uv_set, transform })
    }

    /// Finds the texture's image; `None`, with a warning, if none can be read.
    pub(super) fn place(
        &mut self,
        wanted: Option<TextureUse>,
        material: &str,
    ) -> Result<Option<Placed>, SceneError> {
        let Some(wanted) = wanted else { return Ok(None) };
        let Some(image) = self.image_of(wanted.texture)? else { return Ok(None) };
        let document = self.document;
        let sampler = document
            .textures()
            .nth(wanted.texture)
            .map_or_else(Sampler::default, |texture| convert_sampler(&texture.sampler()));
        let mut uv_set = wanted.uv_set;
        if uv_set > 1 {
            self.notes.warn(format!(
                "material \"{material}\": a texture wants coordinate set {uv_set}, but only sets 0 \
                 and 1 are read; set 0 is used"
            ));
            uv_set = 0;
        }
        let mut transform = wanted.transform;
        if !transform.is_finite() {
            self.notes.warn(format!(
                "material \"{material}\": a texture's transform is not finite and was ignored"
            ));
            transform = Affine2::IDENTITY;
        }
        Ok(Some(Placed { image, sampler, uv_set, transform }))
    }

    /// A texture of a single image.
    pub(super) fn whole(&mut self, placed: Placed, encoding: Encoding) -> TextureRef {
        self.refer(Recipe::Image(placed.image), placed, encoding)
    }

    /// A texture made of several images, placed like the first of them.
    pub(super) fn mixed(
        &mut self,
        placed: Placed,
        images: Vec<ImageId>,
        mix: Mix,
        encoding: Encoding,
    ) -> TextureRef {
        self.refer(Recipe::Mixed { images, mix }, placed, encoding)
    }

    fn refer(&mut self, recipe: Recipe, placed: Placed, encoding: Encoding) -> TextureRef {
        TextureRef {
            texture: self.textures.texture(recipe, encoding, placed.sampler),
            uv_set: placed.uv_set,
            transform: placed.transform,
        }
    }

    /// A data or colour texture; `None` if its image is missing.
    pub(super) fn plain_texture(
        &mut self,
        wanted: Option<TextureUse>,
        material: &str,
        encoding: Encoding,
    ) -> Result<Option<TextureRef>, SceneError> {
        Ok(self.place(wanted, material)?.map(|placed| self.whole(placed, encoding)))
    }

    /// The texture of a surface's colour, or the stand-in if its image is missing.
    pub(super) fn color_texture(
        &mut self,
        wanted: Option<TextureUse>,
        material: &str,
    ) -> Result<Option<TextureRef>, SceneError> {
        if wanted.is_none() {
            return Ok(None);
        }
        let texture = self.plain_texture(wanted, material, Encoding::Color)?;
        Ok(Some(texture.unwrap_or_else(|| self.stand_in())))
    }

    pub(super) fn stand_in(&mut self) -> TextureRef {
        let sampler = Sampler { magnify: Filter::Nearest, ..Sampler::default() };
        TextureRef::new(self.textures.texture(Recipe::Missing, Encoding::Color, sampler))
    }

    /// Combines two textures of a material into one. Each has its channels of the result; unused
    /// channels are 1.
    pub(super) fn pair(
        &mut self,
        material: &str,
        what: &str,
        wanted: [(Option<TextureUse>, [bool; 4]); 2],
        encoding: Encoding,
    ) -> Result<Option<TextureRef>, SceneError> {
        let [(first, first_channels), (second, second_channels)] = wanted;
        let first = self.place(first, material)?;
        let second = self.place(second, material)?;
        let Some(placed) = first.or(second) else { return Ok(None) };
        let both = first.zip(second);
        if both.is_some_and(|(a, b)| !a.matches(&b)) {
            self.notes.warn(format!(
                "material \"{material}\": its two {what} textures lie differently on the surface; \
                 the second was placed like the first"
            ));
        }
        if both.is_some_and(|(a, b)| a.image == b.image) {
            return Ok(Some(self.whole(placed, encoding)));
        }
        let mut images = Vec::new();
        let mut channels = [None; 4];
        for (placed, own) in [(first, first_channels), (second, second_channels)] {
            let Some(placed) = placed else { continue };
            for c in (0..4).filter(|&c| own[c]) {
                channels[c] = Some((images.len(), c));
            }
            images.push(placed.image);
        }
        Ok(Some(self.mixed(placed, images, Mix::Channels(channels), encoding)))
    }

    /// The best readable image of a texture.
    fn image_of(&mut self, texture: usize) -> Result<Option<ImageId>, SceneError> {
        let mut candidates = Vec::new();
        let document = self.document;
        let Some(json) = document.textures().nth(texture) else {
            return Err(self.malformed(&format!("texture {texture}"), "it does not exist"));
        };
        for extension in IMAGE_EXTENSIONS {
            let Some(value) = json.extension_value(extension) else { continue };
            let image = value["source"].as_u64().and_then(|index| usize::try_from(index).ok());
            let Some(image) = image.filter(|&image| image < self.root().images.len()) else {
                self.notes.warn(format!(
                    "texture {texture}: its {extension} names an image that does not exist; that \
                     was left out"
                ));
                continue;
            };
            candidates.push(image);
        }
        candidates.extend(json.source().map(|image| image.index()));
        let mut reasons = Vec::new();
        for image in candidates {
            match self.list_image(image)? {
                Ok(found) => {
                    if let Some(reason) = reasons.last() {
                        self.notes.warn(format!(
                            "{reason}; the image that the file gives as a fallback is used"
                        ));
                    }
                    return Ok(Some(found));
                }
                Err(reason) => reasons.push(reason),
            }
        }
        self.notes.warn(match reasons.pop() {
            Some(reason) => format!("{reason}; a stand-in is shown"),
            // A warning about the material was already given.
            None if json.name() == Some(dangling::NO_TEXTURE) => return Ok(None),
            None => {
                format!("texture {texture} names no image of a supported format and was ignored")
            }
        });
        Ok(None)
    }

    /// Lists an image once, or returns the reason why it cannot be read.
    fn list_image(&mut self, index: usize) -> Result<Listed, SceneError> {
        if let Some(known) = self.images.get(&index) {
            return Ok(known.clone());
        }
        let Some(json) = self.root().images.get(index) else {
            return Err(self.malformed(&format!("image {index}"), "it does not exist"));
        };
        let name = image_name(json, index);
        let listed = self.image_source(json, &name).and_then(|source| {
            self.textures
                .image(&format!("image \"{name}\""), &name, source)
                .map_err(|fault| told(&name, &fault))
        });
        self.images.insert(index, listed.clone());
        Ok(listed)
    }

    /// The source of an image's bytes, or the reason why there is none.
    fn image_source(&self, json: &gltf::json::Image, name: &str) -> Result<Source<'a>, String> {
        let part = format!("image \"{name}\"");
        if let Some(view) = json.buffer_view {
            let bytes = self
                .view(view.value())
                .map_err(|error| format!("{part} cannot be read: {}", self.without_file(&error)))?;
            return Ok(Source::Memory(Cow::Borrowed(bytes)));
        }
        let Some(uri) = &json.uri else {
            return Err(format!("{part} has neither a URI nor a buffer view"));
        };
        let located = files::locate_uri(self.file, &part, uri, self.reach);
        match located.map_err(|error| self.without_file(&error))? {
            Located::Data(bytes) => Ok(Source::Memory(Cow::Owned(bytes))),
            Located::File(path) if self.reach.source.is_some() => match self.reach.read(&path) {
                Ok(bytes) => Ok(Source::Memory(Cow::Owned(bytes.into_owned()))),
                Err(error) => Err(told(name, &Fault::Unreadable(error))),
            },
            Located::File(path) => Ok(Source::File(path)),
        }
    }
}

/// The image's name, or its file's name.
fn image_name(json: &gltf::json::Image, index: usize) -> String {
    let file_name = json.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
    name_or_index(json.name.as_deref().or(file_name), "image", index)
}

/// The message about an image that cannot be read.
fn told(name: &str, fault: &Fault) -> String {
    match fault {
        Fault::Unreadable(error) => {
            format!("image \"{name}\" cannot be read ({error}); put its file beside the scene")
        }
        Fault::Bad(..) | Fault::OtherKind(_) => format!("image \"{name}\" cannot be used: {fault}"),
    }
}

/// The document's images that cannot be decoded.
pub(super) fn unlisted(
    listed: &HashMap<usize, Listed>,
    faults: &[(ImageId, Fault)],
    document: &gltf::Document,
) -> HashMap<usize, Listed> {
    let images = &document.as_json().images;
    let fault_of = |id: ImageId| faults.iter().find(|(faulty, _)| *faulty == id);
    let unlisted = listed.iter().filter_map(|(&index, listed)| {
        let (_, fault) = fault_of(*listed.as_ref().ok()?)?;
        Some((index, Err(told(&image_name(images.get(index)?, index), fault))))
    });
    unlisted.collect()
}

fn convert_sampler(sampler: &gltf::texture::Sampler<'_>) -> Sampler {
    let wrap = |mode| match mode {
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::Repeat => Wrap::Repeat,
    };
    Sampler {
        wrap_u: wrap(sampler.wrap_s()),
        wrap_v: wrap(sampler.wrap_t()),
        magnify: match sampler.mag_filter() {
            Some(MagFilter::Nearest) => Filter::Nearest,
            Some(MagFilter::Linear) | None => Filter::Linear,
        },
        // The filter between mip levels is ignored.
        minify: match sampler.min_filter() {
            Some(
                MinFilter::Nearest
                | MinFilter::NearestMipmapNearest
                | MinFilter::NearestMipmapLinear,
            ) => Filter::Nearest,
            _ => Filter::Linear,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_is_counter_clockwise_on_the_image() {
        // The extension's own example: the lower left quadrant, rotated by 90 degrees.
        let quarter = std::f32::consts::FRAC_PI_2;
        let transform = uv_transform([0.0, 1.0], quarter, [0.5, 0.5]);
        for (uv, expected) in [
            (Vec2::ZERO, Vec2::new(0.0, 1.0)),
            (Vec2::X, Vec2::new(0.0, 0.5)),
            (Vec2::Y, Vec2::new(0.5, 1.0)),
            (Vec2::ONE, Vec2::new(0.5, 0.5)),
        ] {
            let moved = transform.transform_point2(uv);
            assert!((moved - expected).length() < 1e-6, "{uv} to {moved}");
        }
    }

    #[test]
    fn texture_transforms_scale_then_rotate_then_offset() {
        let value = serde_json::json!({
            "offset": [0.25, -1], "rotation": 0.5, "scale": [2, 3], "texCoord": 1,
        });
        let (set, transform) = json_transform(Some(&value), 0);
        let (sin, cos) = 0.5_f32.sin_cos();
        let moved = transform.transform_point2(Vec2::new(1.0, 0.5));
        let expected = Vec2::new(2.0 * cos + 1.5 * sin + 0.25, -2.0 * sin + 1.5 * cos - 1.0);
        assert!((moved - expected).length() < 1e-6, "{moved} {expected}");
        assert_eq!(set, 1);
        assert_eq!(json_transform(None, 3), (3, Affine2::IDENTITY));
    }
}
