use glam::{DVec3, EulerRot, Quat};
use proptest::prelude::*;

use super::*;
use crate::builtin::shapes::{Faces, cuboid, quad};
use crate::{AlphaMode, Instance, Material, Mesh, builtin};

/// The nearest triangle by a loop over all of them, in the world.
fn brute_force(scene: &Scene, origin: Vec3, direction: Vec3) -> Option<(usize, usize, f64)> {
    let (origin, direction) = (origin.as_dvec3(), direction.as_dvec3().normalize());
    let mut nearest: Option<(usize, usize, f64)> = None;
    for (number, instance) in scene.instances.iter().enumerate() {
        let mesh = &scene.meshes[instance.mesh];
        let world = instance.world_from_local.as_dmat4();
        for (index, triangle) in mesh.triangles().enumerate() {
            let [a, b, c] =
                triangle.map(|corner| world.transform_point3(mesh.positions[corner].as_dvec3()));
            let normal = (b - a).cross(c - a);
            let facing = -normal.dot(direction);
            let is_seen = facing > 0.0 || scene.materials[instance.material].double_sided;
            let distance = (a - origin).dot(normal) / direction.dot(normal);
            let at = origin + distance * direction;
            let is_left = |from: DVec3, to: DVec3| (to - from).cross(at - from).dot(normal) >= 0.0;
            let is_inside = is_left(a, b) && is_left(b, c) && is_left(c, a);
            let is_nearer = nearest.is_none_or(|(.., nearest)| distance < nearest);
            if is_seen && is_inside && distance >= 0.0 && is_nearer {
                nearest = Some((number, index, distance));
            }
        }
    }
    nearest
}

/// Whether a point is close to an edge of its triangle, where two algorithms may find different
/// triangles.
fn is_near_an_edge(scene: &Scene, (instance, triangle, _): (usize, usize, f64), at: Vec3) -> bool {
    let placed = &scene.instances[instance];
    let mesh = &scene.meshes[placed.mesh];
    let corners: Vec<Vec3> = mesh
        .triangles()
        .nth(triangle)
        .unwrap()
        .into_iter()
        .map(|corner| placed.world_from_local.transform_point3(mesh.positions[corner]))
        .collect();
    let size = corners[0].distance(corners[1]).max(corners[0].distance(corners[2]));
    (0..3).any(|edge| {
        let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
        let along = (to - from).normalize();
        (at - from).reject_from(along).length() < 1e-3 * size
    })
}

fn assert_agrees(scene: &Scene, picker: &Picker, origin: Vec3, direction: Vec3) {
    let expected = brute_force(scene, origin, direction);
    let found = picker.pick(origin, direction);
    let (Some(expected), Some(found)) = (expected, found) else {
        // Rounding decides whether a ray hits an outermost edge.
        let at =
            origin.as_dvec3() + expected.map_or(0.0, |e| e.2) * direction.as_dvec3().normalize();
        let is_excused = expected.is_some_and(|e| is_near_an_edge(scene, e, at.as_vec3()))
            || found
                .is_some_and(|f| is_near_an_edge(scene, (f.instance, f.triangle, 0.0), f.position));
        assert!(expected.is_none() == found.is_none() || is_excused, "{expected:?}, {found:?}");
        return;
    };
    let error = (f64::from(found.distance_m) - expected.2).abs();
    let is_same = (found.instance, found.triangle) == (expected.0, expected.1);
    assert!(
        (is_same && error <= 1e-5 * (1.0 + expected.2))
            || is_near_an_edge(scene, expected, found.position)
            || error <= 1e-6 * (1.0 + expected.2),
        "{found:?} instead of {expected:?}"
    );
    assert!((found.normal.length() - 1.0).abs() < 1e-5);
    assert!(found.normal.dot(direction) <= 1e-6, "{found:?} looks away");
    assert!((found.shading_normal.length() - 1.0).abs() < 1e-5);
    let at = origin + direction.normalize() * found.distance_m;
    assert!(at.abs_diff_eq(found.position, 1e-4 * (1.0 + found.distance_m)), "{found:?}");
}

/// A mesh of `count` triangles all over a cube, with a material for each side rule.
fn clutter(seed: u64, count: usize) -> Scene {
    let mut state = seed | 1;
    let mut random = || {
        // xorshift64* (Vigna 2016).
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as f32 / (1_u64 << 24) as f32 - 0.5
    };
    let mut vector = || Vec3::new(random(), random(), random());
    let mesh = |vector: &mut dyn FnMut() -> Vec3| {
        let mut mesh = Mesh::default();
        for _ in 0..count {
            let middle = vector() * 4.0;
            mesh.positions.extend([(); 3].map(|()| middle + vector()));
        }
        mesh.normals = vec![Vec3::Y; mesh.positions.len()];
        mesh.indices = (0..mesh.positions.len() as u32).collect();
        mesh
    };
    let mut scene = Scene::default();
    for number in 0..4 {
        scene.meshes.push(mesh(&mut vector));
        let turn = Quat::from_euler(EulerRot::XYZ, vector().x * 6.0, vector().y * 6.0, 1.0);
        let scale =
            Vec3::new(1.0 + vector().x, 1.0 + vector().y, if number == 2 { -0.7 } else { 1.3 });
        scene.materials.push(Material { double_sided: number % 2 == 0, ..Material::default() });
        scene.instances.push(Instance {
            name: String::new(),
            mesh: number,
            material: number,
            world_from_local: Mat4::from_scale_rotation_translation(scale, turn, vector() * 3.0),
            ..Instance::default()
        });
    }
    scene
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn picking_matches_a_loop_over_all_triangles(
        seed in any::<u64>(),
        count in 1_usize..200,
        rays in prop::collection::vec((prop::array::uniform3(-6.0_f32..6.0), prop::array::uniform3(-1.0_f32..1.0)), 16),
    ) {
        let scene = clutter(seed, count);
        let picker = Picker::new(&scene);
        for (origin, direction) in rays {
            let direction = Vec3::from(direction);
            prop_assume!(direction.length() > 1e-3);
            assert_agrees(&scene, &picker, origin.into(), direction * 5.0);
        }
    }
}

#[test]
fn picking_in_built_in_scenes_matches_a_loop() {
    for (name, turn_rad) in [("cornell", 0.0), ("cornell", 0.5), ("atrium", 0.0), ("spheres", 0.0)]
    {
        let mut scene = builtin::scene(name).unwrap();
        scene.rotate(Vec3::splat(turn_rad));
        let picker = Picker::new(&scene);
        let camera = scene.cameras[0].clone();
        let size = glam::UVec2::new(12, 7);
        let mut met = 0;
        for y in 0..size.y {
            for x in 0..size.x {
                let (origin, direction) =
                    camera.ray(glam::Vec2::new(x as f32, y as f32) + 0.37, size);
                assert_agrees(&scene, &picker, origin, direction);
                met += usize::from(picker.pick(origin, direction).is_some());
            }
        }
        assert!(met > 20, "{name}: {met} rays met something");
    }
}

/// A square of edge 2 around the origin that faces +z; its vertex normals lean towards +x.
fn square(double_sided: bool, world_from_local: Mat4) -> Scene {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mesh = Mesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        normals: vec![Vec3::new(0.6, 0.0, 0.8); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    };
    let alpha = AlphaMode::Mask { cutoff: 0.5 };
    Scene {
        meshes: vec![mesh],
        materials: vec![Material { alpha, double_sided, ..Material::default() }],
        instances: vec![Instance {
            name: String::new(),
            mesh: 0,
            material: 0,
            world_from_local,
            ..Instance::default()
        }],
        ..Scene::default()
    }
}

#[test]
fn hits_are_reported_in_world_coordinates() {
    // Scaled by 2 along x: the triangle's normal stays, vertex normals rotate by the inverse
    // transpose.
    let place = Mat4::from_translation(Vec3::new(5.0, 0.0, -2.0))
        * Mat4::from_scale(Vec3::new(2.0, 1.0, 1.0));
    let picker = Picker::new(&square(false, place));
    let pick = picker.pick(Vec3::new(5.5, 0.5, 1.0), Vec3::NEG_Z * 0.1).unwrap();
    assert_eq!((pick.instance, pick.triangle), (0, 1));
    assert_eq!(pick.position, Vec3::new(5.5, 0.5, -2.0));
    assert_eq!((pick.normal, pick.distance_m), (Vec3::Z, 3.0));
    assert!(pick.shading_normal.abs_diff_eq(Vec3::new(0.3, 0.0, 0.8).normalize(), 1e-6));
    assert_eq!(picker.pick(Vec3::new(5.5, 0.5, 1.0), Vec3::Z), None, "what lies behind");
    assert_eq!(picker.pick(Vec3::new(8.0, 0.5, 1.0), Vec3::NEG_Z), None, "beside");
    assert_eq!(picker.pick(Vec3::new(5.5, 0.5, 1.0), Vec3::ZERO), None, "no direction");
}

#[test]
fn rays_pass_backs_of_single_sided_surfaces() {
    let behind = Vec3::new(0.2, 0.3, -4.0);
    assert_eq!(Picker::new(&square(false, Mat4::IDENTITY)).pick(behind, Vec3::Z), None);
    let pick = Picker::new(&square(true, Mat4::IDENTITY)).pick(behind, Vec3::Z).unwrap();
    assert_eq!(pick.normal, Vec3::NEG_Z);
    assert!(pick.shading_normal.abs_diff_eq(Vec3::new(-0.6, 0.0, -0.8), 1e-6));
    // The loader reverses the winding of mirrored meshes, so that the front stays in front.
    let mut mirrored = square(false, Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)));
    mirrored.meshes[0].flip_winding();
    let picker = Picker::new(&mirrored);
    assert_eq!(picker.pick(behind, Vec3::Z), None);
    assert_eq!(picker.pick(-behind, Vec3::NEG_Z).unwrap().normal, Vec3::Z);
}

#[test]
fn is_inside_distinguishes_solids_from_rooms() {
    // The Cornell box: a room of walls that face inwards, with two blocks on its floor.
    let scene = builtin::scene("cornell").unwrap();
    let picker = Picker::new(&scene);
    let bounds = scene.bounds();
    let at = |x: f32, y: f32, z: f32| bounds.min + bounds.size() * Vec3::new(x, y, z);
    assert!(!picker.is_inside(at(0.5, 0.8, 0.5)), "in the air");
    assert!(!picker.is_inside(at(0.5, 0.001, 0.9)), "just above the floor");
    assert!(picker.is_inside(block(&scene)), "in a block");
    // A box without a bottom on a ground.
    let mut standing = Scene::default();
    let body = cuboid(-Vec3::ONE, Vec3::ONE, Faces::NO_BOTTOM);
    let ground = quad(Vec3::NEG_Y, Vec3::Z * 9.0, Vec3::X * 9.0);
    standing.materials.push(Material::default());
    for mesh in [body, ground] {
        let mesh_number = standing.meshes.len();
        standing.meshes.push(mesh);
        standing.instances.push(Instance { mesh: mesh_number, ..Default::default() });
    }
    let standing = Picker::new(&standing);
    assert!(standing.is_inside(Vec3::new(0.3, -0.5, 0.2)), "in what stands on a ground");
    assert!(!standing.is_inside(Vec3::new(1.5, -0.5, 0.2)), "beside it");
    // No point is inside double-sided surfaces.
    let mut two_sided = scene.clone();
    two_sided.materials.iter_mut().for_each(|material| material.double_sided = true);
    assert!(!Picker::new(&two_sided).is_inside(block(&scene)), "in a block of sheets");
}

#[test]
fn backs_are_only_those_of_single_sided_surfaces_within_reach() {
    let mut scene = Scene::default();
    scene.materials.push(Material::default());
    scene.meshes.push(quad(Vec3::ZERO, Vec3::X, Vec3::Y));
    scene.instances.push(Instance::default());
    let picker = Picker::new(&scene);
    let (front, back) = (Vec3::new(0.2, 0.1, 2.0), Vec3::new(0.2, 0.1, -2.0));
    assert_eq!(picker.back_m(back, Vec3::Z, 2.5), Some(2.0));
    assert_eq!(picker.back_m(back, Vec3::Z, 1.5), None, "out of reach");
    assert_eq!(picker.back_m(front, Vec3::NEG_Z, 2.5), None, "the front");
    scene.materials[0].double_sided = true;
    assert_eq!(Picker::new(&scene).back_m(back, Vec3::Z, 2.5), None, "no back");
}

/// The middle of a block: half-way between the floor and the highest surface below the lamp.
fn block(scene: &Scene) -> Vec3 {
    let picker = Picker::new(scene);
    let (low, size) = (scene.bounds().min, scene.bounds().size());
    let places = (1..20).flat_map(|x| (1..20).map(move |z| (x as f32 / 20.0, z as f32 / 20.0)));
    let tops = places.filter_map(|(x, z)| {
        let eye = low + size * Vec3::new(x, 0.8, z);
        picker.pick(eye, Vec3::NEG_Y).map(|met| met.position)
    });
    let top = tops.max_by(|a, b| a.y.total_cmp(&b.y)).expect("there is a floor");
    Vec3::new(top.x, 0.5 * (top.y + low.y), top.z)
}

#[test]
fn rays_ignore_hidden_instances() {
    let mut scene = square(false, Mat4::from_translation(Vec3::Z));
    let behind = Instance { world_from_local: Mat4::IDENTITY, ..scene.instances[0].clone() };
    scene.instances.push(behind);
    let meet = |scene: &Scene| {
        let pick = Picker::new(scene).pick(Vec3::new(0.2, 0.3, 4.0), Vec3::NEG_Z);
        pick.map(|pick| pick.instance)
    };
    assert_eq!(meet(&scene), Some(0));
    scene.instances[0].is_hidden = true;
    assert_eq!(meet(&scene), Some(1));
    scene.instances[1].is_hidden = true;
    assert_eq!(meet(&scene), None);
}

/// The first of coincident surfaces is hit, so that results do not depend on the hierarchy.
#[test]
fn of_coincident_surfaces_the_first_is_hit() {
    let mut scene = square(false, Mat4::IDENTITY);
    scene.meshes[0].indices = [0, 1, 2].repeat(100);
    scene.instances.push(scene.instances[0].clone());
    let pick = Picker::new(&scene).pick(Vec3::new(0.5, 0.0, 4.0), Vec3::NEG_Z).unwrap();
    assert_eq!((pick.instance, pick.triangle), (0, 0));
}

#[test]
fn tiny_objects_are_hit_from_far_away() {
    for size_m in [1e-4_f32, 1.0, 1e5] {
        let picker = Picker::new(&square(false, Mat4::from_scale(Vec3::splat(size_m))));
        // At this distance, an f32 ray still resolves a thousandth of the thing.
        let origin = Vec3::new(0.25, 0.125, 4096.0) * size_m;
        let pick = picker.pick(origin, Vec3::NEG_Z).unwrap();
        assert!((pick.distance_m / size_m - 4096.0).abs() < 1e-3);
        assert_eq!(pick.triangle, 0);
    }
}

#[test]
fn empty_and_broken_scenes_are_picked_safely() {
    assert_eq!(Picker::new(&Scene::default()).pick(Vec3::ZERO, Vec3::X), None);
    let mut broken = square(false, Mat4::IDENTITY);
    broken.meshes[0].indices = vec![0, 1, 77, 0, 2, 3];
    broken.instances[0].material = 9;
    assert_eq!(Picker::new(&broken).pick(Vec3::Z, Vec3::NEG_Z).map(|pick| pick.triangle), Some(1));
    broken.instances[0].mesh = 9;
    assert_eq!(Picker::new(&broken).pick(Vec3::Z, Vec3::NEG_Z), None);
}
