//! Shadow maps of parallel light around the camera: squares within the map of the whole scene, each
//! a quarter as wide as the one before, like cascades in engines (Engel 2006, "Cascaded shadow
//! maps"). They resolve the shadow of an object of a metre on a wide ground.
//!
//! They light visible pixels and follow the camera. The light of voxels uses the map of the whole
//! scene, so that it does not depend on the view, or the maps around the voxels' cascades. Where
//! both kinds cover a place, the finer one is used. A square is placed by the camera's cell, not by
//! the view direction: turning redraws nothing, and shadow edges do not crawl.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lumivox::gpu::{Buffer, Recorder, Texture, TextureView, upload};
use lumivox::{Lights, ShadowLayer};
use lumivox_scene::ShadowMapFineness;

use super::shadow_layers::ParallelSight;
use super::shadow_maps::{ShadowMapPass, depth_array, view_of_all};
use crate::Gpu;
use crate::scene::GpuScene;

/// The most squares of a light: the smallest is 1/64 as wide as the scene.
pub(crate) const SQUARES: u32 = 3;
/// The most lights that have squares.
const MOST_SUNS: usize = 16;
/// The most memory of all squares.
pub(crate) const MAX_NEAR_BYTES: u64 = 64 << 20;
/// The edge of a square divided by that of the next smaller one.
const STEP: f32 = 4.0;
/// The edge of the cells that a square snaps to, as a share of half the square's edge.
const CELL: f32 = 0.25;

/// The fineness of a scene's maps at a resolution.
pub(crate) fn fineness(resolution: u32) -> ShadowMapFineness {
    ShadowMapFineness { resolution, squares: SQUARES, step: STEP, reach_m: None }
}

/// `NearLayer` of `direct.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct NearLayerRecord {
    clip_from_world: Mat4,
    texel_size: f32,
    light: u32,
    padding: [u32; 2],
}

/// The squares of all parallel lights.
#[derive(Debug)]
pub(crate) struct NearShadows {
    texture: Texture,
    pub(crate) maps: TextureView,
    pub(crate) layers: Buffer,
    /// The lights that have squares, with their direction.
    suns: Vec<(u32, Vec3)>,
    /// The squares that the layers of the texture show.
    drawn: Vec<NearLayerRecord>,
    resolution: u32,
}

impl NearShadows {
    /// Allocates the squares of parallel lights that have shadow maps, without drawing them.
    pub(crate) fn new(gpu: &Gpu, lights: &Lights) -> Self {
        let suns =
            lights.mapped.iter().filter_map(|l| Some((l.index, l.source.parallel_direction()?)));
        let suns: Vec<_> = suns.take(MOST_SUNS).collect();
        // Within the memory limit, more lights have coarser maps.
        let mut resolution = lights.map_size[0].max(1);
        let bytes = |edge: u32| 4 * u64::from(edge).pow(2) * u64::from(SQUARES) * suns.len() as u64;
        while bytes(resolution) > MAX_NEAR_BYTES {
            resolution /= 2;
        }
        let edge = if suns.is_empty() { 1 } else { resolution };
        // Bound resources may not be empty.
        let count = (SQUARES * suns.len() as u32).max(1);
        let texture = depth_array(&gpu.device, "shadow maps around the camera", edge, count);
        let none = vec![NearLayerRecord::of_none(); count as usize];
        Self {
            maps: view_of_all(&texture),
            layers: upload(&gpu.device, "shadow layers around the camera", &none),
            texture,
            suns,
            drawn: Vec::new(),
            resolution,
        }
    }

    /// Bytes of the maps.
    pub(crate) fn bytes(&self) -> u64 {
        4 * u64::from(self.resolution).pow(2) * u64::from(SQUARES) * self.suns.len() as u64
    }

    /// Draws the squares around a camera, unless they are drawn already.
    pub(crate) fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        pass: &ShadowMapPass,
        scene: &GpuScene,
        camera: Vec3,
    ) {
        if self.suns.is_empty() {
            return;
        }
        let mut wanted = Vec::new();
        for &(light, direction) in &self.suns {
            let sight = ParallelSight::new(direction, scene.bounds);
            let away_m = camera.distance(camera.clamp(scene.bounds.min, scene.bounds.max));
            let squares = squares(&sight, camera, away_m, self.resolution);
            wanted.extend(squares.map(|layer| NearLayerRecord::new(light, &layer)));
        }
        wanted.resize(SQUARES as usize * self.suns.len(), NearLayerRecord::of_none());
        if wanted == self.drawn {
            return;
        }
        recorder.stage("shadow maps");
        gpu.queue.write_buffer(&self.layers, 0, bytemuck::cast_slice(&wanted));
        for (index, record) in wanted.iter().enumerate() {
            if self.drawn.get(index) != Some(record) && record.light != u32::MAX {
                let layer = (index as u32, &record.layer());
                pass.record_layer(gpu, recorder, scene, &self.texture, layer);
            }
        }
        self.drawn = wanted;
    }
}

impl NearLayerRecord {
    /// The record of an unused layer; no light has this index.
    fn of_none() -> Self {
        Self { light: u32::MAX, ..Self::zeroed() }
    }

    fn new(light: u32, layer: &ShadowLayer) -> Self {
        let ShadowLayer { clip_from_world, texel_size, .. } = *layer;
        Self { clip_from_world, texel_size, light, padding: [0; 2] }
    }

    fn layer(&self) -> ShadowLayer {
        let Self { clip_from_world, texel_size, .. } = *self;
        ShadowLayer { clip_from_world, is_perspective: false, texel_size, has_finer: false }
    }
}

/// The squares around a camera, the smallest first. Squares whose half edge is less than `away_m`,
/// the camera's distance from the scene, are left out: no surface is that near.
fn squares(
    sight: &ParallelSight,
    camera: Vec3,
    away_m: f32,
    resolution: u32,
) -> impl Iterator<Item = ShadowLayer> {
    let middle = sight.view.transform_point3(camera).truncate();
    (1..=SQUARES as i32).rev().filter_map(move |level| {
        let half_m = sight.half_m / STEP.powi(level);
        // Enlarged, as the camera may be off the centre of its cell.
        let square = |middle| sight.layer(middle, half_m * (1.0 + 0.5 * CELL), resolution);
        let texel_m = square(middle).texel_size;
        let cell_m = texel_m * (CELL * half_m / texel_m).floor().max(1.0);
        (half_m >= away_m).then(|| square(cell_m * (middle / cell_m).round()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_scene::Bounds;

    const BOUNDS: Bounds =
        Bounds { min: Vec3::new(-80.0, 0.0, -80.0), max: Vec3::new(80.0, 1.0, 80.0) };

    fn at(camera: Vec3, away_m: f32) -> Vec<ShadowLayer> {
        let sight = ParallelSight::new(Vec3::new(0.4, -1.0, 0.3).normalize(), BOUNDS);
        squares(&sight, camera, away_m, 1024).collect()
    }

    #[test]
    fn near_shadow_layers_surround_the_camera_and_get_finer() {
        let camera = Vec3::new(20.0, 1.5, -31.0);
        let layers = at(camera, 0.0);
        assert_eq!(layers.len(), 3);
        for (layer, reach_m) in layers.iter().zip([1.2, 5.0, 20.0]) {
            for side in [Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z] {
                let ndc = layer.clip_from_world.project_point3(camera + reach_m * side);
                assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0, "{ndc}");
            }
            assert!(layer.texel_size < reach_m / 300.0, "{}", layer.texel_size);
        }
        assert!(layers[0].texel_size < layers[1].texel_size);
    }

    #[test]
    fn small_camera_steps_do_not_move_near_shadow_layers() {
        let camera = Vec3::new(20.1, 1.5, -31.2);
        // The camera moves a quarter of a metre; cells have edges of two fifths.
        let steps = (0..64).map(|step| at(camera + Vec3::X * 0.004 * step as f32, 0.0)[0]);
        let mut squares: Vec<ShadowLayer> = steps.collect();
        squares.dedup();
        assert!(squares.len() <= 3, "{}", squares.len());
        assert_ne!(at(camera + Vec3::X, 0.0)[0], at(camera, 0.0)[0]);
    }

    #[test]
    fn distant_cameras_draw_only_wide_near_shadow_layers() {
        let camera = Vec3::Y * 20.0;
        assert_eq!(at(camera, 19.0).len(), 1);
        assert_eq!(at(camera, 400.0).len(), 0);
    }
}
