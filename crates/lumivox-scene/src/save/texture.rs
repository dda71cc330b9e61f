//! Images, as PNG in the buffer, and references to them.

use std::path::Path;

use glam::{Affine2, Vec2};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::binary::{Source, Target};
use super::document::{number, numbers, own_extras};
use super::{Writer, material};
use crate::load::shorten;
use crate::{Filter, SceneError, Texture, TextureRef, Wrap};

impl Writer<'_> {
    /// Writes the textures that instances use, in the order of their materials.
    pub(super) fn write_textures(&mut self, file: &Path) -> Result<(), SceneError> {
        let mut used = Vec::new();
        let mut met = vec![false; self.scene.textures.len()];
        let mut met_materials = vec![false; self.scene.materials.len()];
        for instance in super::node::shown(self.scene) {
            if std::mem::replace(&mut met_materials[instance.material], true) {
                continue;
            }
            for TextureRef { texture, .. } in
                material::textures(&self.scene.materials[instance.material])
            {
                if !std::mem::replace(&mut met[texture], true) {
                    used.push(texture);
                }
            }
        }
        // Compression takes most of the time of saving.
        let images: Vec<_> =
            used.par_iter().map(|&i| encode_png(&self.scene.textures[i])).collect();
        for (i, png) in used.into_iter().zip(images) {
            let texture = &self.scene.textures[i];
            let png = png.map_err(|reason| SceneError::Image {
                file: file.to_owned(),
                image: format!("texture \"{}\"", texture.name),
                reason: reason.to_string(),
            })?;
            self.textures[i] = Some(self.texture(texture, png));
        }
        Ok(())
    }

    fn texture(&mut self, texture: &Texture, png: Vec<u8>) -> usize {
        let view = self.document.binary.view(Source::Bytes(png), Target::None);
        let image = self.document.push_once(
            "images",
            &json!({ "bufferView": view, "mimeType": "image/png", "name": shorten(&texture.name) }),
        );
        let sampler = self.document.push_once(
            "samplers",
            &json!({
                "wrapS": wrap(texture.sampler.wrap_u),
                "wrapT": wrap(texture.sampler.wrap_v),
                "magFilter": match texture.sampler.magnify {
                    Filter::Nearest => 9728,
                    Filter::Linear => 9729,
                },
                // With mip levels, as in Lumivox.
                "minFilter": match texture.sampler.minify {
                    Filter::Nearest => 9984,
                    Filter::Linear => 9987,
                },
            }),
        );
        self.document.push_once("textures", &json!({ "sampler": sampler, "source": image }))
    }

    /// A reference to a texture (glTF's `textureInfo`).
    pub(super) fn texture_info(&mut self, reference: TextureRef) -> Map<String, Value> {
        let mut info = Map::new();
        info.insert("index".to_owned(), json!(self.textures[reference.texture]));
        if reference.uv_set != 0 {
            info.insert("texCoord".to_owned(), json!(reference.uv_set));
        }
        if reference.transform != Affine2::IDENTITY {
            const EXTENSION: &str = "KHR_texture_transform";
            self.document.uses(EXTENSION);
            let transform = texture_transform(reference.transform);
            info.insert("extensions".to_owned(), json!({ EXTENSION: transform }));
        }
        info
    }
}

/// The closest offset, rotation and scale; if they are not exact, also the exact matrix.
fn texture_transform(transform: Affine2) -> Map<String, Value> {
    let (x, y) = (transform.matrix2.x_axis, transform.matrix2.y_axis);
    let (rotation, scale) = if x.y == 0.0 && y.x == 0.0 {
        (0.0, Vec2::new(x.x, y.y))
    } else {
        // The direction of the first axis, or of the second if the first vanishes.
        let angle = if x == Vec2::ZERO { (-y.x).atan2(y.y) } else { x.y.atan2(x.x) };
        let second = Vec2::new(-angle.sin(), angle.cos());
        (angle, Vec2::new(x.length(), y.dot(second)))
    };
    let offset = transform.translation;
    let mut json = Map::new();
    if offset != Vec2::ZERO {
        json.insert("offset".to_owned(), numbers(offset.as_ref()));
    }
    if rotation != 0.0 {
        // glTF's angles are counter-clockwise in an image whose v grows downwards.
        json.insert("rotation".to_owned(), number(-rotation));
    }
    if scale != Vec2::ONE {
        json.insert("scale".to_owned(), numbers(scale.as_ref()));
    }
    if rotation != 0.0 {
        let mut own = Map::new();
        own.insert("matrix".to_owned(), numbers(&transform.to_cols_array()));
        own_extras(&mut json, &own);
    }
    json
}

fn encode_png(texture: &Texture) -> image::ImageResult<Vec<u8>> {
    let mut png = Vec::new();
    let encoder =
        PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive);
    let (width, height) = (texture.width, texture.height);
    if texture.rgba8.chunks_exact(4).all(|texel| texel[3] == 255) {
        let rgb: Vec<u8> = texture.rgba8.chunks_exact(4).flat_map(|t| [t[0], t[1], t[2]]).collect();
        encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8)?;
    } else {
        encoder.write_image(&texture.rgba8, width, height, ExtendedColorType::Rgba8)?;
    }
    Ok(png)
}

fn wrap(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10_497,
        Wrap::MirroredRepeat => 33_648,
        Wrap::ClampToEdge => 33_071,
    }
}
