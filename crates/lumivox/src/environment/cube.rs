//! Projection of a panorama to a cube, and the cube's mips, on the CPU.

use std::f32::consts::PI;
use std::f64;

use glam::{DVec3, Vec2, Vec3};

use super::Panorama;

/// A panorama that owns its texels.
#[derive(Debug)]
pub(super) struct Image {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgb: Vec<[f32; 3]>,
}

/// Six faces in the order +x, -x, +y, -y, +z, -z, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Cube {
    pub(super) edge: u32,
    pub(super) texels: Vec<Vec3>,
}

impl Image {
    pub(super) fn panorama(&self) -> Panorama<'_> {
        Panorama { width: self.width, height: self.height, rgb: &self.rgb }
    }
}

impl Panorama<'_> {
    /// The unit vector towards a position, in texels from the left and the top edge.
    pub(super) fn direction(&self, x: f64, y: f64) -> DVec3 {
        let azimuth = (x / f64::from(self.width) - 0.5) * f64::consts::TAU;
        let (sine, cosine) = (y / f64::from(self.height) * f64::consts::PI).sin_cos();
        DVec3::new(azimuth.sin() * sine, cosine, -azimuth.cos() * sine)
    }

    /// The solid angle of each texel of a row, sr.
    pub(super) fn solid_angle_sr(&self, row: u32) -> f64 {
        let edge = |row: u32| (f64::from(row) / f64::from(self.height) * f64::consts::PI).cos();
        (edge(row) - edge(row + 1)) * f64::consts::TAU / f64::from(self.width)
    }

    pub(super) fn at(&self, x: u32, y: u32) -> Vec3 {
        Vec3::from(self.rgb[y as usize * self.width as usize + x as usize])
    }

    /// The radiance from a direction, bilinearly filtered.
    fn sample(&self, direction: Vec3) -> Vec3 {
        let azimuth = direction.x.atan2(-direction.z);
        let polar = direction.y.clamp(-1.0, 1.0).acos();
        let place = Vec2::new(
            (azimuth / (2.0 * PI) + 0.5) * self.width as f32 - 0.5,
            polar / PI * self.height as f32 - 0.5,
        );
        let first = place.floor();
        let share = place - first;
        let column = |x: f32| (x as i64).rem_euclid(i64::from(self.width)) as u32;
        let row = |y: f32| y.clamp(0.0, (self.height - 1) as f32) as u32;
        let (left, right) = (column(first.x), column(first.x + 1.0));
        let along = |y: f32| self.at(left, row(y)).lerp(self.at(right, row(y)), share.x);
        along(first.y).lerp(along(first.y + 1.0), share.y)
    }
}

/// The panorama reduced to at most this width, averaged by solid angle; `None` if it is already
/// small enough.
pub(super) fn reduced(panorama: Panorama<'_>, most: u32) -> Option<Image> {
    let mut image: Option<Image> = None;
    loop {
        let from = image.as_ref().map_or(panorama, Image::panorama);
        if from.width <= most {
            return image;
        }
        image = Some(halved(from));
    }
}

fn halved(from: Panorama<'_>) -> Image {
    let (width, height) = (from.width.div_ceil(2), from.height.div_ceil(2));
    let mut rgb = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        let rows = [2 * y, (2 * y + 1).min(from.height - 1)];
        let weights = rows.map(|row| from.solid_angle_sr(row) as f32);
        for x in 0..width {
            let columns = [2 * x, (2 * x + 1).min(from.width - 1)];
            let mut sum = Vec3::ZERO;
            for (row, weight) in rows.into_iter().zip(weights) {
                sum += columns.map(|column| from.at(column, row)).iter().sum::<Vec3>() * weight;
            }
            rgb.push((sum / (2.0 * (weights[0] + weights[1]))).to_array());
        }
    }
    Image { width, height, rgb }
}

/// The direction (of any length) of a position on a face, from -1 to 1: `s` to the right, `t` down.
/// All graphics APIs share this arrangement: Vulkan 1.3, section "Cube map face selection".
pub(super) fn direction(face: usize, s: f32, t: f32) -> Vec3 {
    match face {
        0 => Vec3::new(1.0, -t, -s),
        1 => Vec3::new(-1.0, -t, s),
        2 => Vec3::new(s, 1.0, t),
        3 => Vec3::new(s, -1.0, -t),
        4 => Vec3::new(s, -t, 1.0),
        _ => Vec3::new(-s, -t, -1.0),
    }
}

/// The solid angle of a texel: exact, by the angles of the corners (the integral of
/// 1 / (1 + s^2 + t^2)^(3/2) is atan(s t / sqrt(1 + s^2 + t^2))).
pub(super) fn solid_angle_sr(edge: u32, x: u32, y: u32) -> f32 {
    let place = |i: u32| 2.0 * f64::from(i) / f64::from(edge) - 1.0;
    let corner = |s: f64, t: f64| (s * t).atan2((s * s + t * t + 1.0).sqrt());
    let (s0, s1, t0, t1) = (place(x), place(x + 1), place(y), place(y + 1));
    (corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0)) as f32
}

impl Cube {
    /// Projects a panorama onto a cube. Each texel is the mean of samples distributed over it: 16,
    /// or fewer for large cubes, down to one in the largest, whose texels are as wide as a bilinear
    /// sample of the panorama.
    pub(super) fn project(panorama: Panorama<'_>, edge: u32) -> Self {
        let side = match edge {
            0..=256 => 4,
            257..=512 => 2,
            _ => 1,
        };
        let scale = 2.0 / (edge * side) as f32;
        let mut texels = Vec::with_capacity(6 * edge as usize * edge as usize);
        for face in 0..6 {
            for y in 0..edge {
                for x in 0..edge {
                    let mut sum = Vec3::ZERO;
                    for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
                        let s = ((x * side + i) as f32 + 0.5) * scale - 1.0;
                        let t = ((y * side + j) as f32 + 0.5) * scale - 1.0;
                        sum += panorama.sample(direction(face, s, t).normalize());
                    }
                    texels.push(sum / (side * side) as f32);
                }
            }
        }
        Self { edge, texels }
    }

    /// The next mip: means over the solid angle.
    pub(super) fn halved(&self) -> Self {
        let edge = self.edge / 2;
        let mut texels = Vec::with_capacity(6 * edge as usize * edge as usize);
        // The weights are the same for all faces.
        let weights: Vec<f32> = (0..self.edge)
            .flat_map(|y| (0..self.edge).map(move |x| (x, y)))
            .map(|(x, y)| solid_angle_sr(self.edge, x, y))
            .collect();
        for face in self.texels.chunks_exact(weights.len()) {
            for y in 0..edge {
                for x in 0..edge {
                    let first = (2 * y * self.edge + 2 * x) as usize;
                    let below = first + self.edge as usize;
                    let four = [first, first + 1, below, below + 1];
                    let sum: Vec3 = four.iter().map(|&i| face[i] * weights[i]).sum();
                    texels.push(sum / four.iter().map(|&i| weights[i]).sum::<f32>());
                }
            }
        }
        Self { edge, texels }
    }
}
