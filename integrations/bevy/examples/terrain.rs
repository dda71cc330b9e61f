//! A flight over a valley with a village before sunset: a kilometre of landscape under Bevy's
//! atmosphere, lit by cascades around the camera.

mod common;

use std::f32::consts::PI;

use bevy::asset::RenderAssetUsages;
use bevy::camera::Exposure;
use bevy::light::atmosphere::ScatteringMedium;
use bevy::light::light_consts::lux;
use bevy::light::{
    Atmosphere, AtmosphereEnvironmentMapLight, CascadeShadowConfigBuilder, GlobalAmbientLight,
};
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::pbr::AtmosphereSettings;
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxGi, LumivoxPlugin};
use common::{run::Clock, scene::matt};

/// Edge of the landscape, m, and squares along it.
const EDGE_M: f32 = 1000.0;
const SQUARES: u32 = 200;

fn main() {
    common::run::run("terrain", |app| {
        app.add_plugins(LumivoxPlugin::default());
        app.insert_resource(GlobalAmbientLight::NONE);
        app.insert_resource(ClearColor(Color::BLACK));
        app.add_systems(Startup, (landscape, village, sky)).add_systems(Update, (fly, set_the_sun));
    });
}

/// Height above the sea, m: hills on both sides of a valley along x.
fn height(x: f32, z: f32) -> f32 {
    let side = (z / 90.0).abs().min(4.0);
    let hills = (0.011 * x + 0.4).sin() * (0.017 * z).cos()
        + 0.5 * (0.031 * x).cos() * (0.023 * z + 1.0).sin();
    let rocks = 0.25 * (0.11 * x + 0.07 * z).sin() * (0.13 * z - 0.05 * x).cos();
    10.0 * side * side / (1.0 + 0.2 * side) * (1.0 + 0.5 * hills) + 2.0 * rocks * side.min(1.0)
}

fn normal(x: f32, z: f32) -> Vec3 {
    let slope = |dx: f32, dz: f32| height(x + dx, z + dz) - height(x - dx, z - dz);
    Vec3::new(-slope(1.0, 0.0), 2.0, -slope(0.0, 1.0)).normalize()
}

/// The landscape: a mesh whose vertices have the colours of grass, rock and snow.
fn landscape(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let (mut positions, mut normals, mut colors) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..(SQUARES + 1) * (SQUARES + 1) {
        let place = |number: u32| (number as f32 / SQUARES as f32 - 0.5) * EDGE_M;
        let (x, z) = (place(index % (SQUARES + 1)), place(index / (SQUARES + 1)));
        let (y, up) = (height(x, z), normal(x, z));
        let (grass, rock, snow) =
            (Vec3::new(0.12, 0.22, 0.04), Vec3::new(0.3, 0.24, 0.2), Vec3::splat(0.8));
        let color = grass.lerp(rock, ((0.93 - up.y) * 9.0).clamp(0.0, 1.0));
        let color = color.lerp(snow, ((y - 75.0) / 15.0).clamp(0.0, 1.0));
        positions.push([x, y, z]);
        normals.push(up.to_array());
        colors.push(color.extend(1.0).to_array());
    }
    let corners = |index: u32| {
        let first = index / SQUARES * (SQUARES + 1) + index % SQUARES;
        let below = first + SQUARES + 1;
        [first, below, first + 1, first + 1, below, below + 1]
    };
    let indices = Indices::U32((0..SQUARES * SQUARES).flat_map(corners).collect());
    let mesh = Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::all())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
        .with_inserted_indices(indices);
    let ground = StandardMaterial { perceptual_roughness: 1.0, ..default() };
    commands.spawn((Mesh3d(meshes.add(mesh)), MeshMaterial3d(materials.add(ground))));
}

/// Houses along a road, plastered in three colours, with lit windows.
fn village(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let plaster = [[0.75, 0.7, 0.6], [0.7, 0.28, 0.16], [0.75, 0.6, 0.25]]
        .map(|rgb| matt(&mut materials, rgb));
    let tiles = matt(&mut materials, [0.3, 0.1, 0.06]);
    let window = materials.add(StandardMaterial {
        base_color: Color::BLACK,
        // A lit room behind a pane, in cd/m2.
        emissive: LinearRgba::rgb(900.0, 560.0, 260.0),
        emissive_exposure_weight: 1.0,
        ..default()
    });
    let walls = meshes.add(Cuboid::new(7.0, 5.0, 9.0));
    let roof = meshes.add(
        ConicalFrustum { radius_top: 0.6, radius_bottom: 6.6, height: 3.5 }
            .mesh()
            .resolution(4)
            .build()
            .rotated_by(Quat::from_rotation_y(0.25 * PI))
            .scaled_by(Vec3::new(0.92, 1.0, 1.12)),
    );
    let pane = meshes.add(Cuboid::new(0.1, 1.4, 1.1));
    for number in 0..24_u8 {
        let n = f32::from(number);
        let side = if number % 2 == 0 { 1.0 } else { -1.0 };
        let (x, z) = (-110.0 + 10.0 * n, side * (11.0 + 3.0 * (7.0 * n).sin().abs()));
        let turn = Quat::from_rotation_y(0.5 * PI * side + 0.2 * (3.0 * n).sin());
        let ground = Vec3::new(x, height(x, z), z);
        let place =
            |offset: Vec3| Transform::from_translation(ground + turn * offset).with_rotation(turn);
        let color = plaster[usize::from(number) % 3].clone();
        commands.spawn((Mesh3d(walls.clone()), MeshMaterial3d(color), place(2.3 * Vec3::Y)));
        commands.spawn((Mesh3d(roof.clone()), MeshMaterial3d(tiles.clone()), place(6.5 * Vec3::Y)));
        for (y, z) in [(1.6, -2.2), (1.6, 2.2), (3.6, 0.0)] {
            let offset = Vec3::new(3.51, y, z);
            commands.spawn((Mesh3d(pane.clone()), MeshMaterial3d(window.clone()), place(offset)));
        }
    }
}

/// The sun, the air, and the camera.
fn sky(mut commands: Commands, mut media: ResMut<Assets<ScatteringMedium>>) {
    commands.spawn((
        DirectionalLight { illuminance: lux::RAW_SUNLIGHT, shadow_maps_enabled: true, ..default() },
        CascadeShadowConfigBuilder { maximum_distance: 400.0, ..default() }.build(),
        Transform::default(),
    ));
    commands.spawn(Atmosphere::earth(media.add(ScatteringMedium::earth(128, 128))));
    commands.spawn((
        Camera3d::default(),
        Transform::default(),
        Exposure { ev100: 11.0 },
        AtmosphereSettings {
            transmittance_lut_size: UVec2::new(128, 64),
            sky_view_lut_size: UVec2::new(160, 80),
            aerial_view_lut_size: UVec3::new(16, 16, 16),
            aerial_view_lut_max_distance: 3000.0,
            ..default()
        },
        AtmosphereEnvironmentMapLight { size: UVec2::splat(64), ..default() },
        // The finest voxels of 40 cm reach 13 m, the coarsest of 13 m reach 400 m.
        LumivoxGi {
            volume: GiVolume::Cascades { count: 6, resolution: 64, voxel_size: 0.4 },
            ..default()
        },
    ));
}

/// Moves the camera along the road.
fn fly(clock: Res<Clock>, mut cameras: Query<&mut Transform, With<Camera3d>>) {
    let x = -150.0 + 9.0 * clock.0;
    let at = |x: f32, above: f32| {
        let z = 3.0 * (0.02 * x).sin();
        Vec3::new(x, height(x, z) + above, z)
    };
    for mut transform in &mut cameras {
        *transform = Transform::from_translation(at(x, 6.0)).looking_at(at(x + 40.0, 3.0), Vec3::Y);
    }
}

/// Lowers the sun from six degrees to the horizon in a minute and a half.
fn set_the_sun(clock: Res<Clock>, mut suns: Query<&mut Transform, With<DirectionalLight>>) {
    let elevation = (0.11 - 0.001_2 * clock.0).max(0.0);
    let towards = Vec3::new(0.55 * elevation.cos(), elevation.sin(), 0.83 * elevation.cos());
    for mut transform in &mut suns {
        *transform = Transform::from_translation(towards).looking_at(Vec3::ZERO, Vec3::Y);
    }
}
