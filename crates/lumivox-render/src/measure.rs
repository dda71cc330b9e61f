//! Light as numbers: the grid of a workplane, and statistics of many readings.

use glam::Vec3;

use crate::picture::tone_map::luminance;

/// The illuminance or the luminance of linear RGB (ITU-R BT.709-6, section 3.2), in its unit.
pub fn photometric(rgb: [f32; 3]) -> f32 {
    luminance(rgb) as f32
}

/// A planar grid of points at the centres of equal cells of a parallelogram, such as 0.85 m above a
/// floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workplane {
    /// A corner, m.
    pub origin: Vec3,
    /// The edge along which the columns are counted, m.
    pub along: Vec3,
    /// The edge along which the rows are counted, m.
    pub across: Vec3,
    /// Cells along the first edge, at least 1.
    pub columns: u32,
    /// Cells along the second edge, at least 1.
    pub rows: u32,
}

impl Workplane {
    /// The points, row by row, starting at the origin.
    pub fn points(&self) -> Vec<Vec3> {
        let at = |row: u32, column: u32| {
            let u = (column as f32 + 0.5) / self.columns as f32;
            let v = (row as f32 + 0.5) / self.rows as f32;
            self.origin + u * self.along + v * self.across
        };
        (0..self.rows)
            .flat_map(|row| (0..self.columns).map(move |column| at(row, column)))
            .collect()
    }
}

/// Statistics of readings, in the readings' unit: lux or cd/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// The mean.
    pub mean: f64,
    /// The minimum.
    pub minimum: f64,
    /// The maximum.
    pub maximum: f64,
    /// The minimum divided by the mean (EN 12464-1:2021, the uniformity U0), 0 to 1; 0 in darkness.
    pub uniformity: f64,
}

impl Summary {
    /// The statistics of some readings; all are 0 if `values` is empty.
    pub fn of(values: &[f32]) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        let each = || values.iter().copied().map(f64::from);
        let mean = each().sum::<f64>() / values.len() as f64;
        let minimum = each().fold(f64::INFINITY, f64::min);
        let maximum = each().fold(f64::NEG_INFINITY, f64::max);
        let uniformity = if mean > 0.0 { minimum / mean } else { 0.0 };
        Self { mean, minimum, maximum, uniformity }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_the_middles_of_cells() {
        let plane = Workplane {
            origin: Vec3::new(1.0, 2.0, 3.0),
            along: Vec3::X * 4.0,
            across: Vec3::Z * -1.0,
            columns: 2,
            rows: 1,
        };
        assert_eq!(plane.points(), [Vec3::new(2.0, 2.0, 2.5), Vec3::new(4.0, 2.0, 2.5)]);
    }

    #[test]
    fn uniformity_is_the_least_over_the_mean() {
        let summary = Summary::of(&[1.0, 2.0, 6.0]);
        let expected = Summary { mean: 3.0, minimum: 1.0, maximum: 6.0, uniformity: 1.0 / 3.0 };
        assert_eq!(summary, expected);
        assert_eq!(Summary::of(&[0.0, 0.0]), Summary::default());
        assert_eq!(Summary::of(&[]), Summary::default());
    }
}
