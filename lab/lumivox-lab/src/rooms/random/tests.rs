//! Checks the properties of rooms by rays.

use glam::Vec3;
use lumivox_scene::{Picker, Scene};

use super::{FEWEST_SENSORS, Kind, Room, RoomLight, room};

fn rooms(seeds: std::ops::Range<u32>) -> impl Iterator<Item = Room> {
    seeds.map(|seed| room(seed, Kind::ALL[seed as usize % Kind::ALL.len()]).unwrap())
}

/// Directions spread evenly over the sphere (a Fibonacci lattice).
fn directions() -> impl Iterator<Item = Vec3> {
    let count = 48;
    (0..count).map(move |i| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
        Vec3::new(cos, 0.0, sin) * (1.0 - y * y).sqrt() + Vec3::Y * y
    })
}

fn picker(mut scene: Scene, is_double_sided: bool) -> Picker {
    for material in &mut scene.materials {
        material.double_sided = is_double_sided;
    }
    Picker::new(&scene)
}

#[test]
fn the_same_seed_gives_the_same_room() {
    for kind in Kind::ALL {
        let [a, b, other] = [5, 5, 6].map(|seed| room(seed, kind).unwrap());
        assert_eq!((&a.scene, &a.sensors), (&b.scene, &b.sensors));
        assert_ne!(a.sensors, other.sensors, "{kind:?}");
    }
    // The room is the same on every machine.
    let size_m = room(3, Kind::Plain).unwrap().scene.bounds().size();
    assert!(size_m.abs_diff_eq(Vec3::new(3.242_64, 3.312_226, 4.625_248), 1e-5), "{size_m}");
}

#[test]
fn rooms_are_closed_and_sensors_are_in_free_air() {
    for Room { scene, sensors, is_open, .. } in rooms(0..200) {
        let name = &scene.name;
        assert!(sensors.len() >= FEWEST_SENSORS, "{name}: {} sensors", sensors.len());
        let bounds = scene.bounds();
        let (fronts, all) = (picker(scene.clone(), false), picker(scene.clone(), true));
        let [camera] = scene.cameras.as_slice() else { panic!("{name} needs one camera") };
        let view = fronts.pick(camera.position, camera.forward);
        assert!(view.is_none_or(|met| met.distance_m > 0.7), "{name}: the camera sees {view:?}");
        let mut escaped = 0;
        for (at, normal) in sensors.iter().chain([&(camera.position, camera.forward)]) {
            assert!(at.is_finite() && (normal.length() - 1.0).abs() < 1e-5, "{name}: {normal}");
            assert!((*at - at.clamp(bounds.min, bounds.max)).length() == 0.0, "{name}: {at}");
            for direction in directions() {
                let [front, first] = [&fronts, &all].map(|picker| picker.pick(*at, direction));
                escaped += u32::from(first.is_none());
                // From within a solid, the first surface shows its back.
                let distances = [front, first].map(|met| met.map(|met| met.distance_m));
                assert_eq!(distances[0], distances[1], "{name}: {at} is within a solid");
            }
        }
        assert!(is_open || escaped == 0, "{name} is closed, but {escaped} rays leave it");
    }
}

#[test]
fn every_light_side_and_wall_kind_occurs() {
    let rooms: Vec<Room> = rooms(0..200).collect();
    let count = |is: &dyn Fn(&Room) -> bool| rooms.iter().filter(|room| is(room)).count();
    for light in RoomLight::ALL {
        assert!(count(&|room| room.light == light) > 10, "{light:?}");
    }
    for wall_m in super::WALLS_M {
        assert!(count(&|room| room.wall_m == wall_m) > 10, "{wall_m} m");
    }
    assert!((80..=140).contains(&count(&|room| room.is_double_sided)));
    assert!((90..=150).contains(&count(&|room| room.is_turned)));
    assert!(count(&|room| room.scene.triangle_count() > 4000) > 10);
}
