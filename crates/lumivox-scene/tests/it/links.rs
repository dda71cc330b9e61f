//! Symbolic links in a scene's folder are followed within the folder, but not out of it.

use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

use lumivox_scene::{LoadOptions, Scene, SceneError};
use serde_json::json;
use tempfile::TempDir;

use crate::common::{File, png, write};

/// A folder of a scene, and one beside it that the scene may not read.
struct Place {
    folder: TempDir,
    scene: PathBuf,
    outside: PathBuf,
}

fn place() -> Place {
    let folder = tempfile::tempdir().unwrap();
    let (scene, outside) = (folder.path().join("scene"), folder.path().join("outside"));
    std::fs::create_dir(&scene).unwrap();
    std::fs::create_dir(&outside).unwrap();
    Place { folder, scene, outside }
}

fn with(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    write(folder, name, text.as_ref())
}

fn load_anywhere(scene: &Path) -> Scene {
    let mut options = LoadOptions { allow_outside: true, ..LoadOptions::default() };
    Scene::load_with(scene, &mut options).unwrap()
}

/// The error of a scene that names a file in the folder outside.
fn refused(scene: &Path) -> String {
    let error = Scene::load(scene).unwrap_err();
    assert!(matches!(&error, SceneError::RefusedUri { .. }), "{error}");
    let text = error.to_string();
    for needle in ["scene.gltf: buffer 0", "a link leads out of", "outside", "--allow-outside"] {
        assert!(text.contains(needle), "no {needle} in {text}");
    }
    text
}

#[test]
fn buffers_are_not_read_through_links_that_lead_out() {
    let Place { folder: _folder, scene, outside } = place();
    let file = File::triangle();
    with(&outside, "secret.bin", &file.binary);
    // A link to a file, to a folder, a chain of links, and a link through a folder inside.
    symlink(outside.join("secret.bin"), scene.join("link.bin")).unwrap();
    symlink("../outside", scene.join("folder")).unwrap();
    symlink("link.bin", scene.join("chain.bin")).unwrap();
    std::fs::create_dir(scene.join("inner")).unwrap();
    symlink("../../outside/secret.bin", scene.join("inner/deep.bin")).unwrap();
    for uri in ["link.bin", "folder/secret.bin", "chain.bin", "inner/deep.bin"] {
        let gltf = with(&scene, "scene.gltf", file.naming(uri));
        refused(&gltf);
        assert_eq!(load_anywhere(&gltf).triangle_count(), 1);
    }
    // A neighbouring folder whose name begins like the scene's is outside.
    let neighbour = scene.with_file_name("scene-b");
    std::fs::create_dir(&neighbour).unwrap();
    with(&neighbour, "outside.bin", &file.binary);
    symlink("../scene-b/outside.bin", scene.join("near.bin")).unwrap();
    refused(&with(&scene, "scene.gltf", file.naming("near.bin")));
}

#[test]
fn links_that_stay_inside_are_followed() {
    let Place { folder, scene, .. } = place();
    let file = File::triangle();
    std::fs::create_dir(scene.join("store")).unwrap();
    with(&scene.join("store"), "4f2a.bin", &file.binary);
    symlink("store/4f2a.bin", scene.join("link.bin")).unwrap();
    symlink("store", scene.join("folder")).unwrap();
    for uri in ["link.bin", "folder/4f2a.bin", "store/4f2a.bin"] {
        let gltf = with(&scene, "scene.gltf", file.naming(uri));
        assert_eq!(Scene::load(gltf).unwrap().triangle_count(), 1, "{uri}");
    }
    // A link may lead to the folder itself, and the scene's file may be a link.
    symlink(&scene, folder.path().join("elsewhere")).unwrap();
    let there = folder.path().join("elsewhere/scene.gltf");
    assert_eq!(Scene::load(there).unwrap().triangle_count(), 1);
    symlink("scene.gltf", scene.join("alias.gltf")).unwrap();
    assert_eq!(Scene::load(scene.join("alias.gltf")).unwrap().triangle_count(), 1);
    // A broken link counts as a missing file.
    symlink("gone", scene.join("dangling.bin")).unwrap();
    let gltf = with(&scene, "scene.gltf", file.naming("dangling.bin"));
    assert!(matches!(Scene::load(gltf), Err(SceneError::ReadExternal { .. })));
}

#[test]
fn images_behind_outward_links_get_a_stand_in() {
    let Place { folder: _folder, scene, outside } = place();
    with(&outside, "secret.png", png(1, 1, &[1, 2, 3, 255]));
    symlink(outside.join("secret.png"), scene.join("link.png")).unwrap();
    let mut file = File::triangle();
    file.push("images", json!({ "uri": "link.png" }));
    file.push("textures", json!({ "source": 0 }));
    file.push(
        "materials",
        json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
    );
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let gltf = with(&scene, "scene.glb", file.glb());
    let loaded = Scene::load(&gltf).unwrap();
    assert_eq!(loaded.textures[0].name, "missing image");
    let warnings = loaded.notes.warnings.join("\n");
    for needle in ["link.png", "a link leads out of", "--allow-outside", "a stand-in is shown"] {
        assert!(warnings.contains(needle), "no {needle} in {warnings}");
    }
    assert_eq!(load_anywhere(&gltf).textures[0].rgba8, [1, 2, 3, 255]);
}

#[test]
fn obj_files_cannot_follow_outward_links() {
    let Place { folder: _folder, scene, outside } = place();
    with(&outside, "secret.mtl", "newmtl paint\nKd 1 0 0\n");
    with(&outside, "secret.png", png(1, 1, &[1, 2, 3, 255]));
    symlink(outside.join("secret.mtl"), scene.join("house.mtl")).unwrap();
    symlink("../outside", scene.join("maps")).unwrap();
    let faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\n";
    // The library by its name, in another case, by a path of another machine, and instead of a
    // missing library.
    for library in ["house.mtl", "HOUSE.MTL", "C:\\maps\\house.mtl", "gone.mtl"] {
        let obj = with(&scene, "house.obj", format!("mtllib {library}\n{faces}"));
        let loaded = Scene::load(&obj).unwrap();
        let warnings = loaded.notes.warnings.join("\n");
        assert!(
            warnings.contains("the material \"paint\" is in no material library"),
            "{warnings}"
        );
        if library != "gone.mtl" {
            assert!(warnings.contains("a link leads out of"), "{library}: {warnings}");
            assert!(warnings.contains("--allow-outside"), "{library}: {warnings}");
        }
    }
    std::fs::remove_file(scene.join("house.mtl")).unwrap();
    with(&scene, "house.mtl", "newmtl paint\nmap_Kd maps/secret.png\n");
    let obj = with(&scene, "house.obj", format!("mtllib house.mtl\n{faces}"));
    let loaded = Scene::load(&obj).unwrap();
    assert!(loaded.textures[0].name.starts_with("stand-in"), "{}", loaded.textures[0].name);
    assert!(loaded.notes.warnings.join("\n").contains("a link leads out of"));
    assert_eq!(load_anywhere(&obj).textures[0].rgba8, [1, 2, 3, 255]);
    // A library in a subfolder may use a file in the scene's folder, by a link that stays inside.
    std::fs::create_dir(scene.join("library")).unwrap();
    with(&scene, "wood.png", png(1, 1, &[9, 8, 7, 255]));
    symlink("../wood.png", scene.join("library/wood.png")).unwrap();
    with(&scene.join("library"), "house.mtl", "newmtl paint\nmap_Kd wood.png\n");
    let obj = with(&scene, "house.obj", format!("mtllib library/house.mtl\n{faces}"));
    assert_eq!(Scene::load(&obj).unwrap().textures[0].rgba8, [9, 8, 7, 255]);
}

#[test]
fn vxct_scenes_can_read_the_programs_folder() {
    let Place { folder, outside, .. } = place();
    let program = folder.path().join("program");
    for name in ["scenes", "models"] {
        std::fs::create_dir_all(program.join(name)).unwrap();
    }
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    with(&outside, "secret.obj", triangle);
    with(&program.join("models"), "own.obj", triangle);
    symlink("../../outside/secret.obj", program.join("models/link.obj")).unwrap();
    symlink("own.obj", program.join("models/alias.obj")).unwrap();
    symlink("../models/own.obj", program.join("scenes/beside.obj")).unwrap();
    let shown = |model: &str| {
        let text = format!("scene {{ model {{ path = {model} }} }}");
        let loaded = Scene::load(with(&program.join("scenes"), "a.scene", text)).unwrap();
        (loaded.instances.len(), loaded.notes.warnings.join("\n"))
    };
    for model in ["models/own.obj", "models/alias.obj", "beside.obj"] {
        assert_eq!(shown(model), (1, String::new()), "{model}");
    }
    let (count, warnings) = shown("models/link.obj");
    assert_eq!(count, 0);
    assert!(warnings.contains("a link leads out of"), "{warnings}");
    // The folder `scenes` may be a link: models are found in its target, and beside the link.
    let moved = folder.path().join("moved");
    std::fs::rename(program.join("scenes"), &moved).unwrap();
    std::fs::remove_file(moved.join("beside.obj")).unwrap();
    with(&moved, "beside.obj", triangle);
    symlink(&moved, program.join("scenes")).unwrap();
    for model in ["models/own.obj", "beside.obj"] {
        assert_eq!(shown(model), (1, String::new()), "{model}");
    }
}

/// The pipe has no writer, so opening it would block for ever.
#[test]
fn pipes_are_refused_at_once() {
    let Place { folder: _folder, scene, .. } = place();
    for name in ["a.glb", "a.obj", "a.ply", "a.stl", "a.scene", "wood.png", "b.bin", "b.mtl"] {
        let made = std::process::Command::new("mkfifo").arg(scene.join(name)).status().unwrap();
        assert!(made.success());
    }
    for name in ["a.glb", "a.obj", "a.ply", "a.stl", "a.scene"] {
        let error = Scene::load(scene.join(name)).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("it is a pipe, not a file"), "{error}");
    }
    let gltf = with(&scene, "scene.gltf", File::triangle().naming("b.bin"));
    let error = Scene::load(gltf).unwrap_err().to_string();
    assert!(error.contains("b.bin") && error.contains("it is a pipe"), "{error}");
    let map = lumivox_scene::EnvironmentMap::load(scene.join("wood.png")).unwrap_err().to_string();
    assert!(map.contains("wood.png") && map.contains("it is a pipe"), "{map}");
    let obj = "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\n";
    let loaded = Scene::load(with(&scene, "house.obj", obj)).unwrap();
    let warnings = loaded.notes.warnings.join("\n");
    assert!(warnings.contains("b.mtl") && warnings.contains("it is a pipe"), "{warnings}");
}
