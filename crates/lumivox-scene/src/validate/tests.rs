//! Faults in hand-made scenes.

use glam::{Vec2, Vec4};

use super::*;
use crate::{AlphaMode, LightKind, TextureRef};

fn triangle() -> Scene {
    Scene {
        name: "hand-made".to_owned(),
        meshes: vec![Mesh {
            name: "triangle".to_owned(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: vec![Vec2::ZERO; 3],
            tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3],
            indices: vec![0, 1, 2],
            ..Mesh::default()
        }],
        instances: vec![Instance {
            name: "instance".to_owned(),
            mesh: 0,
            material: 0,
            ..Instance::default()
        }],
        materials: vec![Material::default()],
        ..Scene::default()
    }
}

/// The error that a change brings about, as text.
fn fault(change: impl FnOnce(&mut Scene)) -> String {
    let mut scene = triangle();
    change(&mut scene);
    let error = scene.validate().unwrap_err().to_string();
    assert!(error.starts_with("hand-made: "), "{error}");
    error
}

#[test]
fn validation_is_idempotent() {
    let mut scene = triangle();
    scene.meshes[0].indices.extend([1, 1, 2, 0, 2, 0]);
    scene.validate().unwrap();
    assert_eq!(scene.notes.degenerate_triangles, 2);
    let once = scene.clone();
    scene.validate().unwrap();
    assert_eq!(scene, once);
}

#[test]
fn numbers_that_are_not_finite_are_named() {
    assert!(fault(|s| s.meshes[0].positions[1].y = f32::NAN).contains("position 1"));
    assert!(fault(|s| s.meshes[0].normals[2].x = f32::INFINITY).contains("normal 2"));
    assert!(fault(|s| s.instances[0].world_from_local.w_axis.x = f32::NAN).contains("transform"));
    assert!(fault(|s| s.materials[0].emissive.x = f32::NAN).contains("emission"));
    assert!(fault(|s| s.environment.radiance.x = f32::INFINITY).contains("environment"));
    // Finite numbers whose product is not.
    let far = |s: &mut Scene| {
        s.meshes[0].positions[1].x = 1e30;
        s.instances[0].world_from_local = Mat4::from_scale(Vec3::splat(1e12));
    };
    assert!(fault(far).contains("bounds"));
}

#[test]
fn indices_beyond_the_end_are_named() {
    assert!(fault(|s| s.meshes[0].indices[2] = 3).contains("there are only 3 vertices"));
    assert!(fault(|s| s.instances[0].mesh = 1).contains("meshes"));
    assert!(fault(|s| s.instances[0].material = 9).contains("materials"));
    let texture = Some(TextureRef::new(0));
    assert!(fault(|s| s.materials[0].normal_texture = texture).contains("0 textures"));
}

#[test]
fn attribute_lengths_must_agree() {
    assert!(fault(|s| s.meshes[0].uvs.clear()).contains("texture coordinates"));
    assert!(fault(|s| s.meshes[0].indices.truncate(2)).contains("multiple of three"));
    let texture = |s: &mut Scene| {
        s.textures.push(Texture {
            name: "short".to_owned(),
            width: 2,
            height: 2,
            rgba8: vec![0; 15],
            sampler: crate::Sampler::default(),
        });
    };
    assert!(fault(texture).contains("16 bytes"));
}

#[test]
fn a_scene_without_visible_triangles_is_refused() {
    assert!(fault(|s| s.instances.clear()).contains("no triangles"));
    assert!(fault(|s| s.meshes[0].indices.clear()).contains("no triangles"));
    let line = fault(|s| s.meshes[0].positions[2] = Vec3::X * 2.0);
    assert!(line.contains("1 degenerate"), "{line}");
    assert!(fault(|s| s.meshes[0].positions.fill(Vec3::ONE)).contains("size zero"));
}

#[test]
fn factors_have_ranges() {
    assert!(fault(|s| s.materials[0].emissive.y = -1.0).contains("at least 0"));
    assert!(
        fault(|s| s.materials[0].alpha = AlphaMode::Mask { cutoff: f32::NAN }).contains("cutoff")
    );
    let rough = |s: &mut Scene| {
        s.materials[0].shading = Shading::MetallicRoughness(crate::MetallicRoughness {
            roughness: 1.5,
            ..Default::default()
        });
    };
    assert!(fault(rough).contains("from 0 to 1"));
}

#[test]
fn lights_and_cameras_have_ranges() {
    let spot = |inner: f32, outer: f32| {
        move |s: &mut Scene| {
            s.lights.push(Light {
                kind: LightKind::Spot,
                intensity: 1.0,
                inner_angle_rad: inner,
                outer_angle_rad: outer,
                ..Light::default()
            });
        }
    };
    assert!(fault(spot(0.5, 0.4)).contains("inner angle"));
    assert!(fault(spot(0.5, 2.0)).contains("outer angle"));
    let fov = |s: &mut Scene| s.cameras.push(Camera { vertical_fov_rad: 4.0, ..Camera::default() });
    assert!(fault(fov).contains("field of view"));
    let blind = |s: &mut Scene| s.cameras.push(Camera { forward: Vec3::ZERO, ..Camera::default() });
    assert!(fault(blind).contains("unit length"));
}

#[test]
fn meshes_and_instances_without_extent_are_dropped() {
    let mut scene = triangle();
    let mut empty = scene.meshes[0].clone();
    empty.indices = vec![0, 0, 0];
    scene.meshes.insert(0, empty);
    scene.instances.push(scene.instances[0].clone());
    scene.instances[1].mesh = 1;
    scene.instances.push(scene.instances[1].clone());
    scene.instances[2].world_from_local = Mat4::from_scale(Vec3::new(0.0, 1.0, 0.0));
    scene.validate().unwrap();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 1));
    assert_eq!(scene.instances[0].mesh, 0);
    assert_eq!(scene.notes.warnings.len(), 1);
}

/// A flattened cube gets a thickness, and the normals of its plane.
#[test]
fn flat_transforms_get_a_thickness() {
    let turn = Mat4::from_rotation_x(0.7) * Mat4::from_rotation_z(2.0);
    let sizes = [1e-3, 1.0, 1e6];
    for (size, first) in sizes.into_iter().flat_map(|size| [(size, Mat4::IDENTITY), (size, turn)]) {
        // Flattens a cube into the xz plane.
        let flat = first * Mat4::from_scale(Vec3::new(3.0, 0.0, -2.0) * size) * turn;
        for mirrors in [false, true] {
            let made = invertible(flat, mirrors).unwrap();
            assert_eq!(made.determinant() < 0.0, mirrors);
            assert_eq!(invertible(made, !mirrors), Some(made));
            let normal =
                made.inverse().transpose().transform_vector3(turn.inverse().y_axis.truncate());
            let expected = first.transform_vector3(Vec3::Y);
            assert!(normal.normalize().cross(expected).length() < 1e-5, "{size} {normal}");
            let moved = made - flat;
            assert!(moved.to_cols_array().iter().all(|x| x.abs() < 1e-5 * size));
        }
    }
    for nothing in [Vec3::ZERO, Vec3::X] {
        assert_eq!(invertible(Mat4::from_scale(nothing), false), None);
    }
    let thin = Mat4::from_scale(Vec3::new(1e3, 1e-3, 1e3));
    assert_eq!(invertible(thin, false), Some(thin));
    let rod = Mat4::from_scale(Vec3::new(1.0, 1e-8, 1e-8));
    assert_eq!(invertible(rod, false), Some(rod));
}

#[test]
fn scene_size_counts_only_remaining_triangles() {
    // The large triangle is a line and is removed; the small one, far from the origin, rounds to a
    // point.
    let error = fault(|s| {
        s.meshes[0].positions.extend([Vec3::ZERO, Vec3::splat(1e-12), Vec3::X * 1e-12]);
        s.meshes[0].positions[2] = Vec3::X * 2.0;
        s.meshes[0].normals = vec![Vec3::Z; 6];
        s.meshes[0].uvs = vec![Vec2::ZERO; 6];
        s.meshes[0].tangents = vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 6];
        s.meshes[0].indices = vec![0, 1, 2, 3, 4, 5];
        s.instances[0].world_from_local = Mat4::from_translation(Vec3::splat(9.0));
    });
    assert!(error.contains("size zero"), "{error}");
}

#[test]
fn normals_are_brought_to_unit_length() {
    let mut scene = triangle();
    scene.meshes[0].normals[0] = Vec3::Z * 3.0;
    scene.validate().unwrap();
    assert_eq!(scene.meshes[0].normals[0], Vec3::Z);
}
