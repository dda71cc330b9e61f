//! Images and their sampling.

use glam::Affine2;

/// Refers to one of [`Scene::textures`](super::Scene::textures), with its mapping to vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::textures`](super::Scene::textures).
    pub texture: usize,
    /// The set of a mesh's texture coordinates: 0 is [`Mesh::uvs`](super::Mesh::uvs), 1 is
    /// [`Mesh::uvs1`](super::Mesh::uvs1) (or `uvs` if a mesh has no second set). Default: 0.
    pub uv_set: u32,
    /// Transform from the mesh's coordinates to the image's (`KHR_texture_transform`). Default:
    /// none.
    pub transform: Affine2,
}

impl TextureRef {
    /// A texture at a mesh's own first coordinates.
    #[must_use]
    pub fn new(texture: usize) -> Self {
        Self { texture, uv_set: 0, transform: Affine2::IDENTITY }
    }
}

/// An image of 8 bits a channel. The material's use decides whether the values are sRGB-encoded
/// (colours) or linear (data, such as normals), as in glTF.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// A name for lists and messages.
    pub name: String,
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// Red, green, blue, alpha of each texel, row by row from the top; `4 * width * height` bytes.
    pub rgba8: Vec<u8>,
    /// The sampling of the image.
    pub sampler: Sampler,
}

/// The sampling of an image. Default: repeating, linear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// The texels to the left and right of the image.
    pub wrap_u: Wrap,
    /// The texels above and below the image.
    pub wrap_v: Wrap,
    /// The filter where a texel covers several pixels.
    pub magnify: Filter,
    /// The filter where a pixel covers several texels; renderers add mip levels as they see fit.
    pub minify: Filter,
}

/// The texels outside of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image again, mirrored every second time.
    MirroredRepeat,
    /// The texel at the edge.
    ClampToEdge,
}

/// The interpolation between texel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// A blend of the four nearest texels.
    #[default]
    Linear,
}
