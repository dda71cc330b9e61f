//! Hollow things are not rooms: they have no space to stand in.

use std::f32::consts::{PI, TAU};

use super::*;

/// A surface of revolution about y through points (radius, height), seen from its right-hand side
/// as the points go up: from outside.
fn turned(profile: &[(f32, f32)]) -> Mesh {
    const STEPS: u32 = 32;
    let mut mesh = Mesh::default();
    for &(radius, height) in profile {
        for step in 0..STEPS {
            let (sin, cos) = (step as f32 / STEPS as f32 * TAU).sin_cos();
            mesh.positions.push(Vec3::new(radius * sin, height, radius * cos));
        }
    }
    for ring in 0..profile.len() as u32 - 1 {
        for step in 0..STEPS {
            let (a, b) = (ring * STEPS + step, ring * STEPS + (step + 1) % STEPS);
            mesh.indices.extend([a, b, b + STEPS, a, b + STEPS, a + STEPS]);
        }
    }
    let count = mesh.positions.len();
    mesh.normals = vec![Vec3::Y; count];
    mesh.uvs = vec![Vec2::ZERO; count];
    mesh.tangents = vec![Vec3::X.extend(1.0); count];
    mesh
}

fn round(radius: f32, from: f32, to: f32) -> Vec<(f32, f32)> {
    let steps = 12;
    let angle = |step: usize| from + (to - from) * step as f32 / steps as f32;
    (0..=steps).map(|step| (radius * angle(step).cos(), radius * angle(step).sin())).collect()
}

fn moved(mut mesh: Mesh, by: Vec3) -> Mesh {
    mesh.positions.iter_mut().for_each(|position| *position += by);
    mesh
}

fn inside_out(mut mesh: Mesh) -> Mesh {
    mesh.flip_winding();
    mesh
}

/// Pot, with an opening at the top and a spout; without a lid.
fn teapot() -> Scene {
    let belly = turned(&round(1.0, -1.3, 1.3));
    let lining = inside_out(turned(&round(0.95, -1.3, 1.3)));
    let spout = moved(turned(&[(0.2, -0.3), (0.12, 0.5)]), Vec3::X * 1.2);
    let foot = turned(&[(0.0, -1.02), (0.5, -1.02), (0.3, -0.95)]);
    scene([belly, lining, spout, foot], false)
}

/// Body, head and limbs of sheet metal, hollow, with gaps between them.
fn robot() -> Scene {
    let shell = |radius: f32, from: f32, to: f32| {
        let outer = turned(&round(radius, from, to));
        merge([outer, inside_out(turned(&round(radius * 0.93, from, to)))])
    };
    let body = shell(1.0, -1.1, 1.2);
    let head = moved(shell(0.6, -1.0, PI * 0.5), Vec3::Y * 1.5);
    let limbs = [(-1.2, 0.0), (1.2, 0.0), (-0.5, -1.8), (0.5, -1.8)]
        .map(|(x, y)| moved(shell(0.35, -1.2, 1.2), Vec3::new(x, y, 0.0)));
    scene([body, head].into_iter().chain(limbs), false)
}

/// A body with round ends, seats in it and windows without panes.
fn car() -> Scene {
    let hull = |radius: f32, y: f32| {
        let mut ball = sphere(radius, 32);
        for position in &mut ball.positions {
            *position *= Vec3::new(2.2, 0.75, 0.9);
            position.y += y;
        }
        // Windows all around, above the seats' backs.
        let is_window = |t: &[u32]| {
            let middle = t.iter().map(|&i| ball.positions[i as usize]).sum::<Vec3>() / 3.0;
            middle.y > 0.85 && middle.y < 1.1 && middle.x.abs() < 1.4
        };
        ball.indices =
            ball.indices.chunks(3).filter(|t| !is_window(t)).flatten().copied().collect();
        ball
    };
    let seats = [-0.6, 0.6].map(|x| {
        merge([
            cuboid(Vec3::new(x - 0.3, 0.3, -0.5), Vec3::new(x + 0.3, 0.45, 0.5), Faces::ALL),
            cuboid(Vec3::new(x - 0.4, 0.3, -0.5), Vec3::new(x - 0.3, 0.9, 0.5), Faces::ALL),
        ])
    });
    let wheels = [(-1.3, 0.8), (1.3, 0.8), (-1.3, -0.8), (1.3, -0.8)]
        .map(|(x, z)| moved(sphere(0.35, 16), Vec3::new(x, 0.1, z)));
    let body = [hull(1.0, 0.7), inside_out(hull(0.95, 0.7))];
    scene(body.into_iter().chain(seats).chain(wheels), false)
}

/// A closed housing with gears on an axle.
fn gear_box() -> Scene {
    let outer = cuboid(Vec3::new(-1.0, 0.0, -0.6), Vec3::new(1.0, 1.2, 0.6), Faces::ALL);
    let inner = interior(Vec3::new(-0.95, 0.05, -0.55), Vec3::new(0.95, 1.15, 0.55));
    let gears = (0..5).map(|i| {
        let mut gear = turned(&[(0.0, -0.1), (0.5, -0.1), (0.5, 0.1), (0.0, 0.1)]);
        for position in &mut gear.positions {
            *position = Vec3::new(position.y + i as f32 * 0.4 - 0.8, position.x + 0.6, position.z);
        }
        gear
    });
    scene([outer, inner].into_iter().chain(gears), false)
}

/// A hull that is open above its deck, with a cabin.
fn ship() -> Scene {
    let hull = |scale: f32| {
        let mut ball = sphere(1.0, 32);
        for position in &mut ball.positions {
            *position *= Vec3::new(4.0, 1.2, 1.0) * scale;
        }
        let below = |t: &[u32]| t.iter().all(|&i| ball.positions[i as usize].y < 0.3);
        ball.indices = ball.indices.chunks(3).filter(|t| below(t)).flatten().copied().collect();
        ball
    };
    let cabin = cuboid(Vec3::new(-2.0, 0.0, -0.5), Vec3::new(-0.5, 0.9, 0.5), Faces::ALL);
    let mast = cuboid(Vec3::new(0.4, -0.5, -0.05), Vec3::new(0.5, 3.0, 0.05), Faces::ALL);
    scene([hull(1.0), inside_out(hull(0.95)), cabin, mast], false)
}

#[test]
fn hollow_objects_are_not_treated_as_rooms() {
    let all = [
        ("teapot", teapot()),
        ("robot", robot()),
        ("car", car()),
        ("gear box", gear_box()),
        ("ship", ship()),
    ];
    for (name, original) in all {
        // As CAD and sketching programs write it, too: from both sides, and the round ones inside
        // out.
        let mut both = original.clone();
        both.materials[0].double_sided = true;
        let mut wrong = original.clone();
        wrong.meshes.iter_mut().for_each(Mesh::flip_winding);
        if name == "gear box" {
            wrong = original.clone();
        }
        for (how, scene) in
            [("as it is", &original), ("double-sided", &both), ("inside out", &wrong)]
        {
            let framing = Framing::of(scene);
            assert!(!framing.is_place(), "a {name}, {how}, is no place");
            let camera = framing.camera(ASPECT);
            assert_fits(scene, &camera, ASPECT);
            let light = framing.light(&camera, 0.0);
            assert!(matches!(light, DefaultLight::Studio { .. }), "a {name}, {how}: {light}");
        }
    }
}

#[test]
fn inside_cameras_work_for_hollow_objects() {
    for (name, scene) in [("teapot", teapot()), ("gear box", gear_box())] {
        let camera = Framing::of(&scene).inside(ASPECT);
        let camera = camera.unwrap_or_else(|| panic!("there is room in a {name}"));
        assert!(scene.bounds().contains(camera.position), "{name}: {}", camera.position);
        assert_stands_free(&scene, &camera, 0.01);
    }
    let solid = scene([cuboid(Vec3::NEG_ONE, Vec3::ONE, Faces::ALL)], false);
    assert_eq!(Framing::of(&solid).inside(ASPECT), None);
    // And who asks for the outside of a hall.
    let hall = hall();
    assert_fits(&hall, &Framing::of(&hall).outside(ASPECT), ASPECT);
}
