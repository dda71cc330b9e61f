//! The city as a whole: its size, its light, and cameras with free space around them.

use super::*;
use crate::{AnimationChoice, Picker};

/// Instances of small meshes make millions of triangles over a kilometre.
#[test]
fn the_city_is_large_and_its_meshes_are_shared() {
    let scene = scene(false, false).unwrap();
    let own: usize = scene.meshes.iter().map(Mesh::triangle_count).sum();
    let drawn = scene.triangle_count();
    println!("{drawn} triangles of {own}, {} instances", scene.instances.len());
    assert!(drawn >= 3_000_000 && own <= 150_000, "{drawn} triangles of {own}");
    assert!(scene.instances.len() <= 10_000 && scene.meshes.len() <= 100);
    let size = scene.bounds().max - scene.bounds().min;
    assert!(size.x >= 1000.0 && size.z >= 1000.0 && size.y > 60.0, "{size}");
}

#[test]
fn day_and_night_differ_only_in_light() {
    let [day, night] = [false, true].map(|is_night| scene(is_night, false).unwrap());
    assert!(day.meshes == night.meshes && day.instances == night.instances);
    assert_eq!(day.cameras, night.cameras);
    assert!(day.lights[0].kind.is_parallel());
    assert!(day.materials.iter().all(|material| material.emissive == Vec3::ZERO));
    assert!(night.lights.is_empty());
    let shines = |material: usize| night.materials[material].emissive.max_element() > 0.0;
    let lamps = night.instances.iter().filter(|instance| shines(instance.material));
    assert!(lamps.clone().count() > 1000, "{} lamps", lamps.count());
}

#[test]
fn the_city_is_generated_deterministically() {
    assert!(scene(true, false).unwrap() == scene(true, false).unwrap());
}

/// The scene of the room is the city with another first camera.
#[test]
fn the_room_is_in_the_city() {
    let (city, inside) = (scene(false, false).unwrap(), scene(false, true).unwrap());
    assert!(city.instances == inside.instances);
    assert_eq!(inside.cameras[0].name, "to the window");
    let picker = Picker::new(&inside);
    // Floor, ceiling, and walls of the room are close.
    let camera = &inside.cameras[0];
    for (direction, farthest) in [(Vec3::NEG_Y, 1.7), (Vec3::Y, 1.3), (Vec3::X, 2.4)] {
        let met = picker.pick(camera.position, direction).unwrap();
        assert!(met.distance_m < farthest, "{direction}: {}", met.distance_m);
    }
    // A ray through the window goes far.
    let out = Vec3::new(-0.35, 0.02, 1.0);
    let met = picker.pick(camera.position, out).map_or(f32::MAX, |met| met.distance_m);
    assert!(met > 15.0, "{met}");
}

#[test]
fn cameras_are_clear_of_obstacles() {
    let scene = scene(false, false).unwrap();
    let picker = Picker::new(&scene);
    for camera in &scene.cameras {
        for direction in [camera.forward, Vec3::X, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Z, Vec3::NEG_Y] {
            let met = picker.pick(camera.position, direction);
            let distance = met.map_or(f32::MAX, |met| met.distance_m);
            assert!(distance > 0.4, "{}: {distance} m towards {direction}", camera.name);
        }
        // The camera is above the ground.
        assert!(picker.pick(camera.position, Vec3::NEG_Y).is_some(), "{}", camera.name);
    }
}

/// The flight meets no obstacle, and begins and ends at its first and last stop.
#[test]
fn the_flight_path_hits_no_obstacle() {
    let mut scene = scene(false, false).unwrap();
    let picker = Picker::new(&scene);
    let info = &scene.animations()[0];
    assert_eq!((info.name.as_str(), info.duration_s), ("flight", 42.0));
    let mut before: Option<Vec3> = None;
    let mut way_m = 0.0;
    for step in 0..=168_u8 {
        scene.pose(AnimationChoice::One(0), f32::from(step) * 0.25).unwrap();
        let eye = scene.cameras.last().unwrap().position;
        if let Some(before) = before.replace(eye) {
            let length = eye.distance(before);
            way_m += length;
            let met = picker.pick(before, eye - before);
            let distance = met.map_or(f32::MAX, |met| met.distance_m);
            assert!(distance > length + 0.3, "at {:.2} s", f32::from(step) * 0.25);
            assert!(length < 10.0, "{length} m in a quarter of a second");
        }
    }
    assert!(way_m > 300.0, "{way_m} m");
    let last = Vec3::from(FLIGHT[FLIGHT.len() - 1].eye);
    assert!(before.unwrap().distance(last) < 1e-3);
    assert_eq!(scene.cameras[0].name, "street");
}

#[test]
fn normals_agree_with_the_winding() {
    for mesh in &scene(false, false).unwrap().meshes {
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|corner| mesh.positions[corner]);
            let face = (b - a).cross(c - a);
            for corner in corners {
                assert!(face.dot(mesh.normals[corner]) > 0.0, "{}: {a} {b} {c}", mesh.name);
            }
        }
    }
}
