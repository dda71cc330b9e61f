//! Streaming of vertices by distance, for scenes that exceed the GPU's geometry budget.
//!
//! The scene is packed into small batches, whose content stays in main memory. The batches nearest
//! to the camera are on the GPU, as many as the budget allows. Draws of the others are empty, so
//! that they are neither drawn nor voxelized: missing batches cast no shadows and send no light.

use std::ops::Range;

use glam::Vec3;
use lumivox::GeometryBatch;

use super::geometry::{Batch, BatchLimits, Shading};
use super::{GpuScene, SceneDraw, VertexBuffers};
use crate::Gpu;

/// Limits of a batch: a few hundred KiB, small enough to upload within a frame.
const PART: BatchLimits = BatchLimits { vertices: 8192, indices: 3 * 16_384 };

/// The factor on the distance of a batch that is on the GPU, so that a trembling camera does not
/// load and unload batches.
const STICKING: f32 = 0.8;

/// The fingerprint of a batch that is not on the GPU.
const ABSENT: [u64; 2] = [0; 2];

/// The GPU memory for a scene's geometry, and the camera's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeometryBudget {
    /// The most bytes of vertices and indices.
    pub bytes: u64,
    /// The position of the camera, m.
    pub camera: Vec3,
}

/// How much of a scene is on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StreamedGeometry {
    /// Bytes of all vertices and indices.
    pub bytes: u64,
    /// Bytes of the vertices and indices on the GPU.
    pub resident_bytes: u64,
    /// Triangles of all meshes, each counted once.
    pub triangles: u64,
    /// Triangles on the GPU.
    pub resident_triangles: u64,
    /// Whether batches that fit into the budget are still to be uploaded.
    pub is_late: bool,
}

/// A scene's batches, some of which are on the GPU.
#[derive(Debug)]
pub(super) struct Streaming {
    budget: GeometryBudget,
    parts: Vec<Part>,
    is_late: bool,
}

#[derive(Debug)]
struct Part {
    content: Batch,
    fingerprint: [u64; 2],
    is_resident: bool,
    /// Draws of the batch: their indices in the scene, and their index ranges while the batch is on
    /// the GPU.
    draws: Vec<(usize, Range<u32>)>,
    /// The index counts of the batch's voxelized draws, in order.
    voxelized: Vec<u32>,
}

impl Part {
    fn bytes(&self) -> u64 {
        let Batch { positions, attribute_bytes, shading, indices, .. } = &self.content;
        let vertices = size_of_val(positions.as_slice()) + positions.len() * size_of::<Shading>();
        debug_assert_eq!(shading.len(), positions.len());
        (vertices + attribute_bytes.len() + size_of_val(indices.as_slice())) as u64
    }

    fn triangles(&self) -> u64 {
        self.content.indices.len() as u64 / 3
    }
}

impl GeometryBudget {
    /// Limits the size of streamed batches.
    pub(super) fn limits(all: BatchLimits) -> BatchLimits {
        BatchLimits {
            vertices: all.vertices.min(PART.vertices),
            indices: all.indices.min(PART.indices),
        }
    }

    /// Buffers of a batch that is not on the GPU.
    pub(super) fn absent(device: &wgpu::Device, batch: &Batch) -> VertexBuffers {
        VertexBuffers::new(device, &Batch { kind: batch.kind, ..Batch::default() }, ABSENT)
    }
}

impl Streaming {
    /// Creates the streaming state for packed batches and their current buffers.
    pub(super) fn new(
        budget: GeometryBudget,
        packed: Vec<(Batch, [u64; 2])>,
        buffers: &[VertexBuffers],
        (draws, geometry): (&mut [SceneDraw], &mut [GeometryBatch]),
    ) -> Self {
        let mut parts: Vec<Part> = packed
            .into_iter()
            .zip(buffers)
            .map(|((content, fingerprint), buffers)| Part {
                content,
                fingerprint,
                is_resident: buffers.fingerprint == fingerprint,
                draws: Vec::new(),
                voxelized: Vec::new(),
            })
            .collect();
        for (number, draw) in draws.iter_mut().enumerate() {
            let part = &mut parts[draw.batch];
            part.draws.push((number, draw.indices.clone()));
            if !part.is_resident {
                draw.indices = 0..0;
            }
        }
        for (part, batch) in parts.iter_mut().zip(geometry) {
            part.voxelized = batch.draws.iter().map(|draw| draw.index_count).collect();
            if !part.is_resident {
                batch.draws.iter_mut().for_each(|draw| draw.index_count = 0);
            }
        }
        Self { budget, parts, is_late: true }
    }

    /// All batches, nearest first.
    fn by_distance(&self, draws: &[SceneDraw]) -> Vec<usize> {
        let camera = self.budget.camera;
        let distance = |part: &Part| {
            let to = |(number, _): &(usize, Range<u32>)| {
                let bounds = draws[*number].bounds;
                camera.distance_squared(camera.clamp(bounds.min, bounds.max))
            };
            let nearest = part.draws.iter().map(to).fold(f32::INFINITY, f32::min).sqrt();
            if part.is_resident { STICKING * nearest } else { nearest }
        };
        let distances: Vec<f32> = self.parts.iter().map(distance).collect();
        let mut order: Vec<usize> = (0..self.parts.len()).collect();
        order.sort_by(|a, b| distances[*a].total_cmp(&distances[*b]));
        // A batch without draws is never loaded.
        order.retain(|part| distances[*part].is_finite());
        order
    }

    /// The nearest batches that fit into the budget, nearest first.
    fn wanted(&self, draws: &[SceneDraw]) -> Vec<usize> {
        let mut left = self.budget.bytes;
        let fits = |part: &usize| {
            let bytes = self.parts[*part].bytes();
            let fits = bytes <= left;
            left = left.saturating_sub(bytes);
            fits
        };
        self.by_distance(draws).into_iter().take_while(fits).collect()
    }

    fn figures(&self) -> StreamedGeometry {
        let all = StreamedGeometry { is_late: self.is_late, ..StreamedGeometry::default() };
        self.parts.iter().fold(all, |mut sum, part| {
            let (bytes, triangles) = (part.bytes(), part.triangles());
            sum.bytes += bytes;
            sum.triangles += triangles;
            if part.is_resident {
                sum.resident_bytes += bytes;
                sum.resident_triangles += triangles;
            }
            sum
        })
    }
}

impl GpuScene {
    /// Loads and unloads batches for a camera position. Uploads about `most_bytes` at most, but at
    /// least one batch. Returns whether any batch was loaded or unloaded.
    pub(crate) fn stream(&mut self, gpu: &Gpu, camera: Vec3, most_bytes: u64) -> bool {
        let Some(mut streaming) = self.streaming.take() else { return false };
        if streaming.budget.camera == camera && !streaming.is_late {
            self.streaming = Some(streaming);
            return false;
        }
        streaming.budget.camera = camera;
        let wanted = streaming.wanted(&self.draws);
        let mut is_wanted = vec![false; streaming.parts.len()];
        for part in &wanted {
            is_wanted[*part] = true;
        }
        let mut has_changed = false;
        for (number, part) in streaming.parts.iter_mut().enumerate() {
            if part.is_resident && !is_wanted[number] {
                self.hold(gpu, number, part, false);
                has_changed = true;
            }
        }
        let (mut uploaded, mut is_late) = (0, false);
        for number in wanted {
            let part = &mut streaming.parts[number];
            if part.is_resident {
                continue;
            }
            is_late = uploaded >= most_bytes;
            if is_late {
                break;
            }
            uploaded += part.bytes();
            self.hold(gpu, number, part, true);
            has_changed = true;
        }
        streaming.is_late = is_late;
        self.memory[0].bytes = self.batches.iter().map(VertexBuffers::bytes).sum();
        self.streaming = Some(streaming);
        has_changed
    }

    /// Loads a batch to the GPU, or unloads it.
    fn hold(&mut self, gpu: &Gpu, number: usize, part: &mut Part, is_resident: bool) {
        part.is_resident = is_resident;
        self.batches[number] = if is_resident {
            VertexBuffers::new(&gpu.device, &part.content, part.fingerprint)
        } else {
            GeometryBudget::absent(&gpu.device, &part.content)
        };
        for (draw, indices) in &part.draws {
            self.draws[*draw].indices = if is_resident { indices.clone() } else { 0..0 };
        }
        let draws = std::mem::take(&mut self.geometry.batches[number].draws);
        let mut batch = self.batches[number].for_voxels();
        batch.draws = draws;
        for (draw, index_count) in batch.draws.iter_mut().zip(&part.voxelized) {
            draw.index_count = if is_resident { *index_count } else { 0 };
        }
        self.geometry.batches[number] = batch;
    }

    /// How much of the scene is on the GPU; `None` if there is no budget, so all of it.
    pub(crate) fn streamed(&self) -> Option<StreamedGeometry> {
        self.streaming.as_ref().map(Streaming::figures)
    }

    /// Whether batches are still to be uploaded.
    pub(crate) fn is_streaming(&self) -> bool {
        self.streaming.as_ref().is_some_and(|streaming| streaming.is_late)
    }

    /// The budget, if there is one.
    pub(super) fn budget(&self) -> Option<GeometryBudget> {
        self.streaming.as_ref().map(|streaming| streaming.budget)
    }
}
