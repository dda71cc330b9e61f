//! Geometry of the built-in scenes, by brute force in f64.

use glam::{DVec3, Mat4, Vec3};

use super::{is_large, names, scene};
use crate::{Instance, Scene, SceneError, Shading};

/// Triangles of an instance in world space, with the normals of their corners, and a sphere around
/// them for quick rejection.
struct Thing {
    middle: DVec3,
    radius_m: f64,
    triangles: Vec<([DVec3; 3], [DVec3; 3])>,
}

/// All instances.
fn things(scene: &Scene) -> Vec<Thing> {
    let thing = |instance: &Instance| {
        let mesh = &scene.meshes[instance.mesh];
        let m = instance.world_from_local.as_dmat4();
        let normal_matrix = m.inverse().transpose();
        let place = |i: usize| m.transform_point3(mesh.positions[i].as_dvec3());
        let corners = || (0..mesh.positions.len()).map(place);
        let middle = corners().sum::<DVec3>() / mesh.positions.len() as f64;
        let radius_m = corners().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let normal = |i: usize| normal_matrix.transform_vector3(mesh.normals[i].as_dvec3());
        let triangles = mesh.triangles().map(|t| (t.map(place), t.map(normal))).collect();
        Thing { middle, radius_m, triangles }
    };
    scene.instances.iter().map(thing).collect()
}

/// The nearest hit along a ray: its distance, and whether it meets the front (Moller & Trumbore
/// 1997, "Fast, minimum storage ray-triangle intersection", without culling).
fn cast(things: &[Thing], origin: DVec3, dir: DVec3) -> Option<(f64, bool)> {
    // The margin is far larger than the slack below.
    let is_near = |thing: &&Thing| {
        (thing.middle - origin).cross(dir).length() <= (thing.radius_m + 1e-3) * dir.length()
    };
    let mut nearest: Option<(f64, bool)> = None;
    for ([a, b, c], _) in things.iter().filter(is_near).flat_map(|thing| &thing.triangles) {
        let (ab, ac) = (*b - *a, *c - *a);
        let p = dir.cross(ac);
        let det = ab.dot(p);
        if det == 0.0 {
            continue;
        }
        let s = origin - *a;
        let u = s.dot(p) / det;
        let q = s.cross(ab);
        let v = dir.dot(q) / det;
        let t = ac.dot(q) / det;
        // f32 vertices after a rotation leave gaps of about 1e-7 m at the edges.
        let slack = 1e-6;
        if u < -slack || v < -slack || u + v > 1.0 + slack || t <= 1e-9 {
            continue;
        }
        if nearest.is_none_or(|(distance, _)| t < distance) {
            nearest = Some((t, det > 0.0));
        }
    }
    nearest
}

/// Directions spread evenly over the sphere (a Fibonacci lattice).
fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
        let azimuth = f64::from(i) * 2.399_963_229_728_653;
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * azimuth.cos(), y, r * azimuth.sin())
    })
}

fn assert_closed_around(scene: &Scene, origin: Vec3) {
    let things = things(scene);
    for dir in directions(4000) {
        let hit = cast(&things, origin.as_dvec3(), dir);
        let (distance, front) = hit.unwrap_or_else(|| panic!("{} is open along {dir}", scene.name));
        assert!(front, "{}: a back face along {dir} at {distance} m", scene.name);
    }
}

#[test]
fn every_name_gives_a_valid_scene_with_a_camera() {
    for &name in names() {
        let mut scene = scene(name).unwrap();
        assert_eq!(scene.name, name);
        assert!(!scene.cameras.is_empty(), "{name}");
        assert_eq!(scene.notes.degenerate_triangles, 0, "{name}");
        scene.validate().unwrap();
        assert!(scene.notes.warnings.is_empty(), "{name}: {:?}", scene.notes.warnings);
    }
}

#[test]
fn normals_agree_with_the_winding() {
    for &name in names().iter().filter(|name| !is_large(name)) {
        for (corners, normals) in
            things(&scene(name).unwrap()).into_iter().flat_map(|t| t.triangles)
        {
            let face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            assert!(face.length() > 0.0, "{name}");
            for normal in normals {
                assert!(face.dot(normal) > 0.0, "{name}: {corners:?}");
            }
        }
    }
}

#[test]
fn closed_rooms_have_no_gaps() {
    for name in ["furnace", "two-rooms-closed", "two-rooms", "spheres"] {
        for angles_rad in [Vec3::ZERO, Vec3::new(0.5, 0.35, 0.4)] {
            let mut scene = scene(name).unwrap();
            scene.rotate(angles_rad);
            for camera in &scene.cameras {
                assert_closed_around(&scene, camera.position);
            }
            for light in &scene.lights {
                assert_closed_around(&scene, light.position);
            }
        }
    }
}

#[test]
fn the_closed_dark_room_sees_nothing_of_the_lit_one() {
    let scene = scene("two-rooms-closed").unwrap();
    let things = things(&scene);
    for dir in directions(4000) {
        let origin = DVec3::new(1.0, 1.0, 0.0);
        let (distance, _) = cast(&things, origin, dir).unwrap();
        assert!((origin + dir * distance).x > 0.0);
    }
}

#[test]
fn the_doorway_lets_a_ray_through() {
    let things = things(&scene("two-rooms").unwrap());
    let origin = DVec3::new(1.0, 0.8, 0.5);
    let (distance, _) = cast(&things, origin, DVec3::NEG_X).unwrap();
    assert!((distance - 3.0).abs() < 1e-6, "{distance}");
    let beside = DVec3::new(1.0, 0.8, -0.5);
    let (distance, _) = cast(&things, beside, DVec3::NEG_X).unwrap();
    assert!((distance - 0.9975).abs() < 1e-6, "{distance}");
}

#[test]
fn the_atrium_is_open_only_at_the_roof() {
    let scene = scene("atrium").unwrap();
    let things = things(&scene);
    let mut escaped = 0;
    for x in -5..=5 {
        for z in [-3.2, -1.1, 0.1, 1.3, 3.3] {
            let origin = DVec3::new(f64::from(x) + 0.03, 1.2, z);
            for dir in directions(300) {
                if let Some((_, front)) = cast(&things, origin, dir) {
                    assert!(front, "back face from {origin} along {dir}");
                    continue;
                }
                escaped += 1;
                let at_roof = origin + dir * ((6.0 - origin.y) / dir.y);
                assert!(dir.y > 0.0 && at_roof.x.abs() < 3.61 && at_roof.z.abs() < 1.71);
            }
        }
    }
    assert!(escaped > 100, "the sky is seen by {escaped} rays only");
}

#[test]
fn the_sun_reaches_floor_and_cloth() {
    let scene = scene("atrium").unwrap();
    let things = things(&scene);
    let sun = scene.lights[0].direction.as_dvec3();
    let lit = |point: DVec3| cast(&things, point, -sun).is_none();
    assert!(lit(DVec3::new(1.0, 0.01, 1.0)), "the floor");
    let cloth = (0..40).any(|i| lit(DVec3::new(0.3, 0.9 + 0.04 * f64::from(i), 2.23)));
    assert!(cloth, "a cloth");
}

#[test]
fn cameras_stand_free_and_see_the_scene() {
    for &name in names().iter().filter(|name| !is_large(name)) {
        let scene = scene(name).unwrap();
        let things = things(&scene);
        for camera in &scene.cameras {
            let hit = cast(&things, camera.position.as_dvec3(), camera.forward.as_dvec3());
            let (distance, front) = hit.unwrap();
            assert!(front && distance > 0.5, "{name}, {}: {distance} m", camera.name);
        }
    }
}

#[test]
fn the_cornell_box_fits_the_frame() {
    let scene = scene("cornell").unwrap();
    let bounds = scene.bounds();
    assert!((bounds.min - Vec3::new(-1.0, 0.0, -1.0)).length() < 1e-6);
    assert!((bounds.max - Vec3::new(1.0, 2.0, 1.0)).length() < 1e-6);
    let camera = &scene.cameras[0];
    let view: Mat4 = camera.camera_from_world();
    let half = (camera.vertical_fov_rad * 0.5).tan();
    for corner in [bounds.min.with_z(1.0), bounds.max] {
        let seen = view.transform_point3(corner);
        let height = seen.y.abs() / -seen.z / half;
        assert!(height > 0.95 && height < 1.0, "{height}");
    }
}

#[test]
fn rotation_is_intrinsic_about_the_centre() {
    let (plain, mut turned) = (scene("cornell").unwrap(), scene("cornell").unwrap());
    let quarter = std::f32::consts::FRAC_PI_2;
    turned.rotate(Vec3::new(quarter, 0.0, quarter));
    let center = plain.bounds().center();
    let offset = plain.cameras[0].position - center;
    // About z first: x becomes y, y becomes -x; then about x: y becomes z, z becomes -y.
    let expected = Vec3::new(-offset.y, -offset.z, offset.x);
    assert!((turned.cameras[0].position - center - expected).length() < 1e-5);
    assert!((turned.bounds().center() - center).length() < 1e-5);
}

#[test]
fn rotation_keeps_distances_to_the_lights() {
    let (plain, mut rotated) = (scene("cornell").unwrap(), scene("cornell").unwrap());
    rotated.rotate(Vec3::new(0.5, 0.35, 0.4));
    let distance = |s: &Scene| {
        let instance = &s.instances[3];
        let corner = s.meshes[instance.mesh].positions[0];
        instance.world_from_local.transform_point3(corner).distance(s.lights[0].position)
    };
    assert!((distance(&plain) - distance(&rotated)).abs() < 1e-5);
    assert!((plain.bounds().center() - rotated.bounds().center()).length() < 0.2);
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let error = scene("sponza").unwrap_err();
    assert!(matches!(&error, SceneError::UnknownBuiltin { name, .. } if name == "sponza"));
    assert!(error.to_string().contains("interior-night"));
}

#[test]
fn glossy_variants_differ_in_gloss_only() {
    let (matt, glossy) = (scene("cornell").unwrap(), scene("cornell-glossy").unwrap());
    assert_eq!(glossy.name, "cornell-glossy");
    assert_eq!(matt.meshes, glossy.meshes);
    for (a, b) in matt.materials.iter().zip(&glossy.materials) {
        let (Shading::MetallicRoughness(a), Shading::MetallicRoughness(b)) =
            (&a.shading, &b.shading)
        else {
            panic!("{a:?}, {b:?}");
        };
        assert_eq!(a.base_color, b.base_color);
        assert_eq!((a.specular, b.specular, b.metallic, b.roughness), (0.0, 1.0, 0.0, 0.5));
    }
    assert!(scene("sponza-glossy").is_err());
}
