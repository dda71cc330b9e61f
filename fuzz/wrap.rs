//! glTF documents around compressed data, so that a fuzzer's bytes go only to the decoders.

use serde_json::{Value, json};

/// The least of a document, with the data as its first buffer.
fn document(data: &[u8], extension: &str) -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "buffers": [{ "uri": "data.bin", "byteLength": data.len() }],
        "extensionsUsed": [extension],
    })
}

fn add_buffer(document: &mut Value, buffer: Value) {
    if let Some(buffers) = document["buffers"].as_array_mut() {
        buffers.push(buffer);
    }
}

/// Data are a Draco stream; its attributes have the numbers of `corpus/draco/grid.drc`.
pub fn draco(data: &[u8]) -> Value {
    let mut json = document(data, "KHR_draco_mesh_compression");
    json["bufferViews"] = json!([{ "buffer": 0, "byteLength": data.len() }]);
    json["accessors"] = json!([
        { "componentType": 5125, "count": 1, "type": "SCALAR" },
        { "componentType": 5126, "count": 1, "type": "VEC3" },
        { "componentType": 5126, "count": 1, "type": "VEC3" },
        { "componentType": 5126, "count": 1, "type": "VEC2" },
        { "componentType": 5121, "count": 1, "type": "VEC4" },
    ]);
    json["meshes"] = json!([{ "primitives": [{
        "attributes": { "POSITION": 1, "NORMAL": 2, "TEXCOORD_0": 3, "COLOR_0": 4 },
        "indices": 0,
        "extensions": { "KHR_draco_mesh_compression": {
            "bufferView": 0,
            "attributes": { "POSITION": 3, "NORMAL": 2, "TEXCOORD_0": 1, "COLOR_0": 0 },
        } },
    }] }]);
    json
}

/// Data begin with a byte each for the mode, the filter, the stride and the count; the rest is the
/// stream.
pub fn meshopt(data: &[u8]) -> Value {
    let head = |at: usize| usize::from(data.get(at).copied().unwrap_or(0));
    let mode = ["ATTRIBUTES", "TRIANGLES", "INDICES"][head(0) % 3];
    let filter = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"][head(1) % 4];
    let (stride, count) = (head(2), head(3));
    let stream = data.len().saturating_sub(4);
    let mut json = document(data, "EXT_meshopt_compression");
    let fallback = json!({ "EXT_meshopt_compression": { "fallback": true } });
    add_buffer(&mut json, json!({ "byteLength": stride * count, "extensions": fallback }));
    json["bufferViews"] = json!([{
        "buffer": 1, "byteLength": stride * count,
        "extensions": { "EXT_meshopt_compression": {
            "buffer": 0, "byteOffset": 4, "byteLength": stream, "byteStride": stride,
            "count": count, "mode": mode, "filter": filter,
        } },
    }]);
    let is_attribute = mode == "ATTRIBUTES";
    if is_attribute {
        json["bufferViews"][0]["byteStride"] = json!(stride);
    }
    let (component, kind) = if is_attribute { (5126, "VEC3") } else { (5123, "SCALAR") };
    json["accessors"] = json!([
        { "bufferView": 0, "componentType": component, "count": count, "type": kind },
        { "componentType": 5126, "count": 16, "type": "VEC3" },
    ]);
    json["meshes"] = json!([{ "primitives": [if is_attribute {
        json!({ "attributes": { "POSITION": 0 } })
    } else {
        json!({ "attributes": { "POSITION": 1 }, "indices": 0 })
    }] }]);
    json
}

/// Data are an image of any kind.
pub fn image(data: &[u8]) -> Value {
    let mut json = document(data, "KHR_texture_basisu");
    // (0, 0, 0), (1, 0, 0), (0, 1, 0)
    let corners = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let uri = format!("data:application/octet-stream;base64,{corners}");
    add_buffer(&mut json, json!({ "uri": uri, "byteLength": 36 }));
    json["bufferViews"] = json!([{ "buffer": 1, "byteLength": 36 }]);
    json["accessors"] =
        json!([{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }]);
    json["images"] = json!([{ "uri": "data.bin" }]);
    json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    json["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    json["meshes"] =
        json!([{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }]);
    json
}
