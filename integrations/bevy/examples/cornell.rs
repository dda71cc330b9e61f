//! The Cornell box with a moving block, whose shadow and reflected light follow it.

mod common;

use bevy::camera::Exposure;
use bevy::light::GlobalAmbientLight;
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxGi, LumivoxPlugin};
use common::{run::Clock, scene};

/// The moving block, and its position at rest.
#[derive(Component)]
struct Moves(Vec3);

fn main() {
    common::run::run("cornell", |app| {
        app.add_plugins(LumivoxPlugin::default());
        app.insert_resource(GlobalAmbientLight::NONE);
        app.insert_resource(ClearColor(Color::BLACK));
        app.add_systems(Startup, setup).add_systems(Update, slide);
    });
}

fn setup(world: &mut World) {
    let given = scene::builtin("cornell");
    let spawned = scene::spawn(world, &given);
    for (entity, instance) in spawned.instances.iter().zip(&given.instances) {
        if instance.name == "tall block" {
            let rest = instance.world_from_local.w_axis.truncate();
            world.entity_mut(*entity).insert(Moves(rest));
        }
    }
    let (transform, projection) = scene::camera(&given);
    let gi = LumivoxGi { volume: GiVolume::Scene { resolution: 64 }, ..LumivoxGi::default() };
    world.spawn((Camera3d::default(), transform, projection, Exposure { ev100: 2.5 }, gi));
}

fn slide(clock: Res<Clock>, mut blocks: Query<(&mut Transform, &Moves)>) {
    for (mut transform, moves) in &mut blocks {
        transform.translation = moves.0 + 0.33 * (1.0 - (1.5 * clock.0).cos()) * Vec3::X;
    }
}
