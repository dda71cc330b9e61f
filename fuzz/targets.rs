//! Processing of each input, shared by the fuzz targets and by the test that runs the committed
//! corpus (`crates/lumivox-scene/tests/it/corpus`).
//!
//! Whatever the bytes, a loader may refuse them with an error or give a scene that keeps its
//! promises; it may not panic, run for long, or take memory out of proportion.

// Each target uses its part of this.
#![allow(dead_code)]

#[path = "mutate.rs"]
mod mutate;
#[path = "wrap.rs"]
mod wrap;

use std::collections::HashMap;

use lumivox_scene::{AnimationChoice, EnvironmentMap, LoadOptions, MemoryBudget, Scene};

/// All targets; each has a folder of seeds in `corpus/`.
pub const TARGETS: [&str; 12] = [
    "gltf",
    "glb",
    "glb_structured",
    "draco",
    "meshopt",
    "image",
    "obj",
    "mtl",
    "ply",
    "stl",
    "vxct",
    "environment",
];

/// Runs one input.
pub fn run(target: &str, data: &[u8]) {
    match target {
        "gltf" => scene("scene.gltf", data),
        "glb" => scene("scene.glb", data),
        "glb_structured" => scene("scene.glb", &mutate::glb(EVERYTHING, data)),
        "draco" => wrapped(&wrap::draco(data), data),
        "meshopt" => wrapped(&wrap::meshopt(data), data),
        "image" => wrapped(&wrap::image(data), data),
        "obj" => scene("scene.obj", data),
        "mtl" => {
            let files = HashMap::from([
                ("scene.mtl".to_owned(), data.to_vec()),
                ("colors.png".to_owned(), COLORS.to_vec()),
            ]);
            scene_with("scene.obj", OBJ, &files);
        }
        "ply" => scene("scene.ply", data),
        "stl" => scene("scene.stl", data),
        "vxct" => {
            let files = HashMap::from([
                ("models/box.obj".to_owned(), OBJ.to_vec()),
                ("scenes/b.obj".to_owned(), b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec()),
            ]);
            scene_with("scenes/scene.scene", data, &files);
        }
        "environment" => environment(data),
        _ => panic!("no target is called {target}"),
    }
}

/// A file with everything that the glTF loader reads, for the structured target to start from.
const EVERYTHING: &[u8] = include_bytes!("corpus/glb/everything.glb");

/// An image for materials to name: `colors.png`.
const COLORS: &[u8] = include_bytes!("corpus/environment/picture.png");

/// A scene in materials of an unknown library.
const OBJ: &[u8] =
    b"mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n\
    usemtl a\nf 1/1/1 2/2/1 3/3/1\nusemtl b\nf 1/1 2/2 3/3\nusemtl c\nf 3 2 1\n";

/// Little enough for libFuzzer's limit on single allocations to mean something.
const BUDGET: MemoryBudget = MemoryBudget { texture_bytes: 16 << 20, geometry_bytes: 64 << 20 };

fn environment(data: &[u8]) {
    // Decoders that panic are caught by the loader; libFuzzer's hook would not let it.
    drop(std::panic::take_hook());
    let Ok(map) = EnvironmentMap::from_memory("map", data) else { return };
    assert_eq!(map.rgb.len(), map.width as usize * map.height as usize);
    assert!(map.rgb.iter().flatten().all(|x| x.is_finite() && *x >= 0.0));
}

/// Loads the scene; one that loads must also survive being saved.
fn scene(name: &str, data: &[u8]) {
    let files = HashMap::from([
        ("data.bin".to_owned(), vec![0x3f; 1024]),
        ("colors.png".to_owned(), COLORS.to_vec()),
    ]);
    scene_with(name, data, &files);
}

/// A document around compressed data, which are its `data.bin`.
fn wrapped(document: &serde_json::Value, data: &[u8]) {
    let files = HashMap::from([("data.bin".to_owned(), data.to_vec())]);
    scene_with("scene.gltf", document.to_string().as_bytes(), &files);
}

fn scene_with(name: &str, data: &[u8], files: &HashMap<String, Vec<u8>>) {
    let load = |bytes: &[u8], name: &str| {
        let mut options =
            LoadOptions { budget: BUDGET, files: Some(files), ..LoadOptions::default() };
        Scene::from_memory(name, bytes, &mut options)
    };
    let Ok(mut scene) = load(data, name) else { return };
    promises(&scene);
    let rest = scene.clone();
    for time_s in [0.0, 0.3, 1e9] {
        if scene.pose(AnimationChoice::All, time_s).is_ok() {
            promises(&scene);
        }
    }
    scene = rest;
    let once = scene.clone();
    scene.validate().expect("a loaded scene is valid");
    assert!(once.meshes == scene.meshes, "validating twice changes nothing");

    // Saving takes far longer than most loading: a quarter of the inputs will do.
    if data.iter().fold(0_u8, |sum, &byte| sum.wrapping_add(byte)) % 4 != 0 {
        return;
    }
    let saved = scene.to_glb().expect("a valid scene can be saved");
    let again = match load(&saved, "scene.glb") {
        Ok(again) => again,
        // Textures that share an image may not share the budget.
        Err(error) => panic!("a saved scene cannot be loaded: {error}"),
    };
    assert!(again.to_glb().expect("it can be saved again") == saved, "saved again, it differs");
}

/// Checks the crate's promises for every scene.
fn promises(scene: &Scene) {
    assert!(scene.triangle_count() > 0 || scene.grid_bounds.is_some());
    assert!(scene.bounds().size().is_finite());
    assert!(scene.voxel_bounds().size().max_element() > 0.0);
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        assert!(mesh.indices.iter().all(|&i| (i as usize) < count));
        assert!([mesh.normals.len(), mesh.uvs.len(), mesh.tangents.len()] == [count; 3]);
        for (normal, tangent) in mesh.normals.iter().zip(&mesh.tangents) {
            let (n, t) = (normal.length(), tangent.truncate().length());
            assert!((n - 1.0).abs() < 1e-4, "mesh {}: normal {normal}", mesh.name);
            assert!(
                t > 0.5 && tangent.is_finite(),
                "mesh {}: tangent {tangent} at {normal}",
                mesh.name
            );
        }
    }
}
