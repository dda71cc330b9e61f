//! A look at what was baked.

use glam::{UVec2, Vec3};

use crate::Probe;
use crate::room::Quad;

/// A picture of linear colours.
pub struct Picture {
    pub size: UVec2,
    pixels: Vec<Vec3>,
}

/// Pixels between things.
const GAP: u32 = 4;
/// Pixels of the edge of a texel, and of a probe's ball.
const TEXEL: u32 = 4;
const BALL: u32 = 32;

impl Picture {
    /// The light maps in a row, and below them the probes of the slice in the middle, as balls that
    /// show the light from all sides.
    pub fn of(maps: &[(&Quad, Vec<Vec3>)], texels: &[[u32; 2]], slice: &[Vec<&Probe>]) -> Self {
        let map_width: u32 = texels.iter().map(|[width, _]| TEXEL * width + GAP).sum();
        let map_height = texels.iter().map(|[_, height]| TEXEL * height).max().unwrap_or(0);
        let width = map_width.max(BALL * slice[0].len() as u32);
        let size = UVec2::new(width, map_height + GAP + BALL * slice.len() as u32);
        let mut picture = Self { size, pixels: vec![Vec3::ZERO; size.element_product() as usize] };
        let mut left = 0;
        for ((quad, irradiance), [width, height]) in maps.iter().zip(texels) {
            for y in 0..TEXEL * height {
                for x in 0..TEXEL * width {
                    let texel = (y / TEXEL) * width + x / TEXEL;
                    let radiance = quad.albedo / std::f32::consts::PI * irradiance[texel as usize];
                    picture.set(left + x, TEXEL * height - 1 - y, radiance);
                }
            }
            left += TEXEL * width + GAP;
        }
        for (row, probes) in slice.iter().rev().enumerate() {
            for (column, probe) in probes.iter().enumerate() {
                let corner = UVec2::new(column as u32 * BALL, map_height + GAP + row as u32 * BALL);
                picture.ball(corner, probe);
            }
        }
        picture
    }

    fn ball(&mut self, corner: UVec2, probe: &Probe) {
        let radius = 0.5 * BALL as f32 - 2.0;
        for y in 0..BALL {
            for x in 0..BALL {
                let from_middle = [x, y].map(|n| (n as f32 + 0.5 - 0.5 * BALL as f32) / radius);
                let [right, down] = from_middle;
                let flat = right * right + down * down;
                if flat < 1.0 {
                    let normal = Vec3::new(right, -down, (1.0 - flat).sqrt());
                    let radiance = 0.75 / std::f32::consts::PI * probe.irradiance(normal);
                    self.set(corner.x + x, corner.y + y, radiance);
                }
            }
        }
    }

    fn set(&mut self, x: u32, y: u32, color: Vec3) {
        self.pixels[(y * self.size.x + x) as usize] = color;
    }

    /// Bytes of RGB, so exposed that the brightest hundredth is white.
    pub fn encoded(&self) -> Vec<u8> {
        let mut brightest: Vec<f32> = self
            .pixels
            .iter()
            .map(|pixel| pixel.max_element())
            .filter(|value| *value > 0.0)
            .collect();
        brightest.sort_by(f32::total_cmp);
        let white = brightest.get(brightest.len() * 99 / 100).copied().unwrap_or(1.0);
        self.pixels.iter().flat_map(|pixel| (*pixel / white).to_array().map(srgb)).collect()
    }
}

/// The sRGB encoding of a linear value: IEC 61966-2-1.
fn srgb(linear: f32) -> u8 {
    let encoded =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
}
