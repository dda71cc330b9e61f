//! What an engine hands to the voxelizer: its own vertex and index buffers, materials and textures.

use glam::{Mat4, Vec3, Vec4};

/// A material, as far as diffuse light in voxels is concerned.
#[derive(Clone, Debug)]
pub struct SurfaceMaterial {
    /// The share of light that the surface reflects, 0 to 1, linear RGB; multiplies the texture. The voxels
    /// reflect it diffusely, so for a metal it is the specular colour. `w` is the coverage (alpha).
    pub reflectance: Vec4,
    /// The radiance that the surface emits, in the unit of all radiance; multiplies the texture.
    pub emission: Vec3,
    /// Reflectance, RGBA, with mips, decoded to linear by its format (`Rgba8UnormSrgb`). If `alpha_is_coverage`
    /// is set, its alpha is the share of the texel that is there.
    pub reflectance_texture: Option<wgpu::TextureView>,
    /// Emission, RGB, with mips, decoded to linear by its format.
    pub emission_texture: Option<wgpu::TextureView>,
    /// How the textures are wrapped and filtered; needed if there is a texture.
    pub sampler: Option<wgpu::Sampler>,
    /// Alpha cuts holes: a surface's area in a voxel is scaled by it. With alpha-tested materials, upload
    /// alpha already thresholded (0 or 1), so that its mips hold the covered share.
    pub alpha_is_coverage: bool,
    /// Whether the surface is there seen from behind as well; else it is seen, lit and opaque from the front
    /// (counter-clockwise) side alone.
    pub double_sided: bool,
}

impl Default for SurfaceMaterial {
    /// A grey Lambert surface of 50 % reflectance.
    fn default() -> Self {
        Self {
            reflectance: Vec4::new(0.5, 0.5, 0.5, 1.0),
            emission: Vec3::ZERO,
            reflectance_texture: None,
            emission_texture: None,
            sampler: None,
            alpha_is_coverage: false,
            double_sided: false,
        }
    }
}

/// A run of triangles with one material and one transform.
#[derive(Clone, Copy, Debug)]
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
}

/// Triangles whose vertices share a set of buffers. All buffers need `BufferUsages::STORAGE`, and each must
/// fit into one storage binding (`Limits::max_storage_buffer_binding_size`): split larger ones into batches.
#[derive(Clone, Debug)]
pub struct GeometryBatch {
    /// Positions, three `f32` a vertex, tightly packed.
    pub positions: wgpu::Buffer,
    /// Texture coordinates, two `f32` a vertex; needed if a material has a texture.
    pub texcoords: Option<wgpu::Buffer>,
    /// Indices, `u32`, a triangle list; counter-clockwise seen from the front.
    pub indices: wgpu::Buffer,
    /// The runs of triangles.
    pub draws: Vec<Draw>,
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
