//! Files that are not quite glTF: they are read as intended, with a warning, or the error names
//! their kind.

use lumivox_scene::Scene;
use serde_json::json;

use crate::common::{File, load};

fn told(scene: &Scene) -> String {
    scene.notes.warnings.join("\n")
}

#[test]
fn leftover_indices_are_ignored_with_a_warning() {
    let mut file = File::triangle();
    let indices = file.indices(&[0, 1, 2, 0, 1]);
    file.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let scene = file.load().unwrap();
    assert_eq!(scene.triangle_count(), 1);
    let words = "mesh \"thing\": its 5 indices make no whole number of triangles; the last 2 were \
                 ignored";
    assert!(told(&scene).contains(words), "{}", told(&scene));
}

#[test]
fn a_matrix_overrides_translation_rotation_and_scale() {
    let mut file = File::triangle();
    let matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1];
    file.json["nodes"][0]["matrix"] = json!(matrix);
    assert!(!told(&file.load().unwrap()).contains("matrix"));
    file.json["nodes"][0]["translation"] = json!([0, 7, 0]);
    let scene = file.load().unwrap();
    assert_eq!(scene.bounds().min, glam::Vec3::X * 5.0);
    let words = "stand has a matrix and also a translation, rotation or scale, which glTF forbids; the \
                 matrix counts";
    assert!(told(&scene).contains(words), "{}", told(&scene));
}

#[test]
fn a_huge_yfov_is_read_as_degrees() {
    let mut file = File::triangle();
    let lens = json!({ "type": "perspective", "perspective": { "yfov": 60, "znear": 1 } });
    file.push("cameras", lens);
    file.node(json!({ "camera": 0 }), true);
    let scene = file.load().unwrap();
    assert!((scene.cameras[0].vertical_fov_rad.to_degrees() - 60.0).abs() < 1e-3);
    let words = "camera 0 at node 1: its yfov of 60 counts as degrees";
    assert!(told(&scene).contains(words), "{}", told(&scene));
}

#[test]
fn chunks_need_not_be_padded() {
    let whole = File::triangle().glb();
    let word = |at: usize| u32::from_le_bytes(whole[at..at + 4].try_into().unwrap());
    let json = &whole[20..20 + word(12) as usize];
    for blanks in 1..4_u32 {
        let json = [json.trim_ascii_end(), &b"   "[..blanks as usize]].concat();
        let length = json.len() as u32;
        let binary = &whole[20 + word(12) as usize..];
        let total = (20 + json.len() + binary.len()) as u32;
        let head = [&b"glTF"[..], &2_u32.to_le_bytes(), &total.to_le_bytes()].concat();
        let glb = [&head[..], &length.to_le_bytes(), b"JSON", &json, binary].concat();
        assert_eq!(load("scene.glb", &glb).unwrap().triangle_count(), 1, "{length}");
    }
}

#[test]
fn text_in_utf16_is_read() {
    let text = String::from_utf8(File::triangle().embedded()).unwrap();
    for order in [u16::to_le_bytes, u16::to_be_bytes] {
        let wide: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(order).collect();
        assert_eq!(load("scene.gltf", &wide).unwrap().triangle_count(), 1);
    }
}

#[test]
fn errors_explain_why_a_file_is_not_gltf() {
    let text = String::from_utf8(File::triangle().embedded()).unwrap();
    for (bytes, words) in [
        (
            text.replacen('{', "{\n// \"made by hand\"\n", 1),
            "line 2 has a comment, which JSON forbids",
        ),
        (text.replacen('{', "{ /* \" */ ", 1), "line 1 has a comment"),
        ("[]".to_owned(), "it is a list, but glTF is one object"),
        ("7".to_owned(), "it is a single value, but"),
        (
            r#"{ "metadata": { "version": 4.6, "type": "Object" }, "object": {} }"#.to_owned(),
            "JSON of three.js (\"Object\"), not glTF: load it there and export it with its GLTFExporter",
        ),
    ] {
        let error = load("scene.gltf", bytes.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}
