//! The scenes of the tests.

use super::*;

/// A mesh from positions and triangles; its other arrays are placeholders.
pub(super) fn mesh(positions: Vec<Vec3>, indices: Vec<u32>) -> Mesh {
    let count = positions.len();
    Mesh {
        positions,
        indices,
        normals: vec![Vec3::Y; count],
        uvs: vec![Vec2::ZERO; count],
        tangents: vec![Vec3::X.extend(1.0); count],
        ..Mesh::default()
    }
}

/// The mesh without the triangles whose corners are all in some part of space.
pub(super) fn without(mut mesh: Mesh, is_there: impl Fn(Vec3) -> bool) -> Mesh {
    let is_kept = |t: &&[u32]| !t.iter().all(|&i| is_there(mesh.positions[i as usize]));
    mesh.indices = mesh.indices.chunks(3).filter(is_kept).flatten().copied().collect();
    mesh
}

/// Each mesh as an instance of its own.
pub(super) fn scene(meshes: impl IntoIterator<Item = Mesh>, is_double_sided: bool) -> Scene {
    let mut scene = Scene { name: "test".to_owned(), ..Scene::default() };
    let mut material = Material::diffuse("grey", Vec3::splat(0.5));
    material.double_sided = is_double_sided;
    scene.materials.push(material);
    scene.meshes.extend(meshes);
    let instance = |mesh| Instance { mesh, material: 0, ..Instance::default() };
    scene.instances = (0..scene.meshes.len()).map(instance).collect();
    scene.validate().unwrap();
    scene
}

pub(super) fn scaled(scene: &Scene, scale: f32) -> Scene {
    let mut scene = scene.clone();
    for instance in &mut scene.instances {
        instance.world_from_local =
            Mat4::from_scale(Vec3::splat(scale)) * instance.world_from_local;
    }
    scene
}

/// A room of 6 x 3 x 4 m seen from inside.
pub(super) fn room() -> Mesh {
    interior(Vec3::new(-3.0, 0.0, -2.0), Vec3::new(3.0, 3.0, 2.0))
}

/// The room with a window of 1 x 1 m at one end, walls without thickness.
pub(super) fn room_with_window() -> Mesh {
    // Replaces the wall at +x by four strips around the window.
    let walls = without(room(), |p| p.x > 2.9);
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
pub(super) fn hall() -> Scene {
    let all = FrameFaces { top: true, bottom: false, outer: true };
    let (outer, inner) = (Vec2::new(12.5, 4.5), Vec2::new(12.0, 4.0));
    let walls = frame(outer, inner, [0.0, 10.0], all);
    // A roof with an opening in the middle.
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

/// A hollow ball with a modelled inside, on a stand.
pub(super) fn helmet() -> Scene {
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
pub(super) fn terrain() -> Scene {
    let edge = 41;
    let place = |i: u32| {
        let (x, z) = ((i % edge) as f32 - 20.0, (i / edge) as f32 - 20.0);
        Vec3::new(x, 1.5 * ((x * 0.4).sin() + (z * 0.3).cos()), z)
    };
    let cells = (0..edge * (edge - 1)).filter(|i| i % edge + 1 < edge);
    let indices = cells.flat_map(|i| [i, i + edge, i + edge + 1, i, i + edge + 1, i + 1]);
    scene([mesh((0..edge * edge).map(place).collect(), indices.collect())], false)
}

pub(super) fn cup() -> Scene {
    let walls = frame(
        Vec2::splat(0.04),
        Vec2::splat(0.035),
        [0.005, 0.1],
        FrameFaces { top: true, bottom: false, outer: true },
    );
    let base = cuboid(Vec3::new(-0.04, 0.0, -0.04), Vec3::new(0.04, 0.005, 0.04), Faces::ALL);
    scene([walls, base], false)
}

/// A surface of revolution about y through points (radius, height), seen from its right-hand side
/// as the points go up: from outside.
fn turned(profile: &[(f32, f32)]) -> Mesh {
    const STEPS: u32 = 32;
    let ring = |&(radius, height): &(f32, f32)| {
        (0..STEPS).map(move |step| {
            let (sin, cos) = (step as f32 / STEPS as f32 * TAU).sin_cos();
            Vec3::new(radius * sin, height, radius * cos)
        })
    };
    let bands = (0..profile.len() as u32 - 1).flat_map(|ring| {
        (0..STEPS).flat_map(move |step| {
            let (a, b) = (ring * STEPS + step, ring * STEPS + (step + 1) % STEPS);
            [a, b, b + STEPS, a, b + STEPS, a + STEPS]
        })
    });
    mesh(profile.iter().flat_map(ring).collect(), bands.collect())
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
pub(super) fn teapot() -> Scene {
    let belly = turned(&round(1.0, -1.3, 1.3));
    let lining = inside_out(turned(&round(0.95, -1.3, 1.3)));
    let spout = moved(turned(&[(0.2, -0.3), (0.12, 0.5)]), Vec3::X * 1.2);
    let foot = turned(&[(0.0, -1.02), (0.5, -1.02), (0.3, -0.95)]);
    scene([belly, lining, spout, foot], false)
}

/// Body, head and limbs of sheet metal, hollow, with gaps between them.
pub(super) fn robot() -> Scene {
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
pub(super) fn car() -> Scene {
    let hull = |radius: f32, y: f32| {
        let mut ball = sphere(radius, 32);
        for position in &mut ball.positions {
            *position *= Vec3::new(2.2, 0.75, 0.9);
            position.y += y;
        }
        // Windows all around, above the seats' backs.
        without(ball, |p| (0.8..1.15).contains(&p.y) && p.x.abs() < 1.4)
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
pub(super) fn gear_box() -> Scene {
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
pub(super) fn ship() -> Scene {
    let hull = |scale: f32| {
        let mut ball = sphere(1.0, 32);
        for position in &mut ball.positions {
            *position *= Vec3::new(4.0, 1.2, 1.0) * scale;
        }
        without(ball, |p| p.y > 0.25)
    };
    let cabin = cuboid(Vec3::new(-2.0, 0.0, -0.5), Vec3::new(-0.5, 0.9, 0.5), Faces::ALL);
    let mast = cuboid(Vec3::new(0.4, -0.5, -0.05), Vec3::new(0.5, 3.0, 0.05), Faces::ALL);
    scene([hull(1.0), inside_out(hull(0.95)), cabin, mast], false)
}
