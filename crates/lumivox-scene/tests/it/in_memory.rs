//! Scenes whose files are not on the disk.

use std::collections::HashMap;

use lumivox_scene::{FileSource, LoadOptions, Scene, SceneError, Shading};
use serde_json::json;

use crate::common::{File, png};

type Files = HashMap<String, Vec<u8>>;

fn files(list: &[(&str, &[u8])]) -> Files {
    list.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())).collect()
}

fn load(name: &str, bytes: &[u8], files: Option<&Files>) -> Result<Scene, SceneError> {
    let files = files.map(|files| files as &dyn FileSource);
    Scene::from_memory(name, bytes, &mut LoadOptions { files, ..LoadOptions::default() })
}

/// A triangle whose buffer and image are files.
fn textured() -> File {
    let mut file = File::triangle();
    file.push("images", json!({ "uri": "maps/some%20wood.png" }));
    file.push("textures", json!({ "source": 0 }));
    let color = json!({ "baseColorTexture": { "index": 0 } });
    file.push("materials", json!({ "pbrMetallicRoughness": color }));
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file
}

#[test]
fn the_extension_selects_the_format() {
    let glb = File::triangle().glb();
    let scene = load("some/folder/thing.GLB", &glb, None).unwrap();
    assert_eq!((scene.name.as_str(), scene.triangle_count()), ("thing", 1));
    assert!(matches!(load("thing.blend", &glb, None), Err(SceneError::UnknownFormat { .. })));
    let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    assert_eq!(load("thing.ply", ply, None).unwrap().triangle_count(), 1);
    let stl = b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid\n";
    assert_eq!(load("thing.stl", stl, None).unwrap().triangle_count(), 1);
}

#[test]
fn other_files_come_from_the_callers_source() {
    let file = textured();
    let picture = png(2, 1, &[1, 2, 3, 4, 5, 6, 7, 8]);
    let all = files(&[("room/data.bin", &file.binary), ("room/maps/some wood.png", &picture)]);
    let json = file.naming("./data.bin");
    let scene = load("room/scene.gltf", &json, Some(&all)).unwrap();
    assert_eq!(scene.textures[0].rgba8, [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(scene.notes.warnings, [""; 0]);

    // The source may also have the scene's own file.
    let mut all = all;
    all.insert("room/scene.gltf".to_owned(), json);
    let mut options = LoadOptions { files: Some(&all), ..LoadOptions::default() };
    assert_eq!(Scene::load_with("room/scene.gltf", &mut options).unwrap(), scene);
    assert!(matches!(
        Scene::load_with("room/other.gltf", &mut options),
        Err(SceneError::Read { .. })
    ));
}

#[test]
fn loading_from_memory_reads_no_files() {
    let file = textured();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("data.bin"), &file.binary).unwrap();
    let name = folder.path().join("scene.gltf").to_string_lossy().into_owned();
    let fault = load(&name, &file.naming("data.bin"), None).unwrap_err();
    assert!(matches!(fault, SceneError::ReadExternal { .. }));
    assert!(fault.to_string().contains("from memory without its other files"), "{fault}");
    let fault = load(&name, &file.naming("data.bin"), Some(&Files::new())).unwrap_err();
    assert!(fault.to_string().contains("not among the scene's files"), "{fault}");
    // Loading the scene from the disk finds the file.
    std::fs::write(&name, file.naming("data.bin")).unwrap();
    assert!(Scene::load(&name).is_ok());
}

#[test]
fn materials_and_their_images_are_found_in_another_case() {
    let obj = b"mtllib SCENE.MTL\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wood\nf 1 2 3\n";
    let mtl = b"newmtl wood\nKd 1 1 1\nmap_Kd textures\\WOOD.png\n";
    let picture = png(1, 1, &[9, 8, 7, 255]);
    let all = files(&[("Scene.mtl", mtl), ("Textures/wood.png", &picture)]);
    let scene = load("scene.obj", obj, Some(&all)).unwrap();
    assert_eq!(scene.notes.warnings, [""; 0]);
    let Shading::Phong(phong) = scene.materials[0].shading else { panic!("Phong") };
    assert_eq!(scene.textures[phong.diffuse_texture.unwrap().texture].rgba8, [9, 8, 7, 255]);
    // Without the library there is a warning, and the disk is not searched.
    let scene = load("scene.obj", obj, None).unwrap();
    assert!(scene.notes.warnings.iter().any(|w| w.contains("SCENE.MTL")));
}

#[test]
fn scenes_may_not_leave_their_folder_in_memory_either() {
    let file = File::triangle();
    let all = files(&[("data.bin", &file.binary)]);
    let fault = load("room/scene.gltf", &file.naming("../data.bin"), Some(&all)).unwrap_err();
    assert!(matches!(fault, SceneError::RefusedUri { .. }));
    let mut options =
        LoadOptions { files: Some(&all), allow_outside: true, ..LoadOptions::default() };
    let json = file.naming("../data.bin");
    assert!(Scene::from_memory("room/scene.gltf", &json, &mut options).is_ok());
}

#[test]
fn loading_from_memory_reports_progress() {
    let mut told = Vec::new();
    let mut listen = |progress: lumivox_scene::LoadProgress| told.push(progress);
    let mut options = LoadOptions { progress: Some(&mut listen), ..LoadOptions::default() };
    let stl = b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
        endloop\nendfacet\nendsolid\n";
    Scene::from_memory("thing.stl", stl, &mut options).unwrap();
    let last = told.last().unwrap();
    assert_eq!((last.done, last.total), (stl.len() as u64, stl.len() as u64));
}
