//! Rooms, things and what lies between, made by hand.

use glam::{Mat4, Vec2, Vec3};

mod fineness;
mod first_sight;
mod hollow;

use super::*;
use crate::builtin::shapes::{Faces, FrameFaces, cuboid, frame, interior, merge, quad, sphere};
use crate::{Instance, LightKind, Material, Mesh, builtin};

const ASPECT: f32 = 16.0 / 9.0;

/// Each mesh as an instance of its own.
fn scene(meshes: impl IntoIterator<Item = Mesh>, is_double_sided: bool) -> Scene {
    let mut scene = Scene { name: "test".to_owned(), ..Scene::default() };
    let mut material = Material::diffuse("grey", Vec3::splat(0.5));
    material.double_sided = is_double_sided;
    scene.materials.push(material);
    for (mesh, geometry) in meshes.into_iter().enumerate() {
        scene.meshes.push(geometry);
        let world_from_local = Mat4::IDENTITY;
        scene.instances.push(Instance {
            name: String::new(),
            mesh,
            material: 0,
            world_from_local,
            ..Instance::default()
        });
    }
    scene.validate().unwrap();
    scene
}

/// Lights a scene if necessary, and returns the light that was added.
fn lit(scene: &mut Scene, camera: Option<&Camera>) -> Option<DefaultLight> {
    let options =
        SightOptions { camera: camera.cloned(), aspect: ASPECT, ..SightOptions::default() };
    scene.stage(&options).light
}

fn scaled(scene: &Scene, scale: f32) -> Scene {
    let mut scene = scene.clone();
    for instance in &mut scene.instances {
        instance.world_from_local =
            Mat4::from_scale(Vec3::splat(scale)) * instance.world_from_local;
    }
    scene
}

/// A room of 6 x 3 x 4 m seen from inside.
fn room() -> Mesh {
    interior(Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 3.0, 2.0))
}

/// The room with a window of 1 x 1 m at one end, walls without thickness.
fn room_with_window() -> Mesh {
    let mut walls = room();
    // The wall at +x gives way to four strips around the window.
    let at_end = |t: &[u32]| t.iter().all(|&i| walls.positions[i as usize].x > 2.9);
    walls.indices = walls.indices.chunks(3).filter(|t| !at_end(t)).flatten().copied().collect();
    let strip = |y: [f32; 2], z: [f32; 2]| {
        let center = Vec3::new(3.0, (y[0] + y[1]) * 0.5, (z[0] + z[1]) * 0.5);
        quad(center, Vec3::Z * ((z[1] - z[0]) * 0.5), Vec3::Y * ((y[1] - y[0]) * 0.5))
    };
    let strips = [
        strip([0.0, 1.0], [-2.0, 2.0]),
        strip([2.0, 3.0], [-2.0, 2.0]),
        strip([1.0, 2.0], [-2.0, -0.5]),
        strip([1.0, 2.0], [0.5, 2.0]),
    ];
    merge([walls].into_iter().chain(strips))
}

/// A hall of 24 x 10 x 8 m without a roof, with walls of half a metre that are seen from all sides
/// and a row of columns along each.
fn hall() -> Scene {
    let all = FrameFaces { top: true, bottom: false, outer: true };
    let (outer, inner) = (Vec2::new(12.5, 4.5), Vec2::new(12.0, 4.0));
    let walls = frame(outer, inner, [0.0, 10.0], all);
    // A roof covers all but the middle.
    let opening = frame(outer, Vec2::new(8.0, 1.5), [10.0, 10.5], all);
    let under = FrameFaces { top: false, bottom: true, outer: false };
    let below = frame(outer, Vec2::new(8.0, 1.5), [10.0, 10.5], under);
    let floor = quad(Vec3::ZERO, Vec3::X * 12.5, Vec3::NEG_Z * 4.5);
    let columns = (0..10).map(|i| {
        let foot = Vec3::new((i % 5) as f32 * 4.0 - 8.0, 0.0, if i < 5 { -2.5 } else { 2.5 });
        cuboid(foot - Vec3::new(0.3, 0.0, 0.3), foot + Vec3::new(0.3, 10.0, 0.3), Faces::SIDES)
    });
    scene([walls, opening, below, floor].into_iter().chain(columns), false)
}

/// A ball, hollow inside, with an inner side of its own and a stand: a helmet to rays.
fn helmet() -> Scene {
    let ball = |radius_m: f32| {
        let mut ball = sphere(radius_m, 24);
        ball.positions.iter_mut().for_each(|position| position.y += 3.0);
        ball
    };
    let (shell, mut lining) = (ball(1.0), ball(0.85));
    lining.flip_winding();
    let stand = cuboid(Vec3::new(-0.8, 0.0, -0.8), Vec3::new(0.8, 0.4, 0.8), Faces::ALL);
    let neck = cuboid(Vec3::new(-0.2, 0.4, -0.2), Vec3::new(0.2, 2.2, 0.2), Faces::SIDES);
    scene([shell, lining, stand, neck], false)
}

/// Ground of 40 x 40 m with hills of 3 m.
fn terrain() -> Scene {
    let height = |x: f32, z: f32| 1.5 * ((x * 0.4).sin() + (z * 0.3).cos());
    let mut mesh = Mesh::default();
    let edge = 41;
    for i in 0..edge * edge {
        let (x, z) = ((i % edge) as f32 - 20.0, (i / edge) as f32 - 20.0);
        mesh.positions.push(Vec3::new(x, height(x, z), z));
    }
    for i in (0..edge * (edge - 1)).filter(|i| i % edge + 1 < edge) {
        mesh.indices.extend([i, i + edge, i + edge + 1, i, i + edge + 1, i + 1]);
    }
    let count = mesh.positions.len();
    mesh.normals = vec![Vec3::Y; count];
    mesh.uvs = vec![Vec2::ZERO; count];
    mesh.tangents = vec![Vec3::X.extend(1.0); count];
    scene([mesh], false)
}

/// Fails unless every corner lies in the picture, and the scene fills it in one direction.
fn assert_fits(scene: &Scene, camera: &Camera, aspect: f32) {
    let half = (camera.vertical_fov_rad * 0.5).tan();
    let mut most = 0.0_f32;
    for instance in &scene.instances {
        for &position in &scene.meshes[instance.mesh].positions {
            let world = instance.world_from_local.transform_point3(position);
            let p = camera.camera_from_world().transform_point3(world);
            assert!(-p.z > camera.near_m, "{p} is nearer than {}", camera.near_m);
            let filled = (p.x.abs() / aspect).max(p.y.abs()) / (-p.z * half);
            most = most.max(filled);
        }
    }
    assert!((0.85..=1.0).contains(&most), "fills {most} of the picture");
}

/// Fails unless the camera has free space around it in a place, and a near plane before all that it
/// sees.
fn assert_stands_free(scene: &Scene, camera: &Camera, clearance_m: f32) {
    let framing = Framing::of(scene);
    let eye = framing.unit.unit_from_world(camera.position);
    for way in directions::sphere(1000) {
        let Some(hit) = framing.rays.cast(eye, way) else { continue };
        let distance_m = hit.distance * framing.unit.scale_m;
        assert!(distance_m > clearance_m, "{distance_m} m free at {}", camera.position);
        assert!(distance_m > camera.near_m);
    }
}

#[test]
fn rooms_are_viewed_from_inside_along_their_length() {
    let scene = scene([room()], false);
    let framing = Framing::of(&scene);
    assert!(framing.is_place() && framing.is_enclosed());
    let camera = framing.camera(ASPECT);
    assert!((camera.position.y - 1.6).abs() < 0.02, "{}", camera.position);
    assert!(camera.position.x.abs() > 1.5, "not from an end: {}", camera.position);
    assert!(camera.forward.x * camera.position.x < 0.0 && camera.forward.x.abs() > 0.7);
    assert_stands_free(&scene, &camera, 0.3);
}

#[test]
fn a_window_lets_the_sun_in() {
    let mut scene = scene([room_with_window()], false);
    let framing = Framing::of(&scene);
    assert!(framing.is_place() && !framing.is_enclosed());
    let camera = framing.camera(ASPECT);
    assert!(scene.bounds().contains(camera.position));
    let Some(DefaultLight::SunAndSky { sun, .. }) = lit(&mut scene, None) else {
        panic!("the window lets the sky in")
    };
    assert!(sun.direction.x < -0.3, "the sun comes through the window: {}", sun.direction);
    scene.validate().unwrap();
}

#[test]
fn two_rooms_get_two_lamps() {
    let mut scene = builtin::scene("two-rooms-closed").unwrap();
    scene.lights.clear();
    scene.cameras.clear();
    scene.materials.iter_mut().for_each(|material| material.emissive = Vec3::ZERO);
    assert!(Framing::of(&scene).is_enclosed());
    let Some(DefaultLight::Lamps(lamps)) = lit(&mut scene, None) else {
        panic!("no sun reaches a closed room")
    };
    assert_eq!(lamps.len(), 2);
    assert!(lamps[0].position.x * lamps[1].position.x < 0.0, "{lamps:?}");
    assert_eq!(scene.lights, lamps);
    scene.validate().unwrap();
    assert_eq!(lit(&mut scene, None), None, "now it is lit");
}

#[test]
fn lamps_give_300_lux_in_the_mean() {
    for scale in [1e-3, 1.0, 1e3] {
        let mut scene = scaled(&scene([room()], false), scale);
        let Some(DefaultLight::Lamps(lamps)) = lit(&mut scene, None) else {
            panic!("no sun reaches a closed room")
        };
        let [lamp] = lamps.as_slice() else { panic!("one room, {} lamps", lamps.len()) };
        assert_eq!((lamp.kind, lamp.range_m), (LightKind::Point, None));
        let area_m2 = 2.0 * (6.0 * 3.0 + 6.0 * 4.0 + 3.0 * 4.0) * scale * scale;
        let mean_lux = 4.0 * std::f32::consts::PI * lamp.intensity / area_m2;
        // The area is measured by 2048 rays; grazing ones miss a little of it.
        assert!((mean_lux - 300.0).abs() < 9.0, "{mean_lux} lux at scale {scale}");
        let position = lamp.position / scale;
        assert!(position.y > 2.2 && position.y < 2.6, "below the ceiling: {position}");
        assert!(position.x.abs() < 1.5 && position.z.abs() < 0.7, "in the middle: {position}");
        assert!(lamp.radius_m > 0.0 && lamp.radius_m < 0.1 * scale);
    }
}

/// A lamp in the middle of a cube that lacks one wall loses a sixth of its flux, and is brighter by
/// that.
#[test]
fn lamps_compensate_for_light_lost_through_openings() {
    let mut walls = interior(Vec3::NEG_ONE, Vec3::ONE);
    let is_open = |t: &[u32]| t.iter().all(|&i| walls.positions[i as usize].x > 0.9);
    walls.indices = walls.indices.chunks(3).filter(|t| !is_open(t)).flatten().copied().collect();
    let framing = Framing::of(&scene([walls], false));
    let lamp = lamps::lamp(&framing.rays, Vec3::ZERO).unwrap().light(framing.unit);
    let landing_lm = 4.0 * std::f32::consts::PI * lamp.intensity * 5.0 / 6.0;
    let mean_lux = landing_lm / 20.0;
    assert!((mean_lux - 300.0).abs() < 9.0, "{mean_lux} lux");
}

#[test]
fn boxes_are_viewed_from_outside() {
    let block = || cuboid(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 1.0, 2.0), Faces::ALL);
    for is_double_sided in [false, true] {
        let scene = scene([block()], is_double_sided);
        let framing = Framing::of(&scene);
        assert!(!framing.is_place(), "double-sided: {is_double_sided}");
        assert_fits(&scene, &framing.camera(ASPECT), ASPECT);
    }
}

#[test]
fn double_sided_shells_are_rooms_only_if_furnished() {
    // Sketching programs make rooms of which the front is outside.
    let shell = cuboid(Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 3.0, 2.0), Faces::ALL);
    assert!(!Framing::of(&scene([shell.clone()], true)).is_place());
    let furniture = [-2.0, 0.0, 2.0].map(|x| {
        cuboid(Vec3::new(x - 0.5, 0.0, -1.5), Vec3::new(x + 0.5, 0.8, -0.5), Faces::NO_BOTTOM)
    });
    let scene = scene(furniture.into_iter().chain([shell]), true);
    let camera = scene.default_camera(ASPECT);
    assert!(Framing::of(&scene).is_enclosed() && scene.bounds().contains(camera.position));
    assert_stands_free(&scene, &camera, 0.2);
}

#[test]
fn hollow_things_and_landscapes_are_seen_from_outside() {
    for scene in [helmet(), terrain()] {
        let framing = Framing::of(&scene);
        assert!(!framing.is_place(), "{framing:?}");
        for aspect in [0.5, 1.0, ASPECT] {
            assert_fits(&scene, &framing.camera(aspect), aspect);
        }
    }
}

#[test]
fn a_cup_is_not_treated_as_a_room() {
    let walls = frame(
        Vec2::splat(0.04),
        Vec2::splat(0.035),
        [0.005, 0.1],
        FrameFaces { top: true, bottom: false, outer: true },
    );
    let base = cuboid(Vec3::new(-0.04, 0.0, -0.04), Vec3::new(0.04, 0.005, 0.04), Faces::ALL);
    assert!(!Framing::of(&scene([walls, base], false)).is_place());
}

#[test]
fn an_open_hall_is_seen_from_its_floor_and_lit_through_its_roof() {
    let mut scene = hall();
    let framing = Framing::of(&scene);
    assert!(framing.is_place() && !framing.is_enclosed(), "{framing:?}");
    let camera = framing.camera(ASPECT);
    assert!((1.5..4.0).contains(&camera.position.y), "{}", camera.position);
    assert!(camera.position.x.abs() > 6.0 && camera.position.x.abs() < 12.0);
    assert!(camera.forward.x * camera.position.x < 0.0 && camera.forward.x.abs() > 0.8);
    assert_stands_free(&scene, &camera, 0.3);

    let Some(DefaultLight::SunAndSky { sun, sky, ground: None }) = lit(&mut scene, None) else {
        panic!("an open hall has a sky")
    };
    assert_eq!(scene.environment.map, Some(sky));
    assert_eq!(scene.environment.radiance, Vec3::ONE);
    // Some of the floor is in the sun.
    let towards_sun = -sun.direction;
    let is_lit = |i: i32| {
        let point = Vec3::new((i % 24) as f32 - 11.6, 0.01, (i / 24) as f32 * 0.7 - 3.4);
        framing.rays.is_free(framing.unit.unit_from_world(point), towards_sun, f32::INFINITY)
    };
    let lit = (0..240).filter(|&i| is_lit(i)).count();
    assert!(lit > 20, "{lit} of 240 places on the floor are lit");
}

#[test]
fn cameras_look_into_a_box_missing_a_wall() {
    let mut scene = builtin::scene("cornell").unwrap();
    scene.cameras.clear();
    let camera = scene.default_camera(ASPECT);
    assert!(camera.position.z > 1.0, "before the open side: {}", camera.position);
    assert!(camera.forward.z < -0.9);
    assert_fits(&scene, &camera, ASPECT);
}

#[test]
fn framing_is_independent_of_scale() {
    for original in [helmet(), hall(), scene([room()], false)] {
        let (small, large) = (scaled(&original, 1e-3), scaled(&original, 1e3));
        let (a, b) = (small.default_camera(ASPECT), large.default_camera(ASPECT));
        let close = |x: Vec3, y: Vec3| x.abs_diff_eq(y, 1e-3 * original.bounds().radius_m());
        assert!(close(a.position * 1e3, b.position * 1e-3), "{a:?} {b:?}");
        assert!(a.forward.abs_diff_eq(b.forward, 1e-3));
        assert!((a.near_m * 1e6 / b.near_m - 1.0).abs() < 0.01);
        let light = |scene: &Scene, camera| Framing::of(scene).light(camera, 0.0);
        match (light(&small, &a), light(&large, &b)) {
            (DefaultLight::SunAndSky { sun: a, .. }, DefaultLight::SunAndSky { sun: b, .. }) => {
                assert!(a.direction.abs_diff_eq(b.direction, 1e-3));
            }
            (
                DefaultLight::Studio { rotation_rad: a, .. },
                DefaultLight::Studio { rotation_rad: b, .. },
            ) => assert!((a - b).abs() < 1e-3),
            (DefaultLight::Lamps(a), DefaultLight::Lamps(b)) => {
                assert!(close(a[0].position * 1e3, b[0].position * 1e-3));
            }
            (a, b) => panic!("{a} is not {b}"),
        }
    }
}

#[test]
fn framing_is_deterministic() {
    let (mut a, mut b) = (hall(), hall());
    assert_eq!(a.default_camera(1.0), b.default_camera(1.0));
    assert_eq!(lit(&mut a, None), lit(&mut b, None));
    assert_eq!(a, b);
}

#[test]
fn flat_scenes_are_seen_from_their_front() {
    let (x, y, z) = (Vec3::X, Vec3::Y * 0.5, Vec3::Z * 0.5);
    for (u, v) in [(x, y), (y, x), (x, z), (z, x), (z, y), (y, z)] {
        let mut scene = scene([quad(Vec3::new(5.0, 6.0, 7.0), u, v)], false);
        let camera = scene.default_camera(ASPECT);
        let normal = u.cross(v).normalize();
        assert!(camera.forward.dot(normal) < -0.1, "{normal} is seen along {}", camera.forward);
        assert_fits(&scene, &camera, ASPECT);
        assert!(lit(&mut scene, Some(&camera)).is_some());
        scene.cameras.push(camera);
        scene.validate().unwrap();
    }
}

#[test]
fn a_degenerate_sliver_scene_can_be_staged() {
    let mut sliver = quad(Vec3::ZERO, Vec3::X, Vec3::Y * 1e-6);
    sliver.indices.truncate(3);
    for scale in [1e-9, 1e-3, 1.0, 1e9] {
        let mut scene = scaled(&scene([sliver.clone()], false), scale);
        let camera = scene.default_camera(ASPECT);
        assert!(lit(&mut scene, Some(&camera)).is_some());
        scene.cameras.push(camera);
        scene.validate().unwrap();
    }
    let mut empty = Scene::default();
    let camera = empty.default_camera(f32::NAN);
    assert!(camera.position.is_finite() && camera.near_m > 0.0, "{camera:?}");
    assert!(!Framing::of(&empty).is_enclosed());
    assert!(lit(&mut empty, None).is_some());
}

#[test]
fn panes_let_the_view_and_the_sun_pass() {
    let mut scene = scene([room_with_window()], false);
    let pane = quad(Vec3::new(3.0, 1.5, 0.0), Vec3::Z * 0.5, Vec3::Y * 0.5);
    let mut glass = Material { double_sided: true, ..Material::default() };
    glass.transmission.factor = 0.9;
    scene.materials.push(glass);
    scene.meshes.push(pane);
    let world_from_local = Mat4::IDENTITY;
    scene.instances.push(Instance {
        name: String::new(),
        mesh: 1,
        material: 1,
        world_from_local,
        ..Instance::default()
    });
    scene.validate().unwrap();
    assert!(!Framing::of(&scene).is_enclosed());
    scene.materials[1].transmission.factor = 0.0;
    assert!(Framing::of(&scene).is_enclosed());
}

#[test]
fn things_are_lit_from_the_left_of_the_camera() {
    let mut scene = helmet();
    let camera = scene.default_camera(ASPECT);
    let Some(DefaultLight::Studio { studio, rotation_rad, .. }) = lit(&mut scene, Some(&camera))
    else {
        panic!("things stand in a studio")
    };
    let (mut brightest, mut towards) = (0.0, Vec3::ZERO);
    for (index, texel) in studio.map.rgb.iter().enumerate() {
        if texel[0] > brightest {
            let (x, y) = (index as u32 % studio.map.width, index as u32 / studio.map.width);
            brightest = texel[0];
            towards = studio.map.direction(x as f32 + 0.5, y as f32 + 0.5);
        }
    }
    let towards = glam::Mat3::from_rotation_y(rotation_rad) * towards;
    let seen = camera.camera_from_world().transform_vector3(towards);
    assert!(seen.x < -0.3 && seen.y > 0.0 && seen.z > 0.0, "{seen}");
    scene.validate().unwrap();
}
