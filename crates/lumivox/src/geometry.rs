//! What an engine hands to the voxelizer: its own vertex and index buffers, materials and textures.

use glam::{Affine2, Mat4, Vec3, Vec4};

use crate::Gloss;

/// A material, as far as diffuse light in voxels is concerned.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMaterial {
    /// The share of the light that enters which the surface reflects, 0 to 1, linear RGB; multiplies the
    /// texture and the vertices' colours. The voxels reflect it diffusely, so for a metal it is the specular
    /// colour. `w` is the coverage (alpha).
    pub reflectance: Vec4,
    /// The light that a dielectric mirrors at its surface and does not let enter; none for paper, plaster, metals.
    pub gloss: Gloss,
    /// The radiance that the surface emits, in the unit of all radiance; multiplies the texture.
    pub emission: Vec3,
    /// The share of the light that enters the surface and passes straight through instead of being reflected,
    /// 0 (the default) to 1; multiplies the texture. A surface with it blocks `1 - transmission * luminance` of
    /// the light, with the luminance of its reflectance.
    pub transmission: f32,
    /// Reflectance, RGBA, with mips, decoded to linear by its format (`Rgba8UnormSrgb`). If `alpha_is_coverage`
    /// is set, its alpha is the share of the texel that is there.
    pub reflectance_texture: Option<SurfaceTexture>,
    /// Emission, RGB, with mips, decoded to linear by its format.
    pub emission_texture: Option<SurfaceTexture>,
    /// Transmission, in the red channel, with mips.
    pub transmission_texture: Option<SurfaceTexture>,
    /// Alpha is coverage: a surface's area in a voxel is scaled by it. With alpha-tested materials, upload
    /// alpha already thresholded (0 or 1), so that its mips hold the covered share.
    pub alpha_is_coverage: bool,
    /// Whether the surface is there seen from behind as well; else it is seen, lit and opaque from the front
    /// (counter-clockwise) side alone: cones pass it from behind. A back would stand in the same voxel as the
    /// front, and cones that start near it, on the floor below a wall, would meet it: with backs on all
    /// surfaces the indirect light of the Cornell box falls by 5 %, of the atrium by 25 % (64 voxels), and there
    /// are twice as many faces.
    pub double_sided: bool,
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
        }
    }
}

/// A texture of a material, and where on it a vertex lies.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceTexture {
    /// The image with all its mips.
    pub view: wgpu::TextureView,
    /// How it is wrapped and filtered.
    pub sampler: wgpu::Sampler,
    /// Which of the vertices' texture coordinates to use, 0 or 1; where vertices have no second set, the first.
    pub texcoord_set: u32,
    /// From the vertices' coordinates to the image's.
    pub transform: Affine2,
}

impl SurfaceTexture {
    /// A texture at the vertices' own first coordinates.
    pub fn new(view: wgpu::TextureView, sampler: wgpu::Sampler) -> Self {
        Self { view, sampler, texcoord_set: 0, transform: Affine2::IDENTITY }
    }
}

/// A run of triangles with one material and one transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// The first index in the batch's index buffer.
    pub first_index: u32,
    /// How many indices, a multiple of three.
    pub index_count: u32,
    /// Added to every index.
    pub base_vertex: u32,
    /// Index into [`Geometry::materials`].
    pub material: u32,
    /// Transform of positions into the world (affine; a mirroring one turns the front side over).
    pub world_from_local: Mat4,
    /// Its triangles stay as they are while others move: the voxelizer may keep what it found of them
    /// ([`Gi::voxelize_dynamic`](crate::Gi::voxelize_dynamic)). Where all draws are alike in this, the mark costs
    /// nothing and gains nothing.
    pub is_static: bool,
}

/// Triangles whose vertices share a set of buffers. All buffers need `BufferUsages::STORAGE`, and each must
/// fit into one storage binding (`Limits::max_storage_buffer_binding_size`): split larger ones into batches.
#[derive(Clone, Debug)]
pub struct GeometryBatch {
    /// Positions, three `f32` a vertex, tightly packed.
    pub positions: wgpu::Buffer,
    /// Texture coordinates and colours; needed if a material has a texture.
    pub attributes: Option<VertexAttributes>,
    /// Indices, `u32`, a triangle list; counter-clockwise seen from the front.
    pub indices: wgpu::Buffer,
    /// The runs of triangles.
    pub draws: Vec<Draw>,
}

impl GeometryBatch {
    /// Whether all but the draws is the same.
    pub(crate) fn is_same_but_draws(&self, other: &Self) -> bool {
        self.positions == other.positions
            && self.attributes == other.attributes
            && self.indices == other.indices
    }
}

/// Where in a buffer the texture coordinates and colours of vertices stand: the caller's own layout, as long as
/// numbers stand at multiples of four bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexAttributes {
    /// The buffer, with `BufferUsages::STORAGE`.
    pub buffer: wgpu::Buffer,
    /// Bytes from a vertex to the next, a multiple of four.
    pub stride: u32,
    /// Bytes from the start of a vertex to its texture coordinates, two `f32` a set. Where there is no second
    /// set, the first is used for it.
    pub texcoords: [Option<u32>; 2],
    /// Bytes from the start of a vertex to its colour, four 16-bit numbers of which 65 535 stands for one
    /// (`VertexFormat::Unorm16x4`): linear RGB and alpha that multiply the reflectance.
    pub color: Option<u32>,
}

impl VertexAttributes {
    /// A buffer of nothing but texture coordinates, two `f32` a vertex, tightly packed.
    pub fn texcoords(buffer: wgpu::Buffer) -> Self {
        Self { buffer, stride: 8, texcoords: [Some(0), None], color: None }
    }
}

/// All the triangles of a scene.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Triangles by the buffers that hold them.
    pub batches: Vec<GeometryBatch>,
    /// Materials that the draws refer to.
    pub materials: Vec<SurfaceMaterial>,
}

impl Geometry {
    /// Triangles of all draws.
    pub fn triangle_count(&self) -> u64 {
        let draws = self.batches.iter().flat_map(|batch| &batch.draws);
        draws.map(|draw| u64::from(draw.index_count / 3)).sum()
    }
}
