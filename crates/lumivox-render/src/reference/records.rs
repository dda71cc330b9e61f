//! The path tracer's structs in the GPU's layout (`world.wgsl`, `path.wgsl`).

use bytemuck::{Pod, Zeroable};

use crate::scene::{MaterialRecord, TEXTURE_COUNT};

/// The most peaks of a panorama.
pub(crate) const MOST_PEAKS: usize = 4;

/// `Tile`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct TileRecord {
    pub(crate) origin: [u32; 2],
    pub(crate) size: [u32; 2],
    pub(crate) layer: u32,
    pub(crate) bits: u32,
    pub(crate) padding: [u32; 2],
}

/// `TracedMaterial`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct TracedMaterialRecord {
    pub(crate) shown: MaterialRecord,
    pub(crate) tiles: [TileRecord; TEXTURE_COUNT],
    pub(crate) emitter_density: f32,
    pub(crate) phong_exponent: f32,
    pub(crate) padding: [u32; 2],
}

/// `Emitter`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct EmitterRecord {
    pub(crate) triangle: u32,
    pub(crate) cumulated: f32,
}

/// `Peak`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct PeakRecord {
    pub(crate) direction: [f32; 3],
    pub(crate) cos_cap: f32,
    pub(crate) around: [f32; 3],
    pub(crate) padding: f32,
}

/// `World`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct WorldRecord {
    pub(crate) camera: [f32; 3],
    pub(crate) near_m: f32,
    pub(crate) forward: [f32; 3],
    pub(crate) light_count: u32,
    pub(crate) right: [f32; 3],
    pub(crate) emitter_count: u32,
    pub(crate) up: [f32; 3],
    pub(crate) seed: u32,
    pub(crate) size: [u32; 2],
    pub(crate) first_row: u32,
    pub(crate) row_count: u32,
    pub(crate) environment: [f32; 3],
    pub(crate) most_bounces: u32,
    pub(crate) environment_turn: [f32; 2],
    pub(crate) peak_count: u32,
    pub(crate) occlusion_distance_m: f32,
    pub(crate) root: u32,
    pub(crate) offset_m: f32,
    pub(crate) first_sample: u32,
    pub(crate) sample_count: u32,
    pub(crate) peaks: [PeakRecord; MOST_PEAKS],
}

/// `Pixel`: sums over samples.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct PixelRecord {
    pub(crate) picture: [f32; 3],
    pub(crate) coverage: f32,
    pub(crate) direct: [f32; 3],
    pub(crate) depth_m: f32,
    pub(crate) one_bounce: [f32; 3],
    pub(crate) openness: f32,
    pub(crate) full: [f32; 3],
    pub(crate) padding_0: f32,
    pub(crate) albedo: [f32; 3],
    pub(crate) padding_1: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) padding_2: f32,
}
