//! The choice of a file's scene, and copies of a mesh on one node.

use glam::Vec3;
use lumivox_scene::{LoadOptions, Scene, SceneError};
use serde_json::json;

use crate::common::{File, world_triangles, write};

fn load_scene(file: &File, scene: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "scene.glb", &file.glb());
    let mut options = LoadOptions { scene: Some(scene.to_owned()), ..LoadOptions::default() };
    Scene::load_with(path, &mut options)
}

/// The triangle at x = 0 in the first scene, at 10 in the second, at 20 in the third.
fn three_scenes() -> File {
    let mut file = File::triangle();
    for x in [10, 20] {
        file.node(json!({ "mesh": 0, "translation": [x, 0, 0] }), false);
    }
    file.json["scenes"] = json!([
        { "nodes": [0], "name": "near" },
        { "nodes": [1] },
        { "nodes": [2], "name": "1" },
    ]);
    file
}

#[test]
fn scenes_are_chosen_by_name_or_number() {
    let file = three_scenes();
    // A name takes precedence over a number.
    for (wanted, x) in [("near", 0.0), ("0", 0.0), ("1", 20.0), ("2", 20.0)] {
        let scene = load_scene(&file, wanted).unwrap();
        assert_eq!(scene.bounds().min.x, x, "{wanted}");
        assert_eq!(scene.instances.len(), 1);
        assert!(scene.rig.is_none() && scene.animations().is_empty());
    }
}

#[test]
fn an_unknown_scene_lists_the_known() {
    for wanted in ["far", "3", "-1", ""] {
        let error = load_scene(&three_scenes(), wanted).unwrap_err();
        assert!(matches!(&error, SceneError::UnknownScene { .. }));
        let text = error.to_string();
        assert!(text.contains("scene.glb") && text.contains("0 \"near\", 1, 2 \"1\""), "{text}");
    }
    let mut none = File::triangle();
    none.json["scenes"] = json!([]);
    none.json.as_object_mut().unwrap().remove("scene");
    assert!(load_scene(&none, "0").unwrap_err().to_string().contains("number: none"));
}

/// The triangle with copies that have these attributes.
fn copied(attributes: serde_json::Value) -> File {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    file.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    file.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    file
}

#[test]
fn gpu_instances_are_placed_relative_to_their_node() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let mut file = copied(json!({}));
    let translations = file.vectors(&[[0.0, 0.0, 0.0], [0.0, 0.0, 5.0], [7.0, 0.0, 0.0]]);
    // The second is a rotation by 90 degrees about z; the last does not have unit length.
    let rotations =
        file.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half, half], [0.0, 0.0, 0.0, 2.0]]);
    let scales = file.vectors(&[[1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [-1.0, 1.0, 1.0]]);
    file.json["nodes"][0]["translation"] = json!([100, 0, 0]);
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({ "TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales });
    let scene = file.load().unwrap();
    assert!(scene.notes.warnings.iter().all(|w| !w.contains("instancing")));
    assert_eq!((scene.instances.len(), scene.meshes.len()), (3, 2), "one mesh per winding");
    let corners = |i: usize| {
        let instance = &scene.instances[i];
        [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| instance.world_from_local.transform_point3(p))
    };
    assert_eq!(corners(0), [Vec3::X * 100.0, Vec3::X * 101.0, Vec3::new(100.0, 1.0, 0.0)]);
    let turned =
        [Vec3::new(100.0, 0.0, 5.0), Vec3::new(100.0, 2.0, 5.0), Vec3::new(98.0, 0.0, 5.0)];
    for (got, expected) in corners(1).into_iter().zip(turned) {
        assert!((got - expected).length() < 1e-5, "{got}");
    }
    assert_eq!(corners(2)[1], Vec3::X * 106.0);
    // All fronts face +z, in the mirror, too.
    for ([a, b, c], normal) in world_triangles(&scene) {
        assert!((b - a).cross(c - a).normalize().dot(normal) > 0.999);
        assert!(normal.z > 0.999);
    }
}

#[test]
fn degenerate_gpu_instances_and_unknown_attributes_give_warnings() {
    let mut file = copied(json!({}));
    let scales = file.vectors(&[[1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, f32::NAN, 1.0]]);
    let colors = file.vectors(&[[1.0, 1.0, 1.0]; 3]);
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({ "SCALE": scales, "_COLOR_0": colors });
    let scene = file.load().unwrap();
    assert_eq!(scene.instances.len(), 1);
    let warnings = scene.notes.warnings.join("\n");
    assert!(warnings.contains("2 of 3 copies") && warnings.contains("_COLOR_0"), "{warnings}");
    // Without attributes, the node's mesh is shown once.
    assert_eq!(copied(json!({})).load().unwrap().instances.len(), 1);
}

#[test]
fn invalid_gpu_instancing_is_refused() {
    let fault = |file: File| {
        let text = file.load().unwrap_err().to_string();
        assert!(text.contains("scene.glb: stand"), "{text}");
        text
    };
    assert!(fault(copied(json!(7))).contains("no attributes"));
    assert!(fault(copied(json!({ "SCALE": 99 }))).contains("no accessor"));
    assert!(fault(copied(json!({ "SCALE": -1 }))).contains("no accessor"));
    let mut uneven = copied(json!({}));
    let (two, three) = (uneven.vectors(&[[0.0; 3]; 2]), uneven.vectors(&[[1.0; 3]; 3]));
    uneven.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({ "TRANSLATION": two, "SCALE": three });
    assert!(fault(uneven).contains("differ in length"));
    // A file may claim as many zeros as it has bytes, but these are too many copies.
    let mut many = copied(json!({}));
    many.view(&vec![0; 1_000_001]);
    let zeros = json!({ "componentType": 5126, "count": 1_000_001, "type": "VEC3" });
    let scales = many.push("accessors", zeros);
    many.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
        json!({ "SCALE": scales });
    assert!(fault(many).contains("too many instances"));
}
