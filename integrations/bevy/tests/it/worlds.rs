//! Surroundings, masks, cascades and suns.

use std::f32::consts::PI;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::light::{AmbientLight, EnvironmentMapLight, GlobalAmbientLight};
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy_lumivox::{GiVolume, LumivoxGi};

use crate::common::headless::{self, Shot};
use crate::common::scene;
use crate::stage::{Stage, alone, difference, quick};
use crate::truth;

fn ambient(brightness: f32) -> GlobalAmbientLight {
    GlobalAmbientLight { brightness, ..GlobalAmbientLight::default() }
}

/// The box is open only at its front, and all light of the surroundings enters there.
#[test]
fn surroundings_light_a_box_through_its_opening() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let dark = stage.settled();
    stage.app.insert_resource(ambient(5.0));
    let lit = stage.settled();
    masks_let_light_through_their_holes(&mut stage, [&dark, &lit]);
    ambient_light_is_occluded_and_comes_back(&mut stage, [&dark, &lit]);
    environment_maps_are_seen_through_openings(&mut stage, [&dark, &lit]);
    cascades_light_a_room_as_a_box_does(&mut stage);
}

/// A masked screen before the open front lets light through its holes. The camera, of another
/// layer, does not see it.
fn masks_let_light_through_their_holes(stage: &mut Stage, [dark, lit]: [&Shot; 2]) {
    // Without the borders, where walls in front of the screen are seen.
    let middle = |shot: &Shot| {
        let rows = shot.rgb.chunks(48).skip(9).take(18);
        let rgb = rows.flat_map(|row| &row[12..36]).copied().collect();
        Shot { size: UVec2::new(24, 18), rgb }.mean_luminance()
    };
    let mut behind = |alphas: [u8; 2]| {
        let texels =
            (0..64_u32).flat_map(|texel| [0, 0, 0, alphas[((texel % 8 + texel / 8) % 2) as usize]]);
        let texture = stage.add(Image::new(
            Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
            TextureDimension::D2,
            texels.collect(),
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::all(),
        ));
        let material = stage.add(StandardMaterial {
            base_color_texture: Some(texture),
            alpha_mode: AlphaMode::Mask(0.5),
            double_sided: true,
            cull_mode: None,
            ..default()
        });
        let mesh = stage.add(Mesh::from(Rectangle::new(2.0, 2.0)));
        let place = Transform::from_xyz(0.0, 1.0, 0.97);
        let parts = (Mesh3d(mesh), MeshMaterial3d(material), place, RenderLayers::layer(1));
        let screen = stage.app.world_mut().spawn(parts).id();
        let light = middle(&stage.settled()) - middle(dark);
        stage.app.world_mut().despawn(screen);
        light / (middle(lit) - middle(dark))
    };
    let (none, half, holes) = (behind([255, 255]), behind([0, 255]), behind([0, 0]));
    println!("all holes {holes}, half {half}, none {none}");
    assert!((holes - 1.0).abs() < 0.05 && (0.35..0.6).contains(&half) && none < 0.06);
}

fn ambient_light_is_occluded_and_comes_back(stage: &mut Stage, lights: [&Shot; 2]) {
    let [dark, lit] = lights.map(Shot::mean_luminance);
    let exposure = bevy::camera::Exposure { ev100: 4.0 }.exposure();
    let [found, truth] = [(lit - dark) / exposure, truth::light_of_surroundings(5.0)];
    println!("{found} cd/m2, the path tracer {truth}");
    assert!((found / truth - 1.0).abs() < 0.12, "{found} {truth}");
    // Bevy's own ambient light, which nothing occludes.
    stage.camera().remove::<LumivoxGi>();
    let flat = stage.settled().mean_luminance();
    stage.app.insert_resource(GlobalAmbientLight::NONE);
    let direct = stage.settled().mean_luminance();
    assert!(flat > direct, "{flat} {direct}");
    // A camera's ambient light is disabled and restored as well.
    stage.camera().insert((AmbientLight { brightness: 5.0, ..default() }, quick()));
    let own_lit = stage.settled().mean_luminance();
    assert!((own_lit - lit).abs() < 0.05 * lit, "{own_lit} {lit}");
    stage.camera().remove::<LumivoxGi>();
    let own_flat = stage.settled().mean_luminance();
    assert!((own_flat - flat).abs() < 0.02 * flat, "{own_flat} {flat}");
    stage.camera().remove::<AmbientLight>().insert(quick());
}

/// A uniform map lights like ambient light; a map that is bright on one side follows its rotation.
fn environment_maps_are_seen_through_openings(stage: &mut Stage, [dark, lit]: [&Shot; 2]) {
    let added = |shot: &Shot| shot.mean_luminance() - dark.mean_luminance();
    let mut image = Image::new_fill(
        Extent3d { width: 1, height: 1, depth_or_array_layers: 6 },
        TextureDimension::D2,
        &[255; 4],
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::all(),
    );
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::Cube),
        ..TextureViewDescriptor::default()
    });
    let image = stage.add(image);
    stage.camera().insert(EnvironmentMapLight {
        diffuse_map: image.clone(),
        specular_map: image.clone(),
        intensity: 5.0,
        ..default()
    });
    let white = stage.settled();
    white.save("target/pictures/even-map.png", 2.0);
    let change = difference(&white, lit);
    println!("an even map against ambient light: {change}");
    assert!(change < 0.03, "{change}");
    // New content in the same texture.
    let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
    images.get_mut(&image).expect("there").data.as_mut().expect("texels").fill(0);
    let [white, black] = [added(&white), added(&stage.settled())];
    println!("white {white}, then black {black}");
    assert!((white / added(lit) - 1.0).abs() < 0.05 && black.abs() < 0.05 * white);
    // All light from below; a quarter turn brings it behind the room or to the open front.
    let [behind, front] = [0.5 * PI, -0.5 * PI].map(|angle| {
        let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
        let [black, white] = [Color::BLACK, Color::WHITE];
        let map = EnvironmentMapLight {
            intensity: 30.0,
            rotation: Quat::from_rotation_x(angle),
            ..EnvironmentMapLight::hemispherical_gradient(&mut images, black, black, white)
        };
        stage.camera().insert(map);
        added(&stage.settled())
    });
    println!("from the front {front}, from behind {behind}, even {white}");
    assert!(front > 10.0 * behind.abs(), "{front} {behind}");
    stage.camera().remove::<EnvironmentMapLight>();
    let change = difference(&stage.settled(), dark);
    assert!(change < 0.03, "{change}");
}

fn cascades_light_a_room_as_a_box_does(stage: &mut Stage) {
    let eye = Vec3::new(0.0, 1.0, 0.9);
    let inside = Transform::from_translation(eye).looking_at(Vec3::new(0.0, 0.8, -1.0), Vec3::Y);
    stage.camera().insert(inside);
    let boxed = stage.settled();
    // The finest cascade contains the room, in voxels as large as those of the box.
    stage.gi().volume = GiVolume::Cascades { count: 2, resolution: 64, voxel_size: 0.0625 };
    headless::wait_until_ready(&mut stage.app);
    let nested = stage.settled();
    nested.save("target/pictures/cascades.png", 2.0);
    boxed.save("target/pictures/cascades-boxed.png", 2.0);
    println!("{} {}", nested.mean_luminance(), boxed.mean_luminance());
    let change = difference(&nested, &boxed);
    println!("cascades: {change}");
    assert!(change < 0.1, "{change}");
}

/// A sun through the front, all bounces, against the path tracer.
#[test]
#[ignore = "slow: as the Cornell box (`truth.rs`), of which it differs in the light alone"]
fn a_sunlit_box_matches_the_path_tracer() {
    let _alone = alone();
    let mut given = scene::builtin("cornell");
    given.name = "sun".to_owned();
    for material in &mut given.materials {
        material.emissive = Vec3::ZERO;
    }
    given.lights = vec![lumivox_scene::Light {
        kind: lumivox_scene::LightKind::Directional,
        intensity: 40.0,
        angular_radius_rad: 0.01,
        direction: Vec3::new(0.35, -0.5, -0.8).normalize(),
        ..given.lights.first().cloned().unwrap_or_default()
    }];
    let mut stage = Stage::of(&given, truth::SIZE);
    let [bevy, own] = truth::errors_of(&truth::Expected::of(&given), &mut stage, "sun");
    assert!(bevy.rmse_percent <= 1.1 * own.rmse_percent);
    assert!(bevy.bias_percent.abs() <= 1.1 * own.bias_percent.abs() + 1.0);
}
