//! The images of MTL files as textures, some made of two images or of heights.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use glam::Vec3;
use image::{Rgba, RgbaImage, imageops};

use super::map::{Channel, Map};
use crate::load::files::{Reach, shorten};
use crate::load::image::{Encoding, Pixels};
use crate::load::{self, Notes, color};
use crate::{Scene, Texture};

/// The height of white above black in a bump map with `-bm` 1, as a share of the image's width. MTL
/// has no unit of heights; this gives tiles of a metre joints of one centimetre.
const BUMP_DEPTH: f32 = 0.01;
/// The largest share of texels that are neither clear nor solid (edges) in a cutout.
const MOST_EDGE_TEXELS: f32 = 0.1;

/// The sources of a texture.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Source {
    /// A colour; alpha is 1, whatever the file has.
    Color(PathBuf),
    /// A colour, or white, with the opacity of another image.
    Cutout { color: Option<PathBuf>, opacity: PathBuf, channel: Channel },
    /// Normals, or heights with a strength (the bits of a float).
    Bump { file: PathBuf, bump_bits: u32, heights: Option<bool> },
    /// Roughness in green, metal in blue.
    RoughMetal { rough: Option<PathBuf>, metal: Option<PathBuf>, channels: (Channel, Channel) },
}

impl Source {
    fn encoding(&self) -> Encoding {
        match self {
            Self::Color(_) | Self::Cutout { .. } => Encoding::Color,
            Self::Bump { .. } | Self::RoughMetal { .. } => Encoding::Data,
        }
    }
}

/// The properties of a finished texture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Made {
    pub(super) texture: usize,
    /// The largest linear value of each channel.
    pub(super) brightest: Vec3,
    /// `true` if alpha is 0 or 1 nearly everywhere.
    pub(super) cuts_out: bool,
    /// `true` if the file's alpha was ignored.
    pub(super) unused_alpha: bool,
    /// `true` if heights were converted to normals.
    pub(super) from_heights: bool,
}

/// Makes each texture once, within a budget.
pub(super) struct Textures<'a> {
    reach: Reach<'a>,
    budget_bytes: u64,
    used_bytes: u64,
    /// The number of times that all textures were halved.
    halvings: u32,
    made: HashMap<(Source, bool), Made>,
    /// The encodings of the scene's textures.
    encodings: Vec<Encoding>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(budget_bytes: u64, reach: Reach<'a>) -> Self {
        Self {
            reach,
            budget_bytes,
            used_bytes: 0,
            halvings: 0,
            made: HashMap::new(),
            encodings: Vec::new(),
        }
    }

    /// The texture of a source; the error is the reason and a remedy.
    pub(super) fn get(
        &mut self,
        source: Source,
        map: &Map,
        scene: &mut Scene,
    ) -> Result<Made, String> {
        let key = (source, map.clamp);
        if let Some(&known) = self.made.get(&key) {
            return Ok(known);
        }
        let (name, image, mut made) = make(&key.0, self.reach)?;
        let mut texture = Texture {
            name,
            width: image.width(),
            height: image.height(),
            rgba8: image.into_raw(),
            sampler: crate::Sampler::default(),
        };
        map.set_sampler(&mut texture);
        made.texture = self.push(texture, key.0.encoding(), scene);
        self.made.insert(key, made);
        Ok(made)
    }

    /// Adds a stand-in for a missing texture.
    pub(super) fn stand_in(&mut self, name: &str, scene: &mut Scene) -> usize {
        self.push(load::image::checker(name), Encoding::Color, scene)
    }

    /// Adds a texture, and halves all as often as the budget requires.
    fn push(&mut self, mut texture: Texture, encoding: Encoding, scene: &mut Scene) -> usize {
        (0..self.halvings).for_each(|_| halve(&mut texture, encoding));
        self.used_bytes += texture.rgba8.len() as u64;
        scene.textures.push(texture);
        self.encodings.push(encoding);
        // Textures of one texel cannot shrink.
        while self.used_bytes > self.budget_bytes
            && scene.textures.iter().any(|texture| texture.width > 1 || texture.height > 1)
        {
            self.halvings += 1;
            for (texture, &encoding) in scene.textures.iter_mut().zip(&self.encodings) {
                halve(texture, encoding);
            }
            self.used_bytes = scene.textures.iter().map(|t| t.rgba8.len() as u64).sum();
        }
        scene.textures.len() - 1
    }

    pub(super) fn warn(&self, notes: &mut Notes) {
        if self.halvings > 0 {
            notes.warn(format!(
                "textures were shrunk to 1/{} of their width and height to fit into {} MiB; raise \
                 the budget for textures to keep them",
                1_u64 << self.halvings.min(63),
                self.budget_bytes >> 20
            ));
        }
    }
}

/// Halves the width and height.
fn halve(texture: &mut Texture, encoding: Encoding) {
    let rgba8 = std::mem::take(&mut texture.rgba8);
    let pixels = Pixels { width: texture.width, height: texture.height, rgba8 };
    let Pixels { width, height, rgba8 } = load::image::shrink(pixels, 1, encoding);
    (texture.width, texture.height, texture.rgba8) = (width, height, rgba8);
}

fn make(source: &Source, reach: Reach<'_>) -> Result<(String, RgbaImage, Made), String> {
    let mut made = Made {
        texture: 0,
        brightest: Vec3::ONE,
        cuts_out: false,
        unused_alpha: false,
        from_heights: false,
    };
    let (named, image) = match source {
        Source::Color(file) => {
            let mut image = decode(file, reach)?;
            for texel in image.pixels_mut() {
                made.unused_alpha |= texel[3] != 255;
                texel[3] = 255;
            }
            (file, image)
        }
        Source::Cutout { color, opacity, channel } => {
            let mut alpha = decode(opacity, reach)?;
            let channel = match channel {
                Channel::Unsaid if alpha.pixels().any(|texel| texel[3] != 255) => Channel::Alpha,
                channel => *channel,
            };
            let image = match color {
                Some(color) => {
                    let mut image = decode(color, reach)?;
                    fit(&mut image, &mut alpha);
                    image
                }
                None => RgbaImage::from_pixel(alpha.width(), alpha.height(), Rgba([255; 4])),
            };
            let mut image = image;
            let mut edges = 0_u64;
            for (texel, alpha) in image.pixels_mut().zip(alpha.pixels()) {
                texel[3] = pick(*alpha, channel);
                edges += u64::from((16..240).contains(&texel[3]));
            }
            let texels = u64::from(image.width()) * u64::from(image.height());
            made.cuts_out = edges as f32 <= texels as f32 * MOST_EDGE_TEXELS;
            (opacity, image)
        }
        Source::Bump { file, bump_bits, heights } => {
            let image = decode(file, reach)?;
            made.from_heights = heights.unwrap_or_else(|| !holds_normals(&image));
            if made.from_heights {
                (file, normals_from_heights(&image, f32::from_bits(*bump_bits)))
            } else {
                (file, image)
            }
        }
        Source::RoughMetal { rough, metal, channels } => {
            let mut images =
                [rough, metal].map(|file| file.as_deref().map(|file| decode(file, reach)));
            if let [Some(Ok(rough)), Some(Ok(metal))] = &mut images {
                fit(rough, metal);
            }
            let [rough_image, metal_image] = images;
            let (rough_image, metal_image) = (rough_image.transpose()?, metal_image.transpose()?);
            let Some(file) = rough.as_ref().or(metal.as_ref()) else {
                return Err("there is no image".to_owned());
            };
            let size = rough_image.as_ref().or(metal_image.as_ref());
            let (width, height) = size.map_or((1, 1), RgbaImage::dimensions);
            // Without an image, the channel is 1, so that the material's number counts.
            let value = |image: &Option<RgbaImage>, x, y, channel| {
                image.as_ref().map_or(255, |image| pick(*image.get_pixel(x, y), channel))
            };
            let image = RgbaImage::from_fn(width, height, |x, y| {
                let rough = value(&rough_image, x, y, channels.0);
                let metal = value(&metal_image, x, y, channels.1);
                Rgba([255, rough, metal, 255])
            });
            (file, image)
        }
    };
    if let Source::Color(_) | Source::Cutout { .. } = source {
        let mut most = [0; 3];
        for texel in image.pixels() {
            for (most, value) in most.iter_mut().zip(texel.0) {
                *most = value.max(*most);
            }
        }
        made.brightest =
            Vec3::from_array(most.map(|value| color::linear_from_srgb(f32::from(value) / 255.0)));
    }
    let name = named.file_name().unwrap_or_default().to_string_lossy();
    Ok((shorten(&name), image, made))
}

fn decode(file: &Path, reach: Reach<'_>) -> Result<RgbaImage, String> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let name = shorten(&name);
    let bytes = reach.read(file).map_err(|error| format!("{name} cannot be read: {error}"))?;
    let pixels = load::image::decode_file(&bytes, file)
        .map_err(|fault| format!("{name} cannot be decoded: {fault}"))?;
    let image = RgbaImage::from_raw(pixels.width, pixels.height, pixels.rgba8);
    image.ok_or_else(|| format!("{name} has too few texels for its size"))
}

/// Enlarges the smaller image to the size of the larger.
fn fit(a: &mut RgbaImage, b: &mut RgbaImage) {
    let (width, height) = (a.width().max(b.width()), a.height().max(b.height()));
    for image in [a, b] {
        if image.dimensions() != (width, height) {
            *image = imageops::resize(image, width, height, imageops::FilterType::Triangle);
        }
    }
}

fn pick(texel: Rgba<u8>, channel: Channel) -> u8 {
    match channel {
        Channel::Red => texel[0],
        Channel::Green => texel[1],
        Channel::Blue => texel[2],
        Channel::Alpha => texel[3],
        Channel::Unsaid | Channel::Luminance => luminance(texel),
    }
}

/// The luma (ITU-R BT.709).
fn luminance(texel: Rgba<u8>) -> u8 {
    let rgb = Vec3::new(f32::from(texel[0]), f32::from(texel[1]), f32::from(texel[2]));
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722)).round() as u8
}

/// Whether a bump image holds normals, as many exporters write: it is not grey, and most texels are
/// unit vectors out of the surface.
fn holds_normals(image: &RgbaImage) -> bool {
    let texels = u64::from(image.width()) * u64::from(image.height());
    let fitting = image.pixels().filter(|texel| {
        let vector = Vec3::new(f32::from(texel[0]), f32::from(texel[1]), f32::from(texel[2]));
        let vector = vector / 127.5 - 1.0;
        vector.z > 0.0 && (vector.length() - 1.0).abs() < 0.15
    });
    let grey = image.pixels().all(|texel| texel[0] == texel[1] && texel[1] == texel[2]);
    !grey && fitting.count() as u64 * 2 > texels
}

/// Converts heights to tangent-space normals, by Sobel's differences (weights 1 2 1 across, a sum
/// of eight); the image repeats.
fn normals_from_heights(heights: &RgbaImage, bump: f32) -> RgbaImage {
    let (width, height) = heights.dimensions();
    // Computes each texel's height only once.
    let values: Vec<f32> =
        heights.pixels().map(|texel| f32::from(luminance(*texel)) / 255.0).collect();
    let at = |x: u32, y: u32| values[y as usize * width as usize + x as usize];
    // Converts differences of values to slopes in texels.
    let texels = BUMP_DEPTH * bump * width as f32 / 8.0;
    RgbaImage::from_fn(width, height, |x, y| {
        let (left, right) = ((x + width - 1) % width, (x + 1) % width);
        let (above, below) = ((y + height - 1) % height, (y + 1) % height);
        let column = |x: u32| at(x, above) + 2.0 * at(x, y) + at(x, below);
        let row = |y: u32| at(left, y) + 2.0 * at(x, y) + at(right, y);
        // The image's y points down, the normal's up.
        let slope_x = (column(right) - column(left)) * texels;
        let slope_y = (row(above) - row(below)) * texels;
        let normal = Vec3::new(-slope_x, -slope_y, 1.0).normalize_or(Vec3::Z);
        let [x, y, z] = (normal * 127.5 + 127.5).round().to_array().map(|v| v as u8);
        Rgba([x, y, z, 255])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal(texel: Rgba<u8>) -> Vec3 {
        Vec3::new(f32::from(texel[0]), f32::from(texel[1]), f32::from(texel[2])) / 127.5 - 1.0
    }

    #[test]
    fn a_height_ramp_becomes_normals_of_its_slope() {
        // Ten levels per texel to the right; the first and last columns wrap.
        let width = 20;
        let ramp = RgbaImage::from_fn(width, 8, |x, _| {
            let level = 20 + x as u8 * 10;
            Rgba([level, level, level, 255])
        });
        let normals = normals_from_heights(&ramp, 3.0);
        let slope = 10.0 / 255.0 * BUMP_DEPTH * 3.0 * width as f32;
        let expected = Vec3::new(-slope, 0.0, 1.0).normalize();
        for y in 0..8 {
            for x in 1..width - 1 {
                let n = normal(*normals.get_pixel(x, y));
                assert!((n - expected).length() < 0.012, "{n} {expected}");
            }
        }
        // Upper rows of the image are brighter: the surface falls towards -y, so n.y < 0.
        let up = RgbaImage::from_fn(8, 20, |_, y| {
            let level = 220 - y as u8 * 10;
            Rgba([level, level, level, 255])
        });
        assert!(normal(*normals_from_heights(&up, 30.0).get_pixel(4, 10)).y < -0.05);
    }

    #[test]
    fn bump_maps_are_distinguished_from_normal_maps() {
        let flat = RgbaImage::from_pixel(4, 4, Rgba([128, 128, 255, 255]));
        assert!(holds_normals(&flat));
        let grey = RgbaImage::from_fn(4, 4, |x, _| Rgba([x as u8 * 50; 4]));
        assert!(!holds_normals(&grey));
        let wood = RgbaImage::from_pixel(4, 4, Rgba([150, 100, 60, 255]));
        assert!(!holds_normals(&wood));
    }

    #[test]
    fn textures_shrink_alike_until_they_fit() {
        let mut scene = Scene::default();
        let reach = Reach { anywhere: false, folders: &[], source: None };
        let mut textures = Textures::new(64 * 64 * 4, reach);
        let texture = |edge: u32| Texture {
            name: "t".to_owned(),
            width: edge,
            height: edge,
            rgba8: vec![9; (edge * edge * 4) as usize],
            sampler: crate::Sampler::default(),
        };
        for edge in [64, 64, 16] {
            textures.push(texture(edge), Encoding::Color, &mut scene);
        }
        let widths: Vec<_> = scene.textures.iter().map(|t| t.width).collect();
        assert_eq!(widths, [32, 32, 8]);
        assert!(scene.textures.iter().all(|t| t.rgba8.iter().all(|&b| b == 9)));
        let mut notes = Notes::default();
        textures.warn(&mut notes);
        assert!(notes.warnings[0].contains("1/2 "), "{:?}", notes.warnings);
    }
}
