//! Skinned and morphed meshes: computes their vertex positions as Bevy's vertex shader does.

use bevy::ecs::entity::EntityHashMap;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy::render::Extract;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer, upload,
};
use lumivox::{GiError, wgpu};

use crate::settings::{LumivoxGi, NotInGi};

/// Offset of the joints if a mesh has none.
pub(crate) const NO_JOINTS: u32 = u32::MAX;

/// `Deformation` of `deform.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Deformation {
    pub(crate) vertex_count: u32,
    pub(crate) first_vertex: u32,
    pub(crate) stride: u32,
    pub(crate) position: u32,
    pub(crate) joint_indices: u32,
    pub(crate) joint_weights: u32,
    first_joint: u32,
    pub(crate) first_target: u32,
    pub(crate) target_count: u32,
    first_weight: u32,
    first_position: u32,
    padding: u32,
}

impl Deformation {
    /// Vertices of a slab, without joints or morph targets. Stride and position are in 32-bit
    /// words.
    pub(crate) fn new(vertex_count: u32, first_vertex: u32, stride: u32, position: u32) -> Self {
        Self {
            vertex_count,
            first_vertex,
            stride,
            position,
            joint_indices: NO_JOINTS,
            joint_weights: NO_JOINTS,
            first_joint: 0,
            first_target: 0,
            target_count: 0,
            first_weight: 0,
            first_position: 0,
            padding: 0,
        }
    }
}

/// The joints and weights of all meshes that have any, in the render world.
///
/// Bevy extracts only the joints of meshes that a camera or a shadow map sees. Lumivox needs all,
/// since light comes from behind a camera as well.
#[derive(Resource, Default)]
pub(crate) struct ScenePoses {
    first_joints: EntityHashMap<u32>,
    joints: Vec<Mat4>,
    /// Index of a mesh's first weight, and their number.
    weight_ranges: EntityHashMap<(u32, u32)>,
    weights: Vec<f32>,
}

/// Reads the joints and weights of all meshes that are neither hidden nor marked [`NotInGi`].
pub(crate) fn extract_poses(
    mut poses: ResMut<ScenePoses>,
    cameras: Extract<Query<(), With<LumivoxGi>>>,
    skins: Extract<Query<(Entity, &SkinnedMesh, &InheritedVisibility), Without<NotInGi>>>,
    inverse_bindposes: Extract<Res<Assets<SkinnedMeshInverseBindposes>>>,
    joints: Extract<Query<&GlobalTransform>>,
    morphs: Extract<Query<(Entity, &MeshMorphWeights, &InheritedVisibility), Without<NotInGi>>>,
    shared: Extract<Query<&MorphWeights>>,
) {
    let poses = &mut *poses;
    poses.first_joints.clear();
    poses.joints.clear();
    poses.weight_ranges.clear();
    poses.weights.clear();
    if cameras.is_empty() {
        return;
    }
    for (entity, skin, _) in skins.iter().filter(|(_, _, visibility)| visibility.get()) {
        poses.first_joints.insert(entity, poses.joints.len() as u32);
        let inverses = inverse_bindposes.get(&skin.inverse_bindposes);
        // As in Bevy, a missing joint or inverse bind pose leaves vertices where they are.
        poses.joints.extend(skin.joints.iter().enumerate().map(|(number, joint)| {
            let inverse = inverses.and_then(|inverses| inverses.get(number));
            let joint = joints.get(*joint).ok();
            joint.zip(inverse).map_or(Mat4::IDENTITY, |(joint, inverse)| joint.affine() * *inverse)
        }));
    }
    for (entity, weights, _) in morphs.iter().filter(|(_, _, visibility)| visibility.get()) {
        let weights = match weights {
            MeshMorphWeights::Value { weights } => weights.as_slice(),
            MeshMorphWeights::Reference(other) => {
                shared.get(*other).map(MorphWeights::weights).unwrap_or_default()
            }
        };
        let range = (poses.weights.len() as u32, weights.len() as u32);
        poses.weight_ranges.insert(entity, range);
        poses.weights.extend_from_slice(weights);
    }
}

/// A mesh that is deformed in each frame.
struct Job {
    entity: Entity,
    deformation: Deformation,
    uniform: Buffer,
    group: BindGroup,
}

/// A mesh to be deformed.
pub(crate) struct Wanted {
    pub(crate) entity: Entity,
    pub(crate) vertices: wgpu::Buffer,
    pub(crate) targets: Option<wgpu::Buffer>,
    pub(crate) deformation: Deformation,
}

/// All deformed meshes.
#[derive(Resource, Default)]
pub(crate) struct Deformer {
    wanted: Vec<Wanted>,
    jobs: Vec<Job>,
    kernel: Option<(Kernel, wgpu::BindGroupLayout)>,
    positions: Option<Buffer>,
    position_count: u32,
    joints: Option<Buffer>,
    weights: Option<Buffer>,
    known_joints: Vec<Mat4>,
    known_weights: Vec<f32>,
    is_due: bool,
}

impl Deformer {
    pub(crate) fn clear(&mut self) {
        self.wanted.clear();
        self.jobs.clear();
        self.position_count = 0;
    }

    /// Queues a mesh, and returns the index of its first position.
    pub(crate) fn add(&mut self, mut wanted: Wanted) -> u32 {
        let first = self.position_count;
        wanted.deformation.first_position = first;
        self.position_count += wanted.deformation.vertex_count;
        self.wanted.push(wanted);
        first
    }

    /// The output buffer of all queued meshes, three `f32` per vertex; `None` if there are none.
    pub(crate) fn positions(&mut self, device: &wgpu::Device) -> Option<wgpu::Buffer> {
        if self.position_count == 0 {
            return None;
        }
        let bytes = 12 * u64::from(self.position_count);
        if self.positions.as_ref().is_none_or(|positions| positions.size() < bytes) {
            self.positions =
                Some(storage_buffer(device, "deformed positions", bytes.next_power_of_two()));
        }
        self.positions.as_ref().map(|positions| (**positions).clone())
    }

    /// Uploads the joints and weights of a frame; returns whether meshes have to be deformed again.
    pub(crate) fn follow(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        poses: &ScenePoses,
    ) -> bool {
        if self.wanted.is_empty() {
            return false;
        }
        let (gpu, jobs) = ((device, queue), &mut self.jobs);
        let (joints, known) = (("joints", poses.joints.as_slice()), &mut self.known_joints);
        let mut has_moved = follow(gpu, joints, known, &mut self.joints, jobs);
        let (weights, known) =
            (("morph weights", poses.weights.as_slice()), &mut self.known_weights);
        has_moved |= follow(gpu, weights, known, &mut self.weights, jobs);
        for job in &mut self.jobs {
            let deformation = job.deformation.of_frame(job.entity, poses);
            if deformation != job.deformation {
                job.deformation = deformation;
                queue.write_buffer(&job.uniform, 0, bytemuck::bytes_of(&deformation));
                has_moved = true;
            }
        }
        self.is_due |= has_moved || self.jobs.is_empty();
        self.is_due
    }

    /// Records the deformation of all meshes, if anything has moved.
    pub(crate) fn record(
        &mut self,
        pipelines: &Pipelines,
        recorder: &mut Recorder<'_>,
        poses: &ScenePoses,
    ) -> Result<(), GiError> {
        if !std::mem::take(&mut self.is_due) {
            return Ok(());
        }
        self.plan(pipelines, poses)?;
        let Some((kernel, _)) = &self.kernel else { return Ok(()) };
        recorder.stage("deform");
        for job in &self.jobs {
            kernel.run(recorder, &[&job.group], [job.deformation.vertex_count, 1, 1]);
        }
        Ok(())
    }

    /// Creates the bind groups of the queued meshes, if there are none.
    fn plan(&mut self, pipelines: &Pipelines, poses: &ScenePoses) -> Result<(), GiError> {
        if !self.jobs.is_empty() {
            return Ok(());
        }
        if self.kernel.is_none() {
            let mut layout = LayoutBuilder::compute();
            for _ in 0..5 {
                layout = layout.storage();
            }
            let layout = layout.storage_mut().build(pipelines, "deform");
            let mut library = ShaderLibrary::default();
            library
                .add("bevy::deform", include_str!("deform.wgsl"))
                .constant_u32("NO_JOINTS", NO_JOINTS);
            let kernel = Kernel::new(pipelines, &library, "bevy::deform", "main", &[&layout])?;
            self.kernel = Some((kernel, layout));
        }
        let (Some((_, layout)), Some(joints), Some(weights), Some(positions)) =
            (&self.kernel, &self.joints, &self.weights, &self.positions)
        else {
            return Ok(());
        };
        for Wanted { entity, vertices, targets, deformation } in &self.wanted {
            let deformation = deformation.of_frame(*entity, poses);
            let uniform = upload(pipelines.device(), "deformation", &[deformation]);
            let targets = targets.as_ref().unwrap_or(weights);
            let group = BindGroupBuilder::new(layout)
                .buffer(&uniform)
                .resource(vertices.as_entire_binding())
                .buffer(joints)
                .resource(targets.as_entire_binding())
                .buffer(weights)
                .buffer(positions)
                .build(pipelines.device(), "deform");
            self.jobs.push(Job { entity: *entity, deformation, uniform, group });
        }
        Ok(())
    }
}

impl Deformation {
    /// A copy with the offsets of a frame's joints and weights.
    fn of_frame(mut self, entity: Entity, poses: &ScenePoses) -> Self {
        self.first_joint = poses.first_joints.get(&entity).copied().unwrap_or_default();
        let (first, count) = poses.weight_ranges.get(&entity).copied().unwrap_or_default();
        (self.first_weight, self.target_count) = (first, self.target_count.min(count));
        self
    }
}

/// Uploads a list if it has changed, and returns whether it has. If the buffer has to grow, all
/// jobs are dropped, since they bind the old one.
fn follow<T: bytemuck::Pod + PartialEq>(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    (label, now): (&'static str, &[T]),
    known: &mut Vec<T>,
    buffer: &mut Option<Buffer>,
    jobs: &mut Vec<Job>,
) -> bool {
    if buffer.is_some() && known == now {
        return false;
    }
    known.clear();
    known.extend_from_slice(now);
    let bytes: &[u8] = bytemuck::cast_slice(now);
    if buffer.as_ref().is_none_or(|buffer| buffer.size() < bytes.len() as u64) {
        let room = (bytes.len() as u64).next_power_of_two().max(64);
        *buffer = Some(storage_buffer(device, label, room));
        jobs.clear();
    }
    if let Some(buffer) = buffer {
        queue.write_buffer(buffer, 0, bytes);
    }
    true
}
