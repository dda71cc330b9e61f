//! Skinned and morphed meshes light from where they are drawn; vertex colours act like a
//! material's.

use bevy::camera::visibility::RenderLayers;
use bevy::light::NotShadowCaster;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;

use crate::common::headless::Shot;
use crate::stage::{Stage, alone, difference};

/// The screen's position at rest, and the displacement of its moves.
const REST: Vec3 = Vec3::new(-0.5, 0.7, 0.2);
const MOVE: Vec3 = Vec3::new(0.9, 0.1, 0.0);

fn screen() -> Mesh {
    Cuboid::new(0.1, 1.2, 0.9).mesh().build()
}

fn matt(stage: &mut Stage, base_color: Color) -> MeshMaterial3d<StandardMaterial> {
    MeshMaterial3d(stage.add(StandardMaterial {
        base_color,
        perceptual_roughness: 1.0,
        ..StandardMaterial::default()
    }))
}

/// A screen with two joints, the second with three quarters of the weight.
fn skinned(stage: &mut Stage) -> (Mesh3d, SkinnedMesh) {
    let mut mesh = screen();
    let count = mesh.count_vertices();
    let joints = VertexAttributeValues::Uint16x4(vec![[1, 0, 0, 0]; count]);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[0.75_f32, 0.25, 0.0, 0.0]; count]);
    let mesh = Mesh3d(stage.add(mesh));
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = stage.add(poses);
    let world = stage.app.world_mut();
    let joints = (0..2).map(|_| world.spawn(Transform::from_translation(REST)).id()).collect();
    (mesh, SkinnedMesh { inverse_bindposes, joints })
}

fn place(stage: &mut Stage, joints: &[Entity], at: Vec3) {
    for joint in joints {
        stage.place(*joint, at);
    }
}

#[test]
fn deformed_and_coloured_meshes_light_as_plain_ones() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let blue = Color::linear_rgb(0.1, 0.2, 0.9);
    let material = matt(&mut stage, blue);
    let there = Transform::from_translation(REST + MOVE);
    let mesh = Mesh3d(stage.add(screen()));
    let entity = stage.app.world_mut().spawn((mesh, material.clone(), there)).id();
    let plain = stage.settled();
    plain.save("target/pictures/screen-plain.png", 2.0);

    // A white material with that colour at its vertices looks the same.
    let mut mesh = screen();
    let colors = vec![blue.to_linear().to_f32_array(); mesh.count_vertices()];
    mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    let parts = (Mesh3d(stage.add(mesh)), matt(&mut stage, Color::WHITE));
    stage.app.world_mut().entity_mut(entity).insert(parts);
    let change = difference(&stage.settled(), &plain);
    println!("colours of vertices: {change}");
    assert!(change < 0.02, "{change}");
    stage.app.world_mut().despawn(entity);

    joints_carry_a_mesh(&mut stage, &material, &plain);
    morph_targets_move_a_mesh(&mut stage, &material, &plain);
    unseen_skins_move_as_well(&mut stage, &plain);
}

#[track_caller]
fn assert_moved(moved: &Shot, plain: &Shot, at_rest: &Shot) {
    let [from_plain, from_rest] = [plain, at_rest].map(|other| difference(moved, other));
    println!("from plain {from_plain}, from rest {from_rest}");
    assert!(from_plain < 0.03 && from_rest > 0.2, "{from_plain} {from_rest}");
}

fn joints_carry_a_mesh(
    stage: &mut Stage,
    material: &MeshMaterial3d<StandardMaterial>,
    plain: &Shot,
) {
    let (mesh, skin) = skinned(stage);
    let joints = skin.joints.clone();
    let parts = (mesh, material.clone(), skin, Transform::default());
    let entity = stage.app.world_mut().spawn(parts).id();
    let at_rest = stage.settled();
    place(stage, &joints, REST + MOVE);
    let moved = stage.settled();
    moved.save("target/pictures/screen-skinned.png", 2.0);
    assert_moved(&moved, plain, &at_rest);
    stage.app.world_mut().despawn(entity);
}

fn morph_targets_move_a_mesh(
    stage: &mut Stage,
    material: &MeshMaterial3d<StandardMaterial>,
    plain: &Shot,
) {
    let target = |position| MorphAttributes { position, ..MorphAttributes::default() };
    let count = screen().count_vertices();
    let targets = [vec![target(2.0 * MOVE); count], vec![target(Vec3::Y); count]].concat();
    let mesh = Mesh3d(stage.add(screen().with_morph_targets(targets)));
    let weights = |first| MeshMorphWeights::Value { weights: vec![first, 0.0] };
    let transform = Transform::from_translation(REST);
    let parts = (mesh, material.clone(), weights(0.0), transform);
    let entity = stage.app.world_mut().spawn(parts).id();
    let at_rest = stage.settled();
    *stage.app.world_mut().get_mut(entity).expect("weights") = weights(0.5);
    let moved = stage.settled();
    moved.save("target/pictures/screen-morphed.png", 2.0);
    assert_moved(&moved, plain, &at_rest);
    stage.app.world_mut().despawn(entity);
}

/// Bevy uploads no joints of meshes that no camera or shadow map sees, but they light all the same.
fn unseen_skins_move_as_well(stage: &mut Stage, without: &Shot) {
    let emissive = LinearRgba::rgb(1.0, 1.0, 1.0);
    let lamp = StandardMaterial { emissive, ..StandardMaterial::default() };
    let material = MeshMaterial3d(stage.add(lamp));
    let (mesh, skin) = skinned(stage);
    let joints = skin.joints.clone();
    // The lamp is in another layer than the camera, and casts no shadow.
    let parts = (mesh, material, skin, RenderLayers::layer(1), NotShadowCaster);
    let lamp = stage.app.world_mut().spawn(parts).id();
    let at_rest = stage.settled();
    assert!(!stage.app.world().get::<ViewVisibility>(lamp).expect("a mesh").get());
    place(stage, &joints, REST + MOVE);
    let moved = stage.settled();
    place(stage, &joints, REST);
    let back = stage.settled();
    let [lit, way, left] = [(&at_rest, without), (&moved, &at_rest), (&back, &at_rest)]
        .map(|(one, other)| difference(one, other));
    println!("lit {lit}, moved {way}, back {left}");
    assert!(lit > 0.5 && way > 0.3 && left < 0.1, "{lit} {way} {left}");
}
