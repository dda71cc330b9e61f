//! The voxel grid: its place in the world, and its levels.

use bytemuck::{Pod, Zeroable};
use glam::{IVec3, UVec3, Vec3};

use crate::GiError;
use crate::cascades::{Cascades, MAX_CASCADES, Walked};
use crate::gpu::{Buffer, uniform_buffer};

/// The smallest resolution of the longest axis.
pub const MIN_RESOLUTION: u32 = 16;
/// The largest resolution of the longest axis that the grid's numbering allows.
pub const MAX_RESOLUTION: u32 = 1024;

/// Empty voxels on either side of the fitted bounds. The half puts axis-aligned outer walls into
/// the middle of a voxel: on a boundary, rounding would decide their layer.
const MARGIN: f32 = 1.5;

/// A grid of cubic voxels.
///
/// World space is right-handed with y up, in metres. *Grid space* has its origin at the grid's
/// corner and a voxel as its unit, so voxel `(x, y, z)` fills
/// `[x, x + 1) × [y, y + 1) × [z, z + 1)`. Level `l` of the pyramid has cells of `2^l` voxels;
/// every level halves exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The corner with the smallest coordinates, in the world.
    pub origin_in_world: Vec3,
    /// The edge of a voxel.
    pub voxel_size_m: f32,
    /// Voxels along each axis, a multiple of `2^(levels - 1)`. With cascades: voxels in the storage
    /// of all cascades.
    pub dimensions: UVec3,
    /// Levels of the pyramid, including the finest. With cascades: levels of each cascade.
    pub levels: u32,
    /// The boxes of a clipmap ([`Grid::cascades`]); `None` for a grid of one box.
    pub cascades: Option<Cascades>,
}

impl Grid {
    /// Fits a grid of `resolution` voxels along the longest axis to bounds, with a margin of 1.5
    /// voxels.
    ///
    /// `offset` (in voxels, each component in [0, 1)) shifts the grid against the bounds: errors of
    /// voxel methods depend on the places of walls, so tests and measurements try several offsets.
    /// The other axes get the necessary voxels, rounded up so that every level halves exactly.
    ///
    /// ```
    /// use glam::Vec3;
    /// use lumivox::Grid;
    ///
    /// let grid = Grid::fit(Vec3::ZERO, Vec3::new(4.0, 2.0, 2.0), 64, Vec3::ZERO)?;
    /// assert_eq!(grid.dimensions.x, 64);
    /// assert!((grid.voxel_size_m - 4.0 / 61.0).abs() < 1e-3);
    /// assert!(grid.max_in_world().cmpge(Vec3::new(4.0, 2.0, 2.0)).all());
    /// assert!(Grid::fit(Vec3::ZERO, Vec3::ONE, 63, Vec3::ZERO).is_err());
    /// # Ok::<(), lumivox::GiError>(())
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] when the resolution is out of range or not a multiple of 8, or the
    /// bounds are empty or not finite.
    pub fn fit(min: Vec3, max: Vec3, resolution: u32, offset: Vec3) -> Result<Self, GiError> {
        if !(MIN_RESOLUTION..=MAX_RESOLUTION).contains(&resolution) || !resolution.is_multiple_of(8)
        {
            return Err(GiError::Setting {
                name: "resolution",
                value: resolution.to_string(),
                expected: format!("a multiple of 8 from {MIN_RESOLUTION} to {MAX_RESOLUTION}"),
            });
        }
        let extent = max - min;
        let longest = extent.max_element();
        if !(min.is_finite() && max.is_finite() && longest > 0.0 && longest.is_finite()) {
            return Err(GiError::Setting {
                name: "bounds",
                value: format!("{min} to {max}"),
                expected: "finite and not empty".to_owned(),
            });
        }
        if !(offset.cmpge(Vec3::ZERO).all() && offset.cmplt(Vec3::ONE).all()) {
            return Err(GiError::Setting {
                name: "grid offset",
                value: offset.to_string(),
                expected: "at least 0 and below 1 voxel along each axis".to_owned(),
            });
        }
        // The coarsest level has at least four cells along the longest axis.
        let levels = (resolution / 4).ilog2() + 1;
        let coarsest = 1 << (levels - 1);
        let shift = offset.max_element();
        let voxel_size_m = longest / (resolution as f32 - 2.0 * MARGIN - shift);
        let needed = (extent / voxel_size_m + (2.0 * MARGIN) + offset).ceil().as_uvec3();
        // By rounding, the longest axis may slightly exceed the resolution.
        let needed = needed.min(UVec3::splat(resolution));
        let dimensions = needed.map(|n| n.next_multiple_of(coarsest));
        // The voxels added by rounding up are split between both sides of the shorter axes.
        let slack = (dimensions - needed) / 2;
        let origin_in_world = min - (MARGIN + offset + slack.as_vec3()) * voxel_size_m;
        Ok(Self { origin_in_world, voxel_size_m, dimensions, levels, cascades: None })
    }

    /// Cells of a level along each axis.
    pub fn level_dimensions(&self, level: u32) -> UVec3 {
        self.dimensions >> level
    }

    /// The edge of the cube that Morton codes of a level cover, a power of two.
    pub fn morton_edge(&self, level: u32) -> u32 {
        self.dimensions.max_element().next_power_of_two() >> level
    }

    /// Voxels along each axis of the grid's box, or of each cascade.
    pub fn box_dimensions(&self) -> UVec3 {
        self.cascades.map_or(self.dimensions, |cascades| UVec3::splat(cascades.resolution))
    }

    /// Voxels that the grid stores.
    pub fn voxel_count(&self) -> u64 {
        self.dimensions.as_u64vec3().element_product()
    }

    /// The corner of the grid with the smallest coordinates, in the world, m. With cascades, the
    /// corner of the outermost one.
    pub fn min_in_world(&self) -> Vec3 {
        self.cascades.map_or(self.origin_in_world, |_| self.boxes_in_world()[self.last_box()].0)
    }

    /// The corner of the grid opposite to [`Self::min_in_world`], in the world, m.
    pub fn max_in_world(&self) -> Vec3 {
        self.boxes_in_world()[self.last_box()].1
    }

    /// The opposite corners of each box of the grid, in the world, m: of each cascade, the finest
    /// first, or of the only box.
    pub fn boxes_in_world(&self) -> Vec<(Vec3, Vec3)> {
        let Some(cascades) = &self.cascades else {
            let size = self.dimensions.as_vec3() * self.voxel_size_m;
            return vec![(self.origin_in_world, self.origin_in_world + size)];
        };
        let corners = |(cascade, lowest): (i32, &IVec3)| {
            let voxel = 2.0_f32.powi(cascade);
            let low = self.world_from_grid(lowest.as_vec3() * voxel);
            (low, low + cascades.resolution as f32 * voxel * self.voxel_size_m)
        };
        (0..).zip(cascades.lowest()).map(corners).collect()
    }

    /// Number of boxes in the grid.
    pub(crate) fn box_count(&self) -> u32 {
        self.cascades.map_or(1, |cascades| cascades.count)
    }

    fn last_box(&self) -> usize {
        self.box_count() as usize - 1
    }

    /// Number of different cell sizes: the levels of the pyramid, and one for each coarser cascade.
    pub fn level_count(&self) -> u32 {
        self.levels + self.last_box() as u32
    }

    /// World to grid space.
    pub fn grid_from_world(&self, position: Vec3) -> Vec3 {
        (position - self.origin_in_world) / self.voxel_size_m
    }

    /// Grid space to world.
    pub fn world_from_grid(&self, position: Vec3) -> Vec3 {
        self.origin_in_world + position * self.voxel_size_m
    }

    /// The uniform that `package::grid` declares, for kernels without the volume in group 0.
    pub fn uniform(&self, device: &wgpu::Device) -> Buffer {
        uniform_buffer(device, "grid", &self.to_gpu())
    }

    /// The uniform for walks over only parts of the boxes.
    pub(crate) fn uniform_of_walked(&self, walked: &Walked, device: &wgpu::Device) -> Buffer {
        let [walked_low, walked_high] = walked.to_gpu();
        uniform_buffer(device, "grid", &GridUniform { walked_low, walked_high, ..self.to_gpu() })
    }

    pub(crate) fn to_gpu(self) -> GridUniform {
        let [walked_low, walked_high] = Walked::all(&self).to_gpu();
        GridUniform {
            origin_in_world: self.origin_in_world.to_array(),
            voxel_size_m: self.voxel_size_m,
            dimensions: self.dimensions.to_array(),
            levels: self.levels,
            lowest: self.cascades.map_or([[0; 4]; MAX_CASCADES], |own| own.lowest_of_all()),
            boxes: self.cascades.map_or([[0.0; 4]; MAX_CASCADES], |own| own.boxes()),
            walked_low,
            walked_high,
        }
    }
}

/// `Grid` of `grid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct GridUniform {
    pub(crate) origin_in_world: [f32; 3],
    pub(crate) voxel_size_m: f32,
    pub(crate) dimensions: [u32; 3],
    pub(crate) levels: u32,
    pub(crate) lowest: [[i32; 4]; MAX_CASCADES],
    pub(crate) boxes: [[f32; 4]; MAX_CASCADES],
    pub(crate) walked_low: [[i32; 4]; MAX_CASCADES],
    pub(crate) walked_high: [[i32; 4]; MAX_CASCADES],
}
