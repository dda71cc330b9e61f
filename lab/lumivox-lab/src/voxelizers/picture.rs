//! The voxels of each voxelizer, side by side.

use glam::{UVec2, Vec3};
use image::{Rgb, RgbImage};
use lumivox_app::parts::{Align, Canvas};
use lumivox_render::{EXTRA_COLOR, MISSING_COLOR, VoxelSet, voxel_set_picture};
use lumivox_scene::Camera;

const BACKGROUND: Rgb<u8> = Rgb([24, 24, 27]);
const BRIGHT: Rgb<u8> = Rgb([240, 240, 240]);
const DIM: Rgb<u8> = Rgb([178, 178, 184]);

/// The picture of one voxelizer.
pub struct Panel<'a> {
    /// Its voxels.
    pub set: &'a VoxelSet,
    /// Two lines above the picture.
    pub caption: [String; 2],
}

/// Draws the panels side by side, each of this size, with a key to the colours below.
pub fn picture(panels: &[Panel<'_>], exact: &VoxelSet, camera: &Camera, size: UVec2) -> RgbImage {
    // Text and gaps grow with the panels.
    let text = (size.x as f32 / 22.0).max(12.0);
    let gap = (0.75 * text).round() as u32;
    let line = (1.4 * text).round() as u32;
    let count = panels.len() as u32;
    let width = count * (size.x + gap) + gap;
    let height = 3 * gap + 3 * line + size.y;
    let mut canvas = Canvas::new(width, height, BACKGROUND);
    for (column, panel) in (0..).zip(panels) {
        let x = gap + column * (size.x + gap);
        let [first, second] = &panel.caption;
        canvas.text(first, x, gap, text, Align::Left, BRIGHT);
        canvas.text(second, x, gap + line, 0.85 * text, Align::Left, DIM);
        let pixels = voxel_set_picture(panel.set, exact, camera, size);
        let image =
            RgbImage::from_fn(size.x, size.y, |x, y| Rgb(pixels[(y * size.x + x) as usize]));
        canvas.put(&image, x, gap + 2 * line);
    }
    let y = 2 * gap + 2 * line + size.y;
    let mut x = gap;
    for (color, words) in [(MISSING_COLOR, "missing"), (EXTRA_COLOR, "too many")] {
        canvas.put(&RgbImage::from_pixel(line, line, shown(color)), x, y);
        x += line + gap / 2;
        canvas.text(words, x, y, 0.85 * text, Align::Left, DIM);
        x += canvas.text_width(words, 0.85 * text).ceil() as u32 + 2 * gap;
    }
    canvas.into_image()
}

/// The screen colour of a linear colour in full light, as on the top of a cube.
fn shown(color: Vec3) -> Rgb<u8> {
    Rgb(color.to_array().map(|c| (lumivox_render::srgb_encode(c) * 255.0).round() as u8))
}
