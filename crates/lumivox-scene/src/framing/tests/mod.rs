//! First views of hand-made rooms, things and scenes in between.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Mat4, Vec2, Vec3};

mod light;
mod scenes;

use super::*;
use crate::builtin;
use crate::builtin::shapes::{Faces, FrameFaces, cuboid, frame, interior, merge, quad, sphere};
use crate::{Instance, LightKind, Material, Mesh};
use scenes::*;

const ASPECT: f32 = 16.0 / 9.0;

/// Lights a scene if necessary, and returns the light that was added.
fn lit(scene: &mut Scene, camera: Option<&Camera>) -> Option<DefaultLight> {
    let options =
        SightOptions { camera: camera.cloned(), aspect: ASPECT, ..SightOptions::default() };
    scene.stage(&options).light
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

/// Fails unless the camera has free space around it, and its near plane is before all visible
/// surfaces.
fn assert_stands_free(framing: &Framing, camera: &Camera, clearance_m: f32) {
    let unit = framing.rays.unit;
    for way in directions::sphere(1000) {
        let hit = framing.rays.cast(unit.unit_from_world(camera.position), way);
        let distance_m = hit.map_or(f32::INFINITY, |hit| hit.distance * unit.scale_m);
        assert!(distance_m > clearance_m, "{distance_m} m free at {}", camera.position);
        assert!(distance_m > camera.near_m);
    }
}

#[test]
fn rooms_are_viewed_from_inside_along_their_length() {
    let framing = Framing::of(&scene([room()], false));
    assert!(framing.is_place() && framing.is_enclosed());
    let camera = framing.camera(ASPECT);
    assert!((camera.position.y - 1.6).abs() < 0.02, "{}", camera.position);
    assert!(camera.position.x.abs() > 1.5, "not from an end: {}", camera.position);
    assert!(camera.forward.x * camera.position.x < 0.0 && camera.forward.x.abs() > 0.7);
    assert_stands_free(&framing, &camera, 0.3);
}

#[test]
fn windows_open_a_room_and_panes_do_not_close_it() {
    let mut scene = scene([room_with_window()], false);
    let framing = Framing::of(&scene);
    assert!(framing.is_place() && !framing.is_enclosed());
    assert!(scene.bounds().contains(framing.camera(ASPECT).position));
    scene.meshes.push(quad(Vec3::new(3.0, 1.5, 0.0), Vec3::Z * 0.5, Vec3::Y * 0.5));
    let mut glass = Material { double_sided: true, ..Material::default() };
    glass.transmission.factor = 0.9;
    scene.materials.push(glass);
    scene.instances.push(Instance { mesh: 1, material: 1, ..Instance::default() });
    assert!(!Framing::of(&scene).is_enclosed());
    scene.materials[1].transmission.factor = 0.0;
    assert!(Framing::of(&scene).is_enclosed());
}

#[test]
fn hollow_objects_are_viewed_from_outside() {
    let block = cuboid(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 1.0, 2.0), Faces::ALL);
    let all = [
        ("block", scene([block], false)),
        ("helmet", helmet()),
        ("cup", cup()),
        ("teapot", teapot()),
        ("robot", robot()),
        ("car", car()),
        ("gear box", gear_box()),
        ("ship", ship()),
    ];
    for (name, original) in all {
        // Also as CAD and sketching programs write it: double-sided, and round things inside out.
        let mut both = original.clone();
        both.materials[0].double_sided = true;
        let mut wrong = original.clone();
        if matches!(name, "teapot" | "robot" | "car" | "ship") {
            wrong.meshes.iter_mut().for_each(Mesh::flip_winding);
        }
        for (how, scene) in
            [("as it is", &original), ("double-sided", &both), ("inside out", &wrong)]
        {
            let framing = Framing::of(scene);
            assert!(!framing.is_place(), "a {name}, {how}, is no place");
            let camera = framing.camera(ASPECT);
            assert_fits(scene, &camera, ASPECT);
            let light = framing.light(&camera, &light::NONE);
            assert!(matches!(light, DefaultLight::Studio { .. }), "a {name}, {how}: {light}");
        }
    }
    for aspect in [0.5, 1.0] {
        assert_fits(&terrain(), &terrain().default_camera(aspect), aspect);
    }
}

#[test]
fn double_sided_shells_are_rooms_only_if_furnished() {
    // Sketching programs write rooms whose front faces outwards.
    let shell = cuboid(Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 3.0, 2.0), Faces::ALL);
    assert!(!Framing::of(&scene([shell.clone()], true)).is_place());
    let furniture = [-2.0, 0.0, 2.0].map(|x| {
        cuboid(Vec3::new(x - 0.5, 0.0, -1.5), Vec3::new(x + 0.5, 0.8, -0.5), Faces::NO_BOTTOM)
    });
    let scene = scene(furniture.into_iter().chain([shell]), true);
    let framing = Framing::of(&scene);
    let camera = framing.camera(ASPECT);
    assert!(framing.is_enclosed() && scene.bounds().contains(camera.position));
    assert_stands_free(&framing, &camera, 0.2);
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
    assert_stands_free(&framing, &camera, 0.3);
    assert_fits(&scene, &framing.outside(ASPECT), ASPECT);

    let Some(DefaultLight::SunAndSky { sun, sky, ground: None }) = lit(&mut scene, None) else {
        panic!("an open hall has a sky")
    };
    assert_eq!((scene.environment.map, scene.environment.radiance), (Some(sky), Vec3::ONE));
    // The sun lights a part of the floor.
    let is_lit = |i: &i32| {
        let point = Vec3::new((i % 24) as f32 - 11.6, 0.01, (i / 24) as f32 * 0.7 - 3.4);
        let point = framing.rays.unit.unit_from_world(point);
        framing.rays.is_free(point, -sun.direction, f32::INFINITY)
    };
    let lit = (0..240).filter(is_lit).count();
    assert!(lit > 20, "{lit} of 240 places on the floor are lit");
}

#[test]
fn inside_cameras_work_for_hollow_objects() {
    for (name, scene) in [("teapot", teapot()), ("gear box", gear_box())] {
        let framing = Framing::of(&scene);
        let camera = framing.inside(ASPECT).unwrap_or_else(|| panic!("a {name} has an inside"));
        assert!(scene.bounds().contains(camera.position), "{name}: {}", camera.position);
        assert_stands_free(&framing, &camera, 0.01);
    }
    let solid = scene([cuboid(Vec3::NEG_ONE, Vec3::ONE, Faces::ALL)], false);
    assert_eq!(Framing::of(&solid).inside(ASPECT), None);
}

#[test]
fn cameras_look_into_open_boxes_at_any_scale() {
    let (low, high) = (Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
    let blocks = || {
        [(-0.4, -0.3, 1.2), (0.4, 0.4, 0.6)].map(|(x, z, height)| {
            let (foot, half) = (Vec3::new(x, 0.0, z), Vec3::new(0.3, 0.0, 0.3));
            cuboid(foot - half, foot + half + Vec3::Y * height, Faces::NO_BOTTOM)
        })
    };
    // Walls visible from inside, double-sided walls, and thick walls; all open towards +z.
    let inner = || without(interior(low, high), |p| p.z > 0.9999);
    let wall = Vec3::splat(0.1);
    let outer = cuboid(low - wall, high + wall.with_z(0.0), Faces::ALL);
    let outer = without(outer, |p| p.z > 0.9999);
    let boxes = [
        scene([inner()].into_iter().chain(blocks()), false),
        scene([inner()].into_iter().chain(blocks()), true),
        scene([inner(), outer].into_iter().chain(blocks()), false),
        scene([inner()], false),
    ];
    for (number, original) in boxes.iter().enumerate() {
        for (turn, scale) in [(0.0, 1e-3), (0.0, 1.0), (FRAC_PI_2, 1.0)] {
            let mut turned = original.clone();
            turned.transform(Mat4::from_rotation_y(turn));
            let opening = Mat4::from_rotation_y(turn).transform_vector3(Vec3::Z);
            let camera = scaled(&turned, scale).default_camera(ASPECT);
            let what = format!("box {number} turned by {turn} at scale {scale}: {camera:?}");
            assert!(camera.forward.dot(opening) < -0.99, "{what}");
            assert!(camera.position.dot(opening) > 1.5 * scale, "{what}");
        }
    }
}

#[test]
fn cameras_view_boards_along_their_thin_axis() {
    // A picture frame, a circuit board with its parts, a shelf's side.
    for (thin, half) in [
        (Vec3::Z, Vec3::new(0.8, 0.6, 0.01)),
        (Vec3::Y, Vec3::new(0.8, 0.01, 0.5)),
        (Vec3::X, Vec3::new(0.01, 0.9, 0.5)),
    ] {
        for is_double_sided in [false, true] {
            let mut board = cuboid(-half, half, Faces::ALL);
            if thin == Vec3::Y {
                let part = cuboid(Vec3::new(0.1, 0.01, 0.1), Vec3::new(0.2, 0.02, 0.2), Faces::ALL);
                board = merge([board, part]);
            }
            let scene = scene([board], is_double_sided);
            let camera = scene.default_camera(ASPECT);
            assert!(camera.forward.dot(thin).abs() > 0.99, "{thin}: {}", camera.forward);
            assert_fits(&scene, &camera, ASPECT);
        }
    }
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
    }
}

#[test]
fn small_things_on_a_large_ground_fill_the_picture() {
    let thing = || cuboid(Vec3::new(2.0, 0.0, 1.0), Vec3::new(3.0, 1.2, 2.0), Faces::NO_BOTTOM);
    let ground = || quad(Vec3::ZERO, Vec3::X * 50.0, Vec3::NEG_Z * 50.0);
    let mut dome = sphere(80.0, 24);
    dome.flip_winding();
    let alone = scene([thing()], false);
    for scene in [
        scene([thing(), ground()], false),
        // In one mesh as well.
        scene([merge([ground(), thing()])], false),
        scene([thing(), dome], false),
    ] {
        let camera = scene.default_camera(ASPECT);
        assert_fits(&alone, &camera, ASPECT);
        assert!(camera.position.y > 0.0);
    }
    // A town is large enough to be shown with its plain.
    let town = cuboid(Vec3::new(-30.0, 0.0, -30.0), Vec3::new(30.0, 8.0, 30.0), Faces::NO_BOTTOM);
    let town = scene([town, ground()], false);
    assert_fits(&town, &town.default_camera(ASPECT), ASPECT);
}

#[test]
fn cameras_view_stage_sets_from_the_open_side() {
    let things = || {
        [-1.0, 0.2, 1.3].map(|x| {
            cuboid(Vec3::new(x - 0.3, 0.0, -0.3), Vec3::new(x + 0.3, 0.7, 0.3), Faces::NO_BOTTOM)
        })
    };
    for turn in [0.0, 2.5] {
        // A stage set: floor and back wall of some thickness.
        let wall = cuboid(Vec3::new(-2.0, 0.0, -1.1), Vec3::new(2.0, 2.0, -1.0), Faces::ALL);
        let floor = cuboid(Vec3::new(-2.0, -0.1, -1.0), Vec3::new(2.0, 0.0, 1.0), Faces::ALL);
        let mut scene = scene(things().into_iter().chain([wall, floor]), false);
        scene.transform(Mat4::from_rotation_y(turn));
        let camera = scene.default_camera(ASPECT);
        let front = Mat4::from_rotation_y(turn).transform_vector3(Vec3::Z);
        assert!(camera.forward.dot(front) < -0.3, "turned by {turn}: {}", camera.forward);
    }
}

#[test]
fn framing_is_deterministic_and_independent_of_scale() {
    for original in [helmet(), hall(), scene([room()], false)] {
        let (small, large) = (scaled(&original, 1e-3), scaled(&original, 1e3));
        let (a, b) = (small.default_camera(ASPECT), large.default_camera(ASPECT));
        assert_eq!(a, small.default_camera(ASPECT));
        let close = |x: Vec3, y: Vec3| x.abs_diff_eq(y, 1e-3 * original.bounds().radius_m());
        assert!(close(a.position * 1e3, b.position * 1e-3), "{a:?} {b:?}");
        assert!(a.forward.abs_diff_eq(b.forward, 1e-3));
        assert!((a.near_m * 1e6 / b.near_m - 1.0).abs() < 0.01);
        let light = |scene: &Scene, camera| Framing::of(scene).light(camera, &light::NONE);
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
fn tiny_and_empty_scenes_have_valid_cameras_and_light() {
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
fn slivers_and_millions_of_triangles_are_simplified() {
    // A disc of slivers around its middle, as CAD writes.
    let corners = 50_000;
    let at = |i: u32| Vec2::from_angle(i as f32 / corners as f32 * TAU).extend(0.0);
    let positions = [Vec3::ZERO].into_iter().chain((0..corners).map(at)).collect();
    let indices = (0..corners).flat_map(|i| [0, 1 + i, 1 + (i + 1) % corners]).collect();
    let disc = scene([mesh(positions, indices)], false);
    let framing = Framing::of(&disc);
    assert!(framing.rays.triangles.len() < 2000, "{framing:?}");
    assert!(framing.camera(ASPECT).forward.z < -0.99);
    // A room whose walls have a million triangles stays closed.
    let mut fine = Mesh::default();
    for [a, b, c] in room().triangles().map(|t| t.map(|i| room().positions[i])) {
        let n = 210;
        let first = fine.positions.len() as u32;
        let step = |i: u32| i as f32 / n as f32;
        for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            fine.positions.push(a + (b - a) * step(i) + (c - a) * step(j).min(1.0 - step(i)));
        }
        for at in (0..n * (n + 1)).filter(|at| at % (n + 1) != n) {
            let [low, high] = [first + at, first + at + n + 1];
            fine.indices.extend([low, high, low + 1, low + 1, high, high + 1]);
        }
    }
    let framing = Framing::of(&scene([mesh(fine.positions, fine.indices)], false));
    assert!(framing.is_enclosed() && framing.rays.triangles.len() <= 1_000_000, "{framing:?}");
}

#[test]
fn notes_warn_of_coarse_voxels_and_shadow_maps() {
    let about = |scene: &Scene, fineness: Fineness| -> Vec<&'static str> {
        let options = SightOptions { staging: Staging::None, fineness, ..SightOptions::default() };
        let sight = Sight::of(scene, &options, &Framing::of(scene).into());
        sight.notes.iter().map(|note| note.about).collect()
    };
    // The box is 2 m wide.
    let cornell = builtin::scene("cornell").unwrap();
    for (voxel_m, is_coarse) in [(1.0 / 64.0, false), (1.0 / 16.0, false), (0.5, true)] {
        let fineness = Fineness { voxel_m: Some(voxel_m), shadow_maps: None };
        assert_eq!(about(&cornell, fineness).contains(&"grid"), is_coarse, "{voxel_m} m");
    }
    // Blocks of a metre on a ground of 2 km.
    let ground = quad(Vec3::ZERO, Vec3::Z * 1000.0, Vec3::X * 1000.0);
    let block = |x: f32| {
        let min = Vec3::new(2.0 * x, 0.0, 0.0);
        cuboid(min, min + Vec3::ONE, Faces::NO_BOTTOM)
    };
    let mut scene = scene([ground, merge((-4..4).map(|x| block(x as f32)))], false);
    let eye = Vec3::new(0.0, 4.0, 8.0);
    scene.cameras.push(Camera::look_at(eye, Vec3::ZERO, FRAC_PI_2 / 2.0));
    let direction = Vec3::new(0.3, -0.5, 0.8).normalize();
    let (sun, lamp) = ((LightKind::Directional, 1e5), (LightKind::Point, 1e9));
    for ((kind, intensity), squares, is_coarse) in
        [(sun, 0, true), (sun, 3, false), (lamp, 3, true)]
    {
        let position = direction * -2000.0;
        scene.lights =
            vec![crate::Light { kind, intensity, position, direction, ..Default::default() }];
        let maps = ShadowMapFineness { resolution: 1024, squares, step: 4.0, reach_m: None };
        let fineness = Fineness { voxel_m: None, shadow_maps: Some(maps) };
        let is_noted = about(&scene, fineness).contains(&"shadows");
        assert_eq!(is_noted, is_coarse, "{kind:?}, {squares}");
    }
}
