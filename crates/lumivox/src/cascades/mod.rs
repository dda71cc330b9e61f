//! Cascades: a clipmap of boxes around the camera, each with voxels twice as large as the one
//! within it.
//!
//! The boxes of the clipmap are stored side by side. Cascade *k* is a cube of 2^k times coarser
//! voxels; all cascades have the same number of voxels. All cubes share one storage, so there is
//! one list of voxels, one texture and one light per face, and every stage that iterates over
//! voxels, faces or nodes works as it does for a single box. Only three things depend on where a
//! cell is (`cascades.wgsl`):
//!
//! - *Voxelization* walks a triangle once in each cascade that it meets, scaled to its voxels and
//!   clipped to its box.
//! - *Cones* count lengths in the finest voxels, and levels of cells by their size: 2^level. A
//!   look-up reads the finest cascade that has all the cells it needs, so that cones within a
//!   cascade see nearly the same as in a dense volume. Near the end of a cascade a cone changes to
//!   the voxels of the next one: at the first empty place before the border, or at the border.
//! - *Surfaces* that gather start their cones at their own voxels: faces at their own, pixels and
//!   points at the finest ones. Near a border they choose the cascade at random, so that the border
//!   is not visible.
//!
//! Voxels have absolute coordinates: multiples of their edge, counted from a fixed origin that does
//! not depend on the camera. A voxel is stored at its coordinates modulo the cube's edge, so it
//! stays in place while the cube moves over it (toroidal addressing: Losasso and Hoppe 2004,
//! "Geometry clipmaps", section 3). Cubes move by 2^([`LEVELS`] - 1) voxels, so that the cells of
//! all their levels stay the same, too. A cube's pyramid is short: larger cells belong to the next
//! cascade.
//!
//! Cascades are centered on a given place ([`Gi::center_on`](crate::Gi::center_on)). Voxels of
//! moved boxes are built while the old list stays in use. They replace it a few frames later and
//! inherit the light of the same voxels (`light/copy_replaced.wgsl`). Static surfaces are walked
//! only where they have entered a box (`walked.rs`); elsewhere their sums are kept
//! (`voxelize/keep.wgsl`). A box moves along one axis at a time, so that the entered part is a
//! slab. If draws are added or removed, only the boxes around them are walked. Only faces of new
//! voxels must gather at once; faces of coarse cascades gather less often (`light/turn.wgsl`).
//!
//! Memory: with six lobes 72 bytes a voxel, and a seventh more for the pyramid: 20 MiB for 64
//! voxels along an axis, 160 MiB for 128. Cubes are stored in a block of rows and columns; slots of
//! the block without a cube stay unused ([`CascadeOptions::bytes`]). Eight cubes of 64 with a
//! finest voxel of 0.125 m reach 1 km with 169 MiB, including their masks of empty space.

#[cfg(test)]
mod tests;
mod walked;

pub(crate) use walked::Walked;

use glam::{IVec3, UVec3, Vec3};

use crate::gpu::ShaderLibrary;
use crate::{GiError, Grid};

/// Maximum number of cascades.
pub const MAX_CASCADES: usize = 16;
/// Levels of a cascade's pyramid, including its voxels.
pub(crate) const LEVELS: u32 = 4;
/// Cascades move by multiples of this many voxels.
const STRIDE: i32 = 1 << (LEVELS - 1);
/// The largest coordinate of the cascades' center, in the finest voxels.
const FARTHEST: f32 = 4_194_304.0;
/// Maximum number of voxels along each axis of the storage, limited by the voxel numbering.
const MAX_STORED: u32 = crate::MAX_RESOLUTION;

/// The size of a clipmap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CascadeOptions {
    /// Number of cascades, 1 to [`MAX_CASCADES`]. Default: 8. Each additional cascade doubles the
    /// reach and takes equal memory.
    pub count: u32,
    /// Voxels along each axis of a cascade, a multiple of 8 from 32 to 256. Default: 64. Higher
    /// values move the coarser voxels farther away; memory grows with the third power.
    pub resolution: u32,
    /// The edge of the finest voxels, m, from 0.001 to 1000. Default: 0.125.
    pub voxel_size_m: f32,
}

impl Default for CascadeOptions {
    fn default() -> Self {
        Self { count: 8, resolution: 64, voxel_size_m: 0.125 }
    }
}

impl CascadeOptions {
    /// The edge of the outermost cascade, m. Voxels provide light up to half of it.
    pub fn reach_m(&self) -> f32 {
        self.resolution as f32 * self.voxel_size_m * 2.0_f32.powi(self.count as i32 - 1)
    }

    fn check(&self) -> Result<(), GiError> {
        let fail =
            |name, value: String, expected: String| Err(GiError::Setting { name, value, expected });
        if !(1..=MAX_CASCADES as u32).contains(&self.count) {
            let expected = format!("from 1 to {MAX_CASCADES}");
            return fail("cascades", self.count.to_string(), expected);
        }
        if !(32..=256).contains(&self.resolution) || !self.resolution.is_multiple_of(8) {
            let expected = "a multiple of 8 from 32 to 256".to_owned();
            return fail("cascade_resolution", self.resolution.to_string(), expected);
        }
        if !(0.001..=1000.0).contains(&self.voxel_size_m) {
            let expected = "from 0.001 to 1000 m".to_owned();
            return fail("cascade_voxel", self.voxel_size_m.to_string(), expected);
        }
        let stored = Cascades::stored([self.count, self.resolution]).dimensions();
        if stored.max_element() > MAX_STORED {
            let expected = format!(
                "at most {} for cascades of {} voxels",
                self.most_of_resolution(),
                self.resolution
            );
            return fail("cascades", self.count.to_string(), expected);
        }
        Ok(())
    }

    /// Maximum number of cascades of this resolution that can be numbered.
    fn most_of_resolution(&self) -> u32 {
        let fits = |count: &u32| {
            let stored = Cascades::stored([*count, self.resolution]);
            stored.dimensions().max_element() <= MAX_STORED
        };
        (1..=MAX_CASCADES as u32).filter(fits).max().unwrap_or(0)
    }
}

/// The boxes of a clipmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cascades {
    /// Number of cascades.
    pub count: u32,
    /// Voxels along each axis of a cascade.
    pub resolution: u32,
    /// Arrangement of the cascades in storage.
    blocks: UVec3,
    /// The voxel at the corner of each cascade, in voxels of that cascade.
    lowest: [IVec3; MAX_CASCADES],
}

impl Cascades {
    /// `count` cascades of a resolution, arranged in the smallest block that holds them. The
    /// longest side of the block is x, the axis along which parts of cells are not stacked.
    pub(crate) fn stored([count, resolution]: [u32; 2]) -> Self {
        let blocks = (1..=count).flat_map(|z| (z..=count).map(move |y| (y, z)));
        let blocks = blocks.map(|(y, z)| UVec3::new(count.div_ceil(y * z).max(y), y, z));
        // Bytes per voxel: those of six lobes, and the bits and ranks of the enclosing power of
        // two.
        let best = blocks.min_by_key(|blocks| {
            let longest = u64::from(blocks.max_element());
            let is_too_long = longest * u64::from(resolution) > u64::from(MAX_STORED);
            let volume = 72 * u64::from(blocks.element_product());
            (is_too_long, volume + longest.next_power_of_two().pow(3))
        });
        let blocks = best.unwrap_or(UVec3::ONE);
        Self { count, resolution, blocks, lowest: [IVec3::ZERO; MAX_CASCADES] }
    }

    /// Voxels along each axis of the storage.
    fn dimensions(&self) -> UVec3 {
        self.blocks * self.resolution
    }

    /// The voxel at the corner of each cascade, in voxels of that cascade.
    pub fn lowest(&self) -> &[IVec3] {
        &self.lowest[..self.count as usize]
    }

    /// The corner voxels of all cascades in the layout of the shaders.
    pub(crate) fn lowest_of_all(&self) -> [[i32; 4]; MAX_CASCADES] {
        self.lowest.map(|lowest| lowest.extend(0).to_array())
    }

    /// The boxes after the first step towards `end`. Each box moves along one axis, so that the
    /// entered part is a box, or directly to its end if no part of it would stay.
    pub(crate) fn step_to(&self, end: &Self) -> Self {
        let mut next = *end;
        for (cascade, next) in next.lowest.iter_mut().enumerate() {
            let from = self.lowest[cascade];
            let by = *next - from;
            if by.abs().max_element() < self.resolution as i32 {
                let axis = (0..3).find(|axis| by[*axis] != 0).unwrap_or(0);
                *next = from;
                next[axis] += by[axis];
            }
        }
        next
    }

    /// The center of each cascade, and half of its edge, in the finest voxels.
    pub(crate) fn boxes(&self) -> [[f32; 4]; MAX_CASCADES] {
        let half = 0.5 * self.resolution as f32;
        std::array::from_fn(|cascade| {
            let middle = (self.lowest[cascade].as_vec3() + half).extend(half);
            (middle * 2.0_f32.powi(cascade as i32)).to_array()
        })
    }
}

impl Grid {
    /// A clipmap around a place in the world, m. `offset` (in the finest voxels, each component in
    /// [0, 1)) shifts all voxels relative to the world's origin, as in [`Grid::fit`].
    ///
    /// ```
    /// use glam::Vec3;
    /// use lumivox::{CascadeOptions, Grid};
    ///
    /// let options = CascadeOptions { count: 3, resolution: 64, voxel_size_m: 0.25 };
    /// let grid = Grid::cascades(Vec3::new(100.0, 2.0, 30.0), &options, Vec3::ZERO)?;
    /// let boxes = grid.boxes_in_world();
    /// assert_eq!(boxes.len(), 3);
    /// assert!((boxes[0].1 - boxes[0].0).abs_diff_eq(Vec3::splat(16.0), 1e-3));
    /// assert!((boxes[2].1 - boxes[2].0).abs_diff_eq(Vec3::splat(64.0), 1e-3));
    /// # Ok::<(), lumivox::GiError>(())
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] if an option is out of range, or the place is not finite or too far
    /// from the origin (2^22 of the finest voxels, beyond which `f32` cannot resolve a quarter of a
    /// voxel).
    pub fn cascades(center: Vec3, options: &CascadeOptions, offset: Vec3) -> Result<Self, GiError> {
        options.check()?;
        if !(offset.cmpge(Vec3::ZERO).all() && offset.cmplt(Vec3::ONE).all()) {
            return Err(GiError::Setting {
                name: "grid offset",
                value: offset.to_string(),
                expected: "at least 0 and below 1 voxel along each axis".to_owned(),
            });
        }
        let cascades = Cascades::stored([options.count, options.resolution]);
        let voxel_size_m = options.voxel_size_m;
        let origin_in_world = -(place_of_the_origin(options.count) + offset) * voxel_size_m;
        let (dimensions, levels) = (cascades.dimensions(), LEVELS);
        let cascades = Some(cascades);
        let mut grid = Self { origin_in_world, voxel_size_m, dimensions, levels, cascades };
        grid.center_on(center)?;
        Ok(grid)
    }

    /// Moves the boxes of a clipmap so that a place in the world, m, is within four voxels of the
    /// center of each. Returns `true` if a box has moved; does nothing for a grid without cascades.
    ///
    /// # Errors
    /// [`GiError::Setting`] if the place is not finite or too far from the origin.
    pub fn center_on(&mut self, center: Vec3) -> Result<bool, GiError> {
        let place = self.grid_from_world(center);
        let Some(cascades) = &mut self.cascades else { return Ok(false) };
        if !(place.is_finite() && place.abs().max_element() <= FARTHEST) {
            return Err(GiError::Setting {
                name: "center",
                value: center.to_string(),
                expected: format!(
                    "within {:.0} m of the world's origin, which are 2^22 of the finest voxels",
                    FARTHEST * self.voxel_size_m
                ),
            });
        }
        let before = cascades.lowest;
        let half = 0.5 * cascades.resolution as f32;
        for (cascade, lowest) in (0..).zip(&mut cascades.lowest[..cascades.count as usize]) {
            let corner = place / 2.0_f32.powi(cascade) - half;
            *lowest = (corner / STRIDE as f32).round().as_ivec3() * STRIDE;
        }
        Ok(cascades.lowest != before)
    }
}

/// The grid coordinate of the world's origin, in the finest voxels. Walls are often at round
/// coordinates, and should be in the middle of voxels, as in `Grid::fit`, in every cascade: here at
/// 0.5, 0.25, 0.625, 0.31, 0.66, 0.33 and so on, at least a quarter from a voxel's side.
fn place_of_the_origin(count: u32) -> f32 {
    (1..count).fold(0.5, |place, cascade| {
        let voxel = 2.0_f32.powi(cascade as i32);
        let off_middle = |place: f32| ((place / voxel).fract() - 0.5).abs();
        let other = place + 0.5 * voxel;
        if off_middle(other) < off_middle(place) { other } else { place }
    })
}

/// Defines the shader constants for the storage of cascades.
pub(crate) fn add_constants(shaders: &mut ShaderLibrary, cascades: Option<&Cascades>) {
    let blocks = cascades.map_or(UVec3::ONE, |cascades| cascades.blocks);
    shaders
        .constant_u32("MAX_CASCADES", MAX_CASCADES as u32)
        .constant_u32("CASCADES", cascades.map_or(0, |cascades| cascades.count))
        .constant_u32("CASCADE_EDGE", cascades.map_or(1, |cascades| cascades.resolution))
        .constant_u32("CASCADE_COLUMNS", blocks.x)
        .constant_u32("CASCADE_ROWS", blocks.y);
}
