//! A photographer's studio: the surroundings of things without their own light.
//!
//! Large soft boxes give soft light and calm reflections; a wall merges without an edge into a
//! ground that catches shadows. Everything is neutral grey and in cd/m², as in a bright studio: the
//! boxes have 400 to 2000 cd/m², the wall 300 at its foot. Nothing is symmetric: the largest box is
//! to the left of and above the camera, a lower one to the right fills the shadows, a strip behind
//! draws the outline, and one overhead lights the ground.

use std::f32::consts::PI;

use glam::Vec3;

use crate::{EnvironmentMap, Material};

/// Texels around the horizon. The edges of the boxes are softer than a texel.
const WIDTH: u32 = 256;
/// Luminance of the wall where it meets the ground, and overhead, cd/m².
const WALL_CD_M2: [f32; 2] = [300.0, 120.0];

/// A soft box, by the direction of its centre from the thing in the studio.
struct SoftBox {
    /// The azimuth from the camera, growing to the right, degrees.
    azimuth_deg: f32,
    elevation_deg: f32,
    /// Half its edges, degrees.
    half_deg: [f32; 2],
    luminance_cd_m2: f32,
}

const BOXES: [SoftBox; 4] = [
    SoftBox {
        azimuth_deg: -48.0,
        elevation_deg: 46.0,
        half_deg: [24.0, 20.0],
        luminance_cd_m2: 2000.0,
    },
    SoftBox {
        azimuth_deg: 65.0,
        elevation_deg: 24.0,
        half_deg: [18.0, 20.0],
        luminance_cd_m2: 450.0,
    },
    SoftBox {
        azimuth_deg: 165.0,
        elevation_deg: 38.0,
        half_deg: [30.0, 9.0],
        luminance_cd_m2: 900.0,
    },
    SoftBox {
        azimuth_deg: 0.0,
        elevation_deg: 88.0,
        half_deg: [26.0, 26.0],
        luminance_cd_m2: 400.0,
    },
];
/// The angle over which the edge of a box fades.
const EDGE_DEG: f32 = 4.0;

/// A photographer's studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Studio {
    /// The surroundings of the thing, cd/m²; the middle (-z) is behind the thing for a camera that
    /// looks along -z. Below the horizon it shows the distant ground.
    pub map: EnvironmentMap,
    /// The albedo of the ground, which makes it as bright as the foot of the wall, so that its end
    /// is invisible.
    pub ground_albedo: f32,
    /// Illuminance of the ground, lx.
    pub ground_lux: f32,
}

impl Studio {
    /// Makes the studio.
    pub fn new() -> Self {
        let (width, height) = (WIDTH, WIDTH / 2);
        let name = "studio".to_owned();
        let mut map = EnvironmentMap { name, width, height, ..EnvironmentMap::default() };
        for row in 0..height {
            for column in 0..width {
                let way = map.direction(column as f32 + 0.5, row as f32 + 0.5);
                map.rgb.push([luminance(way); 3]);
            }
        }
        // The map does not contain light from the ground yet.
        let ground_lux = map.irradiance(Vec3::Y).x;
        Self { ground_albedo: PI * WALL_CD_M2[0] / ground_lux, map, ground_lux }
    }

    /// The ground's matt material.
    pub fn ground(&self) -> Material {
        Material::diffuse("studio ground", Vec3::splat(self.ground_albedo))
    }
}

impl Default for Studio {
    fn default() -> Self {
        Self::new()
    }
}

/// The luminance in a direction; the camera looks along -z.
fn luminance(way: Vec3) -> f32 {
    let [foot, top] = WALL_CD_M2;
    if way.y <= 0.0 {
        return foot;
    }
    // The wall is as bright as its foot up to eye height, and darker above.
    let rise = way.y * way.y * (3.0 - 2.0 * way.y);
    let wall = foot + (top - foot) * rise;
    BOXES.iter().fold(wall, |below, lamp| {
        let cover = lamp.cover(way);
        below + (lamp.luminance_cd_m2 - below) * cover
    })
}

impl SoftBox {
    /// 1 inside the box, 0 outside, and in between at its edge.
    fn cover(&self, way: Vec3) -> f32 {
        let azimuth = self.azimuth_deg.to_radians();
        let (up, level) = self.elevation_deg.to_radians().sin_cos();
        // The camera is towards +z.
        let middle = Vec3::new(azimuth.sin() * level, up, azimuth.cos() * level);
        let right = Vec3::Y.cross(middle).normalize();
        let above = middle.cross(right);
        let depth = way.dot(middle);
        if depth <= 0.0 {
            return 0.0;
        }
        let within = |along: Vec3, half_deg: f32| {
            let angle_deg = way.dot(along).atan2(depth).abs().to_degrees();
            let edge = ((half_deg - angle_deg) / EDGE_DEG + 0.5).clamp(0.0, 1.0);
            edge * edge * (3.0 - 2.0 * edge)
        };
        within(right, self.half_deg[0]) * within(above, self.half_deg[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_and_wall_match_in_brightness_where_they_meet() {
        let studio = Studio::new();
        let below = studio.map.rgb.last().unwrap()[0];
        let ground = studio.ground_lux * studio.ground_albedo / PI;
        assert!((ground / below - 1.0).abs() < 1e-3, "{ground} and {below} cd/m²");
        assert!((0.3..0.8).contains(&studio.ground_albedo), "{}", studio.ground_albedo);
        let row = |row: u32| {
            let start = (row * studio.map.width) as usize;
            &studio.map.rgb[start..start + studio.map.width as usize]
        };
        let horizon = studio.map.height / 2;
        for (above, below) in row(horizon - 1).iter().zip(row(horizon)) {
            assert!((above[0] / below[0] - 1.0).abs() < 0.01, "an edge at the horizon");
        }
    }

    #[test]
    fn most_light_comes_from_the_left_of_the_camera() {
        let map = Studio::new().map;
        let lux = |x: f32, y: f32, z: f32| map.irradiance(Vec3::new(x, y, z).normalize()).x;
        assert!(lux(-1.0, 0.5, 1.0) > 1.4 * lux(1.0, 0.5, 1.0), "the key is on the left");
        assert!(lux(0.0, 0.3, 1.0) > 1.3 * lux(0.0, 0.3, -1.0), "and before the thing");
        assert!(lux(1.0, 0.0, 0.5) > 0.25 * lux(-1.0, 0.0, 0.5), "shadows are filled");
        assert!(map.rgb.iter().all(|texel| texel[0] == texel[1] && texel[1] == texel[2]));
    }
}
