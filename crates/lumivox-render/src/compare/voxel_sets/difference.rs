//! The difference of a set of voxels from the exact one.

use super::{Voxel, VoxelSet};

/// The voxels of a voxelizer against the exact set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SetDifference {
    /// Voxels found.
    pub voxels: u32,
    /// Voxels of the exact set that are not found.
    pub missing: u32,
    /// Missing voxels that are only touched, without surface in the exact set.
    pub missing_touched: u32,
    /// Voxels found that are not in the exact set.
    pub extra: u32,
    /// Share of the exact set's surface (the areas along the lobes) that is in missing voxels, 0
    /// to 1.
    pub missing_area: f64,
    /// The surface of all voxels found, divided by that of the exact set.
    pub area: f64,
    /// Root of the mean squared difference of a voxel's reflectance, over red, green and blue
    /// (equally weighted) of the voxels that have surface in both sets. A voxel's reflectance is
    /// the mean over its faces, weighted by area. 0 if there is no such voxel.
    pub color_rmse: f64,
}

impl VoxelSet {
    /// Compares this set with the exact one of the same grid.
    pub fn difference(&self, exact: &Self) -> SetDifference {
        let area = |voxels: &[Voxel]| voxels.iter().map(|voxel| f64::from(voxel.area)).sum::<f64>();
        let exact_area = area(exact.voxels());
        let share = |area: f64| if exact_area > 0.0 { area / exact_area } else { 0.0 };
        let mut result = SetDifference {
            voxels: self.voxels().len() as u32,
            area: share(area(self.voxels())),
            ..Default::default()
        };
        let (mut missing_area, mut squares, mut compared) = (0.0, 0.0, 0_u32);
        for right in exact.voxels() {
            let Some(own) = self.get(right.morton) else {
                result.missing += 1;
                result.missing_touched += u32::from(right.area == 0.0);
                missing_area += f64::from(right.area);
                continue;
            };
            if own.area > 0.0 && right.area > 0.0 {
                let error = (own.reflectance - right.reflectance).as_dvec3();
                squares += error.length_squared() / 3.0;
                compared += 1;
            }
        }
        // Each voxel found is in the exact set or extra.
        result.extra = result.voxels + result.missing - exact.voxels().len() as u32;
        result.missing_area = share(missing_area);
        result.color_rmse = (squares / f64::from(compared.max(1))).sqrt();
        result
    }
}
