//! The mesh instances of the world: extracted when they change, stored in stable slots.
//!
//! A frame without changes costs nothing here. A mesh that has not changed for [`REST_FRAMES`] is
//! static, and its voxels are kept; a mesh that moves is dynamic from that frame on. Each switch
//! makes Lumivox walk all static triangles again, so switches to static are batched.

use bevy::asset::UntypedAssetId;
use bevy::camera::primitives::Aabb;
use bevy::ecs::entity::EntityHashMap;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::render::Extract;
use std::any::TypeId;

use crate::scene::material::LumivoxMaterial;
use crate::settings::NotInGi;

/// Frames without a change after which a mesh is static.
const REST_FRAMES: u32 = 30;
/// Frames for which mesh locations are looked up again after meshes change.
const UNSETTLED_FRAMES: u32 = 4;
/// Frames between searches for meshes at rest.
const SWEEP_FRAMES: u32 = 10;

/// A mesh in the world.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) entity: Entity,
    pub(crate) mesh: AssetId<Mesh>,
    pub(crate) material: UntypedAssetId,
    pub(crate) world_from_local: Mat4,
    pub(crate) bounds: Option<Aabb>,
    /// Whether joints move its vertices.
    pub(crate) is_skinned: bool,
    /// Whether morph targets move its vertices.
    pub(crate) is_morphed: bool,
    pub(crate) is_static: bool,
    /// The frame of its last change.
    changed: u32,
}

impl Instance {
    pub(crate) fn deforms(&self) -> bool {
        self.is_skinned || self.is_morphed
    }
}

/// All instances, and what has changed since the last frame.
#[derive(Resource, Default)]
pub(crate) struct Instances {
    slots: Vec<Option<Instance>>,
    free: Vec<usize>,
    by_entity: EntityHashMap<usize>,
    frame: u32,
    /// Whether instances were added or removed, or changed their mesh, material or static mark: all
    /// draws are then rebuilt.
    pub(crate) is_restructured: bool,
    /// Slots whose transform has changed.
    pub(crate) moved: Vec<usize>,
    /// Frames for which mesh locations may still change: Bevy uploads only some meshes per frame.
    unsettled: u32,
}

impl Instances {
    /// All instances with their slots, in a stable order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &Instance)> {
        self.slots.iter().enumerate().filter_map(|(slot, held)| Some((slot, held.as_ref()?)))
    }

    pub(crate) fn get(&self, slot: usize) -> Option<&Instance> {
        self.slots.get(slot)?.as_ref()
    }

    /// Whether mesh locations may have changed.
    pub(crate) fn is_unsettled(&self) -> bool {
        self.unsettled > 0
    }

    /// Marks everything as changed, for the next frame that applies changes.
    pub(crate) fn skip(&mut self) {
        self.is_restructured = true;
        self.moved.clear();
        self.unsettled = UNSETTLED_FRAMES;
    }

    /// Clears the changes once they are applied.
    pub(crate) fn take_changes(&mut self) {
        self.is_restructured = false;
        self.moved.clear();
        self.unsettled = self.unsettled.saturating_sub(1);
    }

    /// The number of instances, and of slots.
    #[cfg(test)]
    pub(crate) fn counts(&self) -> [usize; 2] {
        [self.by_entity.len(), self.slots.len()]
    }

    /// The box around all instances.
    pub(crate) fn bounds(&self) -> Option<[Vec3; 2]> {
        let mut around: Option<[Vec3; 2]> = None;
        for (_, instance) in self.iter() {
            let Some(bounds) = &instance.bounds else { continue };
            let (center, half) = (Vec3::from(bounds.center), Vec3::from(bounds.half_extents));
            let axes = Mat3::from_mat4(instance.world_from_local);
            let reach = axes.x_axis.abs() * half.x
                + axes.y_axis.abs() * half.y
                + axes.z_axis.abs() * half.z;
            let center = instance.world_from_local.transform_point3(center);
            let [min, max] = around.unwrap_or([Vec3::INFINITY, Vec3::NEG_INFINITY]);
            if center.is_finite() && reach.is_finite() {
                around = Some([min.min(center - reach), max.max(center + reach)]);
            }
        }
        around
    }

    fn set(&mut self, given: Instance) {
        let Some(&slot) = self.by_entity.get(&given.entity) else {
            let slot = self.free.pop().unwrap_or(self.slots.len());
            self.by_entity.insert(given.entity, slot);
            if slot == self.slots.len() {
                self.slots.push(Some(given));
            } else {
                self.slots[slot] = Some(given);
            }
            self.is_restructured = true;
            return;
        };
        let Some(known) = self.slots[slot].as_mut() else { return };
        known.bounds = given.bounds;
        let is_same = known.mesh == given.mesh
            && known.material == given.material
            && known.is_skinned == given.is_skinned
            && known.is_morphed == given.is_morphed;
        if is_same && known.world_from_local == given.world_from_local {
            return;
        }
        known.changed = self.frame;
        self.is_restructured |= !is_same || known.is_static;
        *known = Instance { is_static: false, ..given };
        self.moved.push(slot);
    }

    fn remove(&mut self, entity: Entity) {
        if let Some(slot) = self.by_entity.remove(&entity) {
            self.slots[slot] = None;
            self.free.push(slot);
            self.is_restructured = true;
        }
    }

    /// Notes that the vertices of a mesh have changed.
    fn touch(&mut self, mesh: AssetId<Mesh>) {
        for instance in self.slots.iter_mut().flatten().filter(|instance| instance.mesh == mesh) {
            (instance.is_static, instance.changed) = (false, self.frame);
            self.is_restructured = true;
        }
    }

    /// Marks meshes as static that have not changed for a while.
    fn sweep(&mut self) {
        if !self.frame.is_multiple_of(SWEEP_FRAMES) {
            return;
        }
        let frame = self.frame;
        let rests = |instance: &&mut Instance| {
            !instance.is_static
                && !instance.deforms()
                && frame.wrapping_sub(instance.changed) >= REST_FRAMES
        };
        for instance in self.slots.iter_mut().flatten().filter(rests) {
            instance.is_static = true;
            self.is_restructured = true;
        }
        // Frees the memory once there are no instances.
        if self.by_entity.is_empty() {
            (self.slots, self.free) = (Vec::new(), Vec::new());
        }
    }
}

/// Starts a frame, and notes meshes with new vertices.
pub(crate) fn begin_instances(
    mut instances: ResMut<Instances>,
    mut meshes: Extract<MessageReader<AssetEvent<Mesh>>>,
) {
    instances.frame = instances.frame.wrapping_add(1);
    for event in meshes.read() {
        instances.unsettled = UNSETTLED_FRAMES;
        if let AssetEvent::Modified { id } = event {
            instances.touch(*id);
        }
    }
    instances.sweep();
}

/// The components that are read of an entity.
type Read<M> = (
    Entity,
    &'static Mesh3d,
    &'static MeshMaterial3d<M>,
    &'static GlobalTransform,
    &'static InheritedVisibility,
    Option<&'static Aabb>,
    Has<SkinnedMesh>,
    Has<MeshMorphWeights>,
    Has<NotInGi>,
);

/// Extracts meshes with one type of material.
pub(crate) fn extract_instances<M: LumivoxMaterial>(
    mut instances: ResMut<Instances>,
    changed: Extract<
        Query<
            Read<M>,
            Or<(
                Changed<Mesh3d>,
                Changed<MeshMaterial3d<M>>,
                Changed<GlobalTransform>,
                Changed<InheritedVisibility>,
                Changed<Aabb>,
                Changed<NotInGi>,
                Added<SkinnedMesh>,
                Added<MeshMorphWeights>,
            )>,
        >,
    >,
    all: Extract<Query<Read<M>>>,
    mut without_mesh: Extract<RemovedComponents<Mesh3d>>,
    mut without_material: Extract<RemovedComponents<MeshMaterial3d<M>>>,
    mut without_mark: Extract<RemovedComponents<NotInGi>>,
    mut without_skin: Extract<RemovedComponents<SkinnedMesh>>,
    mut without_weights: Extract<RemovedComponents<MeshMorphWeights>>,
) {
    let instances = &mut *instances;
    for entity in without_mesh.read().chain(without_material.read()) {
        let slot = instances.by_entity.get(&entity);
        let known = slot.and_then(|slot| instances.slots[*slot].as_ref());
        // The entity may already have a material of another type.
        if known.is_some_and(|known| known.material.type_id() == TypeId::of::<M>()) {
            instances.remove(entity);
        }
    }
    let others = without_mark.read().chain(without_skin.read()).chain(without_weights.read());
    for read in changed.iter().chain(others.filter_map(|entity| all.get(entity).ok())) {
        let (entity, mesh, material, transform, visibility, bounds, is_skinned, is_morphed, is_out) =
            read;
        if !visibility.get() || is_out {
            instances.remove(entity);
            continue;
        }
        instances.set(Instance {
            entity,
            mesh: mesh.id(),
            material: material.id().untyped(),
            world_from_local: transform.to_matrix(),
            bounds: bounds.copied(),
            is_skinned,
            is_morphed,
            is_static: false,
            changed: instances.frame,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn instance(entity: u32, x: f32) -> Instance {
        Instance {
            entity: Entity::from_raw_u32(entity).expect("a number of an entity"),
            mesh: AssetId::default(),
            material: AssetId::<StandardMaterial>::default().untyped(),
            world_from_local: Mat4::from_translation(x * Vec3::X),
            bounds: Some(Aabb::from_min_max(Vec3::ZERO, Vec3::ONE)),
            is_skinned: false,
            is_morphed: false,
            is_static: false,
            changed: 0,
        }
    }

    fn next_frame(instances: &mut Instances) {
        (instances.is_restructured, instances.moved) = (false, Vec::new());
        instances.frame += 1;
        instances.sweep();
    }

    #[test]
    fn resting_instances_become_static() {
        let mut instances = Instances::default();
        instances.set(instance(1, 0.0));
        instances.set(instance(2, 0.0));
        for frame in 0..2 * REST_FRAMES {
            next_frame(&mut instances);
            instances.set(Instance { changed: instances.frame, ..instance(2, frame as f32) });
        }
        let marks: Vec<bool> = instances.iter().map(|(_, instance)| instance.is_static).collect();
        assert_eq!(marks, [true, false]);
        // A static instance that moves restructures the draws, a dynamic one does not.
        next_frame(&mut instances);
        instances.set(instance(2, -1.0));
        assert!(!instances.is_restructured && instances.moved == [1]);
        instances.set(instance(1, 1.0));
        assert!(instances.is_restructured);
    }

    #[test]
    fn freed_instance_slots_are_reused() {
        let mut instances = Instances::default();
        for round in 0..10 {
            for entity in 1..=1000 {
                instances.set(instance(1000 * round + entity, 0.0));
            }
            assert_eq!(instances.counts(), [1000, 1000]);
            for entity in 1..=1000 {
                instances.remove(instance(1000 * round + entity, 0.0).entity);
            }
        }
        assert_eq!((instances.counts(), instances.bounds()), ([0, 1000], None));
        instances.frame = SWEEP_FRAMES;
        instances.sweep();
        assert_eq!(instances.counts(), [0, 0]);
    }

    #[test]
    fn bounds_follow_transforms() {
        let mut instances = Instances::default();
        instances.set(instance(1, 0.0));
        let turned = Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2);
        instances.set(Instance { world_from_local: turned, ..instance(2, 0.0) });
        let [min, max] = instances.bounds().expect("there are two");
        assert!(min.abs_diff_eq(Vec3::new(0.0, 0.0, -1.0), 1e-6), "{min}");
        assert!(max.abs_diff_eq(Vec3::ONE, 1e-6), "{max}");
    }
}
