//! Objects, assets, cameras and settings that change.

use bevy::anti_alias::taa::TemporalAntiAliasing;
use bevy::asset::RenderAssetUsages;
use bevy::camera::{Exposure, RenderTarget, Viewport};
use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use bevy_lumivox::lumivox::gpu::{LiveResources, MadeResources};
use bevy_lumivox::{GiQuality, GiVolume, NotInGi};

use crate::common::headless::{self, Shot};
use crate::common::scene;
use crate::stage::{Stage, alone, difference, quick, without_lamp};

/// The means of 4x4 pixels, in which smooth and hard edges look alike.
fn coarse(shot: &Shot) -> Shot {
    let size = shot.size / 4;
    let mut rgb = vec![Vec3::ZERO; size.element_product() as usize];
    for (index, color) in (0..).zip(&shot.rgb) {
        let place = UVec2::new(index % shot.size.x, index / shot.size.x) / 4;
        rgb[(place.y * size.x + place.x) as usize] += *color / 16.0;
    }
    Shot { size, rgb }
}

/// A moved block looks as if it had always been there. TAA, which jitters cameras, only smooths
/// edges: positions from depth match the jitter, and a moving block leaves no trace.
#[test]
fn a_moved_block_leaves_no_trace_with_or_without_taa() {
    let _alone = alone();
    let mut given = scene::builtin("cornell");
    let instance = given.instances.iter_mut().find(|instance| instance.name == "tall block");
    let place = &mut instance.expect("the block").world_from_local.w_axis;
    let (y, z) = (place.y, place.z);
    let mut steps: Vec<_> =
        (0..20).map(|step| Vec3::new(-0.33 + 0.03 * step as f32, y, z)).collect();
    *place = steps[19].extend(1.0);
    let mut stage = Stage::ready(&given);
    let block = stage.instance("tall block");
    let slide = |stage: &mut Stage, steps: &[Vec3]| {
        for at in steps {
            stage.place(block, *at);
            stage.app.update();
        }
    };
    // Twice as long as elsewhere, since the remaining noise is compared.
    let settled = |stage: &mut Stage| {
        stage.frames(20);
        stage.settled()
    };
    let always = settled(&mut stage);
    stage.place(block, steps[0]);
    let before = settled(&mut stage);
    slide(&mut stage, &steps);
    let moved = stage.settled();
    moved.save("target/pictures/moved.png", 2.0);
    let [from_always, from_before] = [&always, &before].map(|other| difference(&moved, other));
    println!("from always {from_always}, from before {from_before}");
    assert!(from_always < 0.04 && from_before > 0.2, "{from_always} {from_before}");

    stage.camera().insert(TemporalAntiAliasing::default());
    let [rough, rough_start] = [always, before].map(|shot| without_lamp(&shot));
    let smooth = without_lamp(&settled(&mut stage));
    smooth.save("target/pictures/taa.png", 2.0);
    rough.save("target/pictures/no-taa.png", 2.0);
    let share = smooth.mean_luminance() / rough.mean_luminance();
    let [edges, still] =
        [difference(&smooth, &rough), difference(&coarse(&smooth), &coarse(&rough))];
    println!("mean {share}, change {edges}, of squares {still}");
    assert!((share - 1.0).abs() < 0.02, "{share}");
    assert!(edges > 0.01, "{edges}");
    assert!(still < 0.2, "{still}");

    steps.reverse();
    slide(&mut stage, &steps);
    let moved = without_lamp(&settled(&mut stage));
    moved.save("target/pictures/taa-moved.png", 2.0);
    rough_start.save("target/pictures/no-taa-moved.png", 2.0);
    let [left, way] =
        [&rough_start, &smooth].map(|other| difference(&coarse(&moved), &coarse(other)));
    println!("after a move {left}, by the move {way}");
    assert!(left < 1.2 * still && way > 1.5 * left, "{left} {way}");
}

#[test]
fn light_follows_changed_objects_and_assets() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let empty = stage.settled();
    steady_frames_make_nothing_on_the_gpu(&mut stage);
    crowds_leave_nothing_behind(&mut stage, &empty);
    assets_may_come_late_and_be_replaced(&mut stage, &empty);
    hidden_and_excluded_things_give_no_light(&mut stage, &empty);
}

fn steady_frames_make_nothing_on_the_gpu(stage: &mut Stage) {
    stage.frames(20);
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

fn crowds_leave_nothing_behind(stage: &mut Stage, empty: &Shot) {
    let mesh = Mesh3d(stage.add(Mesh::from(Cuboid::from_length(0.01))));
    let material = MeshMaterial3d(stage.add(StandardMaterial::from(Color::WHITE)));
    let mut bytes = Vec::new();
    for _ in 0..3 {
        let crowd: Vec<Entity> = (0..1_000)
            .map(|number| {
                let place = UVec3::new(number % 22, (number / 22) % 22, number / 484).as_vec3();
                let transform =
                    Transform::from_translation(place * 0.08 + Vec3::new(-0.9, 0.1, -0.9));
                // Six shadow views of each would take time.
                let parts = (mesh.clone(), material.clone(), transform, NotShadowCaster);
                stage.app.world_mut().spawn(parts).id()
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
    let left = difference(&stage.settled(), empty);
    assert!(left < 0.03, "{left}");
}

/// A floor whose light falls on the front of the short block, and which becomes a tiny cube.
fn assets_may_come_late_and_be_replaced(stage: &mut Stage, empty: &Shot) {
    let size = Extent3d { width: 2, height: 2, depth_or_array_layers: 1 };
    let format = TextureFormat::Rgba8UnormSrgb;
    let of = |texel: [u8; 4]| {
        Image::new(size, TextureDimension::D2, texel.repeat(4), format, RenderAssetUsages::all())
    };
    let redness = |shot: &Shot| {
        let front = (25..32).flat_map(|y| (24..31).map(move |x| (y * shot.size.x + x) as usize));
        let sum: Vec3 = front.map(|pixel| shot.rgb[pixel]).sum();
        sum.x / sum.y
    };
    let world = stage.app.world_mut();
    let mesh = world.resource::<Assets<Mesh>>().reserve_handle();
    let image = world.resource::<Assets<Image>>().reserve_handle();
    let material = stage.add(StandardMaterial {
        base_color_texture: Some(image.clone()),
        perceptual_roughness: 1.0,
        ..StandardMaterial::default()
    });
    let place = Transform::from_xyz(0.0, 0.02, 0.0);
    let parts = (Mesh3d(mesh.clone()), MeshMaterial3d(material.clone()), place);
    let floor = stage.app.world_mut().spawn(parts).id();
    stage.frames(10);
    let world = stage.app.world_mut();
    let plate = Cuboid::new(1.9, 0.02, 1.9).into();
    world.resource_mut::<Assets<Mesh>>().insert(&mesh, plate).expect("new");
    world.resource_mut::<Assets<Image>>().insert(&image, of([255, 20, 20, 255])).expect("new");
    let red = stage.settled();
    // The texture stays; its content changes.
    let mut images = stage.app.world_mut().resource_mut::<Assets<Image>>();
    images.get_mut(&image).expect("there").data = of([20, 255, 20, 255]).data;
    let green = stage.settled();
    let mut meshes = stage.app.world_mut().resource_mut::<Assets<Mesh>>();
    *meshes.get_mut(&mesh).expect("there") = Cuboid::from_length(0.001).into();
    let tiny = stage.settled();
    // The material is emissive now, but no entity has it.
    stage.app.world_mut().despawn(floor);
    let mut materials = stage.app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    materials.get_mut(&material).expect("there").emissive = LinearRgba::rgb(10.0, 10.0, 10.0);
    let gone = stage.settled();
    for (name, shot) in [("red", &red), ("green", &green), ("tiny", &tiny)] {
        shot.save(format!("target/pictures/late-{name}.png"), 2.0);
    }
    println!("{} {}", redness(&red), redness(&green));
    assert!(redness(&red) > 2.0 && redness(&green) < 1.0);
    let [tiny, gone] = [tiny, gone].map(|shot| difference(&shot, empty));
    println!("tiny {tiny}, gone {gone}");
    assert!(tiny < 0.03 && gone < 0.03, "{tiny} {gone}");
}

fn hidden_and_excluded_things_give_no_light(stage: &mut Stage, empty: &Shot) {
    let redness = |shot: &Shot| {
        let [red, green] =
            [0, 1].map(|channel| shot.rgb.iter().map(|rgb| rgb[channel]).sum::<f32>());
        red / green
    };
    let wall = stage.instance("left wall");
    stage.app.world_mut().entity_mut(wall).insert(NotInGi);
    let excluded = redness(&stage.settled());
    stage.app.world_mut().entity_mut(wall).remove::<NotInGi>().insert(Visibility::Hidden);
    let hidden = redness(&stage.settled());
    stage.app.world_mut().entity_mut(wall).insert(Visibility::Inherited);
    // Bounces take some frames.
    stage.frames(40);
    let [with_wall, again] = [empty, &stage.settled()].map(redness);
    println!("{with_wall} {excluded} {hidden} {again}");
    assert!(excluded < with_wall - 0.02 && hidden < excluded);
    assert!((again - with_wall).abs() < 0.01);
}

#[test]
fn light_follows_changed_cameras_and_settings() {
    let _alone = alone();
    let mut stage = Stage::cornell();
    let whole = stage.settled();
    let again = cameras_come_resize_and_go(&mut stage, &whole);
    another_exposure_shows_the_same_light(&mut stage, &again);

    stage.gi().quality = GiQuality::Balanced;
    let high = stage.settled();
    let change = difference(&high, &whole);
    assert!(change < 0.1, "{change}");
    // Another volume is built in the background; until then the old one lights every frame.
    let min = Vec3::new(-1.1, -0.1, -1.1);
    stage.gi().volume = GiVolume::Box { min, max: Vec3::new(1.1, 2.1, 1.1), resolution: 40 };
    let meanwhile = stage.until_ready();
    let worst = meanwhile.iter().map(|shot| difference(shot, &high)).fold(0.0, f32::max);
    println!("the worst frame while another volume is made: {worst}");
    assert!(worst < 0.2, "{worst}");
    let other = stage.settled_over(24);
    let change = difference(&other, &high);
    assert!(change < 0.1, "{change}");

    // Without a camera until all is freed.
    let gi = *stage.gi();
    stage.app.world_mut().despawn(stage.camera);
    stage.frames(130);
    let left = LiveResources::now().buffer_bytes;
    assert!(left < 8 << 20, "{left} bytes are left after the last camera");
    let target = RenderTarget::Image(stage.image.clone().into());
    stage.camera = stage.add_camera(target);
    stage.camera().insert(gi);
    headless::wait_until_ready(&mut stage.app);
    let change = difference(&stage.settled_over(24), &other);
    println!("once more {change}");
    assert!(change < 0.03, "{change}");
}

/// Returns the last picture.
fn cameras_come_resize_and_go(stage: &mut Stage, whole: &Shot) -> Shot {
    // A second camera with this view, at the right of a wider picture.
    let (image, target) = headless::target(&mut stage.app, UVec2::new(112, 36));
    let second = stage.add_camera(target);
    let viewport = Viewport {
        physical_position: UVec2::new(64, 0),
        physical_size: UVec2::new(48, 36),
        ..Viewport::default()
    };
    let lens = Camera { viewport: Some(viewport), order: 1, ..Camera::default() };
    stage.app.world_mut().entity_mut(second).insert((lens, quick()));
    stage.frames(30);
    let wide = headless::mean_shot(&mut stage.app, &image, 8);
    let rows = wide.rgb.chunks(112).flat_map(|row| row[64..].to_vec());
    let right = Shot { size: whole.size, rgb: rows.collect() };
    right.save("target/pictures/viewport.png", 2.0);
    let change = difference(&right, whole);
    assert!(change < 0.04, "{change}");
    // A camera that is switched off for a while, and a picture of another size.
    let mut camera = stage.app.world_mut().get_mut::<Camera>(second);
    camera.as_mut().expect("a camera").is_active = false;
    stage.frames(3);
    for size in [UVec2::new(64, 64), UVec2::new(48, 36)] {
        let (image, target) = headless::target(&mut stage.app, size);
        stage.camera().insert(target);
        stage.image = image;
        stage.frames(3);
    }
    let again = stage.settled();
    let change = difference(&again, whole);
    assert!(change < 0.04, "{change}");
    stage.app.world_mut().despawn(second);
    again
}

/// Usual exposures keep the unit of light; beyond them, the voxels are rebuilt.
fn another_exposure_shows_the_same_light(stage: &mut Stage, before: &Shot) {
    let show = |stage: &mut Stage, ev100: f32| {
        stage.camera().insert(Exposure { ev100 });
        Exposure { ev100: 4.0 }.exposure() / Exposure { ev100 }.exposure()
    };
    let change = |mut shot: Shot, factor: f32| {
        for (rgb, before) in shot.rgb.iter_mut().zip(&before.rgb) {
            // Without the lamp: Bevy's G-buffer holds no emission that bright.
            *rgb = if before.max_element() > 0.3 { *before } else { *rgb * factor };
        }
        difference(&shot, before)
    };
    for ev100 in [14.0, 2.0] {
        let factor = show(stage, ev100);
        let worst = (0..5).map(|_| change(stage.next(), factor)).fold(0.0, f32::max);
        println!("EV100 {ev100}: {worst}");
        assert!(worst < 0.03, "EV100 {ev100}: {worst}");
    }
    for ev100 in [-9.0, 4.0] {
        let factor = show(stage, ev100);
        stage.app.update();
        headless::wait_until_ready(&mut stage.app);
        let in_another_unit = change(stage.settled(), factor);
        println!("EV100 {ev100}, in another unit of light: {in_another_unit}");
        assert!(in_another_unit < 0.03, "EV100 {ev100}: {in_another_unit}");
    }
}
