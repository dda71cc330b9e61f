//! A picture of a set of voxels: cubes with their reflectance; missing and extra voxels have marker
//! colours.
//!
//! Each pixel's ray walks from cell to cell (Amanatides and Woo 1987) until it meets a voxel of
//! either set, so missing voxels are visible as well. It runs on the CPU: it only reads bits, and
//! no frame waits for it.

use glam::{DVec2, DVec3, UVec2, UVec3, Vec3};
use lumivox::Grid;
use lumivox_scene::Camera;

use super::{Voxel, VoxelSet, morton_decode, morton_encode};
use crate::picture::srgb::srgb_encode;

/// Linear colour of voxels of the exact set that are not found.
pub const MISSING_COLOR: Vec3 = Vec3::new(1.0, 0.0, 0.7);
/// Linear colour of voxels that are found, but not in the exact set.
pub const EXTRA_COLOR: Vec3 = Vec3::new(0.0, 0.8, 1.0);
/// Linear colour of voxels that are touched, but contain no surface.
const BARE_COLOR: Vec3 = Vec3::new(0.1, 0.1, 0.1);
/// Linear colour of the background.
const BACKGROUND: Vec3 = Vec3::new(0.01, 0.01, 0.012);

/// Brightness of a cube's sides along x, y and z, so that its shape is visible.
const SIDES: Vec3 = Vec3::new(0.72, 1.0, 0.86);
/// Width of the outline of a cube's sides, as a share of its edge, and its brightness factor.
const EDGE_WIDTH: f64 = 0.05;
const EDGE_LIGHT: f32 = 0.6;
/// Rays along each edge of a pixel.
const RAYS: u32 = 2;

/// Shows `found` against `exact`, as sRGB, row by row from the top.
pub fn voxel_set_picture(
    found: &VoxelSet,
    exact: &VoxelSet,
    camera: &Camera,
    size: UVec2,
) -> Vec<[u8; 3]> {
    let grid = exact.grid();
    let mut cells = Cells::new(grid.dimensions);
    for voxel in found.voxels().iter().chain(exact.voxels()) {
        cells.insert(morton_decode(voxel.morton));
    }
    let view = Rays::new(camera, grid, size);
    let shade = |hit: &Hit| {
        let morton = morton_encode(hit.cell);
        let color = match (found.get(morton), exact.get(morton)) {
            (Some(own), Some(_)) => reflectance(own),
            (Some(_), None) => EXTRA_COLOR,
            (None, _) => MISSING_COLOR,
        };
        color * SIDES[hit.axis] * outline(hit, view.pixel_slope)
    };
    let mut picture = Vec::with_capacity((size.x * size.y) as usize);
    for y in 0..size.y {
        for x in 0..size.x {
            let mut sum = Vec3::ZERO;
            for ray in 0..RAYS * RAYS {
                let within = UVec2::new(ray % RAYS, ray / RAYS).as_dvec2() + 0.5;
                let at = UVec2::new(x, y).as_dvec2() + within / f64::from(RAYS);
                sum += cells
                    .first(view.origin, view.direction(at))
                    .map_or(BACKGROUND, |hit| shade(&hit));
            }
            let color = sum / (RAYS * RAYS) as f32;
            picture.push(color.to_array().map(|c| (srgb_encode(c) * 255.0).round() as u8));
        }
    }
    picture
}

fn reflectance(voxel: &Voxel) -> Vec3 {
    if voxel.area > 0.0 { voxel.reflectance } else { BARE_COLOR }
}

/// The outline as in the renderer's voxel view: darker near the edges of a side; fades out where a
/// pixel is several times as wide.
fn outline(hit: &Hit, pixel_slope: f64) -> f32 {
    let from_corner = hit.position - hit.position.floor();
    let mut to_edge = from_corner.min(1.0 - from_corner);
    to_edge[hit.axis] = 1.0;
    let pixel = hit.distance * pixel_slope;
    if to_edge.min_element() >= EDGE_WIDTH.max(0.5 * pixel) {
        return 1.0;
    }
    let strength = (1.5 - 5.0 * pixel).clamp(0.0, 1.0) as f32;
    1.0 + strength * (EDGE_LIGHT - 1.0)
}

/// The rays of a camera's pixels, in grid space.
struct Rays {
    origin: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    size: DVec2,
    /// Height of a pixel at a distance of 1.
    pixel_slope: f64,
}

impl Rays {
    fn new(camera: &Camera, grid: &Grid, size: UVec2) -> Self {
        let forward = camera.forward.as_dvec3().normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let size = size.as_dvec2();
        Self {
            origin: grid.grid_from_world(camera.position).as_dvec3(),
            forward,
            right,
            up: right.cross(forward),
            size,
            pixel_slope: 2.0 * (0.5 * f64::from(camera.vertical_fov_rad)).tan() / size.y,
        }
    }

    /// The direction through a position in pixels from the top left.
    fn direction(&self, at: DVec2) -> DVec3 {
        let from_middle = (at - 0.5 * self.size) * self.pixel_slope;
        (self.forward + from_middle.x * self.right - from_middle.y * self.up).normalize()
    }
}

/// A bit for every cell of the grid.
struct Cells {
    size: UVec3,
    bits: Vec<u64>,
}

/// The point at which a ray meets a cell.
struct Hit {
    cell: UVec3,
    /// The axis across which the ray enters.
    axis: usize,
    /// The distance in cells.
    distance: f64,
    position: DVec3,
}

impl Cells {
    fn new(size: UVec3) -> Self {
        let count = size.as_u64vec3().element_product();
        Self { size, bits: vec![0; count.div_ceil(64) as usize] }
    }

    fn place(&self, cell: UVec3) -> (usize, u32) {
        let cell = cell.as_u64vec3();
        let size = self.size.as_u64vec3();
        let index = cell.x + size.x * (cell.y + size.y * cell.z);
        ((index / 64) as usize, (index % 64) as u32)
    }

    fn insert(&mut self, cell: UVec3) {
        let (word, bit) = self.place(cell);
        self.bits[word] |= 1 << bit;
    }

    fn contains(&self, cell: UVec3) -> bool {
        let (word, bit) = self.place(cell);
        (self.bits[word] >> bit) & 1 == 1
    }

    /// The first cell of the set on a ray; `direction` has unit length.
    fn first(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let size = self.size.as_dvec3();
        // A direction parallel to a plane never crosses it; the infinities compare correctly.
        let (to_low, to_high) = (-origin / direction, (size - origin) / direction);
        let (enter, leave) = (to_low.min(to_high), to_low.max(to_high));
        let start = enter.max_element().max(0.0);
        if start.is_nan() || start >= leave.min_element() {
            return None;
        }
        let mut axis = if enter.x >= start {
            0
        } else if enter.y >= start {
            1
        } else {
            2
        };
        let entry = origin + start * direction;
        let mut cell = entry.floor().clamp(DVec3::ZERO, size - 1.0).as_ivec3();
        let forward = DVec3::select(direction.cmpge(DVec3::ZERO), DVec3::ONE, DVec3::NEG_ONE);
        let step = (1.0 / direction).abs();
        let mut next = (cell.as_dvec3() + forward.max(DVec3::ZERO) - origin) / direction;
        let mut distance = start;
        loop {
            let here = cell.as_uvec3();
            if self.contains(here) {
                let position = origin + distance * direction;
                return Some(Hit { cell: here, axis, distance, position });
            }
            axis = if next.x <= next.y && next.x <= next.z {
                0
            } else if next.y <= next.z {
                1
            } else {
                2
            };
            distance = next[axis];
            next[axis] += step[axis];
            cell[axis] += forward[axis] as i32;
            if cell[axis] < 0 || cell[axis] >= self.size[axis] as i32 {
                return None;
            }
        }
    }
}
