//! Meshes that bones and morph targets deform.

use glam::{Mat4, Quat, Vec3};
use lumivox_scene::{AnimationChoice, Scene};
use serde_json::json;

use crate::common::tube::{CORNERS, HEIGHT_M, RADIUS_M, tube};
use crate::common::{File, world_triangles, write};

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-5
}

/// Fails unless every triangle's front faces roughly along its first normal: bending and swelling
/// shear the surface, but not its normals.
fn assert_fronts(scene: &Scene, at: &str) {
    for ([a, b, c], normal) in world_triangles(scene) {
        let front = (b - a).cross(c - a).normalize();
        assert!(front.dot(normal) > 0.2, "{at}: {a} {b} {c} faces {front}, not {normal}");
    }
}

/// Fails unless normals and tangents have unit length and are orthogonal.
fn assert_frames(scene: &Scene, at: &str) {
    for mesh in &scene.meshes {
        for (n, t) in mesh.normals.iter().zip(&mesh.tangents) {
            assert!((n.length() - 1.0).abs() < 1e-5, "{at}: {n}");
            assert!((t.truncate().length() - 1.0).abs() < 1e-5, "{at}: {t}");
            assert!(t.truncate().dot(*n).abs() < 1e-5 && t.w.abs() == 1.0, "{at}: {n} {t}");
        }
    }
}

#[test]
fn skinned_vertices_follow_their_bones() {
    let mut scene = tube().file.load().unwrap();
    assert!(scene.notes.warnings.len() == 1, "{:?}", scene.notes.warnings);
    let last = scene.meshes[0].positions.len() - CORNERS - 1;
    // The corner at the front, +z, of the last ring only depends on the third bone.
    assert!(close(scene.meshes[0].positions[last], Vec3::new(0.0, HEIGHT_M, RADIUS_M)));
    for time_s in [0.0, 0.7, 1.0, 2.0_f32] {
        scene.pose(AnimationChoice::One(0), time_s).unwrap();
        let at = format!("at {time_s} s");
        // The expected position: two joints of one metre each, rotated by equal angles.
        let turn = Quat::from_rotation_z(time_s / 2.0 * std::f32::consts::FRAC_PI_4);
        let tip = Vec3::Y + turn * (Vec3::Y + turn * Vec3::new(0.0, 1.0, RADIUS_M));
        assert!(close(scene.meshes[0].positions[last], tip), "{at}");
        let normal = scene.meshes[0].normals[last];
        assert!(close(normal, turn * turn * Vec3::Z), "{at}: {normal}");
        assert_fronts(&scene, &at);
        assert_frames(&scene, &at);
        // Half-way up, blended bones and the swelling act together.
        let widest = scene.meshes[0].positions.iter().map(|p| p.z).fold(0.0, f32::max);
        assert!((widest - RADIUS_M * (1.0 + time_s / 2.0)).abs() < 1e-5, "{at}: {widest}");
    }
}

#[test]
fn the_nodes_own_transform_does_not_place_a_skinned_mesh() {
    let plain = tube().file.load().unwrap();
    let mut moved = tube();
    moved.file.json["nodes"][moved.body]["translation"] = json!([7, 8, 9]);
    moved.file.json["nodes"][moved.body]["scale"] = json!([0, 0, 0]);
    let moved = moved.file.load().unwrap();
    assert_eq!(moved.meshes, plain.meshes);
    assert_eq!(moved.instances, plain.instances);
    // A parent of the joints moves.
    let mut carried = tube();
    let joint = carried.joints[0];
    let carrier = json!({ "children": [joint], "translation": [7, 8, 9] });
    let carrier = carried.file.node(carrier, false);
    carried.file.json["scenes"][0]["nodes"] = json!([carrier, carried.body]);
    let carried = carried.file.load().unwrap();
    assert!(close(carried.bounds().min, plain.bounds().min + Vec3::new(7.0, 8.0, 9.0)));
    // Joints outside the scene have transforms, too.
    let mut apart = tube();
    let carrier = json!({ "children": [apart.joints[0]], "translation": [7, 8, 9] });
    apart.file.node(carrier, false);
    apart.file.json["scenes"][0]["nodes"] = json!([apart.body]);
    assert_eq!(apart.file.load().unwrap().bounds(), carried.bounds());
}

#[test]
fn poses_of_skinned_meshes_ignore_earlier_poses() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "tube.glb", &tube().file.glb());
    let rest = Scene::load(&path).unwrap();
    let mut scene = rest.clone();
    for time_s in [2.0, 0.5, 1.99, 0.5, 0.0] {
        scene.pose(AnimationChoice::All, time_s).unwrap();
        let mut fresh = rest.clone();
        fresh.pose(AnimationChoice::All, time_s).unwrap();
        assert_eq!(scene, fresh, "at {time_s} s");
        let mut valid = scene.clone();
        valid.validate().unwrap();
        assert_eq!(valid, scene, "at {time_s} s");
    }
    // The animation starts with the rest pose.
    assert_eq!(scene, rest);
}

#[test]
fn each_use_of_a_mesh_deforms_on_its_own() {
    let mut made = tube();
    // Adds a use of the mesh on the same bones without swelling, and one without a skin that is
    // always swollen.
    made.file.node(json!({ "mesh": 0, "skin": 0, "name": "thin" }), true);
    made.file.node(json!({ "mesh": 0, "weights": [1], "translation": [9, 0, 0] }), true);
    // A mesh that nothing deforms is shared.
    for x in [20, 30] {
        made.file.node(json!({ "mesh": 0, "translation": [x, 0, 0] }), true);
    }
    let mut scene = made.file.load().unwrap();
    scene.pose(AnimationChoice::All, 2.0).unwrap();
    assert_eq!((scene.instances.len(), scene.meshes.len()), (5, 4));
    let marks: Vec<bool> = scene.instances.iter().map(|instance| instance.is_static).collect();
    assert_eq!(marks, [false, false, true, true, true], "bones and swelling move the first two");
    let widest = |i: usize| {
        let mesh = &scene.meshes[scene.instances[i].mesh];
        mesh.positions.iter().map(|p| p.z).fold(0.0, f32::max)
    };
    let expected = [2.0, 1.0, 2.0, 1.0, 1.0].map(|r| r * RADIUS_M);
    for (i, expected) in expected.into_iter().enumerate() {
        assert!((widest(i) - expected).abs() < 1e-5, "instance {i}: {}", widest(i));
    }
    assert!(format!("{:?}", scene.rig).contains("deformed_meshes: 2"), "{:?}", scene.rig);
}

#[test]
fn mirrored_bones_keep_front_faces() {
    for flat in [false, true] {
        let mut made = tube();
        let root = made.joints[0];
        made.file.json["nodes"][root]["scale"] = json!([-1, 1, 1]);
        if flat {
            let primitive = &mut made.file.json["meshes"][0]["primitives"][0];
            primitive["attributes"].as_object_mut().unwrap().remove("NORMAL");
        }
        let mut scene = made.file.load().unwrap();
        for time_s in [0.0, 1.3, 2.0] {
            scene.pose(AnimationChoice::All, time_s).unwrap();
            let at = format!("flat {flat}, at {time_s} s");
            assert_fronts(&scene, &at);
            assert_frames(&scene, &at);
            // The tube is mirrored and bends to the other side; its outside still faces outwards.
            let mesh = &scene.meshes[0];
            let outward = mesh.triangles().take(2 * CORNERS).all(|[i, ..]| {
                mesh.normals[i].dot(mesh.positions[i] * Vec3::new(1.0, 0.0, 1.0)) > 0.0
            });
            assert!(outward, "{at}");
        }
        assert!(scene.bounds().max.x > 1.0, "flat {flat}: {:?}", scene.bounds());
    }
}

#[test]
fn flat_meshes_get_the_normals_of_their_deformed_triangles() {
    let mut made = tube();
    let primitive = &mut made.file.json["meshes"][0]["primitives"][0];
    primitive["attributes"].as_object_mut().unwrap().remove("NORMAL");
    let mut scene = made.file.load().unwrap();
    for time_s in [0.0, 2.0] {
        scene.pose(AnimationChoice::All, time_s).unwrap();
        assert_frames(&scene, "flat");
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.positions.len(), mesh.indices.len());
        for t in mesh.triangles() {
            let [a, b, c] = t.map(|i| mesh.positions[i]);
            let front = (b - a).cross(c - a).normalize();
            for i in t {
                assert!((front - mesh.normals[i]).length() < 1e-4, "{front} {}", mesh.normals[i]);
            }
        }
    }
}

#[test]
fn skins_without_animations_are_baked() {
    let mut made = tube();
    made.file.json["animations"] = json!([]);
    let turn = Quat::from_rotation_z(0.5).to_array();
    let bone = made.joints[1];
    made.file.json["nodes"][bone]["rotation"] = json!(turn);
    made.file.json["meshes"][0]["weights"] = json!([0.5]);
    let scene = made.file.load().unwrap();
    assert!(scene.rig.is_none());
    let widest = scene.meshes[0].positions.iter().map(|p| p.z).fold(0.0, f32::max);
    assert!((widest - 1.5 * RADIUS_M).abs() < 1e-5);
    let tip = Vec3::Y + Quat::from_rotation_z(0.5) * Vec3::Y * 2.0;
    let last = scene.meshes[0].positions.len() - CORNERS - 1;
    assert!(close(scene.meshes[0].positions[last], tip + Vec3::Z * RADIUS_M));
}

/// One triangle on one joint with this matrix, and an identity bind matrix.
fn on_a_joint(joint: Mat4, weights: [f32; 4]) -> File {
    let mut file = File::triangle();
    let view = file.view(&[0; 12]);
    let joints = file.accessor(view, 5121, 3, "VEC4");
    let weights = file.vectors(&[weights; 3]);
    // Oblique normals, for which the inverse transpose matters.
    let normals = file.vectors(&[[0.6, 0.0, 0.8]; 3]);
    let tangents = file.vectors(&[[0.8, 0.0, -0.6, 1.0]; 3]);
    let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    attributes["NORMAL"] = json!(normals);
    attributes["TANGENT"] = json!(tangents);
    let bone = file.node(json!({ "matrix": joint.to_cols_array() }), true);
    file.push("skins", json!({ "joints": [bone] }));
    file.json["nodes"][0]["skin"] = json!(0);
    file
}

#[test]
fn normals_follow_the_inverse_transpose() {
    let scales = [Vec3::new(1.0, 1.0, 4.0), Vec3::new(1e-6, 1e-6, 3e-6), Vec3::new(-2.0, 1.0, 1.0)];
    for scale in scales {
        let joint = Mat4::from_scale_rotation_translation(
            scale,
            Quat::from_rotation_y(0.7),
            Vec3::new(1.0, 2.0, 3.0),
        );
        let scene = on_a_joint(joint, [1.0, 0.0, 0.0, 0.0]).load().unwrap();
        let mesh = &scene.meshes[0];
        let expected = joint.inverse().transpose().transform_vector3(Vec3::new(0.6, 0.0, 0.8));
        assert!(close(mesh.normals[0], expected.normalize()), "{scale}: {}", mesh.normals[0]);
        assert!(close(mesh.positions[1], joint.transform_point3(Vec3::X)));
        // The tangent follows the surface, and a mirror changes the bitangent's sign.
        let along = joint.transform_vector3(Vec3::new(0.8, 0.0, -0.6)).normalize();
        assert!(close(mesh.tangents[0].truncate(), along), "{scale}: {}", mesh.tangents[0]);
        assert_eq!(mesh.tangents[0].w, scale.x.signum());
        assert_fronts(&scene, &scale.to_string());
    }
}

#[test]
fn bad_joint_weights_are_repaired_with_a_warning() {
    for (weights, told) in [
        ([1.0, 0.0, 0.0, 0.0], false),
        ([0.501, 0.501, 0.0, 0.0], false),
        ([3.0, 1.0, 0.0, 0.0], true),
        ([0.0; 4], true),
        ([-0.5, 0.5, 0.0, 0.0], true),
    ] {
        let file = on_a_joint(Mat4::from_translation(Vec3::Z * 5.0), weights);
        let scene = file.load().unwrap();
        // The only joint moves all vertices, whatever their weights.
        assert!(close(scene.meshes[0].positions[1], Vec3::new(1.0, 0.0, 5.0)), "{weights:?}");
        let warned = scene.notes.warnings.iter().any(|w| w.contains("3 vertices have joint"));
        assert_eq!(warned, told, "{weights:?}");
    }
}

#[test]
fn eight_joints_per_vertex_are_supported() {
    let mut file = on_a_joint(Mat4::IDENTITY, [0.5, 0.0, 0.0, 0.0]);
    let bone = file.node(json!({ "translation": [0, 0, 8] }), true);
    file.json["skins"][0]["joints"].as_array_mut().unwrap().push(json!(bone));
    // The second set: 16-bit joints, and weights as normalised bytes.
    let bytes: Vec<u8> =
        [[0, 0, 0, 1_u16]; 3].as_flattened().iter().flat_map(|j| j.to_le_bytes()).collect();
    let view = file.view(&bytes);
    let joints = file.accessor(view, 5123, 3, "VEC4");
    let view = file.view(&[[0, 0, 0, 255_u8]; 3].concat());
    let weights = file.accessor(view, 5121, 3, "VEC4");
    file.json["accessors"][weights]["normalized"] = json!(true);
    let attributes = &mut file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = json!(joints);
    attributes["WEIGHTS_1"] = json!(weights);
    let scene = file.load().unwrap();
    // The weights 0.5 and 1 become 1/3 and 2/3.
    assert!(close(scene.meshes[0].positions[0], Vec3::Z * 16.0 / 3.0));
}

#[test]
fn morph_targets_displace_positions_normals_and_tangents() {
    let mut file = File::triangle();
    let normals = file.vectors(&[[0.0, 0.0, 1.0]; 3]);
    let tangents = file.vectors(&[[1.0, 0.0, 0.0, -1.0]; 3]);
    // A sparse target: only the last vertex moves.
    let index = file.view(&[2]);
    let value: Vec<u8> = [0.0_f32, 0.0, 4.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let value = file.view(&value);
    let lifted = file.push(
        "accessors",
        json!({ "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
            "count": 1,
            "indices": { "bufferView": index, "componentType": 5121 },
            "values": { "bufferView": value },
        } }),
    );
    let shifted = file.vectors(&[[2.0, 0.0, 0.0]; 3]);
    let leaning = file.vectors(&[[0.0, 1.0, 0.0]; 3]);
    let turning = file.vectors(&[[0.0, 1.0, -1.0]; 3]);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = json!(normals);
    primitive["attributes"]["TANGENT"] = json!(tangents);
    primitive["targets"] = json!([
        { "POSITION": lifted },
        { "POSITION": shifted, "NORMAL": leaning, "TANGENT": turning },
    ]);
    // The node's weights override the mesh's.
    file.json["meshes"][0]["weights"] = json!([9, 9]);
    file.json["nodes"][0]["weights"] = json!([0.5, 1]);
    let scene = file.load().unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(
        mesh.positions,
        [Vec3::new(2.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 2.0),]
    );
    let normal = Vec3::new(0.0, 1.0, 1.0).normalize();
    assert!(mesh.normals.iter().all(|n| close(*n, normal)));
    // (1, 1, -1) is already orthogonal to the normal.
    let tangent = Vec3::new(1.0, 1.0, -1.0).normalize();
    assert!(close(mesh.tangents[0].truncate(), tangent) && mesh.tangents[0].w == -1.0);

    // Weights of the mesh, and animated weights with two numbers per key.
    let weights = file.floats(&[0.0, 0.0, 1.0, 0.0]);
    file.animation("lift", &[0.0, 1.0], &[(0, "weights", "LINEAR", weights)]);
    file.json["nodes"][0].as_object_mut().unwrap().remove("weights");
    let mut scene = file.load().unwrap();
    assert_eq!(scene.meshes[0].positions[2], Vec3::new(18.0, 1.0, 36.0));
    scene.pose(AnimationChoice::All, 0.25).unwrap();
    assert_eq!(scene.meshes[0].positions[2], Vec3::new(0.0, 1.0, 1.0));
    scene.pose(AnimationChoice::All, 0.0).unwrap();
    assert_eq!(scene.meshes[0].normals, [Vec3::Z; 3]);
}

#[test]
fn triangles_degenerate_at_rest_can_grow_later() {
    let mut file = File::triangle();
    // Adds a second triangle, a point at rest, which the target enlarges. Without normals, it is
    // flat.
    let positions = file.vectors(&[
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [5.0, 0.0, 0.0],
        [5.0, 0.0, 0.0],
        [5.0, 0.0, 0.0],
    ]);
    let spread =
        file.vectors(&[[0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
    let weights = file.floats(&[0.0, 1.0, 0.0]);
    file.json["meshes"][0]["primitives"][0] = json!({
        "attributes": { "POSITION": positions }, "targets": [{ "POSITION": spread }],
    });
    file.animation("open", &[0.0, 1.0, 2.0], &[(0, "weights", "LINEAR", weights)]);
    let mut scene = file.load().unwrap();
    assert_eq!((scene.triangle_count(), scene.notes.degenerate_triangles), (1, 0));
    for (time_s, count) in [(1.0, 2), (2.0, 1), (0.5, 2)] {
        scene.pose(AnimationChoice::All, time_s).unwrap();
        assert_eq!(scene.triangle_count(), count, "at {time_s} s");
        assert_fronts(&scene, "opened");
    }
    assert_eq!(scene.meshes[0].normals[3], Vec3::Y);
}

/// If one corner moves, its triangle's plane changes, and so do the frames of the other corners.
#[test]
fn frames_of_flat_triangles_turn_with_a_single_corner() {
    for corner in 0..3 {
        let mut file = File::triangle();
        let mut lifted = [[0.0; 3]; 3];
        lifted[corner] = [0.0, 0.0, 2.0];
        let lifted = file.vectors(&lifted);
        file.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": lifted }]);
        file.json["meshes"][0]["weights"] = json!([1]);
        let scene = file.load().unwrap();
        let at = format!("corner {corner}");
        assert!(scene.meshes[0].normals.iter().all(|normal| normal.z < 0.9), "{at}");
        assert_fronts(&scene, &at);
        assert_frames(&scene, &at);
    }
}

#[test]
fn a_morphed_mesh_in_a_mirror_keeps_its_front() {
    for flat in [false, true] {
        let mut file = File::triangle();
        let normals = file.vectors(&[[0.0, 0.0, 1.0]; 3]);
        let grown = file.vectors(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let primitive = &mut file.json["meshes"][0]["primitives"][0];
        if !flat {
            primitive["attributes"]["NORMAL"] = json!(normals);
        }
        primitive["targets"] = json!([{ "POSITION": grown }]);
        let weights = file.floats(&[0.0, 1.0]);
        let scales = file.vectors(&[[1.0, 1.0, 1.0], [-3.0, 1.0, 1.0]]);
        file.animation(
            "flip",
            &[0.0, 1.0],
            &[(0, "weights", "LINEAR", weights), (0, "scale", "LINEAR", scales)],
        );
        let mut scene = file.load().unwrap();
        for time_s in [0.0, 0.125, 0.5, 1.0] {
            scene.pose(AnimationChoice::All, time_s).unwrap();
            let triangles = world_triangles(&scene);
            let size = (1.0 + time_s) * (1.0 - 4.0 * time_s);
            let x = triangles[0].0.iter().map(|p| p.x).find(|x| *x != 0.0);
            assert_eq!(x, Some(size), "at {time_s} s");
            assert!(triangles[0].1.z > 0.999, "at {time_s} s");
            assert_fronts(&scene, &format!("at {time_s} s"));
        }
    }
}
