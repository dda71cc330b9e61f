//! A skinned figure walks with a torch between pillars in the dark.

mod common;

use std::f32::consts::PI;

use bevy::asset::RenderAssetUsages;
use bevy::camera::Exposure;
use bevy::light::GlobalAmbientLight;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxGi, LumivoxPlugin};
use common::{run::Clock, scene::matt};

/// A limb that swings about its joint: amplitude and phase, rad.
#[derive(Component)]
struct Swings(f32, f32);

/// The whole figure.
#[derive(Component)]
struct Walks;

fn main() {
    common::run::run("torch", |app| {
        app.add_plugins(LumivoxPlugin::default());
        app.insert_resource(GlobalAmbientLight::NONE);
        app.insert_resource(ClearColor(Color::BLACK));
        app.add_systems(Startup, (hall, figure)).add_systems(Update, walk);
    });
}

/// A hall of pillars, and the camera.
fn hall(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let [stone, red, blue] = [[0.6, 0.57, 0.5], [0.65, 0.12, 0.08], [0.12, 0.2, 0.6]]
        .map(|rgb| matt(&mut materials, rgb));
    let mut place = |size: Vec3, at: Vec3, material: &Handle<StandardMaterial>| {
        let mesh = meshes.add(Cuboid::from_size(size));
        commands.spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material.clone()),
            Transform::from_translation(at),
        ));
    };
    place(Vec3::new(10.0, 0.2, 6.0), Vec3::new(0.0, -0.1, 0.0), &stone);
    place(Vec3::new(10.0, 0.2, 6.0), Vec3::new(0.0, 3.1, 0.0), &stone);
    place(Vec3::new(10.0, 3.0, 0.2), Vec3::new(0.0, 1.5, -3.0), &stone);
    place(Vec3::new(0.2, 3.0, 6.0), Vec3::new(-5.0, 1.5, 0.0), &red);
    place(Vec3::new(0.2, 3.0, 6.0), Vec3::new(5.0, 1.5, 0.0), &blue);
    for x in [-3.0, -1.0, 1.0, 3.0] {
        place(
            Vec3::new(0.4, 3.0, 0.4),
            Vec3::new(x, 1.5, -1.6),
            if x < 0.0 { &red } else { &blue },
        );
    }
    commands.spawn((
        Camera3d::default(),
        Transform::from_xyz(0.0, 1.7, 5.5).looking_at(Vec3::new(0.0, 1.2, 0.0), Vec3::Y),
        Exposure { ev100: 3.0 },
        LumivoxGi { volume: GiVolume::Scene { resolution: 96 }, ..default() },
    ));
}

/// A figure of six boxes, each moved by its own joint.
fn figure(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut poses: ResMut<Assets<SkinnedMeshInverseBindposes>>,
) {
    // Joint, size, depth of the middle below the joint, amplitude and phase of each limb.
    let limbs = [
        (Vec3::new(0.0, 0.9, 0.0), Vec3::new(0.4, 0.6, 0.25), -0.3, 0.0, 0.0),
        (Vec3::new(0.0, 1.5, 0.0), Vec3::new(0.22, 0.28, 0.22), -0.18, 0.0, 0.0),
        (Vec3::new(0.0, 0.9, 0.12), Vec3::new(0.16, 0.9, 0.16), 0.45, 0.6, 0.0),
        (Vec3::new(0.0, 0.9, -0.12), Vec3::new(0.16, 0.9, 0.16), 0.45, 0.6, PI),
        (Vec3::new(0.0, 1.45, -0.27), Vec3::new(0.12, 0.6, 0.12), 0.3, 0.5, 0.0),
        (Vec3::new(0.0, 1.45, 0.27), Vec3::new(0.12, 0.6, 0.12), 0.3, 0.0, 0.0),
    ];
    let walker = commands.spawn((Walks, Transform::default(), Visibility::default())).id();
    let mut whole: Option<Mesh> = None;
    let (mut joints, mut inverse) = (Vec::new(), Vec::new());
    for (number, (joint, size, below, swing, phase)) in limbs.into_iter().enumerate() {
        let middle = joint - below * Vec3::Y;
        let mut limb = Mesh::from(Cuboid::from_size(size)).translated_by(middle);
        let count = limb.count_vertices();
        let indices = VertexAttributeValues::Uint16x4(vec![[number as u16, 0, 0, 0]; count]);
        limb.insert_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, indices);
        limb.insert_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, vec![[1.0_f32, 0.0, 0.0, 0.0]; count]);
        limb.asset_usage = RenderAssetUsages::all();
        match &mut whole {
            Some(whole) => whole.merge(&limb).expect("limbs of the same attributes"),
            None => whole = Some(limb),
        }
        let at = Transform::from_translation(joint);
        joints.push(
            commands.spawn((Swings(swing, phase), at, Visibility::default(), ChildOf(walker))).id(),
        );
        inverse.push(Mat4::from_translation(-joint));
    }
    // The torch floats in front of the figure.
    let torch = (
        PointLight {
            color: Color::linear_rgb(1.0, 0.55, 0.22),
            intensity: 4000.0,
            radius: 0.03,
            shadow_maps_enabled: true,
            shadow_map_near_z: 0.02,
            ..default()
        },
        Transform::from_xyz(0.55, 1.75, 0.3),
        ChildOf(walker),
    );
    commands.spawn(torch);
    let skin = SkinnedMesh { inverse_bindposes: poses.add(inverse), joints };
    let cloth = StandardMaterial { base_color: Color::linear_rgb(0.5, 0.45, 0.4), ..default() };
    let mesh = meshes.add(whole.expect("six limbs"));
    commands.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(materials.add(cloth)),
        skin,
        Transform::default(),
    ));
}

fn walk(
    clock: Res<Clock>,
    mut walkers: Query<&mut Transform, With<Walks>>,
    mut limbs: Query<(&mut Transform, &Swings), Without<Walks>>,
) {
    for mut transform in &mut walkers {
        let along = (0.35 * clock.0).sin();
        transform.translation = Vec3::new(3.8 * along, 0.0, 0.3);
        let turn = if (0.35 * clock.0).cos() < 0.0 { PI } else { 0.0 };
        transform.rotation = Quat::from_rotation_y(turn);
    }
    for (mut transform, swings) in &mut limbs {
        transform.rotation = Quat::from_rotation_z(swings.0 * (5.0 * clock.0 + swings.1).sin());
    }
}
