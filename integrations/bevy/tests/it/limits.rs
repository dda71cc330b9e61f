//! Unsupported things are reported, and nothing panics.

use bevy::asset::RenderAssetUsages;
use bevy::light::RectLight;
use bevy::mesh::PrimitiveTopology;
use bevy::prelude::*;
use bevy_lumivox::{GiVolume, LumivoxEvent};

use crate::common::scene;
use crate::stage::{Stage, alone, quick};

#[test]
fn an_empty_world_waits_and_reports_skipped_objects() {
    let _alone = alone();
    let given = scene::builtin("cornell");
    let nothing =
        lumivox_scene::Scene { cameras: given.cameras.clone(), ..lumivox_scene::Scene::default() };
    let mut stage = Stage::of(&nothing, UVec2::new(16, 16));
    stage.use_small_shadow_maps();
    stage.camera().insert(quick());
    stage.frames(10);
    assert_eq!(stage.events(), []);
    scene::spawn(stage.app.world_mut(), &given);
    stage.wait_for(|event| *event == LumivoxEvent::Ready);
    what_is_left_out_is_reported_once(&mut stage);
    settings_out_of_range_are_reported_once(&mut stage);
}

fn settings_out_of_range_are_reported_once(stage: &mut Stage) {
    stage.gi().volume = GiVolume::Scene { resolution: 7 };
    let event = stage.wait_for(|event| matches!(event, LumivoxEvent::Failed { .. }));
    let LumivoxEvent::Failed { error } = event else { return };
    assert!(error.contains("resolution is 7"), "{error}");
    stage.frames(5);
    assert_eq!(stage.events(), []);
}

fn what_is_left_out_is_reported_once(stage: &mut Stage) {
    let strip = Mesh::new(PrimitiveTopology::TriangleStrip, RenderAssetUsages::all())
        .with_inserted_attribute(
            Mesh::ATTRIBUTE_POSITION,
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        )
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 3]);
    let strip = stage.add(strip);
    let material = stage.add(StandardMaterial::from(Color::WHITE));
    for _ in 0..2 {
        stage.app.world_mut().spawn((Mesh3d(strip.clone()), MeshMaterial3d(material.clone())));
    }
    stage.app.world_mut().spawn(RectLight::default());
    // Textures need coordinates.
    let image = stage.add(Image::default());
    let textured = StandardMaterial { base_color_texture: Some(image), ..default() };
    let textured = stage.add(textured);
    let mut plain = Mesh::from(Cuboid::from_length(0.1));
    plain.remove_attribute(Mesh::ATTRIBUTE_UV_0);
    let plain = stage.add(plain);
    stage.app.world_mut().spawn((Mesh3d(plain), MeshMaterial3d(textured)));
    let mut told = Vec::new();
    for _ in 0..20 {
        stage.app.update();
        told.extend(stage.events());
    }
    assert_eq!(told.len(), 3, "{told:?}");
    for part in ["strips", "ATTRIBUTE_UV_0"] {
        let is_it = |event: &LumivoxEvent| matches!(event, LumivoxEvent::MeshLeftOut { reason } if reason.contains(part));
        assert!(told.iter().any(is_it), "{told:?}");
    }
    assert!(told.contains(&LumivoxEvent::LightLeftOut { kind: "RectLight" }), "{told:?}");
}

/// A device with too few storage buffers: reported once, and Bevy continues with its own light.
#[test]
fn missing_device_limits_are_reported_once() {
    let _alone = alone();
    let given = scene::builtin("cornell");
    let mut limits = bevy::render::settings::WgpuLimits::default();
    // Enough for Bevy.
    limits.max_storage_buffers_per_shader_stage = 7;
    let mut stage = Stage::on(Some(limits), &given, UVec2::new(16, 16));
    stage.use_small_shadow_maps();
    stage.camera().insert(quick());
    let event = stage.wait_for(|event| {
        matches!(event, LumivoxEvent::Failed { .. } | LumivoxEvent::Unsupported { .. })
    });
    println!("{event:?}");
    let told = format!("{event:?}");
    assert!(told.contains("max_storage_buffers_per_shader_stage"), "{told}");
    stage.frames(5);
    assert_eq!(stage.events(), []);
}
