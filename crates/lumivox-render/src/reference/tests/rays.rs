//! Tests of rays against triangles: hits equal those of a loop on the CPU, and no ray slips through
//! an edge.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use lumivox::gpu::{Kernel, Recorder, read_buffer};
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, VolumeKind};

use super::*;
use crate::reference::geometry::{AS_SEEN, BOTH_SIDES, NO_TRIANGLE};
use crate::reference::upload::layout;

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Query {
    origin: [f32; 3],
    sides: u32,
    direction: [f32; 3],
    distance: f32,
    weights: [f32; 2],
    triangle: u32,
    padding: u32,
}

fn query(origin: DVec3, direction: DVec3, sides: u32) -> Query {
    Query {
        origin: origin.as_vec3().to_array(),
        direction: direction.normalize().as_vec3().to_array(),
        distance: 3e38,
        sides,
        ..Query::zeroed()
    }
}

/// The hits of rays in a scene whose bounds are centred at the origin.
fn ask(scene: &Scene, queries: &[Query]) -> Vec<Query> {
    let middle = scene.bounds().center().length();
    assert!(middle < 1e-6 * scene.bounds().radius_m(), "the middle is {middle} away");
    // Kernels of this layout write the film, so it must be large enough for all queries.
    let size = UVec2::new(64, queries.len().div_ceil(128) as u32);
    let tracer = tracer(scene, &ReferenceSettings { size, ..settings(1, 1) });
    let (device, queue) = (&tracer.gpu.device, &tracer.gpu.queue);
    let pipelines = &tracer.gpu.pipelines;
    let mut shaders = crate::shaders::library(&library_with_volume(
        VolumeKind::default(),
        Directionality::default(),
    ));
    let features = Features { stack: tracer.uploaded.stack, ..Features::ALL };
    features.set(&mut shaders);
    let module = "render::reference::rays_test";
    shaders.add(module, include_str!("rays.wgsl"));
    let kernel =
        Kernel::new(pipelines, &shaders, module, "main", &[&layout(pipelines)]).expect("a shader");
    let film = &tracer.uploaded.film;
    queue.write_buffer(film, 0, bytemuck::cast_slice(queries));
    let mut recorder = Recorder::new(device, queue);
    kernel.run(&mut recorder, &[&tracer.uploaded.group], [queries.len() as u32, 1, 1]);
    recorder.submit();
    let read = read_buffer(device, queue, film, 0..size_of_val(queries) as u64);
    pollster::block_on(read).expect("answers")
}

/// Random numbers in [0, 1): splitmix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A point in the cube from -1 to 1.
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
}

fn soup(corners: Vec<Vec3>) -> Mesh {
    Mesh {
        normals: vec![Vec3::Y; corners.len()],
        uvs: vec![glam::Vec2::ZERO; corners.len()],
        tangents: vec![Vec3::X.extend(1.0); corners.len()],
        indices: (0..corners.len() as u32).collect(),
        positions: corners,
        ..Mesh::default()
    }
}

/// The distance of the nearest hit, and whether rounding may decide it because the ray passes close
/// to an edge.
fn nearest(
    corners: &[Vec3],
    is_double_sided: impl Fn(usize) -> bool,
    query: &Query,
) -> (f64, bool) {
    let origin = Vec3::from(query.origin).as_dvec3();
    let direction = Vec3::from(query.direction).as_dvec3();
    let (mut best, mut is_close) = (f64::INFINITY, false);
    for (index, triangle) in corners.chunks_exact(3).enumerate() {
        let [a, b, c] = [0, 1, 2].map(|i| triangle[i].as_dvec3());
        let normal = (b - a).cross(c - a);
        let along = normal.dot(direction);
        let distance = normal.dot(a - origin) / along;
        if distance <= 0.0 || (along > 0.0 && query.sides == AS_SEEN && !is_double_sided(index)) {
            continue;
        }
        let point = origin + distance * direction;
        let beside = [(a, b), (b, c), (c, a)]
            .map(|(p, q)| (q - p).cross(point - p).dot(normal) / normal.length_squared());
        let least = beside.into_iter().fold(f64::INFINITY, f64::min);
        // Ten times the shader's tolerance.
        let blur = 1e-5 * (1.0 + distance * (b - a).length().max((c - a).length()) / along.abs());
        is_close |= least.abs() < blur && distance < best;
        if least >= 0.0 {
            best = best.min(distance);
        }
    }
    (best, is_close)
}

fn assert_twin(what: &str, scene: &Scene, corners: &[Vec3], half: usize, queries: &[Query]) {
    let (mut hits, mut close) = (0, 0);
    for (query, answer) in queries.iter().zip(ask(scene, queries)) {
        let (expected, is_close) = nearest(corners, |index| index >= half, query);
        if is_close {
            close += 1;
            continue;
        }
        if expected.is_finite() {
            hits += 1;
            let distance = f64::from(answer.distance);
            let is_same =
                answer.triangle != NO_TRIANGLE && (distance / expected - 1.0).abs() < 1e-3;
            assert!(is_same, "{what}: {answer:?}, not at {expected}");
        } else {
            assert_eq!(answer.triangle, NO_TRIANGLE, "{what}: {answer:?}, where nothing is");
        }
    }
    println!("{what}: {hits} of {} rays hit, {close} pass an edge closely", queries.len());
    assert!(hits > queries.len() / 10 && close < queries.len() / 5, "{what} says little");
}

#[test]
fn ray_hits_match_a_brute_force_loop() {
    let mut random = Random(1);
    let mut corners = Vec::new();
    for index in 0..600 {
        let center = random.point();
        // Triangles of all sizes; some are needles, and some have no area.
        let size = 0.6 * random.next().powi(3) + 1e-3;
        let [a, b] = [random.point() * size, random.point() * size];
        let c = match index % 20 {
            0 => a + 1e-4 * b,
            1 => 2.0 * a,
            _ => b,
        };
        corners.extend([center, center + a, center + c].map(DVec3::as_vec3));
    }
    // Triangles in the corners of a box, so that the centre of the bounds is known.
    for sign in [-2.0, 2.0] {
        corners.extend([
            Vec3::splat(sign),
            Vec3::splat(sign) * 0.99,
            Vec3::new(sign, sign, 0.99 * sign),
        ]);
    }
    // The second half is double-sided.
    let half = corners.len() / 6;
    let mut scene = stage();
    let one = Material::diffuse("one side", Vec3::ONE);
    add(&mut scene, soup(corners[..3 * half].to_vec()), one.clone());
    let two = Material { double_sided: true, ..one };
    add(&mut scene, soup(corners[3 * half..].to_vec()), two);
    let queries: Vec<Query> = (0..6000)
        .map(|index| {
            // Some directions are along axes: zeros are a special case.
            let mut direction = random.point();
            if index % 10 == 0 {
                direction = DVec3::AXES[index / 10 % 3] * direction.x.signum();
            }
            let sides = if index % 2 == 0 { AS_SEEN } else { BOTH_SIDES };
            query(random.point() * 1.5, direction, sides)
        })
        .collect();
    assert_twin("a soup", &scene, &corners, half, &queries);
}

/// Nested triangles that double in size: the hierarchy is as deep as their number.
#[test]
fn rays_traverse_very_deep_hierarchies() {
    let mut corners = Vec::new();
    for index in 0..100 {
        let size = f64::from(index - 60).exp2();
        for turn in 0..3 {
            let sine_cosine = (f64::from(turn) * std::f64::consts::TAU / 3.0).sin_cos();
            corners.push((size * DVec3::new(sine_cosine.1, sine_cosine.0, 0.3)).as_vec3());
        }
    }
    let mirrored: Vec<Vec3> = corners.iter().map(|corner| -*corner).collect();
    corners.extend(mirrored);
    let half = 0;
    let mut scene = stage();
    let both = Material { double_sided: true, ..Material::diffuse("nested", Vec3::ONE) };
    add(&mut scene, soup(corners.clone()), both);
    let mut random = Random(2);
    let queries: Vec<Query> = (0..2000)
        .map(|_| {
            let size = (80.0 * random.next() - 45.0).exp2();
            let target = DVec3::new(random.next() - 0.5, random.next() - 0.5, 0.0) * size;
            let origin = random.point() * size + DVec3::Z * 2.0 * size;
            query(origin, target - origin, BOTH_SIDES)
        })
        .collect();
    let depth = tracer(&scene, &settings(1, 1)).uploaded.stack;
    println!("a stack of {depth}");
    assert!(depth > 20, "the hierarchy is only {depth} deep");
    assert_twin("nested", &scene, &corners, half, &queries);
}

/// No ray leaves a closed, finely divided sphere, even towards its edges and corners.
#[test]
fn no_ray_slips_through_an_edge() {
    let (rings, segments) = (128_u32, 256_u32);
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        for segment in 0..=segments {
            // Positions are bit-identical where the seam closes and at the poles.
            let polar = f64::from(ring) / f64::from(rings) * std::f64::consts::PI;
            let azimuth =
                f64::from(segment % segments) / f64::from(segments) * std::f64::consts::TAU;
            let sine = if ring % rings == 0 { 0.0 } else { polar.sin() };
            let at = DVec3::new(sine * azimuth.cos(), polar.cos(), -sine * azimuth.sin());
            mesh.positions.push(at.as_vec3());
            mesh.normals.push(at.as_vec3());
            mesh.uvs.push(glam::Vec2::ZERO);
            mesh.tangents.push(at.as_vec3().any_orthonormal_vector().extend(1.0));
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let upper = ring * (segments + 1) + segment;
            let lower = upper + segments + 1;
            mesh.indices.extend([upper, lower, upper + 1, upper + 1, lower, lower + 1]);
        }
    }
    let mut random = Random(3);
    let triangles: Vec<[usize; 3]> = mesh.triangles().collect();
    let queries: Vec<Query> = (0..20_000)
        .map(|index| {
            let triangle = triangles[(random.next() * triangles.len() as f64) as usize];
            let [a, b, _] = triangle.map(|corner| mesh.positions[corner].as_dvec3());
            let share = if index % 4 == 0 { 0.0 } else { random.next() };
            // Rounded to f32, like the origins of a picture's rays.
            let origin = (0.97 / 3.0_f64.sqrt() * random.point()).as_vec3().as_dvec3();
            query(origin, a + share * (b - a) - origin, BOTH_SIDES)
        })
        .collect();
    let mut scene = stage();
    add(&mut scene, mesh, Material::diffuse("sphere", Vec3::ONE));
    let answers = ask(&scene, &queries);
    let lost = answers.iter().filter(|answer| answer.triangle == NO_TRIANGLE).count();
    assert_eq!(lost, 0, "of {} rays, {lost} slip through", queries.len());
}
