//! Skinned and morphed meshes: as if their vertices were where they are drawn.

use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;

use crate::stage::{Stage, alone, difference};

/// Where the screen is at rest, and how far it is moved.
const REST: Vec3 = Vec3::new(-0.5, 0.7, 0.2);
const MOVE: Vec3 = Vec3::new(0.9, 0.1, 0.0);

fn screen() -> Mesh {
    Cuboid::new(0.1, 1.2, 0.9).mesh().build()
}

fn material(world: &mut World) -> MeshMaterial3d<StandardMaterial> {
    let blue = StandardMaterial {
        base_color: Color::linear_rgb(0.1, 0.2, 0.9),
        perceptual_roughness: 1.0,
        ..StandardMaterial::default()
    };
    MeshMaterial3d(world.resource_mut::<Assets<StandardMaterial>>().add(blue))
}

/// The picture with a plain screen at the place that the others are moved to.
fn plain() -> crate::common::headless::Shot {
    let mut stage = Stage::cornell();
    let world = stage.app.world_mut();
    let material = material(world);
    let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(screen()));
    world.spawn((mesh, material, Transform::from_translation(REST + MOVE)));
    let shot = stage.settled();
    shot.save("target/pictures/screen-plain.png", 2.0);
    shot
}

#[test]
fn joints_carry_a_mesh() {
    let _alone = alone();
    let plain = plain();
    let mut stage = Stage::cornell();
    let world = stage.app.world_mut();
    let material = material(world);
    let mut mesh = screen();
    let count = mesh.count_vertices();
    let joints = VertexAttributeValues::Uint16x4(vec![[1, 0, 0, 0]; count]);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[0.75_f32, 0.25, 0.0, 0.0]; count]);
    let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(mesh));
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let joints: Vec<Entity> =
        (0..2).map(|_| world.spawn(Transform::from_translation(REST)).id()).collect();
    let skin = SkinnedMesh { inverse_bindposes, joints: joints.clone() };
    world.spawn((mesh, material, skin, Transform::default()));
    let at_rest = stage.settled();
    // One joint has three quarters of the weight, the other the rest.
    for (joint, share) in [(joints[1], 1.0), (joints[0], 1.0)] {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(joint).expect("a joint");
        transform.translation = REST + share * MOVE;
    }
    let moved = stage.settled();
    moved.save("target/pictures/screen-skinned.png", 2.0);
    let [from_plain, from_rest] = [&plain, &at_rest].map(|other| difference(&moved, other));
    assert!(from_plain < 0.03 && from_rest > 0.2, "{from_plain} {from_rest}");
}

#[test]
fn morph_targets_move_a_mesh() {
    let _alone = alone();
    let plain = plain();
    let mut stage = Stage::cornell();
    let world = stage.app.world_mut();
    let material = material(world);
    let target = |position| MorphAttributes { position, ..MorphAttributes::default() };
    let count = screen().count_vertices();
    let targets = [vec![target(2.0 * MOVE); count], vec![target(Vec3::Y); count]].concat();
    let mesh = screen().with_morph_targets(targets);
    let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(mesh));
    let weights = MeshMorphWeights::Value { weights: vec![0.0, 0.0] };
    let transform = Transform::from_translation(REST);
    let entity = world.spawn((mesh, material, weights, transform)).id();
    let at_rest = stage.settled();
    let mut weights = stage.app.world_mut().get_mut::<MeshMorphWeights>(entity).expect("weights");
    *weights = MeshMorphWeights::Value { weights: vec![0.5, 0.0] };
    let moved = stage.settled();
    moved.save("target/pictures/screen-morphed.png", 2.0);
    let [from_plain, from_rest] = [&plain, &at_rest].map(|other| difference(&moved, other));
    assert!(from_plain < 0.03 && from_rest > 0.2, "{from_plain} {from_rest}");
}
