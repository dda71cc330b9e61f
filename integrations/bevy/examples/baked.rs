//! Light without the plugin: the Cornell box with an irradiance volume from `lumivox bake`.
//!
//! The volume was made by this command:
//! `lumivox bake builtin:cornell --spacing 0.25 -o integrations/bevy/assets/cornell.ktx2`, which
//! prints the volume's place.

mod common;

use bevy::camera::Exposure;
use bevy::light::{GlobalAmbientLight, IrradianceVolume};
use bevy::prelude::*;
use common::scene;

fn main() {
    common::run::run("baked", |app| {
        app.insert_resource(GlobalAmbientLight::NONE);
        app.insert_resource(ClearColor(Color::BLACK));
        app.add_systems(Startup, setup);
    });
}

fn setup(world: &mut World) {
    let given = scene::builtin("cornell");
    scene::spawn(world, &given);
    let (transform, projection) = scene::camera(&given);
    world.spawn((Camera3d::default(), transform, projection, Exposure { ev100: 2.5 }));
    let voxels = world.resource::<AssetServer>().load("cornell.ktx2");
    let place = Transform::from_xyz(0.0, 1.0, 0.0).with_scale(Vec3::splat(2.004));
    world.spawn((IrradianceVolume { voxels, intensity: 1.0, ..default() }, place));
}
