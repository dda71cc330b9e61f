//! Objects, assets, cameras and settings that change.

use bevy::anti_alias::taa::TemporalAntiAliasing;
use bevy::asset::RenderAssetUsages;
use bevy::camera::{Exposure, RenderTarget, Viewport};
use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy::render::camera::TemporalJitter;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_lumivox::lumivox::gpu::{LiveResources, MadeResources};
use bevy_lumivox::{GiVolume, LumivoxGi, NotInGi};

use crate::common::{headless, scene};
use crate::stage::{Stage, alone, difference, quick, without_lamp};

#[test]
fn a_block_that_has_moved_looks_as_if_it_had_been_there_always() {
    let _alone = alone();
    let given = scene::builtin("cornell");
    let mut stage = Stage::cornell();
    let before = stage.settled();
    let block = stage.instance(&given, "tall block");
    for step in 0..20 {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(block).expect("a transform");
        transform.translation.x = -0.33 + 0.03 * step as f32;
        stage.app.update();
    }
    let moved = stage.settled();
    moved.save("target/pictures/moved.png", 2.0);
    let mut there = given.clone();
    let instance = there.instances.iter_mut().find(|instance| instance.name == "tall block");
    let matrix = &mut instance.expect("the block").world_from_local;
    matrix.w_axis.x = -0.33 + 0.03 * 19.0;
    let mut fresh = Stage::of(&there, UVec2::new(48, 36));
    fresh.use_small_shadow_maps();
    fresh.app.world_mut().entity_mut(fresh.camera).insert(quick());
    headless::wait_until_ready(&mut fresh.app);
    let always = fresh.settled();
    let [from_always, from_before] = [&always, &before].map(|other| difference(&moved, other));
    println!("from always {from_always}, from before {from_before}");
    assert!(from_always < 0.04 && from_before > 0.2, "{from_always} {from_before}");
}

/// The means of squares of 4x4 pixels, in which smooth and hard edges look alike.
fn coarse(shot: &headless::Shot) -> headless::Shot {
    let size = shot.size / 4;
    let mut rgb = vec![Vec3::ZERO; size.element_product() as usize];
    for (index, color) in (0..).zip(&shot.rgb) {
        let place = UVec2::new(index % shot.size.x, index / shot.size.x) / 4;
        rgb[(place.y * size.x + place.x) as usize] += *color / 16.0;
    }
    headless::Shot { size, rgb }
}

/// TAA jitters cameras: positions from depth match it, and a moved block leaves no trace.
#[test]
fn temporal_antialiasing_smooths_edges_alone() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    // Twice as long as elsewhere, since the remaining noise is compared.
    let settled = |stage: &mut Stage| {
        stage.frames(20);
        without_lamp(&stage.settled())
    };
    let rough = settled(&mut stage);
    stage.app.world_mut().entity_mut(stage.camera).insert(TemporalAntiAliasing::default());
    let smooth = settled(&mut stage);
    smooth.save("target/pictures/taa.png", 2.0);
    rough.save("target/pictures/no-taa.png", 2.0);
    let share = smooth.mean_luminance() / rough.mean_luminance();
    let [edges, still] =
        [difference(&smooth, &rough), difference(&coarse(&smooth), &coarse(&rough))];
    println!("mean {share}, change {edges}, of squares {still}");
    assert!((share - 1.0).abs() < 0.02, "{share}");
    assert!(edges > 0.01, "{edges}");
    assert!(still < 0.2, "{still}");

    let block = stage.instance(&scene::builtin("cornell"), "tall block");
    for step in 0..20 {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(block).expect("a transform");
        transform.translation.x = -0.33 + 0.03 * step as f32;
        stage.app.update();
    }
    let moved = settled(&mut stage);
    stage.app.world_mut().entity_mut(stage.camera).remove::<TemporalAntiAliasing>();
    stage.app.world_mut().entity_mut(stage.camera).remove::<TemporalJitter>();
    let rough = settled(&mut stage);
    moved.save("target/pictures/taa-moved.png", 2.0);
    rough.save("target/pictures/no-taa-moved.png", 2.0);
    let [left, way] = [
        difference(&coarse(&moved), &coarse(&rough)),
        difference(&coarse(&moved), &coarse(&smooth)),
    ];
    println!("after a move {left}, by the move {way}");
    assert!(left < 1.2 * still && way > 1.5 * left, "{left} {way}");
}

#[test]
fn steady_frames_make_nothing_on_the_gpu() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    stage.frames(48);
    let before = MadeResources::now();
    stage.frames(30);
    let after = MadeResources::now();
    let made = [
        after.buffers - before.buffers,
        after.textures - before.textures,
        after.bind_groups - before.bind_groups,
    ];
    assert_eq!(made, [0; 3]);
}

#[test]
fn crowds_leave_nothing_behind() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let empty = stage.settled();
    let world = stage.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::from_length(0.01));
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(Color::WHITE);
    let mut bytes = Vec::new();
    for _ in 0..3 {
        let crowd: Vec<Entity> = (0..5_000)
            .map(|number| {
                let place = UVec3::new(number % 22, (number / 22) % 22, number / 484).as_vec3();
                let transform =
                    Transform::from_translation(place * 0.08 + Vec3::new(-0.9, 0.1, -0.9));
                let parts = (Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), transform);
                // Six shadow views of them would take time.
                stage.app.world_mut().spawn((parts, NotShadowCaster)).id()
            })
            .collect();
        stage.frames(6);
        for entity in crowd {
            stage.app.world_mut().despawn(entity);
        }
        stage.frames(6);
        bytes.push(LiveResources::now().buffer_bytes);
    }
    println!("{bytes:?} bytes");
    assert!(bytes[2] <= bytes[1], "memory grows: {bytes:?}");
    let left = stage.settled();
    let change = difference(&left, &empty);
    assert!(change < 0.03, "{change}");
}

#[test]
fn assets_may_come_late_and_be_replaced() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let empty = stage.settled();
    let world = stage.app.world_mut();
    let mesh = world.resource::<Assets<Mesh>>().reserve_handle();
    let image = world.resource::<Assets<Image>>().reserve_handle();
    let material = StandardMaterial {
        base_color_texture: Some(image.clone()),
        emissive: LinearRgba::rgb(0.0, 0.0, 0.0),
        perceptual_roughness: 1.0,
        ..StandardMaterial::default()
    };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
    let transform = Transform::from_xyz(0.0, 1.0, -0.5);
    let parts = (Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), transform);
    let ball = world.spawn(parts).id();
    stage.frames(10);
    let size = Extent3d { width: 2, height: 2, depth_or_array_layers: 1 };
    let pixels = [255, 20, 20, 255].repeat(4);
    let format = TextureFormat::Rgba8UnormSrgb;
    let red = Image::new(size, TextureDimension::D2, pixels, format, RenderAssetUsages::all());
    let world = stage.app.world_mut();
    world.resource_mut::<Assets<Mesh>>().insert(&mesh, Sphere::new(0.4).into()).expect("new");
    world.resource_mut::<Assets<Image>>().insert(&image, red).expect("new");
    let with_ball = stage.settled();
    assert!(difference(&with_ball, &empty) > 0.1);
    // The mesh of an asset is replaced: first a ball, then a tiny cube.
    stage.app.world_mut().despawn(ball);
    let world = stage.app.world_mut();
    let white = world.resource_mut::<Assets<StandardMaterial>>().add(Color::WHITE);
    let replaced = world.resource_mut::<Assets<Mesh>>().add(Sphere::new(0.4));
    let parts = (Mesh3d(replaced.clone()), MeshMaterial3d(white), transform);
    let other = world.spawn(parts).id();
    let with_other = stage.settled();
    assert!(difference(&with_other, &empty) > 0.1);
    let world = stage.app.world_mut();
    let plate = Mesh::from(Cuboid::new(0.001, 0.001, 0.001));
    *world.resource_mut::<Assets<Mesh>>().get_mut(&replaced).expect("there") = plate;
    stage.frames(40);
    let small = stage.settled();
    for (name, shot) in [("empty", &empty), ("ball", &with_ball), ("small", &small)] {
        shot.save(format!("target/pictures/late-{name}.png"), 2.0);
    }
    let change = difference(&small, &empty);
    println!("replaced: {change}");
    assert!(change < 0.03, "{change}");
    stage.app.world_mut().despawn(other);
    // The material is emissive now, but no entity has it.
    let world = stage.app.world_mut();
    let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
    materials.get_mut(&material).expect("there").emissive = LinearRgba::rgb(10.0, 10.0, 10.0);
    let gone = stage.settled();
    let change = difference(&gone, &empty);
    assert!(change < 0.03, "{change}");
}

/// The texture stays; its content changes.
#[test]
fn images_may_be_modified_in_place() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let size = Extent3d { width: 2, height: 2, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    let of = |texel: [u8; 4]| {
        Image::new(size, TextureDimension::D2, texel.repeat(4), format, RenderAssetUsages::all())
    };
    let world = stage.app.world_mut();
    let image = world.resource_mut::<Assets<Image>>().add(of([255, 20, 20, 255]));
    let material = StandardMaterial {
        base_color_texture: Some(image.clone()),
        perceptual_roughness: 1.0,
        ..StandardMaterial::default()
    };
    let material = world.resource_mut::<Assets<StandardMaterial>>().add(material);
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::new(1.9, 0.02, 1.9));
    // A floor, whose light falls on the front of the short block.
    let place = Transform::from_xyz(0.0, 0.02, 0.0);
    world.spawn((Mesh3d(mesh), MeshMaterial3d(material), place));
    let redness = |shot: &headless::Shot| {
        let front = (25..32).flat_map(|y| (24..31).map(move |x| (y * shot.size.x + x) as usize));
        let sum: Vec3 = front.map(|pixel| shot.rgb[pixel]).sum();
        sum.x / sum.y
    };
    let red = stage.settled();
    let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
    images.get_mut(&image).expect("there").data = of([20, 255, 20, 255]).data;
    let green = stage.settled();
    red.save("target/pictures/modified-red.png", 2.0);
    green.save("target/pictures/modified-green.png", 2.0);
    println!("{} {}", redness(&red), redness(&green));
    assert!(redness(&red) > 2.0 && redness(&green) < 1.0);
}

/// Usual exposures keep the unit of light; beyond them, the voxels are rebuilt.
#[test]
fn another_exposure_shows_the_same_light() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    stage.frames(20);
    let before = stage.settled();
    let show = |stage: &mut Stage, ev100: f32| {
        stage.app.world_mut().entity_mut(stage.camera).insert(Exposure { ev100 });
        Exposure { ev100: 4.0 }.exposure() / Exposure { ev100 }.exposure()
    };
    let change = |mut shot: headless::Shot, factor: f32| {
        for (rgb, before) in shot.rgb.iter_mut().zip(&before.rgb) {
            // Without the lamp: Bevy's G-buffer holds no emission that bright.
            *rgb = if before.max_element() > 0.3 { *before } else { *rgb * factor };
        }
        difference(&shot, &before)
    };
    for ev100 in [14.0, 2.0] {
        let factor = show(&mut stage, ev100);
        let worst = (0..5).map(|_| change(stage.next(), factor)).fold(0.0, f32::max);
        println!("EV100 {ev100}: {worst}");
        assert!(worst < 0.03, "EV100 {ev100}: {worst}");
    }
    let factor = show(&mut stage, -9.0);
    stage.app.update();
    headless::wait_until_ready(&mut stage.app);
    let in_another_unit = change(stage.settled(), factor);
    println!("in another unit of light: {in_another_unit}");
    assert!(in_another_unit < 0.03, "{in_another_unit}");
}

#[test]
fn what_is_hidden_or_left_out_lends_no_light() {
    let _alone = alone();
    let given = scene::builtin("cornell");
    let mut stage = Stage::cornell();
    let red = stage.instance(&given, "left wall");
    let redness = |shot: &headless::Shot| {
        let [red, green] =
            [0, 1].map(|channel| shot.rgb.iter().map(|rgb| rgb[channel]).sum::<f32>());
        red / green
    };
    let with_wall = redness(&stage.settled());
    stage.app.world_mut().entity_mut(red).insert(NotInGi);
    let left_out = redness(&stage.settled());
    stage.app.world_mut().entity_mut(red).remove::<NotInGi>();
    // Bounces take some frames.
    stage.frames(120);
    let again = redness(&stage.settled());
    stage.app.world_mut().entity_mut(red).insert(Visibility::Hidden);
    let hidden = redness(&stage.settled());
    println!("{with_wall} {left_out} {again} {hidden}");
    assert!(left_out < with_wall - 0.02 && hidden < left_out);
    assert!((again - with_wall).abs() < 0.01);
}

#[test]
fn cameras_come_resize_and_go() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let whole = stage.settled();
    // A second camera with this view, at the right of a wider picture.
    let (image, target) = headless::target(&mut stage.app, UVec2::new(112, 36));
    let world = stage.app.world_mut();
    let camera = world.entity(stage.camera);
    let parts = (
        *camera.get::<Transform>().expect("a transform"),
        camera.get::<Projection>().expect("a lens").clone(),
        *camera.get::<Exposure>().expect("an exposure"),
        *camera.get::<LumivoxGi>().expect("global illumination"),
        bevy::core_pipeline::tonemapping::Tonemapping::None,
        bevy::core_pipeline::tonemapping::DebandDither::Disabled,
    );
    let viewport = Viewport {
        physical_position: UVec2::new(64, 0),
        physical_size: UVec2::new(48, 36),
        ..Viewport::default()
    };
    let lens = Camera { viewport: Some(viewport), order: 1, ..Camera::default() };
    let second = world.spawn((Camera3d::default(), lens, target, parts)).id();
    stage.frames(30);
    let wide = headless::mean_shot(&mut stage.app, &image, 8);
    let rows = wide.rgb.chunks(112).flat_map(|row| row[64..].to_vec());
    let right = headless::Shot { size: whole.size, rgb: rows.collect() };
    right.save("target/pictures/viewport.png", 2.0);
    let change = difference(&right, &whole);
    assert!(change < 0.04, "{change}");
    // A camera that is switched off for a while, and a picture of another size.
    let world = stage.app.world_mut();
    world.get_mut::<Camera>(second).expect("a camera").is_active = false;
    stage.frames(3);
    world_resize(&mut stage, UVec2::new(64, 64));
    stage.frames(3);
    world_resize(&mut stage, UVec2::new(48, 36));
    let again = stage.settled();
    let change = difference(&again, &whole);
    assert!(change < 0.04, "{change}");
    stage.app.world_mut().despawn(second);
    stage.app.world_mut().despawn(stage.camera);
    stage.frames(130);
    let left = LiveResources::now().buffer_bytes;
    assert!(left < 8 << 20, "{left} bytes are left after the last camera");
}

fn world_resize(stage: &mut Stage, size: UVec2) {
    let (image, target) = headless::target(&mut stage.app, size);
    stage.app.world_mut().entity_mut(stage.camera).insert::<RenderTarget>(target);
    stage.image = image;
}

#[test]
fn settings_change_at_run_time() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let before = stage.settled();
    let camera = stage.camera;
    let mut set = |change: fn(&mut LumivoxGi)| {
        change(&mut stage.app.world_mut().get_mut::<LumivoxGi>(camera).expect("it is there"));
        stage.settled()
    };
    let high = set(|gi| gi.quality = bevy_lumivox::GiQuality::Balanced);
    let change = difference(&high, &before);
    assert!(change < 0.1, "{change}");
    // Another volume is built in the background; until then the old one lights every frame.
    let min = Vec3::new(-1.1, -0.1, -1.1);
    stage.app.world_mut().get_mut::<LumivoxGi>(camera).expect("it is there").volume =
        GiVolume::Box { min, max: Vec3::new(1.1, 2.1, 1.1), resolution: 40 };
    let worst = (0..120).map(|_| difference(&stage.next(), &high)).fold(0.0, f32::max);
    println!("the worst frame while another volume is made: {worst}");
    assert!(worst < 0.2, "{worst}");
    let other = stage.settled_over(24);
    // Without global illumination until its resources are freed.
    let gi = *stage.app.world().get::<LumivoxGi>(camera).expect("it is there");
    stage.app.world_mut().entity_mut(camera).remove::<LumivoxGi>();
    stage.frames(130);
    stage.app.world_mut().entity_mut(camera).insert(gi);
    headless::wait_until_ready(&mut stage.app);
    let again = stage.settled_over(24);
    let [from_high, from_other] = [difference(&other, &high), difference(&again, &other)];
    println!("another volume {from_high}, once more {from_other}");
    assert!(from_high < 0.1 && from_other < 0.03, "{from_high} {from_other}");
}
