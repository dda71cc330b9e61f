//! The draws of a scene: triangles, transforms, and the order in which the transforms are stored.

use std::collections::HashMap;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use lumivox_scene::{Bounds, Instance};

/// `DrawRecord` of `draws.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct DrawRecord {
    pub(crate) world_from_local: Mat4,
    pub(crate) normal_from_local: Mat4,
}

impl DrawRecord {
    pub(super) fn new(world_from_local: Mat4) -> Self {
        // Multiplied by the determinant's sign: mirroring must not turn normals inwards.
        let linear = glam::Mat3::from_mat4(world_from_local);
        let normal_from_local = Mat4::from_mat3(linear.inverse().transpose());
        Self { world_from_local, normal_from_local }
    }
}

/// A run of triangles with one material and one transform.
#[derive(Clone, Debug)]
pub struct SceneDraw {
    /// Its batch in [`GpuScene::batches`](super::GpuScene::batches).
    pub batch: usize,
    /// Its range in the batch's buffer of indices.
    pub indices: Range<u32>,
    /// The vertex that index 0 refers to.
    pub base_vertex: i32,
    /// Its material in [`GpuScene::materials`](super::GpuScene::materials).
    pub material: usize,
    /// Its transform.
    pub world_from_local: Mat4,
    /// Its bounds in the world.
    pub bounds: Bounds,
    /// Whether it is voxelized.
    pub is_voxelized: bool,
    /// Whether its transform reverses the winding of triangles.
    pub is_mirrored: bool,
    /// The index of its transform in `draw_records`; shaders refer to the draw by it.
    pub record: u32,
}

impl SceneDraw {
    /// Whether `other` has the same triangles, whatever its transform.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let triangles = |draw: &Self| (draw.batch, draw.indices.clone(), draw.base_vertex);
        triangles(self) == triangles(other) && self.record == other.record
    }
}

/// The parts of an instance.
#[derive(Clone, Debug)]
pub(super) struct InstanceParts {
    /// The instance's properties at upload, without its transform; `None` if it is hidden.
    pub(super) kind: Option<InstanceKind>,
    /// The range of the instance's draws in `draws`.
    pub(super) draws: Range<usize>,
    /// Batch and index in `geometry` of each draw, if they are voxelized.
    pub(super) voxelized: Vec<(usize, usize)>,
}

/// The properties of an instance that determine where its parts are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct InstanceKind {
    mesh: usize,
    material: usize,
    is_voxelized: bool,
    is_static: bool,
    is_mirrored: bool,
}

impl InstanceKind {
    /// The kind of an instance; `None` if it is hidden.
    pub(super) fn of(instance: &Instance) -> Option<Self> {
        (!instance.is_hidden).then(|| Self {
            mesh: instance.mesh,
            material: instance.material,
            is_voxelized: instance.is_voxelized,
            is_static: instance.is_static,
            is_mirrored: instance.world_from_local.determinant() < 0.0,
        })
    }
}

/// Numbers the records of draws so that draws which differ only in their transforms are adjacent.
/// Returns the runs of records, and for each record its draw.
pub(super) fn number_records(draws: &mut [SceneDraw]) -> (Vec<Range<u32>>, Vec<u32>) {
    let mut places = HashMap::new();
    let mut members: Vec<Vec<u32>> = Vec::new();
    for (number, draw) in (0..).zip(draws.iter()) {
        let key = (draw.batch, draw.indices.start, draw.base_vertex, draw.material);
        let key = (key, draw.is_mirrored, draw.indices.end);
        let place = *places.entry(key).or_insert_with(|| {
            members.push(Vec::new());
            members.len() - 1
        });
        members[place].push(number);
    }
    let mut runs = Vec::with_capacity(members.len());
    let mut order = Vec::with_capacity(draws.len());
    for members in members {
        let start = order.len() as u32;
        for number in members {
            draws[number as usize].record = order.len() as u32;
            order.push(number);
        }
        runs.push(start..order.len() as u32);
    }
    (runs, order)
}
