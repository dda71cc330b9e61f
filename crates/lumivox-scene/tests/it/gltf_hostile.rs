//! Broken and malicious files: always an error that names the file, never a panic.

use std::sync::LazyLock;

use lumivox_scene::{Scene, SceneError};
use proptest::prelude::*;
use serde_json::json;

use crate::common::{File, fault, load, load_from_memory, png, write};

/// The error of the triangle after a change to its JSON.
fn changed(change: impl FnOnce(&mut serde_json::Value)) -> String {
    let mut file = File::triangle();
    change(&mut file.json);
    fault(&file)
}

/// Everything that the loader reads, in a small file.
fn rich() -> File {
    let mut file = File::triangle();
    let image = file.view(&png(2, 2, &[7; 16]));
    file.push("images", json!({ "bufferView": image, "mimeType": "image/png" }));
    file.push("samplers", json!({ "wrapS": 33071, "magFilter": 9728 }));
    file.push("textures", json!({ "source": 0, "sampler": 0 }));
    file.push(
        "materials",
        json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "extensions": {
                "KHR_texture_transform": { "scale": [2, 3], "rotation": 1, "texCoord": 1 },
            } } },
            "normalTexture": { "index": 0 },
            "emissiveFactor": [1, 1, 1],
            "extensions": {
                "KHR_materials_emissive_strength": { "emissiveStrength": 2 },
                "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 0 } },
                "KHR_materials_sheen": { "sheenRoughnessTexture": { "index": 0 } },
                "KHR_materials_specular": { "specularTexture": { "index": 0 } },
            },
        }),
    );
    file.push(
        "materials",
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
            "diffuseTexture": { "index": 0 }, "specularGlossinessTexture": { "index": 0 },
        } } }),
    );
    let colors = file.vectors(&[[0.5_f32, 0.5, 1.0]; 3]);
    let normals = file.vectors(&[[0.0, 0.0, 1.0]; 3]);
    let uvs = file.vectors(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["attributes"]["NORMAL"] = json!(normals);
    primitive["attributes"]["TEXCOORD_0"] = json!(uvs);
    primitive["attributes"]["TEXCOORD_1"] = json!(uvs);
    primitive["attributes"]["COLOR_0"] = json!(colors);
    let mut other = primitive.clone();
    other["material"] = json!(1);
    file.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(other);
    file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }),
    );
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    file.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "spot": {} }] } });
    let camera = file.node(json!({ "camera": 0, "rotation": [0, 0, 0, 1] }), false);
    file.node(
        json!({
            "children": [camera],
            "scale": [-1, 1, 1],
            "mesh": 0,
            "extensions": { "KHR_lights_punctual": { "light": 0 } },
        }),
        true,
    );
    file
}

#[test]
fn missing_files_and_unknown_formats_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let missing = Scene::load(folder.path().join("none.glb")).unwrap_err();
    assert!(matches!(&missing, SceneError::Read { .. }));
    assert!(missing.to_string().contains("none.glb"));
    let directory = folder.path().join("folder.gltf");
    std::fs::create_dir(&directory).unwrap();
    assert!(matches!(Scene::load(directory), Err(SceneError::Read { .. })));
    for name in ["scene.fbx", "scene"] {
        let error = load(name, b"").unwrap_err();
        assert!(matches!(&error, SceneError::UnknownFormat { .. }));
        assert!(error.to_string().contains(".gltf, .glb, .obj, .ply, .stl, .scene, .vxct or .txt"));
    }
}

#[test]
fn garbage_bytes_are_refused() {
    let garbage: [&[u8]; 9] = [
        b"",
        b"{",
        b"hello",
        b"[]",
        b"{}",
        b"\xff\xfe\x00",
        b"glTF",
        b"glTF\x02\0\0\0\0\0\0\0",
        b"glTF\x02\0\0\0\xff\xff\xff\xff",
    ];
    for bytes in garbage {
        for name in ["scene.gltf", "scene.glb"] {
            let error = load(name, bytes).unwrap_err();
            assert!(matches!(&error, SceneError::Malformed { .. }), "{error}");
        }
    }
}

#[test]
fn every_truncation_of_a_glb_is_an_error() {
    let whole = rich().glb();
    load("whole.glb", &whole).unwrap();
    for length in 0..whole.len() {
        let error = load_from_memory("cut.glb", &whole[..length]).expect_err("a cut file");
        assert!(matches!(&error, SceneError::Malformed { .. }), "{length}: {error}");
    }
}

#[test]
fn every_truncation_of_a_gltf_is_an_error() {
    let whole = rich().embedded();
    load("whole.gltf", &whole).unwrap();
    for length in 0..whole.len() {
        load_from_memory("cut.gltf", &whole[..length]).expect_err("a cut file");
    }
}

#[test]
fn invalid_geometry_is_refused() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut file = File::triangle();
        file.binary[4..8].copy_from_slice(&bad.to_le_bytes());
        let error = fault(&file);
        assert!(error.contains("numbers that are not finite"), "{error}");
    }
    let mut beyond = File::triangle();
    let at = beyond.json["bufferViews"][1]["byteOffset"].as_u64().unwrap() as usize;
    beyond.binary[at] = 3;
    let error = fault(&beyond);
    assert!(error.contains("index 0") && error.contains("only 3 vertices"), "{error}");

    let mut point = File::triangle();
    point.binary[..36].fill(0);
    assert!(fault(&point).contains("size zero"));

    let mut line = File::triangle();
    line.binary[24..36].fill(0);
    assert!(fault(&line).contains("1 degenerate"));

    assert!(fault(&File::new()).contains("no triangles"));
    assert!(changed(|json| json["scenes"][0]["nodes"] = json!([])).contains("no triangles"));
}

#[test]
fn counts_beyond_the_data_are_refused() {
    let count = 4_000_000_000_u64;
    // The error is about the count, not about the budget.
    for accessor in [0, 1] {
        let error = changed(|json| json["accessors"][accessor]["count"] = json!(count));
        assert!(error.contains("4000000000 elements"), "{error}");
        assert!(error.contains("do not fit in its view"), "{error}");
        assert!(!error.contains("budget"), "{error}");
    }
    let error = changed(|json| {
        let copies =
            json!({ "bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3" });
        json["accessors"].as_array_mut().unwrap().push(copies);
        json["nodes"][0]["extensions"] =
            json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2 } } });
    });
    assert!(error.contains("do not fit") && !error.contains("split it up"), "{error}");
    let error = changed(|json| json["accessors"][0]["count"] = json!(4));
    assert!(error.contains("do not fit in its view"), "{error}");
    let error = changed(|json| json["accessors"][0]["byteOffset"] = json!(u64::MAX));
    assert!(error.contains("do not fit"), "{error}");
    let error = changed(|json| json["bufferViews"][0]["byteLength"] = json!(1_000_000));
    assert!(error.contains("do not fit in its buffer"), "{error}");
    let error = changed(|json| json["bufferViews"][0]["byteOffset"] = json!(u64::MAX));
    assert!(error.contains("do not fit in its buffer"), "{error}");
    let error = changed(|json| json["bufferViews"][0]["byteStride"] = json!(4));
    assert!(error.contains("stride"), "{error}");
    let zeros = |json: &mut serde_json::Value| {
        json["accessors"][0] =
            json!({ "componentType": 5126, "count": 100_000_000, "type": "VEC3" });
    };
    let error = changed(zeros);
    assert!(error.contains("without data"), "{error}");
}

#[test]
fn dangling_references_are_refused() {
    for (list, key) in [("meshes", "primitives"), ("nodes", "mesh"), ("scenes", "nodes")] {
        let error = changed(|json| match list {
            "meshes" => json[list][0][key][0]["attributes"]["POSITION"] = json!(99),
            "nodes" => json[list][0][key] = json!(99),
            _ => json[list][0][key] = json!([99]),
        });
        assert!(error.contains("malformed"), "{error}");
    }
    changed(|json| json["meshes"][0]["primitives"][0]["indices"] = json!(99));
    changed(|json| json["accessors"][0]["bufferView"] = json!(99));
    changed(|json| json["bufferViews"][0]["buffer"] = json!(99));
    changed(|json| json["accessors"][0]["componentType"] = json!(1));
    changed(|json| json["accessors"][0]["type"] = json!("MAT4"));
    changed(|json| json["meshes"][0]["primitives"][0]["mode"] = json!(77));
    changed(|json| json["cameras"] = json!([{ "type": "perspective" }]));
    let mixed = json!([{ "type": "perspective",
        "orthographic": { "xmag": 1, "ymag": 1, "zfar": 1, "znear": 0 } }]);
    changed(|json| json["cameras"] = mixed);
}

#[test]
fn cyclic_and_shared_node_hierarchies_are_refused() {
    let error = changed(|json| json["nodes"][0]["children"] = json!([0]));
    assert!(error.contains("own ancestor"), "{error}");
    let error = changed(|json| {
        let parent = json!({ "children": [0] });
        json["nodes"] = json!([json["nodes"][0].clone(), parent, parent]);
        json["scenes"][0]["nodes"] = json!([1, 2]);
    });
    assert!(error.contains("two parents"), "{error}");
}

#[test]
fn very_deep_hierarchies_are_loaded() {
    let mut file = File::triangle();
    for _ in 0..20_000 {
        let child = file.json["nodes"].as_array().unwrap().len() - 1;
        file.node(json!({ "children": [child] }), false);
    }
    let top = file.json["nodes"].as_array().unwrap().len() - 1;
    file.json["scenes"][0]["nodes"] = json!([top]);
    assert_eq!(file.load().unwrap().triangle_count(), 1);
}

#[test]
fn invalid_transforms_are_refused() {
    let error = changed(|json| json["nodes"][0]["translation"] = json!([1e300, 0, 0]));
    assert!(error.contains("not finite") || error.contains("JSON"), "{error}");
    let mut projection = [0.0; 16];
    for i in 0..4 {
        projection[i * 5] = 1.0;
    }
    projection[3] = 0.5;
    let error = changed(|json| json["nodes"][0]["matrix"] = json!(projection));
    assert!(error.contains("affine"), "{error}");
    // The scene's only mesh is scaled to zero.
    assert!(changed(|json| json["nodes"][0]["scale"] = json!([0, 0, 0])).contains("no triangles"));
}

#[test]
fn paths_that_leave_the_folder_are_refused() {
    let outer = tempfile::tempdir().unwrap();
    let inner = outer.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    let file = File::triangle();
    let outside = write(outer.path(), "outside.bin", &file.binary);
    let absolute = outside.to_string_lossy().into_owned();
    let uris = [
        "../outside.bin",
        "./../outside.bin",
        "%2e%2e/outside.bin",
        "..\\outside.bin",
        absolute.as_str(),
        "file://outside.bin",
        "http://example.org/a.bin",
        "C:/outside.bin",
    ];
    for uri in uris {
        let path = write(&inner, "scene.gltf", &file.naming(uri));
        let error = Scene::load(path).unwrap_err();
        assert!(matches!(&error, SceneError::RefusedUri { .. }), "{uri}: {error}");
        assert!(error.to_string().contains("buffer 0"), "{error}");
    }
}

#[test]
fn missing_files_are_named() {
    let error = load("scene.gltf", &File::triangle().naming("gone.bin")).unwrap_err();
    assert!(matches!(&error, SceneError::ReadExternal { .. }));
    let text = error.to_string();
    assert!(text.contains("buffer 0") && text.contains("gone.bin"), "{text}");
}

/// Made once: making it takes longer than loading it.
static RICH: LazyLock<Vec<u8>> = LazyLock::new(|| rich().glb());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn flipped_bytes_never_panic(
        flips in prop::collection::vec((any::<prop::sample::Index>(), 1_u8..), 1..6)
    ) {
        let mut bytes = RICH.clone();
        for (at, mask) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= mask;
        }
        // A scene and an error are both correct; a panic is not.
        let _ = load_from_memory("scene.glb", &bytes);
    }

    #[test]
    fn changed_digits_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..6)
    ) {
        // Digits in the JSON are sizes, offsets and indices, so changing them tests more than
        // random bytes.
        let mut bytes = RICH.clone();
        let digits: Vec<usize> = (20..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
        for (at, digit) in changes {
            bytes[digits[at.index(digits.len())]] = digit;
        }
        let _ = load_from_memory("scene.glb", &bytes);
    }
}
