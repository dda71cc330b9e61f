//! Buffer views compressed with meshoptimizer.

use glam::{Vec2, Vec3};
use lumivox_scene::Scene;
use serde_json::{Value, json};

use crate::common::{File, flip_bytes};

/// A square of two triangles with compressed vertices and indices; the views refer to a fallback
/// buffer without data.
struct Square {
    file: File,
    fallback_bytes: usize,
}

impl Square {
    fn new() -> Self {
        let mut file = File::new();
        file.json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
        file.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
        file.mesh(json!({ "attributes": {} }));
        file.node(json!({ "mesh": 0 }), true);
        Self { file, fallback_bytes: 0 }
    }

    /// Adds a compressed view of `count` elements.
    fn view(&mut self, encoded: &[u8], count: usize, stride: usize, more: Value) -> usize {
        let stream = self.file.view(encoded);
        let mut extension = self.file.json["bufferViews"][stream].clone();
        extension["byteStride"] = json!(stride);
        extension["count"] = json!(count);
        for (key, value) in more.as_object().unwrap() {
            extension[key] = value.clone();
        }
        let view = &mut self.file.json["bufferViews"][stream];
        *view = json!({
            "buffer": 1, "byteOffset": self.fallback_bytes, "byteLength": count * stride,
            "extensions": { "EXT_meshopt_compression": extension },
        });
        if more["mode"] == "ATTRIBUTES" {
            view["byteStride"] = json!(stride);
        }
        self.fallback_bytes += count * stride;
        stream
    }

    fn attribute(&mut self, semantic: &str, view: usize, component: u32, kind: &str) {
        let accessor = self.file.accessor(view, component, 4, kind);
        self.file.json["accessors"][accessor]["normalized"] = json!(component != 5126);
        self.file.json["meshes"][0]["primitives"][0]["attributes"][semantic] = json!(accessor);
    }

    fn indices(&mut self, view: usize, component: u32) {
        let accessor = self.file.accessor(view, component, 6, "SCALAR");
        self.file.json["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
    }

    fn finish(mut self) -> File {
        self.file.binary.resize(self.file.binary.len().next_multiple_of(4), 0);
        self.file.json["buffers"] = json!([
            { "byteLength": self.file.binary.len() },
            {
                "byteLength": self.fallback_bytes,
                "extensions": { "EXT_meshopt_compression": { "fallback": true } },
            },
        ]);
        self.file
    }
}

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
const INDICES: [u32; 6] = [0, 1, 2, 0, 2, 3];

fn attributes(filter: &str) -> Value {
    json!({ "mode": "ATTRIBUTES", "filter": filter })
}

fn square() -> File {
    let mut square = Square::new();
    let positions = meshopt::encode_vertex_buffer(&CORNERS).unwrap();
    let view = square.view(&positions, 4, 12, attributes("NONE"));
    square.attribute("POSITION", view, 5126, "VEC3");
    let indices = meshopt::encode_index_buffer(&INDICES, 4).unwrap();
    let view = square.view(&indices, 6, 2, json!({ "mode": "TRIANGLES" }));
    square.indices(view, 5123);
    square.finish()
}

fn corners(scene: &Scene) -> Vec<Vec3> {
    let mesh = &scene.meshes[0];
    mesh.indices.iter().map(|&i| mesh.positions[i as usize]).collect()
}

#[test]
fn compressed_positions_and_triangles_are_decoded() {
    let scene = square().load().unwrap();
    let expected: Vec<Vec3> = INDICES.iter().map(|&i| CORNERS[i as usize].into()).collect();
    // The codec may rotate the corners of a triangle.
    for (got, expected) in corners(&scene).chunks(3).zip(expected.chunks(3)) {
        assert!(
            (0..3).any(|turn| (0..3).all(|i| got[i] == expected[(i + turn) % 3])),
            "{got:?} {expected:?}"
        );
    }
    // Also with the newer name of the extension.
    let mut file = square();
    let text = file.json.to_string().replace("EXT_meshopt", "KHR_meshopt");
    file.json = serde_json::from_str(&text).unwrap();
    assert_eq!(file.load().unwrap().meshes, scene.meshes);
}

#[test]
fn four_byte_index_sequences_are_decoded() {
    let mut square = Square::new();
    let positions = meshopt::encode_vertex_buffer(&CORNERS).unwrap();
    let view = square.view(&positions, 4, 12, attributes("NONE"));
    square.attribute("POSITION", view, 5126, "VEC3");
    let indices = meshopt::encode_index_sequence(&INDICES, 4).unwrap();
    let view = square.view(&indices, 6, 4, json!({ "mode": "INDICES" }));
    square.indices(view, 5125);
    let scene = square.finish().load().unwrap();
    let expected: Vec<Vec3> = INDICES.iter().map(|&i| CORNERS[i as usize].into()).collect();
    assert_eq!(corners(&scene), expected);
}

#[test]
fn meshopt_filters_are_decoded() {
    let mut square = Square::new();
    let floats: Vec<f32> = CORNERS.as_flattened().to_vec();
    let exponents = meshopt::encode_filter_exp::<3>(&CORNERS, 16, meshopt::EncodeExpMode::Separate);
    assert_eq!(exponents.len() * 3, floats.len());
    let encoded = meshopt::encode_vertex_buffer(&exponents).unwrap();
    let view = square.view(&encoded, 4, 12, attributes("EXPONENTIAL"));
    square.attribute("POSITION", view, 5126, "VEC3");

    let normals = [
        [0.6_f32, 0.0, 0.8, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, -0.6, 0.8, 0.0],
        [0.0, 0.0, -1.0, 0.0],
    ];
    let octahedra = meshopt::encode_filter_oct::<i8>(&normals, 8);
    let encoded = meshopt::encode_vertex_buffer(&octahedra).unwrap();
    let view = square.view(&encoded, 4, 4, attributes("OCTAHEDRAL"));
    square.attribute("NORMAL", view, 5120, "VEC3");
    let octahedra = meshopt::encode_filter_oct::<i16>(&normals, 16);
    let encoded = meshopt::encode_vertex_buffer(&octahedra).unwrap();
    let view = square.view(&encoded, 4, 8, attributes("OCTAHEDRAL"));
    square.attribute("TANGENT", view, 5122, "VEC4");

    // The quaternions are stored as colours, the only attribute of four numbers, so they are within
    // 0 and 1.
    let turns = [
        [0.5_f32, 0.5, 0.5, 0.5],
        [0.0, 0.6, 0.0, 0.8],
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let quaternions = meshopt::encode_filter_quat(&turns, 16);
    let encoded = meshopt::encode_vertex_buffer(&quaternions).unwrap();
    let view = square.view(&encoded, 4, 8, attributes("QUATERNION"));
    square.attribute("COLOR_0", view, 5122, "VEC4");

    let scene = square.finish().load().unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions, CORNERS.map(Vec3::from_array));
    for i in 0..4 {
        let normal = Vec3::from_slice(&normals[i][..3]);
        assert!((mesh.normals[i] - normal).length() < 0.02, "{}", mesh.normals[i]);
        assert!((mesh.tangents[i].truncate() - normal).length() < 1e-3, "{}", mesh.tangents[i]);
        for (got, expected) in mesh.colors[i].to_array().iter().zip(turns[i]) {
            assert!((got - expected).abs() < 1e-3, "{} {:?}", mesh.colors[i], turns[i]);
        }
    }
}

#[test]
fn the_colour_filter_is_decoded() {
    let mut square = Square::new();
    let positions = meshopt::encode_vertex_buffer(&CORNERS).unwrap();
    let view = square.view(&positions, 4, 12, attributes("NONE"));
    square.attribute("POSITION", view, 5126, "VEC3");
    let colors = [[1.0_f32, 0.5, 0.25, 1.0], [0.0, 0.0, 0.0, 0.5], [0.2, 0.9, 0.4, 1.0], [1.0; 4]];
    let encoded = meshopt::encode_filter_color::<u16>(&colors, 16);
    let encoded = meshopt::encode_vertex_buffer(&encoded).unwrap();
    let view = square.view(&encoded, 4, 8, attributes("COLOR"));
    square.attribute("COLOR_0", view, 5123, "VEC4");
    let uvs: [[u16; 2]; 4] = [[0, 0], [65_535, 0], [65_535, 65_535], [0, 65_535]];
    let encoded = meshopt::encode_vertex_buffer(&uvs).unwrap();
    let view = square.view(&encoded, 4, 4, attributes("NONE"));
    square.attribute("TEXCOORD_0", view, 5123, "VEC2");
    square.file.json["meshes"][0]["primitives"][0]["mode"] = json!(6);
    let scene = square.finish().load().unwrap();
    let mesh = &scene.meshes[0];
    // A fan without normals has another order of corners.
    for (position, (color, uv)) in mesh.positions.iter().zip(mesh.colors.iter().zip(&mesh.uvs)) {
        let i = CORNERS.iter().position(|corner| Vec3::from(*corner) == *position).unwrap();
        for (got, expected) in color.to_array().iter().zip(colors[i]) {
            assert!((got - expected).abs() < 1e-3, "{color} {:?}", colors[i]);
        }
        assert_eq!(*uv, Vec2::new(position.x, position.y) / 2.0);
    }
}

#[test]
fn invalid_meshopt_streams_are_refused() {
    let fault = |change: &dyn Fn(&mut Value)| {
        let mut file = square();
        change(&mut file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
        let error = file.load().unwrap_err().to_string();
        assert!(error.contains("buffer view 0, its meshopt compression"), "{error}");
        error
    };
    assert!(fault(&|e| e["count"] = json!(1_u64 << 40)).contains("cannot hold"));
    assert!(fault(&|e| e["count"] = json!(u64::MAX)).contains("cannot hold"));
    fault(&|e| e["count"] = json!(3));
    assert!(fault(&|e| e["byteStride"] = json!(6)).contains("multiple of 4"));
    assert!(fault(&|e| e["byteStride"] = json!(260)).contains("multiple of 4"));
    assert!(fault(&|e| e["byteStride"] = Value::Null).contains("missing"));
    assert!(fault(&|e| e["buffer"] = json!(9)).contains("do not fit"));
    assert!(fault(&|e| e["byteLength"] = json!(9_999)).contains("do not fit"));
    assert!(fault(&|e| e["mode"] = json!("MAGIC")).contains("mode"));
    assert!(fault(&|e| e["filter"] = json!("OCTAHEDRAL")).contains("filter"));
    fault(&|e| e["mode"] = json!("TRIANGLES"));
    fault(&|e| e["byteLength"] = json!(5));
    // A buffer without bytes must be a fallback buffer.
    let mut file = square();
    file.json["bufferViews"][0].as_object_mut().unwrap().remove("extensions");
    assert!(file.load().unwrap_err().to_string().contains("buffer 1"));
}

/// A buffer whose views are all compressed is not read, whether or not it is marked or its file
/// exists.
#[test]
fn fallback_buffers_are_never_read() {
    let expected = square().load().unwrap().meshes;
    let mut unmarked = square();
    unmarked.json["buffers"][1].as_object_mut().unwrap().remove("extensions");
    assert_eq!(unmarked.load().unwrap().meshes, expected);
    for marked in [true, false] {
        let mut missing = if marked { square() } else { unmarked.clone() };
        missing.json["buffers"][1]["uri"] = json!("gone.bin");
        assert_eq!(missing.load().unwrap().meshes, expected);
    }
    // A stream may be in a buffer whose views are all compressed.
    let mut mixed = unmarked;
    for view in mixed.json["bufferViews"].as_array_mut().unwrap() {
        view["buffer"] = json!(0);
    }
    mixed.json["buffers"].as_array_mut().unwrap().pop();
    assert_eq!(mixed.load().unwrap().meshes, expected);
}

#[test]
fn flipped_bytes_never_panic() {
    let mut file = square();
    // The streams are in the first buffer, the only one with bytes.
    file.json["bufferViews"].as_array_mut().unwrap().push(json!({
        "buffer": 0, "byteOffset": 0, "byteLength": file.binary.len(),
    }));
    flip_bytes(&file, 2, 1000);
}
