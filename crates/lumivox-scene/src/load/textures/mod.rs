//! The textures of a scene, from materials' references to texels.
//!
//! While materials are read, textures are only listed, with their images and recipes. Of the images
//! only the sizes are read. When all sizes are known, the loader decides how far the textures must
//! shrink to fit into the budget. Then they are decoded and shrunk, several at a time.

mod mix;

use std::collections::HashMap;
use std::path::Path;

use rayon::prelude::*;

use super::geometry::size_text;
use super::image::{self, Encoding, Fault, Header, Pixels, Source};
use super::{LoadOptions, Notes};
use crate::{Sampler, SceneError, Texture};

pub(super) use mix::Mix;

/// The most bytes of textures that are made at once; a single texture may take more.
const BYTES_UNDER_WAY: u64 = 512 << 20;
/// The most texels of all textures before they are shrunk: it would take minutes to decode more.
const MOST_TEXELS: u64 = 1 << 35;

/// The index of a listed image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct ImageId(usize);

/// The sources of a texture.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Recipe {
    /// An unchanged image.
    Image(ImageId),
    /// A new image out of several.
    Mixed {
        /// The one or two images that it is made of.
        images: Vec<ImageId>,
        /// The way to combine them.
        mix: Mix,
    },
    /// The stand-in for a missing image: a board of magenta and black.
    Missing,
}

impl Recipe {
    fn images(&self) -> &[ImageId] {
        match self {
            Self::Image(image) => std::slice::from_ref(image),
            Self::Mixed { images, .. } => images,
            Self::Missing => &[],
        }
    }
}

struct Image<'a> {
    /// The part of the scene's file, for messages.
    part: String,
    name: String,
    source: Source<'a>,
    header: Header,
}

/// A recipe, and its textures: the same texels with several samplers.
struct Product {
    recipe: Recipe,
    encoding: Encoding,
    width: u32,
    height: u32,
    /// The number of times that both edges are halved.
    halvings: u32,
    /// Indices of the textures.
    textures: Vec<usize>,
}

impl Product {
    fn texels(&self) -> u64 {
        let edge = |length| u64::from(image::halved(length, self.halvings));
        edge(self.width) * edge(self.height)
    }

    /// Bytes of all textures of the product.
    fn bytes(&self) -> u64 {
        self.texels() * 4 * self.textures.len() as u64
    }
}

/// The reason why textures were not made.
pub(super) enum NotMade {
    /// Images that cannot be decoded, each with the reason; the scene can be shown without them.
    Images(Vec<(ImageId, Fault)>),
    /// The scene cannot be loaded.
    Scene(SceneError),
}

impl From<SceneError> for NotMade {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

/// The textures of one scene.
#[derive(Default)]
pub(super) struct Textures<'a> {
    images: Vec<Image<'a>>,
    products: Vec<Product>,
    product_of: HashMap<Recipe, usize>,
    samplers: Vec<Sampler>,
    texture_of: HashMap<(usize, Sampler), usize>,
}

impl<'a> Textures<'a> {
    /// Lists an image, and reads its size. `part` is the part of the file that names it, for
    /// messages.
    pub(super) fn image(
        &mut self,
        part: &str,
        name: &str,
        source: Source<'a>,
    ) -> Result<ImageId, Fault> {
        let header = image::header(&source)?;
        let image = Image { part: part.to_owned(), name: name.to_owned(), source, header };
        self.images.push(image);
        Ok(ImageId(self.images.len() - 1))
    }

    /// The index that a texture will have in the scene. Equal recipes with equal samplers share one
    /// texture.
    pub(super) fn texture(
        &mut self,
        recipe: Recipe,
        encoding: Encoding,
        sampler: Sampler,
    ) -> usize {
        let product = self.product(recipe, encoding);
        let next = self.samplers.len();
        let texture = *self.texture_of.entry((product, sampler)).or_insert(next);
        if texture == next {
            self.samplers.push(sampler);
            self.products[product].textures.push(texture);
        }
        texture
    }

    fn product(&mut self, recipe: Recipe, encoding: Encoding) -> usize {
        if let Some(&known) = self.product_of.get(&recipe) {
            // An image that is a colour in one material and data in another is averaged as data.
            if encoding == Encoding::Data {
                self.products[known].encoding = Encoding::Data;
            }
            return known;
        }
        let headers = || recipe.images().iter().map(|image| self.images[image.0].header);
        let product = Product {
            encoding,
            width: headers().map(|header| header.width).max().unwrap_or(image::BOARD_EDGE),
            height: headers().map(|header| header.height).max().unwrap_or(image::BOARD_EDGE),
            halvings: 0,
            textures: Vec::new(),
            recipe: recipe.clone(),
        };
        self.products.push(product);
        self.product_of.insert(recipe, self.products.len() - 1);
        self.products.len() - 1
    }

    /// Makes all textures for the scene in `file`.
    pub(super) fn make(
        mut self,
        file: &Path,
        options: &mut LoadOptions<'_>,
        notes: &mut Notes,
    ) -> Result<Vec<Texture>, NotMade> {
        self.check_amount(file)?;
        self.fit(options.budget.texture_bytes, notes);
        let total = self.products.len() as u64;
        let mut made: Vec<Option<Texture>> = Vec::new();
        made.resize_with(self.samplers.len(), || None);
        let mut faults = Vec::new();
        let mut begin = 0;
        while begin < self.products.len() {
            options.tell("textures", begin as u64, total);
            let end = self.batch(begin);
            let batch = self.products[begin..end]
                .par_iter()
                .map(|product| self.product_pixels(product))
                .collect::<Vec<_>>();
            for (product, pixels) in self.products[begin..end].iter().zip(batch) {
                match pixels {
                    Ok(pixels) => self.place(product, pixels, &mut made),
                    Err(fault) => faults.push(fault),
                }
            }
            begin = end;
        }
        options.tell("textures", total, total);
        if !faults.is_empty() {
            return Err(NotMade::Images(faults));
        }
        Ok(made.into_iter().flatten().collect())
    }

    fn check_amount(&self, file: &Path) -> Result<(), SceneError> {
        let mut texels = 0_u64;
        for product in &self.products {
            for image in product.recipe.images() {
                let image = &self.images[image.0];
                texels += u64::from(image.header.width) * u64::from(image.header.height);
                if texels > MOST_TEXELS {
                    return Err(SceneError::Malformed {
                        file: file.to_owned(),
                        part: image.part.clone(),
                        reason: "with it the scene has too many texels, split it up".to_owned(),
                    });
                }
            }
        }
        Ok(())
    }

    /// Halves the largest texture repeatedly, until all of them together fit into `budget` bytes.
    fn fit(&mut self, budget: u64, notes: &mut Notes) {
        let all: u64 = self.products.iter().map(Product::bytes).sum();
        let mut bytes = all;
        // Ordered by size, then by their order in the scene, so that the result is deterministic.
        let mut queue: std::collections::BinaryHeap<_> =
            self.products.iter().enumerate().map(|(i, p)| (p.texels(), usize::MAX - i)).collect();
        while bytes > budget {
            let Some((texels, key)) = queue.pop() else { break };
            let product = &mut self.products[usize::MAX - key];
            let before = product.bytes();
            product.halvings += 1;
            bytes -= before - product.bytes();
            // A single texel cannot shrink.
            if product.texels() < texels {
                queue.push((product.texels(), key));
            }
        }
        let shrunk: usize =
            self.products.iter().filter(|p| p.halvings > 0).map(|p| p.textures.len()).sum();
        if shrunk > 0 {
            notes.warn(format!(
                "the textures need {} and the budget is {}: {shrunk} of {} were shrunk by halves, \
                 down to {} altogether; a larger budget keeps them",
                size_text(all),
                size_text(budget),
                self.samplers.len(),
                size_text(bytes)
            ));
        }
    }

    /// The end of the batch of products that begins at `begin`.
    fn batch(&self, begin: usize) -> usize {
        let most = rayon::current_num_threads() * 2;
        let mut bytes = 0;
        let mut end = begin;
        while end < self.products.len() && end - begin < most {
            let product = &self.products[end];
            let images = product.recipe.images().iter().map(|image| self.images[image.0].header);
            let decoded: u64 = images.map(|h| u64::from(h.width) * u64::from(h.height) * 4).sum();
            // Decoders hold the image in the file's format and the result at once.
            bytes += decoded * 2 + product.texels() * 4;
            if end > begin && bytes > BYTES_UNDER_WAY {
                break;
            }
            end += 1;
        }
        end
    }

    fn product_pixels(&self, product: &Product) -> Result<Pixels, (ImageId, Fault)> {
        let decode = |id: &ImageId| {
            let image = &self.images[id.0];
            image::decode(&image.source, image.header).map_err(|fault| (*id, fault))
        };
        let pixels = match &product.recipe {
            Recipe::Image(image) => decode(image)?,
            Recipe::Mixed { images, mix } => {
                let images = images.iter().map(decode).collect::<Result<Vec<_>, _>>()?;
                mix.mix(&images, product.width, product.height)
            }
            Recipe::Missing => image::board(),
        };
        Ok(image::shrink(pixels, product.halvings, product.encoding))
    }

    fn place(&self, product: &Product, pixels: Pixels, made: &mut [Option<Texture>]) {
        let names: Vec<&str> = product
            .recipe
            .images()
            .iter()
            .map(|image| self.images[image.0].name.as_str())
            .collect();
        let name = if names.is_empty() { "missing image".to_owned() } else { names.join(" + ") };
        let texture = |rgba8: Vec<u8>, index: usize| Texture {
            name: name.clone(),
            width: pixels.width,
            height: pixels.height,
            rgba8,
            sampler: self.samplers[index],
        };
        let Some((&last, others)) = product.textures.split_last() else { return };
        for &index in others {
            made[index] = Some(texture(pixels.rgba8.clone(), index));
        }
        made[last] = Some(texture(pixels.rgba8, last));
    }
}
