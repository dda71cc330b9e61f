//! The parts of cascades that triangle walks cover; elsewhere previous sums are kept
//! (`voxelize/keep.wgsl`).

use std::array;

use glam::{IVec3, Vec3};

use super::{Cascades, MAX_CASCADES, STRIDE};
use crate::{Draw, Grid};

/// Voxel range to walk for each cascade: first inclusive, last exclusive. Without cascades, and by
/// default, everything is walked.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Walked {
    voxels: [[IVec3; 2]; MAX_CASCADES],
    /// Opposite corners of the ranges in the world, m, enlarged by one voxel on all sides for
    /// rounding. Empty ranges intersect nothing.
    parts: [[Vec3; 2]; MAX_CASCADES],
    cascades: usize,
}

impl Walked {
    /// All voxels of all cascades.
    pub(crate) fn all(grid: &Grid) -> Self {
        Self::over(grid, |cascades, cascade| Some(cascades.voxels_of(cascade)))
    }

    /// The voxels that have entered the boxes since their positions in the grid `before`, and those
    /// near changed surfaces: `boxes` in the world, m.
    pub(crate) fn changed(grid: &Grid, before: &Grid, boxes: &[[Vec3; 2]]) -> Self {
        Self::over(grid, |cascades, cascade| {
            let own = cascades.voxels_of(cascade);
            let entered = match &before.cascades {
                Some(before) if cascades.keeps_of(before, cascade) => {
                    cascades.entered(before, cascade)
                }
                _ => Some(own),
            };
            let edge_m = grid.voxel_size_m * 2.0_f32.powi(cascade as i32);
            let voxel = |place: Vec3| ((place - grid.origin_in_world) / edge_m).floor();
            let near = boxes.iter().map(|[low, high]| {
                // Rounds to whole strides, since the bits of neighbouring voxels share a word.
                let stride = STRIDE as f32;
                let low = (((voxel(*low) - 1.0) / stride).floor() * stride).as_ivec3();
                let high = (((voxel(*high) + 2.0) / stride).ceil() * stride).as_ivec3();
                [low.max(own[0]), high.min(own[1])]
            });
            let near = near.filter(|[low, high]| low.cmplt(*high).all());
            entered.into_iter().chain(near).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        })
    }

    fn over(grid: &Grid, of: impl Fn(&Cascades, usize) -> Option<[IVec3; 2]>) -> Self {
        let count = grid.cascades.map_or(0, |cascades| cascades.count as usize);
        let voxels = array::from_fn(|cascade| match &grid.cascades {
            Some(cascades) if cascade < count => {
                let none = [cascades.lowest[cascade]; 2];
                of(cascades, cascade).unwrap_or(none)
            }
            _ => [IVec3::ZERO; 2],
        });
        let parts = array::from_fn(|cascade| {
            let [low, high] = voxels[cascade];
            if low.cmpge(high).any() {
                return [Vec3::INFINITY, Vec3::NEG_INFINITY];
            }
            let edge = 2.0_f32.powi(cascade as i32);
            [low - 1, high + 1].map(|voxel| grid.world_from_grid(voxel.as_vec3() * edge))
        });
        Self { voxels, parts, cascades: count }
    }

    /// The ranges in the layout of the shaders: all first voxels, then all last ones.
    pub(crate) fn to_gpu(self) -> [[[i32; 4]; MAX_CASCADES]; 2] {
        [0, 1].map(|end| self.voxels.map(|bounds| bounds[end].extend(0).to_array()))
    }

    /// Bit mask of the cascades in which a draw may touch the walked range.
    pub(crate) fn cascades_of(&self, draw: &Draw) -> u32 {
        let Some([low, high]) = draw.bounds_in_world().filter(|_| self.cascades > 0) else {
            return u32::MAX;
        };
        let meets = |part: &[Vec3; 2]| !(high.cmplt(part[0]).any() || low.cmpgt(part[1]).any());
        let bits = (0..).zip(&self.parts[..self.cascades]);
        bits.filter(|(_, part)| meets(part)).map(|(cascade, _)| 1 << cascade).sum()
    }
}

impl Cascades {
    /// Voxel range of a cascade: first inclusive, last exclusive.
    fn voxels_of(&self, cascade: usize) -> [IVec3; 2] {
        let low = self.lowest[cascade];
        [low, low + self.resolution as i32]
    }

    /// Whether a cascade keeps a part of its former contents, and the entered part is a box.
    fn keeps_of(&self, before: &Self, cascade: usize) -> bool {
        let by = (self.lowest[cascade] - before.lowest[cascade]).abs();
        let axes = by.to_array().into_iter().filter(|by| *by > 0).count();
        axes <= 1 && by.max_element() < self.resolution as i32
    }

    /// The part of a cascade that has entered it along one axis, if any.
    fn entered(&self, before: &Self, cascade: usize) -> Option<[IVec3; 2]> {
        let [low, high] = self.voxels_of(cascade);
        let by = low - before.lowest[cascade];
        if by == IVec3::ZERO {
            return None;
        }
        let first = IVec3::select(by.cmpgt(IVec3::ZERO), high - by, low);
        let end = IVec3::select(by.cmplt(IVec3::ZERO), low - by, high);
        Some([first, end])
    }
}
