//! Triangles to voxels: the exact set of voxels that they touch, and the surface in each voxel.
//!
//! # Stages
//! 1. `split` cuts each triangle into work items, tiles of columns along the dominant axis of its
//!    normal. A prefix sum numbers them, and the counts become the sizes of indirect dispatches: no
//!    queue can overflow, and no thread walks a whole wall.
//! 2. `mark` walks the items and sets the bit of each voxel that its triangle touches, by
//!    separating axes (Schwarz and Seidel 2010). The pyramid of bits and its ranks are the list of
//!    voxels.
//! 3. `planes` walks the items twice. The piece of the triangle in each voxel belongs to the lobe
//!    of its normal's dominant axis and side, and to one of the lobe's up to four planes. The walks
//!    find these planes, and add up the area of each voxel's surface.
//! 4. `accumulate` walks once more and adds vector area, reflectance, emission and position to the
//!    integer sums of the piece's plane, and sets the bits of its cover (`cover`); `resolve` turns
//!    the sums into faces.
//! 5. `starts` moves each face's position into the face's visible part.
//!
//! # Parts
//! Static and dynamic draws ([`Draw::is_static`](crate::Draw)) are two shares of the surface, each
//! with its own voxels, planes and sums (`share.rs`). Neither share depends on the other, not even
//! the scale of its sums. So if only dynamic draws have changed, the static share is unchanged, and
//! only dynamic triangles are walked. `union.rs` unites both in one list in the same way whether a
//! share is new or kept: the result has the same bits as a voxelization of everything.
//!
//! Walking again costs less memory than storing the pieces, of which a fine mesh has millions.
//! Buffers of static surface are sized from counts that are read back, those of dynamic surface
//! have spare capacity. A voxelization takes a few frames; `settle.rs` waits for it.
//!
//! A caller's own [`Voxelization`] may walk otherwise than over items; everything else is shared.
//!
//! # Sums
//! All concurrent writes are bit sets or integer sums, so neither scheduling nor the order of the
//! triangles affects the result. Each voxel's sums have the largest scale that cannot overflow,
//! chosen from its surface, and terms are rounded at random (by a hash of triangle and voxel), so
//! that a million terms below the unit still add up.

pub(crate) mod batch;
mod frames;
mod hook;
pub(crate) mod input;
mod kernels;
#[cfg(test)]
mod layouts_test;
mod new_list;
mod scene;
mod settle;
mod share;
mod union;
mod walk;

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable};

use crate::GiError;
use crate::gpu::{Pipelines, ShaderLibrary};
use crate::voxels::FaceRecord;
pub use hook::{Detail, Voxelization, VoxelizationShares, Walk, WalkRun, WalkStep, Walker};
use kernels::Kernels;
pub(crate) use scene::{Collected, FrameVoxels, VoxelizedScene};
pub(crate) use settle::known;
pub(crate) use union::Moving;

/// Columns of voxels along the side of a work item's tile.
const TILE_EDGE: u32 = 4;

/// Defines the constants that Rust and the shaders of this stage share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("TILE_EDGE", TILE_EDGE)
        .constant_u32("FACE_WORDS", size_of::<FaceRecord>() as u32 / 4)
        .constant_u32("FACE_POSITION", offset_of!(FaceRecord, position_in_world) as u32 / 4)
        .constant_u32("FACE_VECTOR_AREA", offset_of!(FaceRecord, vector_area) as u32 / 4)
        .constant_u32("FACE_REFLECTANCE", offset_of!(FaceRecord, reflectance) as u32 / 4)
        .constant_u32("FACE_EMISSION", offset_of!(FaceRecord, emission) as u32 / 4)
        .constant_u32("FACE_GLOSS", offset_of!(FaceRecord, gloss) as u32 / 4)
        .constant_u32("FACE_CELL", offset_of!(FaceRecord, cell) as u32 / 4)
        .constant_u32("FACE_LOBE", offset_of!(FaceRecord, lobe) as u32 / 4)
        .constant_u32("FACE_FLAGS", offset_of!(FaceRecord, flags) as u32 / 4)
        .constant_u32("FACE_MASK_LOW", offset_of!(FaceRecord, mask_low) as u32 / 4)
        .constant_u32("FACE_MASK_HIGH", offset_of!(FaceRecord, mask_high) as u32 / 4)
        .constant_u32("FACE_PROFILES", offset_of!(FaceRecord, profiles) as u32 / 4)
        .constant_u32("OVERFLOW_VOXELS", union::OVERFLOW_VOXELS)
        .constant_u32("OVERFLOW_SUMS", union::OVERFLOW_SUMS)
        .constant_u32("OVERFLOW_NODES", union::OVERFLOW_NODES)
        .constant_u32("OVERFLOW_FACES", union::OVERFLOW_FACES)
        .constant_u32("DOUBLE_SIDED", input::DOUBLE_SIDED)
        .constant_u32("OPEN_BEHIND", input::OPEN_BEHIND)
        .constant_u32("ALPHA_IS_COVERAGE", input::ALPHA_IS_COVERAGE)
        .constant_u32("HAS_COLORS", input::HAS_COLORS)
        .constant_u32("HAS_FLOAT_COLORS", input::HAS_FLOAT_COLORS)
        .constant_u32("HAS_BYTE_COLORS", input::HAS_BYTE_COLORS)
        .constant_u32("HAS_SHORT_INDICES", input::HAS_SHORT_INDICES);
}

/// `VoxelFaces` of `faces.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct VoxelFaces {
    lobes: u32,
    area_low: u32,
    area_high: u32,
    first_face: u32,
    planes: [u32; 24],
}

/// Results of a voxelization.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VoxelizeStats {
    /// Triangles given.
    pub triangles: u64,
    /// Walked triangles: all, or only the dynamic ones if the static ones were reused.
    pub walked: u64,
    /// `true` if the results of an earlier voxelization were reused for the static triangles. All
    /// counts here include them.
    pub static_reused: bool,
    /// Triangles with no area or non-finite coordinates, which are left out.
    pub skipped: u64,
    /// Triangles that lie wholly outside the grid.
    pub outside: u64,
    /// Tiles that triangles are cut into; an exact walk has a thread for each.
    pub work_items: u64,
    /// Pieces of triangles in voxels, each counted as often as a walk finds it.
    pub fragments: u64,
    /// Occupied voxels.
    pub voxels: u32,
    /// Sides of voxels that have surface.
    pub faces: u32,
}

/// The kernels that turn triangles into voxels.
#[derive(Debug)]
pub(crate) struct Voxelizer {
    kernels: Kernels,
    /// The caller's own walker, which replaces the kernels' walks.
    walker: Option<Box<dyn Walker>>,
}

impl Voxelizer {
    /// Links the kernels of the exact walk, or makes the caller's own method.
    ///
    /// # Errors
    /// [`GiError::Shader`] if a shader does not link, which is a bug in this crate, and the errors
    /// of [`Voxelization::make`].
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        voxelization: Option<&dyn Voxelization>,
    ) -> Result<Self, GiError> {
        let kernels = Kernels::new(device, shaders, voxelization)?;
        let shares = VoxelizationShares { device, shaders, layouts: &kernels.layouts };
        let walker = voxelization.map(|own| own.make(&shares)).transpose()?;
        Ok(Self { kernels, walker })
    }

    /// The layouts of the bind groups that kernels over triangles share: the grid, the triangles,
    /// and a run of them with its textures.
    pub(crate) fn triangle_layouts(&self) -> [&wgpu::BindGroupLayout; 3] {
        let kernels::Layouts { grid, triangles, run, .. } = &self.kernels.layouts;
        [grid, triangles, run]
    }
}
