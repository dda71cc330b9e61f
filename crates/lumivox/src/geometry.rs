//! The voxelizer's input: an engine's own vertex and index buffers, materials and textures.

use std::ops::{Deref, DerefMut};

use glam::{Affine2, Mat3, Mat4, Vec3, Vec4};

use crate::{Gloss, version};

/// The part of a material that affects diffuse light in voxels.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMaterial {
    /// The share of entering light that the surface reflects, 0 to 1, linear RGB; multiplied by the
    /// texture and the vertices' colours. The voxels reflect it diffusely, so use the specular
    /// colour for a metal. `w` is the coverage (alpha).
    pub reflectance: Vec4,
    /// The light that a dielectric mirrors at its surface instead of letting it enter;
    /// `Gloss::NONE` for paper, plaster and metals.
    pub gloss: Gloss,
    /// The radiance that the surface emits, in the unit of all radiance; multiplied by the texture.
    pub emission: Vec3,
    /// The share of light at normal incidence that passes straight through instead of being
    /// reflected, 0 (the default) to 1; multiplied by the texture. It falls towards grazing angles.
    /// A transmissive surface blocks `1 - transmission * luminance` of the light, with the
    /// luminance of its reflectance.
    pub transmission: f32,
    /// Reflectance, RGBA, with mips, decoded to linear by its format (`Rgba8UnormSrgb`). If
    /// `alpha_is_coverage` is set, its alpha is the covered share of the texel.
    pub reflectance_texture: Option<SurfaceTexture>,
    /// Emission, RGB, with mips, decoded to linear by its format.
    pub emission_texture: Option<SurfaceTexture>,
    /// Transmission, in the red channel, with mips.
    pub transmission_texture: Option<SurfaceTexture>,
    /// `true` if alpha is coverage, which scales a surface's area in a voxel. With alpha-tested
    /// materials, upload alpha already thresholded (0 or 1), so that its mips contain the covered
    /// share.
    pub alpha_is_coverage: bool,
    /// `true` if the surface is also visible from behind; otherwise it is visible and lit only from
    /// the front (counter-clockwise). From behind it is black and blocks light, except light that
    /// passes by coverage, transmission or `open_behind`.
    pub double_sided: bool,
    /// `true` if light from behind passes through a single-sided surface, as for stages with an
    /// open side. Default: `false`.
    pub open_behind: bool,
}

impl Default for SurfaceMaterial {
    /// A grey Lambert surface of 50 % reflectance.
    fn default() -> Self {
        Self {
            reflectance: Vec4::new(0.5, 0.5, 0.5, 1.0),
            gloss: Gloss::NONE,
            emission: Vec3::ZERO,
            transmission: 0.0,
            reflectance_texture: None,
            emission_texture: None,
            transmission_texture: None,
            alpha_is_coverage: false,
            double_sided: false,
            open_behind: false,
        }
    }
}

/// A texture of a material, and how vertices map to it.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceTexture {
    /// The image with all its mips.
    pub view: wgpu::TextureView,
    /// The sampler, for wrapping and filtering.
    pub sampler: wgpu::Sampler,
    /// The vertices' set of texture coordinates, 0 or 1; the first if vertices have no second set.
    pub texcoord_set: u32,
    /// Transform from the vertices' coordinates to the image's.
    pub transform: Affine2,
}

impl SurfaceTexture {
    /// A texture at the vertices' first coordinates, untransformed.
    pub fn new(view: wgpu::TextureView, sampler: wgpu::Sampler) -> Self {
        Self { view, sampler, texcoord_set: 0, transform: Affine2::IDENTITY }
    }
}

/// A run of triangles with one material and one transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// The first index, counted from the batch's first one ([`Indices::offset`]).
    pub first_index: u32,
    /// Number of indices, a multiple of three; 0 skips the draw, and `first_index` is then ignored.
    pub index_count: u32,
    /// Added to every index.
    pub base_vertex: u32,
    /// Index into [`GeometryParts::materials`].
    pub material: u32,
    /// Transform of positions into the world (affine; a mirroring one flips the front side).
    pub world_from_local: Mat4,
    /// `true` if its triangles do not change while others move: the voxelizer may reuse its results
    /// for them ([`Gi::voxelize_dynamic`](crate::Gi::voxelize_dynamic)). It has no effect if all
    /// draws have the same value.
    pub is_static: bool,
    /// The opposite corners of a box around its positions, before the transform; `None` (the
    /// default) if unknown. With cascades, triangles are skipped if their box lies outside of the
    /// voxelized boxes, and when static draws are added or removed, only the contents of their
    /// boxes are voxelized again.
    pub bounds: Option<[Vec3; 2]>,
}

impl Draw {
    /// A run of triangles; all other fields are zero, the identity, or not set.
    pub fn new(first_index: u32, index_count: u32, material: u32) -> Self {
        Self {
            first_index,
            index_count,
            base_vertex: 0,
            material,
            world_from_local: Mat4::IDENTITY,
            is_static: false,
            bounds: None,
        }
    }

    /// The draw's bits, to find equal draws.
    pub(crate) fn bits(&self) -> [u32; 28] {
        let bounds =
            self.bounds.map(|bounds| bounds.map(|corner| corner.to_array().map(f32::to_bits)));
        let [low, high] = bounds.unwrap_or_default();
        let numbers = [self.first_index, self.index_count, self.base_vertex, self.material];
        let marks = [u32::from(self.is_static), u32::from(bounds.is_some())];
        let places = self.world_from_local.to_cols_array().map(f32::to_bits);
        let all = numbers.into_iter().chain(marks).chain(places).chain(low).chain(high);
        let mut bits = [0; 28];
        bits.iter_mut().zip(all).for_each(|(bit, value)| *bit = value);
        bits
    }

    /// The opposite corners of a box around the draw in the world, m; `None` if unknown.
    pub(crate) fn bounds_in_world(&self) -> Option<[Vec3; 2]> {
        let [low, high] = self.bounds?;
        let linear = Mat3::from_mat4(self.world_from_local).to_cols_array();
        let middle = self.world_from_local.transform_point3(0.5 * (low + high));
        let reach = Mat3::from_cols_array(&linear.map(f32::abs)) * (0.5 * (high - low));
        Some([middle - reach, middle + reach])
    }
}

/// Triangles whose vertices share a set of buffers. All buffers need `BufferUsages::STORAGE`, and
/// each must fit into one storage binding (`Limits::max_storage_buffer_binding_size`): split larger
/// ones into batches. One buffer may have several uses, as for interleaved vertices and slabs of
/// meshes.
///
/// ```
/// # pollster::block_on(async {
/// # let (device, queue) = lumivox::gpu::open_device().await?;
/// # use glam::Vec3;
/// # use lumivox::gpu::{Timing, upload};
/// # use lumivox::{Geometry, Gi, GiConfig, Grid, SurfaceMaterial, wgpu};
/// # let mut slab = vec![0.0_f32; 1024 + 3 * 8];
/// # for (corner, place) in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]].into_iter().enumerate() {
/// #     slab[1024 + 8 * corner] = place[0];
/// #     slab[1024 + 8 * corner + 2] = place[1];
/// # }
/// # let vertices = upload(&device, "vertices", &slab);
/// # let mut numbers = vec![0_u16; 256 + 4];
/// # numbers[256..259].copy_from_slice(&[0, 1, 2]);
/// # let indices = upload(&device, "indices", &numbers);
/// # let (vertices, indices) = ((*vertices).clone(), (*indices).clone());
/// use lumivox::{Draw, GeometryBatch, Indices, VertexAttributes, VertexPositions};
///
/// // A mesh in a slab: position, normal and texture coordinates a vertex, 16-bit indices.
/// let mut attributes = VertexAttributes::new(vertices.clone(), 32);
/// attributes.offset = 4096;
/// attributes.texcoords[0] = Some(24);
/// let positions = VertexPositions { buffer: vertices, stride: 32, offset: 4096 };
/// let format = wgpu::IndexFormat::Uint16;
/// let indices = Indices { buffer: indices, format, offset: 512 };
/// let mut batch = GeometryBatch::new(positions, indices, vec![Draw::new(0, 3, 0)]);
/// batch.attributes = Some(attributes);
///
/// let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
/// let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
/// let materials = vec![SurfaceMaterial::default()];
/// let geometry = Geometry::new(vec![batch], materials);
/// assert!(gi.voxelize(&geometry, Timing::Off).await?.stats.voxels > 0);
/// # Ok::<(), lumivox::GiError>(())
/// # }).unwrap();
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct GeometryBatch {
    /// Positions, three `f32` a vertex.
    pub positions: VertexPositions,
    /// Texture coordinates and colours; required if a material has a texture. Default: none.
    pub attributes: Option<VertexAttributes>,
    /// Indices, a triangle list; counter-clockwise seen from the front.
    pub indices: Indices,
    /// The runs of triangles.
    pub draws: Vec<Draw>,
}

impl GeometryBatch {
    /// Triangles without texture coordinates and colours. A plain `wgpu::Buffer` converts to
    /// tightly packed positions and to 32-bit indices.
    pub fn new(
        positions: impl Into<VertexPositions>,
        indices: impl Into<Indices>,
        draws: Vec<Draw>,
    ) -> Self {
        let (positions, indices) = (positions.into(), indices.into());
        Self { positions, attributes: None, indices, draws }
    }

    /// `true` if everything except the draws is equal.
    pub(crate) fn is_same_but_draws(&self, other: &Self) -> bool {
        self.positions == other.positions
            && self.attributes == other.attributes
            && self.indices == other.indices
    }
}

/// The place of vertex positions in a buffer.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexPositions {
    /// The buffer, with `BufferUsages::STORAGE`.
    pub buffer: wgpu::Buffer,
    /// Bytes from one position to the next, a multiple of four and at least 12.
    pub stride: u32,
    /// Bytes from the start of the buffer to the position of vertex 0, a multiple of four.
    pub offset: u64,
}

impl From<wgpu::Buffer> for VertexPositions {
    /// Tightly packed, from the start of the buffer.
    fn from(buffer: wgpu::Buffer) -> Self {
        Self { buffer, stride: 12, offset: 0 }
    }
}

/// The place of indices in a buffer, tightly packed.
#[derive(Clone, Debug, PartialEq)]
pub struct Indices {
    /// The buffer, with `BufferUsages::STORAGE`.
    pub buffer: wgpu::Buffer,
    /// 16 or 32 bits.
    pub format: wgpu::IndexFormat,
    /// Bytes from the start of the buffer to index 0, a multiple of an index's size.
    pub offset: u64,
}

impl From<wgpu::Buffer> for Indices {
    /// 32 bits, from the start of the buffer.
    fn from(buffer: wgpu::Buffer) -> Self {
        Self { buffer, format: wgpu::IndexFormat::Uint32, offset: 0 }
    }
}

/// The place of the texture coordinates and colours of vertices in a buffer, in any layout in which
/// numbers are aligned to four bytes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct VertexAttributes {
    /// The buffer, with `BufferUsages::STORAGE`.
    pub buffer: wgpu::Buffer,
    /// Bytes from one vertex to the next, a multiple of four.
    pub stride: u32,
    /// Bytes from the start of the buffer to vertex 0, a multiple of four; default 0.
    pub offset: u64,
    /// Bytes from the start of a vertex to its texture coordinates, two `f32` a set. If there is no
    /// second set, the first is used instead. Default: none.
    pub texcoords: [Option<u32>; 2],
    /// Bytes from the start of a vertex to its colour: linear RGB and alpha, multiplied with the
    /// reflectance. Default: none.
    pub color: Option<u32>,
    /// How the colour is stored: `Unorm16x4` (the default), `Unorm8x4` or `Float32x4`.
    pub color_format: wgpu::VertexFormat,
}

impl VertexAttributes {
    /// Vertices of `stride` bytes, without any attributes yet.
    pub fn new(buffer: wgpu::Buffer, stride: u32) -> Self {
        let color_format = wgpu::VertexFormat::Unorm16x4;
        Self { buffer, stride, offset: 0, texcoords: [None; 2], color: None, color_format }
    }

    /// A buffer with only texture coordinates, two `f32` a vertex, tightly packed.
    pub fn texcoords(buffer: wgpu::Buffer) -> Self {
        Self { texcoords: [Some(0), None], ..Self::new(buffer, 8) }
    }
}

/// All the triangles of a scene. It derefs to its [`GeometryParts`]; every mutable access to them
/// counts as a change.
///
/// ```
/// # use lumivox::{Geometry, SurfaceMaterial};
/// let mut geometry = Geometry::default();
/// geometry.materials.push(SurfaceMaterial::default());
/// assert_eq!(geometry.triangle_count(), 0);
/// ```
#[derive(Clone, Debug)]
pub struct Geometry {
    parts: GeometryParts,
    version: u64,
}

/// The triangles and materials of a [`Geometry`].
#[derive(Clone, Debug, Default)]
pub struct GeometryParts {
    /// Triangles, by buffers.
    pub batches: Vec<GeometryBatch>,
    /// Materials that the draws refer to.
    pub materials: Vec<SurfaceMaterial>,
}

impl Default for Geometry {
    /// No triangles.
    fn default() -> Self {
        Self::new(Vec::new(), Vec::new())
    }
}

impl Deref for Geometry {
    type Target = GeometryParts;

    fn deref(&self) -> &GeometryParts {
        &self.parts
    }
}

impl DerefMut for Geometry {
    fn deref_mut(&mut self) -> &mut GeometryParts {
        self.invalidate();
        &mut self.parts
    }
}

impl Geometry {
    /// Triangles by buffers, and the materials that their draws refer to.
    pub fn new(batches: Vec<GeometryBatch>, materials: Vec<SurfaceMaterial>) -> Self {
        Self { parts: GeometryParts { batches, materials }, version: version::next() }
    }

    /// Call when the contents of the buffers of dynamic draws have changed, such as the vertices of
    /// a skinned mesh.
    pub fn invalidate(&mut self) {
        self.version = version::next();
    }

    /// A number that changes whenever the triangles or materials do.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Triangles of all draws.
    pub fn triangle_count(&self) -> u64 {
        let draws = self.batches.iter().flat_map(|batch| &batch.draws);
        draws.map(|draw| u64::from(draw.index_count / 3)).sum()
    }
}
