//! Images and samplers.

use std::io::Cursor;

use gltf::texture::{MagFilter, MinFilter, WrappingMode};
use image::error::ImageFormatHint;
use image::{ImageFormat, ImageReader, Limits};

use super::{Loader, name_or_index};
use crate::load::files;
use crate::{Filter, Sampler, SceneError, Texture, TextureRef, Wrap};

/// The longest edge in texels: what common GPUs take.
const LONGEST_EDGE: u32 = 16_384;
/// Bytes that decoding one image may take: the largest image with 16 bits a channel, and some.
const MOST_DECODER_BYTES: u64 = 3 << 30;

impl Loader<'_> {
    /// Loads a texture once; `None` where it has no image of a kind that is read here.
    pub(super) fn texture(
        &mut self,
        texture: &gltf::Texture<'_>,
    ) -> Result<Option<TextureRef>, SceneError> {
        let Some(source) = texture.source() else {
            self.notes.warn(format!(
                "texture {} has no PNG or JPEG image and was ignored",
                texture.index()
            ));
            return Ok(None);
        };
        let sampler = texture.sampler();
        let key = (source.index(), sampler.index());
        if let Some(&texture) = self.textures.get(&key) {
            return Ok(Some(TextureRef::new(texture)));
        }
        let sampler = Sampler {
            wrap_u: wrap(sampler.wrap_s()),
            wrap_v: wrap(sampler.wrap_t()),
            magnify: match sampler.mag_filter() {
                Some(MagFilter::Nearest) => Filter::Nearest,
                Some(MagFilter::Linear) | None => Filter::Linear,
            },
            minify: match sampler.min_filter() {
                Some(
                    MinFilter::Nearest
                    | MinFilter::NearestMipmapNearest
                    | MinFilter::NearestMipmapLinear,
                ) => Filter::Nearest,
                _ => Filter::Linear,
            },
        };
        // The same image under another sampler needs no second decoding.
        let twin = self.textures.iter().find(|((image, _), _)| *image == key.0).map(|(_, &t)| t);
        let mut loaded = match twin {
            Some(twin) => {
                let twin = self.scene.textures[twin].clone();
                self.spend_texels(&twin.name, twin.width, twin.height)?;
                twin
            }
            None => self.decode(source.index())?,
        };
        loaded.sampler = sampler;
        self.scene.textures.push(loaded);
        let texture = self.scene.textures.len() - 1;
        self.textures.insert(key, texture);
        Ok(Some(TextureRef::new(texture)))
    }

    fn decode(&mut self, index: usize) -> Result<Texture, SceneError> {
        let Some(json) = self.root().images.get(index) else {
            return Err(self.malformed(&format!("image {index}"), "it does not exist"));
        };
        // Its name, or that of its file: what a user can find.
        let file_name = json.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
        let name = name_or_index(json.name.as_deref().or(file_name), "image", index);
        let part = format!("image \"{}\"", files::shorten(&name));
        let external;
        let bytes = match (json.buffer_view, &json.uri) {
            (Some(view), _) => self.view(view.value())?,
            (None, Some(uri)) => {
                external = files::read_uri(self.file, &part, uri, self.reach)?;
                &external
            }
            (None, None) => {
                return Err(self.malformed(&part, "it has neither a URI nor a buffer view"));
            }
        };
        let (width, height) =
            size(bytes).map_err(|reason| self.bad_image(&part, reason.to_string()))?;
        if width > LONGEST_EDGE || height > LONGEST_EDGE {
            let reason = format!(
                "it has {width} x {height} texels, more than {LONGEST_EDGE} along an edge; shrink it"
            );
            return Err(self.bad_image(&part, reason));
        }
        self.spend_texels(&part, width, height)?;
        let decoded =
            decode_rgba8(bytes).map_err(|reason| self.bad_image(&part, reason.to_string()))?;
        Ok(Texture {
            name,
            width: decoded.width(),
            height: decoded.height(),
            rgba8: decoded.into_raw(),
            sampler: Sampler::default(),
        })
    }

    fn spend_texels(&mut self, part: &str, width: u32, height: u32) -> Result<(), SceneError> {
        let texels = u64::from(width) * u64::from(height);
        let left = self.budget.texels.checked_sub(texels);
        self.budget.texels = left.ok_or_else(|| self.too_many(part, "texels"))?;
        Ok(())
    }

    fn bad_image(&self, image: &str, reason: String) -> SceneError {
        SceneError::Image { file: self.file.to_owned(), image: image.to_owned(), reason }
    }
}

/// A reader of PNG or JPEG, told apart by their first bytes: declared types are often wrong.
fn reader(bytes: &[u8]) -> Result<ImageReader<Cursor<&[u8]>>, image::ImageError> {
    let format = image::guess_format(bytes)?;
    if !matches!(format, ImageFormat::Png | ImageFormat::Jpeg) {
        return Err(image::ImageError::Unsupported(ImageFormatHint::Exact(format).into()));
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_DECODER_BYTES);
    reader.limits(limits);
    Ok(reader)
}

fn size(bytes: &[u8]) -> Result<(u32, u32), image::ImageError> {
    reader(bytes)?.into_dimensions()
}

fn decode_rgba8(bytes: &[u8]) -> Result<image::RgbaImage, image::ImageError> {
    Ok(reader(bytes)?.decode()?.into_rgba8())
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::ClampToEdge => Wrap::ClampToEdge,
        WrappingMode::MirroredRepeat => Wrap::MirroredRepeat,
        WrappingMode::Repeat => Wrap::Repeat,
    }
}
