//! A day in an atrium: the sun crosses it, and its light reaches the arcades.

mod common;

use bevy::camera::Exposure;
use bevy::light::GlobalAmbientLight;
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxGi, LumivoxPlugin};
use common::{run::Clock, scene};

fn main() {
    common::run::run("atrium", |app| {
        app.add_plugins(LumivoxPlugin::default());
        // The sky: seen by cones where there is no roof.
        app.insert_resource(GlobalAmbientLight {
            color: Color::linear_rgb(0.7, 0.85, 1.0),
            brightness: 4000.0,
            ..default()
        });
        app.insert_resource(ClearColor(Color::linear_rgb(0.35, 0.5, 0.9)));
        app.add_systems(Startup, setup).add_systems(Update, pass_the_day);
    });
}

fn setup(world: &mut World) {
    let given = scene::builtin("atrium");
    scene::spawn(world, &given);
    let (transform, projection) = scene::camera(&given);
    let gi = LumivoxGi { volume: GiVolume::Scene { resolution: 128 }, ..LumivoxGi::default() };
    world.spawn((Camera3d::default(), transform, projection, Exposure { ev100: 11.0 }, gi));
}

/// A day of sixteen seconds.
fn pass_the_day(clock: Res<Clock>, mut suns: Query<(&mut Transform, &mut DirectionalLight)>) {
    for (mut transform, mut sun) in &mut suns {
        let angle = 0.3 + (0.157 * clock.0) % 2.5;
        let towards = Vec3::new(angle.cos(), angle.sin(), 0.35).normalize();
        *transform = Transform::from_translation(towards).looking_at(Vec3::ZERO, Vec3::Y);
        sun.illuminance = 90_000.0 * towards.y.max(0.0);
    }
}
