//! Makes small glTF files in memory and on disk.

pub mod tube;

use std::path::{Path, PathBuf};

use glam::Vec3;
use lumivox_scene::{LoadOptions, MetallicRoughness, Scene, SceneError, Shading};
use serde_json::{Value, json};

/// A glTF document being built: JSON, and the bytes of its only buffer.
#[derive(Clone)]
pub struct File {
    pub json: Value,
    pub binary: Vec<u8>,
}

impl File {
    /// An empty document.
    pub fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [] }],
            "nodes": [], "meshes": [], "accessors": [], "bufferViews": [], "materials": [],
            "textures": [], "images": [], "samplers": [], "cameras": [],
        });
        Self { json, binary: Vec::new() }
    }

    /// One triangle in the xy plane that faces +z, with 16-bit indices.
    pub fn triangle() -> Self {
        let mut file = Self::new();
        let positions = file.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let indices = file.indices(&[0, 1, 2]);
        let mesh =
            file.mesh(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
        file.node(json!({ "name": "stand", "mesh": mesh }), true);
        file
    }

    /// Appends to one of the document's lists, and returns the index.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    /// Adds a buffer view of these bytes, aligned to four.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let offset = self.binary.len();
        self.binary.extend(bytes);
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        self.push("bufferViews", view)
    }

    /// Adds an accessor of float vectors.
    pub fn vectors<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessor(view, 5126, values.len(), &format!("VEC{N}"))
    }

    /// Adds an accessor of 16-bit indices.
    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessor(view, 5123, values.len(), "SCALAR")
    }

    pub fn accessor(&mut self, view: usize, component: u32, count: usize, kind: &str) -> usize {
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }),
        )
    }

    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "name": "thing", "primitives": [primitive] }))
    }

    /// Adds an accessor of single floats.
    pub fn floats(&mut self, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessor(view, 5126, values.len(), "SCALAR")
    }

    /// Adds an animation whose channels (node, path, interpolation, values) share their times.
    pub fn animation(
        &mut self,
        name: &str,
        times_s: &[f32],
        channels: &[(usize, &str, &str, usize)],
    ) -> usize {
        let input = self.floats(times_s);
        let (samplers, channels): (Vec<_>, Vec<_>) = channels
            .iter()
            .enumerate()
            .map(|(i, (node, path, interpolation, output))| {
                (
                    json!({ "input": input, "output": output, "interpolation": interpolation }),
                    json!({ "sampler": i, "target": { "node": node, "path": path } }),
                )
            })
            .unzip();
        let animation = json!({ "name": name, "samplers": samplers, "channels": channels });
        self.push("animations", animation)
    }

    /// Adds a node, which is a root of the scene if `root`.
    pub fn node(&mut self, node: Value, root: bool) -> usize {
        let index = self.push("nodes", node);
        if root {
            self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        }
        index
    }

    /// The JSON, without empty lists, and with the buffer.
    fn document(&self, uri: Option<&str>) -> Vec<u8> {
        let mut json = self.json.clone();
        let object = json.as_object_mut().unwrap();
        object.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        if !self.binary.is_empty() && !object.contains_key("buffers") {
            let mut buffer = json!({ "byteLength": self.binary.len() });
            if let Some(uri) = uri {
                buffer["uri"] = json!(uri);
            }
            object.insert("buffers".to_owned(), json!([buffer]));
        }
        serde_json::to_vec(&json).unwrap()
    }

    pub fn glb(&self) -> Vec<u8> {
        let mut document = self.document(None);
        document.resize(document.len().next_multiple_of(4), b' ');
        let mut binary = self.binary.clone();
        binary.resize(binary.len().next_multiple_of(4), 0);
        let mut glb = b"glTF".to_vec();
        let word =
            |glb: &mut Vec<u8>, n: usize| glb.extend(u32::try_from(n).unwrap().to_le_bytes());
        word(&mut glb, 2);
        word(&mut glb, 12 + 8 + document.len() + 8 + binary.len());
        word(&mut glb, document.len());
        glb.extend(b"JSON");
        glb.extend(&document);
        word(&mut glb, binary.len());
        glb.extend(b"BIN\0");
        glb.extend(&binary);
        glb
    }

    /// JSON with the buffer as a data URI.
    pub fn embedded(&self) -> Vec<u8> {
        self.document(Some(&data_uri("application/octet-stream", &self.binary)))
    }

    /// JSON that refers to the buffer's file.
    pub fn naming(&self, uri: &str) -> Vec<u8> {
        self.document(Some(uri))
    }

    pub fn load(&self) -> Result<Scene, SceneError> {
        load("scene.glb", &self.glb())
    }
}

/// The error of loading, which must name the file.
pub fn fault(file: &File) -> String {
    let error = file.load().unwrap_err().to_string();
    assert!(error.contains("scene.glb: "), "{error}");
    error
}

/// Writes the bytes to a fresh folder and loads them.
pub fn load(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    Scene::load(write(folder.path(), name, bytes))
}

/// Loads the bytes from memory, for tests that load thousands of files.
pub fn load_from_memory(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    Scene::from_memory(name, bytes, &mut LoadOptions::default())
}

pub fn write(folder: &Path, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

pub fn data_uri(kind: &str, bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = format!("data:{kind};base64,");
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize];
            text.push(if i <= group.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

/// A PNG of these texels.
pub fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let image = image::RgbaImage::from_raw(width, height, rgba.to_vec()).unwrap();
    encode(&image::DynamicImage::from(image), image::ImageFormat::Png)
}

pub fn encode(image: &image::DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// The corners of each triangle in world space, with the world normal of the first.
pub fn world_triangles(scene: &Scene) -> Vec<([Vec3; 3], Vec3)> {
    let mut triangles = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let m = instance.world_from_local;
        let normal_matrix = m.inverse().transpose();
        for t in mesh.triangles() {
            triangles.push((
                t.map(|i| m.transform_point3(mesh.positions[i])),
                normal_matrix.transform_vector3(mesh.normals[t[0]]).normalize(),
            ));
        }
    }
    triangles
}

/// The properties of a material that must be metallic-roughness.
pub fn shading(scene: &Scene, material: usize) -> MetallicRoughness {
    match scene.materials[material].shading {
        Shading::MetallicRoughness(shading) => shading,
        other => panic!("not metallic-roughness: {other:?}"),
    }
}

/// A cube of 12 triangles with normals, texture coordinates, and a texture from an image view.
pub fn textured_cube() -> File {
    let mut file = File::new();
    let (mut positions, mut normals, mut uvs, mut indices) = (vec![], vec![], vec![], vec![]);
    for axis in 0..3 {
        for side in [-1.0, 1.0_f32] {
            let mut normal = [0.0; 3];
            normal[axis] = side;
            let n = Vec3::from_array(normal);
            let u = n.any_orthonormal_vector();
            let v = n.cross(u);
            let first = u16::try_from(positions.len()).unwrap();
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                positions.push((n + u * a + v * b).to_array());
                normals.push(normal);
                uvs.push([0.5 + a * 0.5, 0.5 - b * 0.5]);
            }
            indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        }
    }
    let (positions, normals) = (file.vectors(&positions), file.vectors(&normals));
    let (uvs, indices) = (file.vectors(&uvs), file.indices(&indices));
    let texels = [255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 9, 8, 7, 6];
    let view = file.view(&png(2, 2, &texels));
    let image = file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    let sampler = json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987 });
    let sampler = file.push("samplers", sampler);
    let texture = file.push("textures", json!({ "source": image, "sampler": sampler }));
    let material = file.push(
        "materials",
        json!({
            "name": "paint",
            "pbrMetallicRoughness": {
                "baseColorTexture": { "index": texture },
                "metallicFactor": 0.25,
                "roughnessFactor": 0.5,
            },
            "normalTexture": { "index": texture, "scale": 0.5 },
            "alphaMode": "MASK", "alphaCutoff": 0.3,
            "doubleSided": true,
        }),
    );
    let mesh = file.mesh(json!({
        "attributes": { "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs },
        "indices": indices, "material": material,
    }));
    file.node(json!({ "mesh": mesh }), true);
    file
}

/// Loads copies with some random bytes of a buffer view changed, which must not panic. A linear
/// congruential generator (Knuth 1998, volume 2, section 3.3.4) makes failures repeatable.
pub fn flip_bytes(original: &File, view: usize, times: usize) {
    let number = |key: &str| original.json["bufferViews"][view][key].as_u64().unwrap() as usize;
    let (begin, length) = (number("byteOffset"), number("byteLength"));
    let whole = original.glb();
    // The binary chunk is at the end of the file.
    let binary = whole.len() - original.binary.len().next_multiple_of(4);
    let mut state = 1_u64;
    let mut draw = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..times {
        let mut bytes = whole.clone();
        for _ in 0..=draw(4) {
            bytes[binary + begin + draw(length)] = draw(256) as u8;
        }
        let _ = load_from_memory("scene.glb", &bytes);
    }
}
