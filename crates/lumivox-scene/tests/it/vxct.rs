//! The shipped scenes in VXCT's format, and the features of scenes that the format needs: instances
//! that are hidden or not voxelized, and a box for the voxels.

use std::path::{Path, PathBuf};

use glam::{Mat4, Vec3};
use lumivox_scene::{
    AnimationChoice, Bounds, Framing, Instance, LoadOptions, Material, Scene, SceneError, builtin,
};
use serde_json::json;

use crate::common::File;

fn folder() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "..", "..", "scenes"].iter().collect()
}

/// All scenes that are shipped, by name.
fn shipped() -> Vec<PathBuf> {
    let mut files: Vec<_> =
        std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn load(name: &str) -> Scene {
    Scene::load(folder().join(name)).unwrap()
}

#[test]
fn shipped_scenes_load_without_warnings_and_round_trip() {
    let names: Vec<_> = shipped().iter().map(|file| file.file_name().unwrap().to_owned()).collect();
    assert_eq!(names, ["cornell.scene", "emit.scene", "gallery.scene", "many.scene"]);
    for file in shipped() {
        let scene = Scene::load(&file).unwrap();
        assert_eq!(scene.notes.warnings, [""; 0], "{}", file.display());
        assert_eq!(scene.notes.scenes.concat(), scene.name, "the file is called as its scene");
        assert!(scene.triangle_count() > 30 && scene.shines());
        // The whole scene is in the box that VXCT voxelizes.
        let (all, cube) = (scene.bounds(), scene.grid_bounds.unwrap());
        assert!(cube.contains(all.min) && cube.contains(all.max), "{all:?}");
        let glb = scene.to_glb().unwrap();
        let again = Scene::from_memory("again.glb", &glb, &mut LoadOptions::default()).unwrap();
        assert_eq!(again.notes.warnings, [""; 0]);
        assert_eq!(again.grid_bounds, scene.grid_bounds);
        assert_eq!(again.lights, scene.lights);
        let marks = |scene: &Scene| -> Vec<_> {
            let marks = |i: &Instance| (i.name.clone(), i.is_hidden, i.is_voxelized, i.is_static);
            scene.instances.iter().map(marks).collect()
        };
        assert_eq!(marks(&again), marks(&scene));
        assert_eq!(again.to_glb().unwrap(), glb);
    }
}

#[test]
fn shipped_scenes_have_their_expected_content() {
    let cornell = load("cornell.scene");
    let hidden: Vec<_> = cornell.instances.iter().filter(|i| i.is_hidden).collect();
    assert_eq!(hidden.len(), 1);
    assert_eq!(hidden[0].name, "FrontWall");
    assert_eq!(cornell.lights.len(), 1);
    let emit = load("emit.scene");
    assert!(emit.lights.is_empty());
    assert_eq!(emit.materials.iter().filter(|m| m.emissive != Vec3::ZERO).count(), 2);
    let gallery = load("gallery.scene");
    assert_eq!(gallery.lights.len(), 2);
    assert_eq!(gallery.instances.iter().filter(|i| !i.is_voxelized).count(), 1);
    assert!(load("many.scene").instances.len() > 60);
}

#[test]
fn the_front_wall_closes_the_box() {
    let mut scene = load("cornell.scene");
    assert!(!Framing::of(&scene).is_enclosed());
    let before = scene.triangle_count();
    scene.instances.iter_mut().for_each(|instance| instance.is_hidden = false);
    assert_eq!(scene.triangle_count(), before + 2);
    assert!(Framing::of(&scene).is_enclosed());
}

#[test]
fn scenes_on_the_disk_find_their_models() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(&path, text).unwrap();
        path
    };
    write("models/tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let text = "scene { model { path = models/tri.obj } model { path = TRI.obj } }";
    assert_eq!(Scene::load(write("scenes/a.txt", text)).unwrap().instances.len(), 2);
    let elsewhere = write("rooms/a.scene", text);
    let refused = Scene::load(&elsewhere).unwrap();
    assert_eq!(refused.instances.len(), 0);
    let expected = "\"models/tri.obj\" does not exist; put it beside the scene";
    assert!(refused.notes.warnings[0].ends_with(expected), "{:?}", refused.notes.warnings);
    let mut options = LoadOptions { allow_outside: true, ..LoadOptions::default() };
    assert_eq!(Scene::load_with(&elsewhere, &mut options).unwrap().instances.len(), 2);
    let missing = Scene::load(folder.path().join("no.vxct")).unwrap_err();
    assert!(matches!(missing, SceneError::Read { .. }));
    let errors = Scene::load(write("scenes/b.scene", "scene {\n light { x")).unwrap_err();
    let expected = "b.scene:2:11: found the end of the file, expected `}` for the `{` at 2:8";
    assert!(errors.to_string().ends_with(expected), "{errors}");
}

/// Two boxes of a builtin scene; the far one can be hidden.
fn two() -> Scene {
    let mut scene = builtin::scene("furnace").unwrap();
    let mut far = scene.instances[0].clone();
    "far".clone_into(&mut far.name);
    far.world_from_local = Mat4::from_translation(Vec3::X * 10.0);
    scene.instances.push(far);
    scene.validate().unwrap();
    scene
}

#[test]
fn hidden_instances_do_not_count() {
    let all = two();
    let near = builtin::scene("furnace").unwrap();
    let mut scene = all.clone();
    scene.instances[1].is_hidden = true;
    scene.validate().unwrap();
    assert_eq!(scene.bounds(), near.bounds());
    assert_ne!(scene.bounds(), all.bounds());
    assert_eq!(scene.triangle_count(), near.triangle_count());
    assert_eq!(scene.shown().count(), 1);
    assert_eq!(Framing::of(&scene).outside(1.5), Framing::of(&near).outside(1.5));
    // A hidden light does not shine.
    let mut lamp = all;
    lamp.lights.clear();
    lamp.environment.radiance = Vec3::ZERO;
    lamp.materials.iter_mut().for_each(|material| material.emissive = Vec3::ZERO);
    lamp.materials.push(Material { emissive: Vec3::ONE, ..Material::default() });
    lamp.instances[1].material = lamp.materials.len() - 1;
    assert!(lamp.shines());
    lamp.instances[1].is_hidden = true;
    assert!(!lamp.shines());
}

#[test]
fn a_fully_hidden_scene_needs_grid_bounds() {
    let mut scene = two();
    scene.instances.iter_mut().for_each(|instance| instance.is_hidden = true);
    let message = scene.validate().unwrap_err().to_string();
    assert!(message.contains("all instances are hidden"), "{message}");
    scene.grid_bounds = Some(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
    scene.validate().unwrap();
    assert_eq!(scene.instances.len(), 2);
    assert_eq!(scene.voxel_bounds().size(), Vec3::splat(2.0));
    for bounds in [
        Bounds { min: Vec3::ONE, max: Vec3::ONE },
        Bounds::EMPTY,
        Bounds { min: Vec3::ONE, max: Vec3::NEG_ONE },
        Bounds { min: Vec3::splat(-3e38), max: Vec3::splat(3e38) },
        Bounds { min: Vec3::ZERO, max: Vec3::NAN },
    ] {
        scene.grid_bounds = Some(bounds);
        let message = scene.validate().unwrap_err().to_string();
        assert!(message.contains("the box of the voxels"), "{message}");
    }
}

#[test]
fn grid_bounds_turn_with_the_scene() {
    let mut scene = two();
    scene.grid_bounds = Some(Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) });
    scene.transform(Mat4::from_rotation_z(std::f32::consts::FRAC_PI_2));
    let bounds = scene.grid_bounds.unwrap();
    assert!(bounds.min.abs_diff_eq(Vec3::new(-2.0, 0.0, 0.0), 1e-6), "{bounds:?}");
    assert!(bounds.max.abs_diff_eq(Vec3::new(0.0, 1.0, 3.0), 1e-6), "{bounds:?}");
}

/// Two nodes with the triangle, the second below a third.
fn hierarchy() -> File {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        { "name": "near", "mesh": 0 },
        { "name": "parent", "children": [2], "extensions": { "KHR_node_visibility": { "visible": false } } },
        { "name": "child", "mesh": 0, "translation": [3, 0, 0],
          "extensions": { "KHR_node_visibility": { "visible": true }, "KHR_lights_punctual": { "light": 0 } } },
    ]);
    file.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_node_visibility"]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    file
}

#[test]
fn invisible_nodes_hide_their_children() {
    let scene = hierarchy().load().unwrap();
    let hidden: Vec<_> = scene.instances.iter().map(|i| (i.name.as_str(), i.is_hidden)).collect();
    assert_eq!(hidden, [("near", false), ("child", true)]);
    assert_eq!(scene.triangle_count(), 1);
    assert!(scene.lights.is_empty());
    let warning = scene.notes.warnings.last().unwrap();
    assert_eq!(warning, "child: its light was skipped, because it is hidden");
    let mut required = hierarchy();
    required.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
    assert_eq!(required.load().unwrap().instances.len(), 2);
    // A node with any other value of `visible` is visible.
    for extension in [json!({}), json!({ "visible": 0 }), json!({ "visible": true })] {
        let mut file = hierarchy();
        file.json["nodes"][1]["extensions"]["KHR_node_visibility"] = extension;
        assert_eq!(file.load().unwrap().triangle_count(), 2);
    }
    let mut none = hierarchy();
    none.json["scenes"][0]["nodes"] = json!([1]);
    assert!(none.load().unwrap_err().to_string().contains("all instances are hidden"));
}

#[test]
fn instance_marks_survive_posing() {
    let mut file = File::triangle();
    file.json["nodes"] = json!([
        { "name": "first", "mesh": 0 },
        { "name": "grows", "mesh": 0 },
        { "name": "last", "mesh": 0, "extras": { "lumivox": { "voxelized": false } } },
    ]);
    file.json["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    let scales = file.vectors(&[[0.0; 3], [1.0; 3]]);
    file.animation("grow", &[0.0, 1.0], &[(1, "scale", "LINEAR", scales)]);
    let mut scene = file.load().unwrap();
    let marks = |scene: &Scene| -> Vec<_> {
        let marks = |i: &Instance| (i.name.clone(), i.is_hidden, i.is_voxelized);
        scene.instances.iter().map(marks).collect()
    };
    scene.instances[0].is_hidden = true;
    for time_s in [0.0, 1.0, 0.0, 0.5] {
        scene.pose(AnimationChoice::All, time_s).unwrap();
        let mut expected =
            vec![("first".to_owned(), true, true), ("last".to_owned(), false, false)];
        if time_s > 0.0 {
            expected.insert(1, ("grows".to_owned(), false, true));
        }
        assert_eq!(marks(&scene), expected, "at {time_s} s");
    }
    // Without visible instances, only a scene with a box is valid.
    scene.instances.iter_mut().for_each(|instance| instance.is_hidden = true);
    assert!(matches!(scene.pose(AnimationChoice::All, 0.5), Err(SceneError::NothingAtTime { .. })));
    scene.grid_bounds = Some(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
    scene.pose(AnimationChoice::All, 0.5).unwrap();
}

#[test]
fn shipped_models_are_one_mesh_within_the_cube() {
    let models = folder().join("../models");
    for entry in std::fs::read_dir(Path::new(&models)).unwrap() {
        let path = entry.unwrap().path();
        let scene = Scene::load(&path).unwrap();
        assert_eq!((scene.instances.len(), scene.meshes.len()), (1, 1), "{}", path.display());
        let bounds = scene.bounds();
        let cube = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
        assert!(cube.contains(bounds.min) && cube.contains(bounds.max), "{bounds:?}");
        // Fronts face outwards: normals agree with the winding.
        let mesh = &scene.meshes[0];
        for [a, b, c] in mesh.triangles() {
            let [p, q, r] = [a, b, c].map(|i| mesh.positions[i]);
            assert!((q - p).cross(r - p).dot(mesh.normals[a]) > 0.0, "{}", path.display());
        }
    }
}
