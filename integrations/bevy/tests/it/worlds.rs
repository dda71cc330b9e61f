//! Cascades, suns, masks, environment maps and vertex colours.

use std::f32::consts::PI;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::RenderLayers;
use bevy::light::{EnvironmentMapLight, GlobalAmbientLight};
use bevy::prelude::*;
use bevy::render::render_resource::{
    Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
};
use bevy_lumivox::{GiVolume, LumivoxGi};

use crate::common::{headless, scene};
use crate::stage::{Stage, alone, difference, quick};
use crate::truth;

#[test]
fn cascades_light_a_room_as_a_box_does() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let eye = Vec3::new(0.0, 1.0, 0.9);
    let inside = Transform::from_translation(eye).looking_at(Vec3::new(0.0, 0.8, -1.0), Vec3::Y);
    stage.app.world_mut().entity_mut(stage.camera).insert(inside);
    let boxed = stage.settled();
    // The finest cascade contains the room, in voxels as large as those of the box.
    let volume = GiVolume::Cascades { count: 2, resolution: 64, voxel_size: 0.0625 };
    let gi = LumivoxGi { volume, ..quick() };
    stage.app.world_mut().entity_mut(stage.camera).insert(gi);
    headless::wait_until_ready(&mut stage.app);
    let nested = stage.settled();
    nested.save("target/pictures/cascades.png", 2.0);
    boxed.save("target/pictures/cascades-boxed.png", 2.0);
    println!("{} {}", nested.mean_luminance(), boxed.mean_luminance());
    let change = difference(&nested, &boxed);
    println!("cascades: {change}");
    assert!(change < 0.1, "{change}");
}

/// A map that is bright on one side follows its rotation, and lights the room only through the
/// front. A uniform map lights like ambient light, which `limits.rs` compares with path tracing.
#[test]
fn environment_maps_are_seen_through_openings() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let dark = stage.settled();
    stage.app.insert_resource(GlobalAmbientLight { brightness: 5.0, ..default() });
    let ambient = stage.settled();
    stage.app.insert_resource(GlobalAmbientLight::NONE);
    let mut lit_by = |map: &dyn Fn(&mut Assets<Image>) -> EnvironmentMapLight| {
        let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
        let map = map(&mut images);
        stage.app.world_mut().entity_mut(stage.camera).insert(map);
        stage.settled()
    };
    let even = lit_by(&|images| {
        EnvironmentMapLight::solid_color(images, Color::WHITE).with_intensity(5.0)
    });
    even.save("target/pictures/even-map.png", 2.0);
    let change = difference(&even, &ambient);
    println!("an even map against ambient light: {change}");
    assert!(change < 0.03, "{change}");
    let added = |shot: &headless::Shot| shot.mean_luminance() - dark.mean_luminance();
    // All light from below; a quarter turn brings it to the open front or behind the room.
    let from_below = |turn: Quat| {
        move |images: &mut Assets<Image>| EnvironmentMapLight {
            intensity: 30.0,
            rotation: turn,
            ..EnvironmentMapLight::hemispherical_gradient(
                images,
                Color::BLACK,
                Color::BLACK,
                Color::WHITE,
            )
        }
    };
    let front = added(&lit_by(&from_below(Quat::from_rotation_x(-0.5 * PI))));
    let behind = added(&lit_by(&from_below(Quat::from_rotation_x(0.5 * PI))));
    println!("from the front {front}, from behind {behind}, even {}", added(&ambient));
    assert!(front > 10.0 * behind.abs(), "{front} {behind}");
    // New content in the same texture.
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
    let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
    let image = images.add(image);
    let map = EnvironmentMapLight {
        diffuse_map: image.clone(),
        specular_map: image.clone(),
        intensity: 5.0,
        ..default()
    };
    stage.app.world_mut().entity_mut(stage.camera).insert(map);
    let white = added(&stage.settled());
    let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
    images.get_mut(&image).expect("there").data.as_mut().expect("texels").fill(0);
    let black = added(&stage.settled());
    println!("white {white}, then black {black}");
    assert!((white / added(&ambient) - 1.0).abs() < 0.05 && black.abs() < 0.05 * white);
    stage.app.world_mut().entity_mut(stage.camera).remove::<EnvironmentMapLight>();
    let again = stage.settled();
    let change = difference(&again, &dark);
    assert!(change < 0.03, "{change}");
}

/// A sun through the front, all bounces, against the path tracer.
#[test]
#[ignore = "slow: as the Cornell box (`truth.rs`), of which it differs in the light alone"]
fn a_sun_is_as_bright_as_it_is() {
    let _alone = alone();
    let mut given = scene::builtin("cornell");
    given.name = "sun".to_owned();
    for material in &mut given.materials {
        material.emissive = Vec3::ZERO;
    }
    given.lights = vec![lumivox_scene::Light {
        kind: lumivox_scene::LightKind::Directional {
            illuminance_lux: 40.0,
            angular_radius_rad: 0.01,
        },
        direction: Vec3::new(0.35, -0.5, -0.8).normalize(),
        ..given.lights.first().cloned().unwrap_or_default()
    }];
    let stage = Stage::of(&given, truth::SIZE);
    let [bevy, own] = truth::errors_of(&truth::Expected::of(&given), stage, "sun");
    assert!(bevy.rmse_percent <= 1.1 * own.rmse_percent);
    assert!(bevy.bias_percent.abs() <= 1.1 * own.bias_percent.abs() + 1.0);
}

/// A masked screen before the open front lets light through its holes. The camera, of another
/// layer, does not see it.
#[test]
fn masks_let_light_through_their_holes() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    // Without the borders, where walls in front of the screen are seen.
    let middle = |shot: headless::Shot| {
        let rows = shot.rgb.chunks(48).skip(9).take(18);
        let pixels: Vec<_> = rows.flat_map(|row| &row[12..36]).copied().collect();
        headless::Shot { size: UVec2::new(24, 18), rgb: pixels }.mean_luminance()
    };
    let dark = middle(stage.settled());
    stage.app.insert_resource(GlobalAmbientLight { brightness: 5.0, ..default() });
    let open = middle(stage.settled()) - dark;
    let mut behind = |alphas: [u8; 2]| {
        let world = stage.app.world_mut();
        let texels =
            (0..64_u32).flat_map(|texel| [0, 0, 0, alphas[((texel % 8 + texel / 8) % 2) as usize]]);
        let image = Image::new(
            Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
            TextureDimension::D2,
            texels.collect(),
            TextureFormat::Rgba8UnormSrgb,
            RenderAssetUsages::all(),
        );
        let texture = world.resource_mut::<Assets<Image>>().add(image);
        let black = StandardMaterial {
            base_color_texture: Some(texture),
            alpha_mode: AlphaMode::Mask(0.5),
            double_sided: true,
            cull_mode: None,
            ..default()
        };
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(black);
        let mesh = world.resource_mut::<Assets<Mesh>>().add(Rectangle::new(2.0, 2.0));
        let place = Transform::from_xyz(0.0, 1.0, 0.97);
        let parts = (Mesh3d(mesh), MeshMaterial3d(material), place, RenderLayers::layer(1));
        let screen = world.spawn(parts).id();
        stage.frames(40);
        let light = middle(stage.settled()) - dark;
        stage.app.world_mut().despawn(screen);
        light / open
    };
    let (holes, half, none) = (behind([0, 0]), behind([0, 255]), behind([255, 255]));
    println!("all holes {holes}, half {half}, none {none}");
    assert!((holes - 1.0).abs() < 0.05 && (0.35..0.6).contains(&half) && none < 0.06);
}

/// Vertex colours light like a material of the same colour.
#[test]
fn colours_of_vertices_are_those_of_voxels() {
    let _alone = alone();
    let blue = Color::linear_rgb(0.1, 0.2, 0.9);
    let lit = |by_vertices: bool| {
        let mut stage = Stage::cornell();
        let world = stage.app.world_mut();
        let mut mesh = Cuboid::new(0.1, 1.2, 0.9).mesh().build();
        let color = blue.to_linear().to_f32_array();
        if by_vertices {
            let colors = vec![color; mesh.count_vertices()];
            mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
        }
        let base_color = if by_vertices { Color::WHITE } else { blue };
        let material = StandardMaterial { base_color, perceptual_roughness: 1.0, ..default() };
        let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        let place = Transform::from_xyz(0.0, 0.7, 0.0);
        world.spawn((Mesh3d(mesh), MeshMaterial3d(material), place));
        stage.settled()
    };
    let change = difference(&lit(true), &lit(false));
    println!("colours of vertices: {change}");
    assert!(change < 0.02, "{change}");
}
