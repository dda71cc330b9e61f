//! Compressed geometry and images in glTF files.

use glam::{Vec2, Vec3, Vec4};
use lumivox_scene::{LoadOptions, MemoryBudget, Scene};
use serde_json::json;

use crate::common::{File, flip_bytes, load_from_memory, shading, world_triangles, write};

const GRID: &[u8] = include_bytes!("../data/grid.drc");

/// A primitive whose data are in a Draco stream; attributes are (semantic, component, type, ID in
/// the stream).
fn draco(stream: &[u8], attributes: &[(&str, u32, &str, u32)]) -> File {
    let mut file = File::new();
    let view = file.view(stream);
    let mut accessor = |component: u32, kind: &str| {
        // The counts are from before compression, and may differ.
        file.push("accessors", json!({ "componentType": component, "count": 1, "type": kind }))
    };
    let indices = accessor(5125, "SCALAR");
    let (mut accessors, mut numbers) = (json!({}), json!({}));
    for &(semantic, component, kind, number) in attributes {
        accessors[semantic] = json!(accessor(component, kind));
        numbers[semantic] = json!(number);
    }
    let mesh = file.mesh(json!({
        "attributes": accessors, "indices": indices,
        "extensions": { "KHR_draco_mesh_compression": {
            "bufferView": view, "attributes": numbers,
        } },
    }));
    file.node(json!({ "mesh": mesh }), true);
    file.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    file
}

fn grid() -> File {
    draco(
        GRID,
        &[
            ("POSITION", 5126, "VEC3", 3),
            ("NORMAL", 5126, "VEC3", 2),
            ("TEXCOORD_0", 5126, "VEC2", 1),
            ("COLOR_0", 5121, "VEC4", 0),
        ],
    )
}

#[test]
fn a_draco_stream_decodes_to_the_original_mesh() {
    let scene = grid().load().unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!((scene.triangle_count(), mesh.positions.len()), (18, 16));
    for (i, position) in mesh.positions.iter().enumerate() {
        // Twelve bits for positions and coordinates, eight for colours.
        let near = |a: f32, b: f32| (a - b).abs() < 1e-3;
        let Vec2 { x, y } = position.truncate();
        let corner = (position * 3.0).round() / 3.0;
        assert!((*position - corner).length() < 1e-3, "{position}");
        assert!(near(mesh.uvs[i].x, x) && near(mesh.uvs[i].y, 1.0 - y), "{}", mesh.uvs[i]);
        assert!((mesh.colors[i] - Vec4::new(x, y, 0.2, 1.0)).abs().max_element() < 1e-2);
        assert!(mesh.normals[i].dot(Vec3::Z) > 0.999);
    }
    let area = world_triangles(&scene)
        .iter()
        .map(|([a, b, c], normal)| (b - a).cross(c - a).dot(*normal) * 0.5)
        .sum::<f32>();
    assert!((area - 1.0).abs() < 1e-3, "{area}");
}

/// Streams of Google's encoder at different levels, and the number of the sphere's triangles: for a
/// thousand or more the encoder uses additional methods.
const SPHERES: [(&[u8], usize); 6] = [
    (include_bytes!("../data/sphere-0.drc"), 80),
    (include_bytes!("../data/sphere-1.drc"), 1280),
    (include_bytes!("../data/sphere-3.drc"), 1280),
    (include_bytes!("../data/sphere-7.drc"), 1280),
    (include_bytes!("../data/sphere-9.drc"), 1280),
    (include_bytes!("../data/sphere-10.drc"), 1280),
];

#[test]
fn all_draco_compression_levels_are_decoded() {
    // Ten bits for 4 m, with an error of half a step along each axis.
    let off_m = 4.0 / 1023.0 * 0.5 * 3.0_f32.sqrt() + 1e-5;
    for (stream, triangles) in SPHERES {
        let scene = draco(stream, &[("POSITION", 5126, "VEC3", 0)]).load().unwrap();
        assert_eq!(scene.triangle_count(), triangles);
        for ([a, b, c], _) in world_triangles(&scene) {
            // The front faces outwards.
            assert!(
                (b - a).cross(c - a).dot(a + b + c) > 0.0,
                "{triangles} triangles: {a} {b} {c}"
            );
            assert!((a.length() - 2.0).abs() < off_m, "{triangles} triangles: {a}");
        }
    }
}

#[test]
fn invalid_draco_streams_are_refused() {
    let fault = |file: &File| file.load().unwrap_err().to_string();
    let position = ("POSITION", 5126, "VEC3", 3);
    let error = fault(&draco(&GRID[..GRID.len() / 2], &[position]));
    assert!(error.contains("mesh 0, primitive 0, its Draco compression"), "{error}");
    assert!(fault(&draco(b"DRACO", &[position])).contains("cannot be decoded"));
    assert!(fault(&draco(GRID, &[("POSITION", 5126, "VEC3", 9)])).contains("lacks"));
    // Normals as texture coordinates: three numbers instead of two.
    let error = fault(&draco(GRID, &[position, ("TEXCOORD_0", 5126, "VEC2", 2)]));
    assert!(error.contains("3 components instead of 2"), "{error}");
    let mut file = grid();
    let extension = |file: &mut File, key: &str, value: serde_json::Value| {
        let primitive = &mut file.json["meshes"][0]["primitives"][0];
        primitive["extensions"]["KHR_draco_mesh_compression"][key] = value;
    };
    extension(&mut file, "bufferView", json!(7));
    assert!(fault(&file).contains("buffer view 7"));
    extension(&mut file, "bufferView", json!("none"));
    assert!(fault(&file).contains("missing"));
    let mut file = grid();
    let primitive = file.json["meshes"][0]["primitives"][0].as_object_mut().unwrap();
    primitive.remove("indices");
    assert!(fault(&file).contains("its indices are missing"));

    // Four thousand million faces and points in a few bytes (sequential, version 2.2) exceed any
    // budget.
    for method in [0, 1] {
        let mut claim = b"DRACO\x02\x02\x01\x00\x00\x00".to_vec();
        claim.extend([0xff, 0xff, 0xff, 0xff, 0x0e].repeat(2));
        claim.push(method);
        let error = fault(&draco(&claim, &[position]));
        assert!(error.contains("malformed") && !error.contains("budget"), "{error}");
    }

    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "grid.glb", &grid().glb());
    let budget = MemoryBudget { geometry_bytes: 100, ..MemoryBudget::default() };
    let options = &mut LoadOptions { budget, ..LoadOptions::default() };
    let error = Scene::load_with(&path, options).unwrap_err().to_string();
    assert!(error.contains("need more, but the budget is 0.1 KiB"), "{error}");
}

/// The triangle with a texture of these bytes.
fn image(bytes: &[u8]) -> File {
    let mut file = File::triangle();
    let view = file.view(bytes);
    file.push("images", json!({ "bufferView": view, "mimeType": "image/ktx2" }));
    file.push("textures", json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } }));
    let pbr = json!({ "baseColorTexture": { "index": 0 } });
    file.push("materials", json!({ "pbrMetallicRoughness": pbr }));
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    file.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
    file
}

const ETC1S: &[u8] = include_bytes!("../data/ramp-etc1s.ktx2");
const UASTC: &[u8] = include_bytes!("../data/ramp-uastc-zstd.ktx2");
const ASTC: &[u8] = include_bytes!("../data/ramp-astc.ktx2");

#[test]
fn basis_universal_and_astc_images_are_decoded() {
    // The limits are the mean differences of the encoder's own decoder, rounded up.
    for (bytes, mean) in [(ETC1S, 10.0), (UASTC, 2.0), (ASTC, 2.0)] {
        let scene = image(bytes).load().unwrap();
        assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
        let texture = &scene.textures[shading(&scene, 0).base_color_texture.unwrap().texture];
        assert_eq!((texture.width, texture.height), (16, 16));
        let expected = (0..256_u32).flat_map(|i| {
            let (x, y) = ((i % 16) as u8 * 17, (i / 16) as u8 * 17);
            [x, y, 60, 255 - x]
        });
        let sum: f64 =
            texture.rgba8.iter().zip(expected).map(|(a, b)| f64::from(a.abs_diff(b))).sum();
        assert!(sum / 1024.0 < mean, "{}", sum / 1024.0);
    }
}

/// A container with one level, without supercompression.
fn ktx2(format: u32, width: u32, height: u32, level: &[u8]) -> Vec<u8> {
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    for word in [format, 1, width, height, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    for word in [104, level.len() as u64, level.len() as u64] {
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(level);
    bytes
}

#[test]
fn plain_ktx2_formats_are_decoded() {
    let texels = |bytes: &[u8]| {
        let scene = image(bytes).load().unwrap();
        scene.textures[0].rgba8.as_chunks::<4>().0.to_vec()
    };
    assert_eq!(texels(&ktx2(9, 2, 1, &[7, 9])), [[7, 0, 0, 255], [9, 0, 0, 255]]);
    assert_eq!(texels(&ktx2(16, 1, 1, &[7, 9])), [[7, 9, 0, 255]]);
    assert_eq!(texels(&ktx2(29, 1, 2, &[1, 2, 3, 4, 5, 6])), [[1, 2, 3, 255], [4, 5, 6, 255]]);
    assert_eq!(texels(&ktx2(43, 1, 1, &[1, 2, 3, 4])), [[1, 2, 3, 4]]);
    assert_eq!(texels(&ktx2(50, 1, 1, &[1, 2, 3, 4])), [[3, 2, 1, 4]]);
    // BC1: two colours of 5, 6, 5 bits, and two bits for each of 16 texels. The palette: red, blue,
    // and mixtures of two thirds and one third.
    let bc1 = [0x00, 0xF8, 0x1F, 0x00, 0b11_10_01_00, 0, 0, 0];
    let block = texels(&ktx2(131, 4, 4, &bc1));
    assert_eq!(block[..2], [[255, 0, 0, 255], [0, 0, 255, 255]]);
    assert!(block[2][0].abs_diff(170) <= 1 && block[2][2].abs_diff(85) <= 1, "{:?}", block[2]);
    assert_eq!(block[15], [255, 0, 0, 255]);
    // At the edges, only a part of a block is used.
    assert_eq!(texels(&ktx2(131, 3, 1, &bc1)), block[..3]);
}

#[test]
fn invalid_ktx2_images_get_a_stand_in() {
    let fault = |bytes: &[u8]| {
        let scene = load_from_memory("scene.glb", &image(bytes).glb()).unwrap();
        let said = scene.notes.warnings.join("\n");
        assert!(said.contains("a stand-in is shown"), "{said}");
        said
    };
    assert!(fault(&ktx2(43, 4, 4, &[0; 63])).contains("63 of 64 bytes"));
    assert!(fault(&ktx2(97, 1, 1, &[0; 8])).contains("VkFormat 97"));
    let mut cube = ktx2(43, 1, 1, &[0; 4]);
    cube[36] = 6;
    assert!(fault(&cube).contains("one flat image"));
    let mut beyond = ktx2(43, 1, 1, &[0; 4]);
    beyond[80..88].fill(0xff);
    assert!(fault(&beyond).contains("do not fit"));
    for whole in [ETC1S, UASTC, ASTC] {
        for length in 0..whole.len() {
            fault(&whole[..length]);
        }
    }
}

#[test]
fn flipped_bytes_never_panic() {
    for original in [image(ETC1S), image(UASTC), image(ASTC)] {
        flip_bytes(&original, 2, 300);
    }
    flip_bytes(&grid(), 0, 300);
}
