//! The directions of a map's texels, and integrals over them.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use crate::EnvironmentMap;

impl EnvironmentMap {
    /// The unit vector towards a position in the picture, in the map's own frame (before
    /// [`Environment::rotation_rad`](crate::Environment::rotation_rad)): `x` in texels from the
    /// left edge, `y` from the top edge; the middle of the first texel is at 0.5, 0.5.
    pub fn direction(&self, x: f32, y: f32) -> Vec3 {
        let azimuth = (f64::from(x) / f64::from(self.width) - 0.5) * TAU;
        let polar = f64::from(y) / f64::from(self.height) * PI;
        DVec3::new(azimuth.sin() * polar.sin(), polar.cos(), -azimuth.cos() * polar.sin()).as_vec3()
    }

    /// The solid angle of each texel of a row, sr.
    pub fn solid_angle_sr(&self, row: u32) -> f64 {
        let edge = |row: u32| (f64::from(row) / f64::from(self.height) * PI).cos();
        (edge(row) - edge(row + 1)) * TAU / f64::from(self.width)
    }

    /// The mean radiance over all directions.
    pub fn mean_radiance(&self) -> Vec3 {
        let rows = self.rgb.chunks(self.width.max(1) as usize);
        let mut sum = DVec3::ZERO;
        for (row, texels) in (0..self.height).zip(rows) {
            let weight = self.solid_angle_sr(row) / (4.0 * PI);
            let texels = texels.iter().map(|texel| Vec3::from(*texel).as_dvec3());
            sum += weight * texels.sum::<DVec3>();
        }
        sum.as_vec3()
    }

    /// The irradiance of a surface with a unit normal in the map's own frame: the integral of
    /// radiance times cosine over its hemisphere, in pi times the map's unit.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        let rows = self.rgb.chunks(self.width.max(1) as usize);
        let mut sum = DVec3::ZERO;
        for (row, texels) in (0..self.height).zip(rows) {
            let weight = self.solid_angle_sr(row);
            for (column, texel) in texels.iter().enumerate() {
                let direction = self.direction(column as f32 + 0.5, row as f32 + 0.5);
                let cosine = f64::from(normal.dot(direction).max(0.0));
                sum += weight * cosine * Vec3::from(*texel).as_dvec3();
            }
        }
        sum.as_vec3()
    }
}
