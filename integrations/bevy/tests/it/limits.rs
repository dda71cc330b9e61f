//! Unsupported things are reported, and nothing panics.

use bevy::asset::RenderAssetUsages;
use bevy::light::{AmbientLight, GlobalAmbientLight, RectLight};
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxEvent, LumivoxGi};

use crate::common::scene;
use crate::stage::{Stage, alone, quick};
use crate::truth;

#[test]
fn settings_out_of_range_are_told_and_nothing_is_lit() {
    let _alone = alone();
    let mut stage = Stage::of(&scene::builtin("cornell"), UVec2::new(16, 16));
    stage.use_small_shadow_maps();
    let gi = LumivoxGi { volume: GiVolume::Scene { resolution: 7 }, ..LumivoxGi::default() };
    stage.app.world_mut().entity_mut(stage.camera).insert(gi);
    let event = stage.wait_for(|event| matches!(event, LumivoxEvent::Failed { .. }));
    let LumivoxEvent::Failed { error } = event else { return };
    assert!(error.contains("resolution is 7"), "{error}");
    // Reported only once.
    stage.frames(5);
    assert_eq!(stage.events(), []);
}

#[test]
fn what_is_left_out_is_told_once() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let world = stage.app.world_mut();
    let strip = Mesh::new(PrimitiveTopology::TriangleStrip, RenderAssetUsages::all())
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_POSITION,
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 3]);
    let strip = world.resource_mut::<Assets<Mesh>>().add(strip);
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(Color::WHITE);
    for _ in 0..2 {
        world.spawn((Mesh3d(strip.clone()), MeshMaterial3d(material.clone())));
    }
    world.spawn(RectLight::default());
    // Textures need coordinates.
    let image = world.resource_mut::<Assets<Image>>().add(Image::default());
    let textured = StandardMaterial { base_color_texture: Some(image), ..default() };
    let textured = world.resource_mut::<Assets<StandardMaterial>>().add(textured);
    let mut plain = Mesh::from(Cuboid::from_length(0.1));
    plain.remove_attribute(Mesh::ATTRIBUTE_UV_0);
    let plain = world.resource_mut::<Assets<Mesh>>().add(plain);
    world.spawn((Mesh3d(plain), MeshMaterial3d(textured)));
    let mut told = Vec::new();
    for _ in 0..20 {
        stage.app.update();
        told.extend(stage.events());
    }
    told.retain(|event| *event != LumivoxEvent::Ready);
    assert_eq!(told.len(), 3, "{told:?}");
    for part in ["strips", "ATTRIBUTE_UV_0"] {
        let is_it = |event: &LumivoxEvent| matches!(event, LumivoxEvent::MeshLeftOut { reason } if reason.contains(part));
        assert!(told.iter().any(is_it), "{told:?}");
    }
    assert!(told.contains(&LumivoxEvent::LightLeftOut { kind: "RectLight" }), "{told:?}");
}

/// A device with too few storage buffers: reported once, and Bevy continues with its own light.
#[test]
fn what_a_device_lacks_is_told() {
    let _alone = alone();
    let given = scene::builtin("cornell");
    let mut limits = bevy::render::settings::WgpuLimits::default();
    // Enough for Bevy.
    limits.max_storage_buffers_per_shader_stage = 7;
    let mut stage = Stage::on(Some(limits), &given, UVec2::new(16, 16));
    stage.use_small_shadow_maps();
    stage.app.world_mut().entity_mut(stage.camera).insert(quick());
    let event = stage.wait_for(|event| {
        matches!(event, LumivoxEvent::Failed { .. } | LumivoxEvent::Unsupported { .. })
    });
    println!("{event:?}");
    let told = format!("{event:?}");
    assert!(told.contains("max_storage_buffers_per_shader_stage"), "{told}");
    stage.frames(5);
    assert_eq!(stage.events(), []);
}

#[test]
fn an_empty_world_waits_for_meshes() {
    let _alone = alone();
    let nothing = lumivox_scene::Scene {
        cameras: scene::builtin("cornell").cameras,
        ..lumivox_scene::Scene::default()
    };
    let mut stage = Stage::of(&nothing, UVec2::new(16, 16));
    stage.use_small_shadow_maps();
    stage.app.world_mut().entity_mut(stage.camera).insert(quick());
    stage.frames(10);
    assert_eq!(stage.events(), []);
    scene::spawn(stage.app.world_mut(), &scene::builtin("cornell"));
    stage.wait_for(|event| *event == LumivoxEvent::Ready);
}

#[test]
fn ambient_light_lights_what_is_open_and_comes_back() {
    let _alone = alone();
    // The box is open only at its front, and all light enters there.
    let mut stage = Stage::cornell();
    let dark = stage.settled().mean_luminance();
    let ambient = GlobalAmbientLight { brightness: 5.0, ..GlobalAmbientLight::default() };
    stage.app.insert_resource(ambient.clone());
    let lit = stage.settled().mean_luminance();
    stage.app.world_mut().entity_mut(stage.camera).remove::<LumivoxGi>();
    let flat = stage.settled().mean_luminance();
    stage.app.insert_resource(GlobalAmbientLight::NONE);
    let direct = stage.settled().mean_luminance();
    // Light through the front, not Bevy's own ambient light, which nothing occludes.
    let exposure = bevy::camera::Exposure { ev100: 4.0 }.exposure();
    let [found, truth] = [(lit - dark) / exposure, truth::light_of_surroundings(5.0)];
    println!("{found} cd/m2, the path tracer {truth}");
    assert!((found / truth - 1.0).abs() < 0.12, "{found} {truth}");
    assert!(flat > direct, "{flat} {direct}");
    // A camera's ambient light is disabled and restored as well.
    let own = AmbientLight { brightness: 5.0, ..AmbientLight::default() };
    stage.app.world_mut().entity_mut(stage.camera).insert((own, quick()));
    let own_lit = stage.settled().mean_luminance();
    assert!((own_lit - lit).abs() < 0.05 * lit, "{own_lit} {lit}");
    stage.app.world_mut().entity_mut(stage.camera).remove::<LumivoxGi>();
    let own_flat = stage.settled().mean_luminance();
    assert!((own_flat - flat).abs() < 0.02 * flat, "{own_flat} {flat}");
}
