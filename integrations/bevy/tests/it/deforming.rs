//! Skinned and morphed meshes light as if their vertices were where they are drawn.

use std::sync::OnceLock;

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

/// A screen with two joints, the second with three quarters of the weight.
fn skinned(world: &mut World) -> (Mesh3d, SkinnedMesh) {
    let mut mesh = screen();
    let count = mesh.count_vertices();
    let joints = VertexAttributeValues::Uint16x4(vec![[1, 0, 0, 0]; count]);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, joints);
    mesh.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[0.75_f32, 0.25, 0.0, 0.0]; count]);
    let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(mesh));
    let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
    let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
    let joints = (0..2).map(|_| world.spawn(Transform::from_translation(REST)).id()).collect();
    (mesh, SkinnedMesh { inverse_bindposes, joints })
}

fn place(stage: &mut Stage, joint: Entity, at: Vec3) {
    let mut transform = stage.app.world_mut().get_mut::<Transform>(joint).expect("a joint");
    transform.translation = at;
}

fn material(world: &mut World) -> MeshMaterial3d<StandardMaterial> {
    let blue = StandardMaterial {
        base_color: Color::linear_rgb(0.1, 0.2, 0.9),
        perceptual_roughness: 1.0,
        ..StandardMaterial::default()
    };
    MeshMaterial3d(world.resource_mut::<Assets<StandardMaterial>>().add(blue))
}

/// The picture of a plain screen at the place that the others are moved to; made once.
fn plain() -> &'static Shot {
    static PLAIN: OnceLock<Shot> = OnceLock::new();
    PLAIN.get_or_init(|| {
        let mut stage = Stage::cornell();
        let world = stage.app.world_mut();
        let material = material(world);
        let mesh = Mesh3d(world.resource_mut::<Assets<Mesh>>().add(screen()));
        world.spawn((mesh, material, Transform::from_translation(REST + MOVE)));
        let shot = stage.settled();
        shot.save("target/pictures/screen-plain.png", 2.0);
        shot
    })
}

#[test]
fn joints_carry_a_mesh() {
    let _alone = alone();
    let plain = plain();
    let mut stage = Stage::cornell();
    let world = stage.app.world_mut();
    let material = material(world);
    let (mesh, skin) = skinned(world);
    let joints = skin.joints.clone();
    world.spawn((mesh, material, skin, Transform::default()));
    let at_rest = stage.settled();
    for joint in joints {
        place(&mut stage, joint, REST + MOVE);
    }
    let moved = stage.settled();
    moved.save("target/pictures/screen-skinned.png", 2.0);
    let [from_plain, from_rest] = [plain, &at_rest].map(|other| difference(&moved, other));
    assert!(from_plain < 0.03 && from_rest > 0.2, "{from_plain} {from_rest}");
}

/// Bevy uploads no joints of meshes that no camera or shadow map sees, but they light all the same.
#[test]
fn unseen_skins_move_as_well() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let without = stage.settled();
    let world = stage.app.world_mut();
    let lamp = StandardMaterial {
        emissive: LinearRgba::rgb(1.0, 1.0, 1.0),
        ..StandardMaterial::default()
    };
    let material = MeshMaterial3d(world.resource_mut::<Assets<StandardMaterial>>().add(lamp));
    let (mesh, skin) = skinned(world);
    let joints = skin.joints.clone();
    // The lamp is in another layer than the camera, and casts no shadow.
    let lamp = world.spawn((mesh, material, skin, RenderLayers::layer(1), NotShadowCaster)).id();
    let at_rest = stage.settled();
    assert!(!stage.app.world().get::<ViewVisibility>(lamp).expect("a mesh").get());
    for joint in &joints {
        place(&mut stage, *joint, REST + MOVE);
    }
    let moved = stage.settled();
    for joint in &joints {
        place(&mut stage, *joint, REST);
    }
    let back = stage.settled();
    let [lit, way, left] = [(&at_rest, &without), (&moved, &at_rest), (&back, &at_rest)]
        .map(|(one, other)| difference(one, other));
    println!("lit {lit}, moved {way}, back {left}");
    assert!(lit > 0.5 && way > 0.3 && left < 0.1, "{lit} {way} {left}");
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
    let [from_plain, from_rest] = [plain, &at_rest].map(|other| difference(&moved, other));
    assert!(from_plain < 0.03 && from_rest > 0.2, "{from_plain} {from_rest}");
}
