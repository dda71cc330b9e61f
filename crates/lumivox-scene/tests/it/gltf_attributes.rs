//! Vertex data of glTF files: accessors of all kinds, coordinate sets, colours, tangents.

use glam::{Vec2, Vec3, Vec4};
use lumivox_scene::{LoadOptions, MemoryBudget, Scene, SceneError};
use serde_json::json;

use crate::common::{File, png, shading, textured_cube, world_triangles, write};

#[test]
fn strips_fans_and_unindexed_lists_are_loaded() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    for (mode, order) in [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let mut file = File::new();
        let positions = file.vectors(&order.map(|i| square[i]));
        let mesh = file.mesh(json!({ "attributes": { "POSITION": positions }, "mode": mode }));
        file.node(json!({ "mesh": mesh }), true);
        let scene = file.load().unwrap();
        assert_eq!(scene.triangle_count(), 2, "mode {mode}");
        for (_, normal) in world_triangles(&scene) {
            assert_eq!(normal, Vec3::Z, "mode {mode}");
        }
    }
}

#[test]
fn indices_of_all_widths_are_loaded() {
    for (component, bytes) in [
        (5121, vec![0_u8, 1, 2]),
        (5123, vec![0, 0, 1, 0, 2, 0]),
        (5125, vec![0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]),
    ] {
        let mut file = File::triangle();
        let view = file.view(&bytes);
        let indices = file.accessor(view, component, 3, "SCALAR");
        file.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        assert_eq!(file.load().unwrap().meshes[0].indices, [0, 1, 2]);
    }
}

#[test]
fn interleaved_normalised_and_sparse_accessors_are_read() {
    let mut file = File::triangle();
    // 8-bit texture coordinates with a stride of four bytes.
    let view = file.view(&[0, 255, 9, 9, 255, 51, 9, 9, 0, 0, 9, 9]);
    file.json["bufferViews"][view]["byteStride"] = json!(4);
    let uvs = file.accessor(view, 5121, 3, "VEC2");
    file.json["accessors"][uvs]["normalized"] = json!(true);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = json!(uvs);
    // Replaces the second position.
    let indices = file.view(&[1]);
    let moved: Vec<u8> = [5.0_f32, 0.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = file.view(&moved);
    file.json["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    let scene = file.load().unwrap();
    assert_eq!(scene.meshes[0].uvs, [Vec2::Y, Vec2::new(1.0, 0.2), Vec2::ZERO]);
    assert_eq!(scene.meshes[0].positions[1], Vec3::X * 5.0);
    // Replacements are packed, even if elements have a stride.
    let indices = file.view(&[0, 2]);
    let values = file.view(&[51, 0, 255, 102]);
    file.json["accessors"][uvs]["sparse"] = json!({
        "count": 2,
        "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    let uvs = &file.load().unwrap().meshes[0].uvs;
    assert_eq!(*uvs, [Vec2::new(0.2, 0.0), Vec2::new(1.0, 0.2), Vec2::new(1.0, 0.4)]);
}

#[test]
fn zero_normals_are_replaced() {
    let mut file = File::triangle();
    let normals = file.vectors(&[[0.0, 0.0, 0.0], [0.0, 0.0, 4.0], [0.0, 0.0, 1.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normals);
    let scene = file.load().unwrap();
    assert_eq!(scene.meshes[0].normals, [Vec3::Z; 3]);
    assert!(scene.notes.warnings.join(" ").contains("normals"));
}

/// Adds an accessor to the triangle as an attribute.
fn with_attribute(mut file: File, semantic: &str, accessor: usize) -> File {
    file.json["meshes"][0]["primitives"][0]["attributes"][semantic] = json!(accessor);
    file
}

#[test]
fn quantized_attributes_are_read() {
    // KHR_mesh_quantization: positions, normals and coordinates of 8 and 16 bits, of which only the
    // normalised ones are shares.
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let positions = file.view(&[0, 0, 0, 9, 200, 0, 0, 9, 0, 100, 0, 9]);
    file.json["bufferViews"][positions]["byteStride"] = json!(4);
    let positions = file.accessor(positions, 5121, 3, "VEC3");
    let normals = file.view(&[0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0]);
    file.json["bufferViews"][normals]["byteStride"] = json!(4);
    let normals = file.accessor(normals, 5120, 3, "VEC3");
    file.json["accessors"][normals]["normalized"] = json!(true);
    let tangents = file.view(&[127, 0, 0, 0x81, 127, 0, 0, 0x81, 127, 0, 0, 0x81]);
    let tangents = file.accessor(tangents, 5120, 3, "VEC4");
    file.json["accessors"][tangents]["normalized"] = json!(true);
    let shorts: Vec<u8> =
        [0_i16, -300, 4095, 7, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect();
    let uvs = file.view(&shorts);
    let uvs = file.accessor(uvs, 5122, 3, "VEC2");
    let file = with_attribute(file, "POSITION", positions);
    let file = with_attribute(file, "NORMAL", normals);
    let file = with_attribute(file, "TANGENT", tangents);
    let scene = with_attribute(file, "TEXCOORD_0", uvs).load().unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X * 200.0, Vec3::Y * 100.0]);
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    assert_eq!(mesh.tangents, [Vec4::new(1.0, 0.0, 0.0, -1.0); 3]);
    assert_eq!(mesh.uvs, [Vec2::new(0.0, -300.0), Vec2::new(4095.0, 7.0), Vec2::new(2.0, 3.0)]);
    // Both -128 and -127 are -1 (glTF 2.0, section 3.11).
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let view = file.view(&[0x80, 127, 0, 0, 0x81, 0x80, 0, 0, 0, 0, 0, 0]);
    file.json["bufferViews"][view]["byteStride"] = json!(4);
    let uvs = file.accessor(view, 5120, 3, "VEC2");
    file.json["accessors"][uvs]["normalized"] = json!(true);
    let scene = with_attribute(file, "TEXCOORD_0", uvs).load().unwrap();
    assert_eq!(scene.meshes[0].uvs, [Vec2::new(-1.0, 1.0), Vec2::NEG_ONE, Vec2::ZERO]);
}

#[test]
fn vertex_colours_of_all_types_are_read() {
    let expected = [Vec4::new(1.0, 0.2, 0.0, 1.0), Vec4::ONE, Vec4::new(0.0, 0.0, 0.6, 1.0)];
    let shares = [[255_u8, 51, 0], [255, 255, 255], [0, 0, 153]];
    let bytes: Vec<u8> = shares.as_flattened().to_vec();
    let shorts: Vec<u8> =
        shares.iter().flatten().flat_map(|&v| (u16::from(v) * 257).to_le_bytes()).collect();
    let floats: Vec<u8> =
        shares.iter().flatten().flat_map(|&v| (f32::from(v) / 255.0).to_le_bytes()).collect();
    for (component, bytes) in [(5121, bytes), (5123, shorts), (5126, floats)] {
        let mut file = File::triangle();
        let view = file.view(&bytes);
        let colors = file.accessor(view, component, 3, "VEC3");
        // Omitted for bytes on purpose: integer colours are always normalised.
        if component == 5123 {
            file.json["accessors"][colors]["normalized"] = json!(true);
        }
        let scene = with_attribute(file, "COLOR_0", colors).load().unwrap();
        for (color, expected) in scene.meshes[0].colors.iter().zip(expected) {
            assert!((*color - expected).length() < 1e-6, "{component}: {color}");
        }
        assert_eq!(scene.meshes[0].colors.len(), 3);
        // The only warning is about the missing material.
        assert_eq!(scene.notes.warnings.len(), 1, "{:?}", scene.notes.warnings);
    }
    let mut file = File::triangle();
    let colors = file.vectors(&[[1.0_f32, 1.0, 2.0, 0.5], [1.0; 4], [1.0; 4]]);
    let scene = with_attribute(file, "COLOR_0", colors).load().unwrap();
    assert_eq!(scene.meshes[0].colors[0], Vec4::new(1.0, 1.0, 1.0, 0.5));
    assert!(scene.notes.warnings.join(" ").contains("1 colours were limited"));
    // White colours are dropped.
    let mut file = File::triangle();
    let colors = file.vectors(&[[1.0_f32; 4]; 3]);
    assert!(with_attribute(file, "COLOR_0", colors).load().unwrap().meshes[0].colors.is_empty());
}

/// The triangle with two sets of texture coordinates, and a material with this normal texture.
fn with_sets(texture: serde_json::Value) -> File {
    let mut file = File::triangle();
    let first = file.vectors(&[[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let second = file.vectors(&[[0.5_f32, 0.5], [0.5, 0.75], [0.75, 0.5]]);
    let normals = file.vectors(&[[0.0_f32, 0.0, 1.0]; 3]);
    let image = file.view(&png(2, 2, &[128, 128, 255, 255].repeat(4)));
    file.push("images", json!({ "bufferView": image, "mimeType": "image/png" }));
    file.push("textures", json!({ "source": 0 }));
    file.push("materials", json!({ "name": "two sets", "normalTexture": texture }));
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let file = with_attribute(file, "TEXCOORD_0", first);
    let file = with_attribute(file, "NORMAL", normals);
    with_attribute(file, "TEXCOORD_1", second)
}

#[test]
fn the_second_uv_set_is_read_only_if_used() {
    let scene = with_sets(json!({ "index": 0, "texCoord": 1 })).load().unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.uvs1, [Vec2::new(0.5, 0.5), Vec2::new(0.5, 0.75), Vec2::new(0.75, 0.5)]);
    assert_eq!(mesh.uvs[1], Vec2::X);
    assert_eq!(scene.materials[0].normal_texture.unwrap().uv_set, 1);
    assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
    assert!(with_sets(json!({ "index": 0 })).load().unwrap().meshes[0].uvs1.is_empty());

    // A warning names a set that is missing in the mesh or the model.
    let mut file = with_sets(json!({ "index": 0, "texCoord": 1 }));
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"].as_object_mut().unwrap().remove("TEXCOORD_1");
    let scene = file.load().unwrap();
    assert!(scene.notes.warnings[0].contains("wants coordinate set 1"));
    let scene = with_sets(json!({ "index": 0, "texCoord": 2 })).load().unwrap();
    assert_eq!(scene.materials[0].normal_texture.unwrap().uv_set, 0);
    assert!(scene.notes.warnings[0].contains("wants coordinate set 2"));
}

#[test]
fn an_unused_second_uv_set_is_read_on_request() {
    let load = |file: File| {
        let mut options = LoadOptions { second_uvs: true, ..LoadOptions::default() };
        Scene::from_memory("scene.glb", &file.glb(), &mut options).unwrap()
    };
    let scene = load(with_sets(json!({ "index": 0 })));
    let expected = [Vec2::new(0.5, 0.5), Vec2::new(0.5, 0.75), Vec2::new(0.75, 0.5)];
    assert_eq!(scene.meshes[0].uvs1, expected);
    let plain = load(File::triangle());
    assert!(plain.meshes[0].uvs1.is_empty());
    let about_sets = |warning: &String| warning.contains("coordinate set");
    assert!(!plain.notes.warnings.iter().any(about_sets), "{:?}", plain.notes.warnings);
}

#[test]
fn a_mesh_may_have_only_the_second_uv_set() {
    let mut file = with_sets(json!({ "index": 0, "texCoord": 1 }));
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    // Also without normals: vertices are split, with their coordinates.
    for semantic in ["TEXCOORD_0", "NORMAL"] {
        primitive["attributes"].as_object_mut().unwrap().remove(semantic);
    }
    let scene = file.load().unwrap();
    assert_eq!(scene.meshes[0].uvs, [Vec2::ZERO; 3]);
    assert_eq!(scene.meshes[0].uvs1[2], Vec2::new(0.75, 0.5));
    // The second set swaps u and v: u grows with y.
    assert!((scene.meshes[0].tangents[0].truncate() - Vec3::Y).length() < 1e-6);
}

#[test]
fn tangents_follow_the_normal_textures_coordinates() {
    let tangent = |texture| with_sets(texture).load().unwrap().meshes[0].tangents[0];
    let first = tangent(json!({ "index": 0 }));
    assert!((first - Vec4::new(1.0, 0.0, 0.0, -1.0)).length() < 1e-6, "{first}");
    let second = tangent(json!({ "index": 0, "texCoord": 1 }));
    assert!((second - Vec4::new(0.0, 1.0, 0.0, 1.0)).length() < 1e-6, "{second}");
    // A rotation by 90 degrees maps v to u and -u to v: the image's u grows along y.
    let moved = json!({ "rotation": std::f32::consts::FRAC_PI_2 });
    let turned = tangent(json!({ "index": 0, "extensions": { "KHR_texture_transform": moved } }));
    assert!((turned - Vec4::new(0.0, 1.0, 0.0, -1.0)).length() < 1e-6, "{turned}");
    // The transform's own set wins.
    let moved = json!({ "texCoord": 1, "scale": [-1, 1] });
    let other = tangent(json!({ "index": 0, "extensions": { "KHR_texture_transform": moved } }));
    assert!((other - Vec4::new(0.0, -1.0, 0.0, -1.0)).length() < 1e-6, "{other}");
}

#[test]
fn geometry_beyond_the_budget_is_refused_with_numbers() {
    let file = textured_cube();
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "cube.glb", &file.glb());
    let load = |geometry_bytes| {
        let budget = MemoryBudget { geometry_bytes, ..MemoryBudget::default() };
        Scene::load_with(&path, &mut LoadOptions { budget, ..LoadOptions::default() })
    };
    // 24 vertices of 48 bytes and 36 indices of 4.
    assert!(load(24 * 48 + 36 * 4).is_ok());
    let error = load(24 * 48 + 36 * 4 - 1).unwrap_err();
    assert!(matches!(&error, SceneError::TooLarge { .. }), "{error}");
    let text = error.to_string();
    for word in ["mesh \"thing\"", "1.3 KiB", "budget", "raise"] {
        assert!(text.contains(word), "{word} in {text}");
    }
    assert_eq!(shading(&load(1 << 20).unwrap(), 0).metallic, 0.25);
}
