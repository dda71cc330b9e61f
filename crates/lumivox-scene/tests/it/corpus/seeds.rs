//! Small files with all that the loaders read, for a fuzzer to start from.

use lumivox_scene::builtin;
use serde_json::{Value, json};

use super::shapes;
use crate::common::{File, data_uri, encode, png};

/// Target, file name, bytes.
pub fn all() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let panel = builtin::scene("panel").unwrap();
    let mut seeds = vec![
        ("glb", "everything.glb", everything().glb()),
        ("glb", "panel.glb", panel.to_glb().unwrap()),
        ("glb", "triangle.glb", File::triangle().glb()),
        ("gltf", "everything.gltf", everything().embedded()),
        ("gltf", "triangle.gltf", File::triangle().embedded()),
        ("gltf", "zeros.gltf", zeros()),
        ("obj", "mixes.obj", shapes::OBJ.to_vec()),
        ("obj", "plain.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec()),
        ("mtl", "phong.mtl", shapes::PHONG.to_vec()),
        ("mtl", "pbr.mtl", shapes::PBR.to_vec()),
        ("ply", "ascii.ply", shapes::ASCII_PLY.to_vec()),
        ("ply", "little.ply", shapes::binary_ply("binary_little_endian", u32::to_le_bytes)),
        ("ply", "big.ply", shapes::binary_ply("binary_big_endian", u32::to_be_bytes)),
        ("ply", "strip.ply", shapes::STRIP_PLY.to_vec()),
        ("stl", "ascii.stl", shapes::ASCII_STL.to_vec()),
        ("stl", "binary.stl", shapes::binary_stl()),
        ("vxct", "everything.scene", shapes::VXCT.to_vec()),
        ("vxct", "empty.scene", b"scene { }\n".to_vec()),
        ("environment", "sky.hdr", hdr()),
        ("environment", "rle.hdr", RUN_LENGTHS.to_vec()),
        ("environment", "half.exr", exr(exr::prelude::Encoding::FAST_LOSSLESS)),
        ("environment", "zip.exr", exr(exr::prelude::Encoding::SMALL_LOSSLESS)),
        ("environment", "plain.exr", exr(exr::prelude::Encoding::UNCOMPRESSED)),
        ("environment", "picture.png", png(4, 2, &[99; 32])),
        // Decisions of `fuzz/mutate.rs`; its file is the real seed.
        ("glb_structured", "none", vec![0]),
        ("glb_structured", "some", (0..64_u8).map(|i| i.wrapping_mul(37)).collect()),
        ("draco", "grid.drc", include_bytes!("../../data/grid.drc").to_vec()),
        ("image", "etc1s.ktx2", include_bytes!("../../data/ramp-etc1s.ktx2").to_vec()),
        ("image", "uastc.ktx2", include_bytes!("../../data/ramp-uastc-zstd.ktx2").to_vec()),
        ("image", "astc.ktx2", include_bytes!("../../data/ramp-astc.ktx2").to_vec()),
        ("image", "grey.jpg", grey_jpeg()),
        ("image", "colors.png", png(4, 4, &[123; 64])),
        ("image", "colors.webp", webp()),
    ];
    seeds.extend(meshopt());
    seeds
}

fn grey_jpeg() -> Vec<u8> {
    let grey = image::GrayImage::from_fn(8, 8, |x, y| image::Luma([(x * y) as u8]));
    encode(&grey.into(), image::ImageFormat::Jpeg)
}

fn webp() -> Vec<u8> {
    let colors = image::RgbaImage::from_fn(4, 4, |x, y| image::Rgba([x as u8, y as u8, 7, 99]));
    encode(&colors.into(), image::ImageFormat::WebP)
}

/// Streams behind the four bytes that `fuzz/wrap.rs` reads: mode, filter, stride, count.
fn meshopt() -> Vec<(&'static str, &'static str, Vec<u8>)> {
    let corners = [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
    let wide = corners.map(|[x, y, z]| [x, y, z, 1.0]);
    let indices = [0, 1, 2, 0, 2, 3];
    let stream = |head: [u8; 4], stream: Vec<u8>| [head.to_vec(), stream].concat();
    let triangles = meshopt::encode_index_buffer(&indices, 4).unwrap();
    let vertices = meshopt::encode_vertex_buffer(&corners).unwrap();
    let filtered = meshopt::encode_vertex_buffer(&wide).unwrap();
    vec![
        ("meshopt", "vertices", stream([0, 0, 12, 4], vertices)),
        ("meshopt", "exponential", stream([0, 3, 16, 4], filtered)),
        ("meshopt", "triangles", stream([1, 0, 2, 6], triangles)),
    ]
}

/// A Radiance picture of 4 x 2 texels.
fn hdr() -> Vec<u8> {
    let texels: Vec<_> = (0..8).map(|i| image::Rgb([i as f32, 0.5, 1000.0])).collect();
    let mut bytes = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&texels, 4, 2).unwrap();
    bytes
}

/// One of 8 x 1 texels with an exposure, in packed runs.
const RUN_LENGTHS: &[u8] = b"#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\
    \x02\x02\x00\x08\x88\x50\x88\x60\x84\x70\x04\x01\x02\x03\x04\x88\x81";

fn exr(encoding: exr::prelude::Encoding) -> Vec<u8> {
    use exr::prelude::*;
    let texel = |at: Vec2<usize>| (at.x() as f32, f16::from_f32(0.5), at.y() as f32);
    let layer =
        Layer::new((8, 4), LayerAttributes::named("sky"), encoding, SpecificChannels::rgb(texel));
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Accessors without data, and an image beside them.
fn zeros() -> Vec<u8> {
    let mut file = File::triangle();
    let uvs = file.push("accessors", json!({ "componentType": 5126, "count": 3, "type": "VEC2" }));
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uvs);
    file.push("images", json!({ "uri": data_uri("image/png", &png(1, 1, &[9; 4])) }));
    file.push("textures", json!({ "source": 0 }));
    file.push(
        "materials",
        json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }),
    );
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file.embedded()
}

/// Every part of glTF that the loader knows, and of its extensions, in one file.
fn everything() -> File {
    let mut file = File::new();
    images(&mut file);
    materials(&mut file);
    let plain = meshes(&mut file);
    nodes(&mut file, plain);
    animations(&mut file);
    let mut used = std::collections::BTreeSet::new();
    collect_extensions(&file.json, &mut used);
    file.json["extensionsUsed"] = json!(used);
    file
}

fn collect_extensions(json: &Value, used: &mut std::collections::BTreeSet<String>) {
    match json {
        Value::Object(object) => {
            if let Some(Value::Object(extensions)) = object.get("extensions") {
                used.extend(extensions.keys().cloned());
            }
            object.values().for_each(|value| collect_extensions(value, used));
        }
        Value::Array(list) => list.iter().for_each(|value| collect_extensions(value, used)),
        _ => {}
    }
}

fn images(file: &mut File) {
    let colors: Vec<u8> = (0..64).map(|i| i * 4 + 1).collect();
    let view = file.view(&png(4, 4, &colors));
    file.push("images", json!({ "bufferView": view, "mimeType": "image/png", "name": "colors" }));
    let view = file.view(&grey_jpeg());
    file.push("images", json!({ "bufferView": view, "mimeType": "image/jpeg" }));
    let deep = image::ImageBuffer::from_fn(2, 2, |x, _| image::Rgb([x as u16 * 30_000, 7, 65_535]));
    let view = file.view(&encode(&image::DynamicImage::ImageRgb16(deep), image::ImageFormat::Png));
    file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    file.push(
        "samplers",
        json!({ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9985 }),
    );
    for source in 0..3 {
        file.push("textures", json!({ "source": source, "sampler": 0 }));
    }
}

fn materials(file: &mut File) {
    let transform = json!({ "KHR_texture_transform": {
        "offset": [0.1, 0.2], "rotation": 0.5, "scale": [2, 3], "texCoord": 1,
    } });
    file.push("materials", json!({
        "name": "layers",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.6, 0.7, 0.8], "metallicFactor": 0.25, "roughnessFactor": 0.5,
            "baseColorTexture": { "index": 0, "extensions": transform },
            "metallicRoughnessTexture": { "index": 1, "texCoord": 1 },
        },
        "normalTexture": { "index": 2, "scale": 0.5 },
        "occlusionTexture": { "index": 1, "strength": 0.5 },
        "emissiveFactor": [1, 0.5, 0], "emissiveTexture": { "index": 0 },
        "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 5 },
            "KHR_materials_ior": { "ior": 1.4 },
            "KHR_materials_specular": {
                "specularFactor": 0.5, "specularColorFactor": [1, 0.5, 2],
                "specularTexture": { "index": 1 }, "specularColorTexture": { "index": 0 },
            },
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25,
                "clearcoatTexture": { "index": 1 }, "clearcoatRoughnessTexture": { "index": 0 },
                "clearcoatNormalTexture": { "index": 2 },
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": [0.5, 0.25, 0], "sheenRoughnessFactor": 0.5,
                "sheenColorTexture": { "index": 0 }, "sheenRoughnessTexture": { "index": 1 },
            },
            "KHR_materials_transmission": {
                "transmissionFactor": 0.5, "transmissionTexture": { "index": 0 },
            },
            "KHR_materials_volume": { "thicknessFactor": 1 },
        },
    }));
    file.push(
        "materials",
        json!({
            "name": "gloss", "alphaMode": "BLEND",
            "extensions": { "KHR_materials_pbrSpecularGlossiness": {
                "diffuseFactor": [0.5, 0.5, 0.5, 0.5], "specularFactor": [0.2, 0.3, 0.4],
                "glossinessFactor": 0.5, "diffuseTexture": { "index": 0 },
                "specularGlossinessTexture": { "index": 0 },
            } },
        }),
    );
    file.push(
        "materials",
        json!({
            "name": "unlit", "extensions": { "KHR_materials_unlit": {} },
        }),
    );
    file.push(
        "materials",
        json!({
            "name": "phong", "extras": { "lumivox": { "phong": { "shininess": 20 } } },
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 } },
        }),
    );
}

/// Floats of one kind for each vertex.
fn attribute<const N: usize>(file: &mut File, f: impl Fn(usize) -> [f32; N]) -> usize {
    file.vectors(&(0..6).map(f).collect::<Vec<_>>())
}

/// Integers of one kind for each vertex.
fn packed(file: &mut File, component: u32, kind: &str, normalized: bool, bytes: &[u8]) -> usize {
    let view = file.view(bytes);
    file.json["bufferViews"][view]["byteStride"] = json!(bytes.len() / 6);
    let accessor = file.accessor(view, component, 6, kind);
    file.json["accessors"][accessor]["normalized"] = json!(normalized);
    accessor
}

fn meshes(file: &mut File) -> usize {
    let corner = |i: usize| [(i % 3) as f32, (i / 3) as f32, (i * i) as f32 * 0.1];
    let positions = attribute(file, corner);
    let normals = attribute(file, |_| [0.0, 0.0, 1.0]);
    let tangents = attribute(file, |_| [1.0, 0.0, 0.0, -1.0]);
    let uvs = attribute(file, |i| [i as f32 * 0.3, 0.5]);
    let uvs1 = packed(file, 5123, "VEC2", true, &[128; 24]);
    let colors = packed(file, 5121, "VEC4", true, &[200; 24]);
    let joints = packed(file, 5121, "VEC4", false, &[0, 1, 0, 1].repeat(6));
    let weights = attribute(file, |i| [1.0 - i as f32 * 0.1, i as f32 * 0.1, 0.0, 0.0]);
    let indices = file.indices(&[0, 1, 3, 3, 1, 4, 1, 2, 4]);
    let bytes = file.view(&[0, 1, 3, 4, 2, 5]);
    let strip = file.accessor(bytes, 5121, 6, "SCALAR");

    // One of the morph target's positions moves.
    let numbers = file.view(&2_u32.to_le_bytes());
    let values = file.view(&[0.5_f32, 1.0, 0.25].map(f32::to_le_bytes).concat());
    let sparse = file.push(
        "accessors",
        json!({
            "componentType": 5126, "count": 6, "type": "VEC3",
            "sparse": {
                "count": 1,
                "indices": { "bufferView": numbers, "componentType": 5125 },
                "values": { "bufferView": values },
            },
        }),
    );
    let quantized =
        packed(file, 5122, "VEC3", false, &(0..48).map(|i| i * 5 % 7).collect::<Vec<_>>());
    let all = json!({
        "POSITION": positions, "NORMAL": normals, "TANGENT": tangents, "TEXCOORD_0": uvs,
        "TEXCOORD_1": uvs1, "COLOR_0": colors,
    });
    let plain = file.mesh(json!({ "attributes": all, "indices": indices, "material": 0 }));
    let primitives = file.json["meshes"][plain]["primitives"].as_array_mut().unwrap();
    primitives.push(json!({ "attributes": { "POSITION": positions, "TEXCOORD_0": uvs },
        "indices": strip, "mode": 5, "material": 1 }));
    primitives.push(json!({ "attributes": { "POSITION": positions }, "mode": 6, "material": 2 }));
    primitives
        .push(json!({ "attributes": { "POSITION": positions, "TEXCOORD_0": uvs }, "material": 3 }));
    primitives.push(json!({ "attributes": { "POSITION": positions }, "mode": 1 }));

    let mut skinned = all;
    skinned["JOINTS_0"] = json!(joints);
    skinned["WEIGHTS_0"] = json!(weights);
    let skinned = file.mesh(json!({
        "attributes": skinned, "indices": indices, "material": 0,
        "targets": [{ "POSITION": sparse, "NORMAL": normals }],
    }));
    file.json["meshes"][skinned]["weights"] = json!([0.5]);
    file.mesh(json!({ "attributes": { "POSITION": quantized }, "indices": indices }));
    plain
}

fn nodes(file: &mut File, plain: usize) {
    let bind: Vec<f32> = glam::Mat4::IDENTITY.to_cols_array().repeat(2);
    let view = file.view(&bind.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>());
    let bind = file.accessor(view, 5126, 2, "MAT4");
    let moved = attribute(file, |i| [i as f32, 0.0, 0.0]);

    file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }),
    );
    file.push("cameras", json!({
        "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1 },
    }));
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "intensity": 10, "extras": { "lumivox": { "angularRadiusRad": 0.01 } } },
        { "type": "point", "color": [1, 0.5, 0], "range": 5,
          "extras": { "lumivox": { "radiusM": 0.1, "colorScale": 2 } } },
        { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.5 } },
    ] } });

    let elbow = file.node(json!({ "name": "elbow", "translation": [0, 1, 0] }), false);
    let shoulder = file.node(json!({ "name": "shoulder", "children": [elbow] }), true);
    file.push(
        "skins",
        json!({ "joints": [shoulder, elbow], "inverseBindMatrices": bind, "skeleton": shoulder }),
    );
    file.node(json!({ "name": "arm", "mesh": 1, "skin": 0, "weights": [0.25] }), true);
    let mut children = Vec::new();
    for light in 0..3 {
        children.push(file.node(
            json!({
                "extensions": { "KHR_lights_punctual": { "light": light } },
                "rotation": [0.5, 0.5, 0.5, 0.5],
            }),
            false,
        ));
    }
    for camera in 0..2 {
        children.push(file.node(json!({ "camera": camera, "translation": [0, 0, 5] }), false));
    }
    file.node(
        json!({ "name": "root", "mesh": plain, "scale": [-1, 2, 1], "children": children }),
        true,
    );
    file.node(
        json!({ "mesh": 2, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1] }),
        true,
    );
    file.node(
        json!({
            "mesh": plain,
            "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": moved } } },
        }),
        true,
    );

    let texels = file.view(&[0.5_f32; 6].map(f32::to_le_bytes).concat());
    file.json["scenes"][0]["extras"] = json!({ "lumivox": { "environment": {
        "radiance": [1, 2, 3], "rotationRad": 0.5,
        "map": { "bufferView": texels, "width": 2, "height": 1, "name": "sky" },
    } } });
    file.push("scenes", json!({ "name": "other", "nodes": [elbow] }));
}

fn animations(file: &mut File) {
    let scalars = |file: &mut File, values: &[f32]| {
        let view = file.view(&values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>());
        file.accessor(view, 5126, values.len(), "SCALAR")
    };
    let times = scalars(file, &[0.0, 0.5, 1.0]);
    let weights = scalars(file, &[0.0, 1.0, 0.5]);
    let places = file.vectors(&[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]);
    let turns = file.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.6, 0.8], [0.0, 1.0, 0.0, 0.0]]);
    let cubic = file.vectors(&[[0.5_f32, 1.0, 1.5]; 9]);
    let sampler = |output: usize, interpolation: &str| json!({ "input": times, "output": output, "interpolation": interpolation });
    let samplers = [
        sampler(places, "LINEAR"),
        sampler(turns, "LINEAR"),
        sampler(cubic, "CUBICSPLINE"),
        sampler(weights, "STEP"),
    ];
    let channel = |sampler: usize, node: usize, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
    let channels = [
        channel(0, 0, "translation"),
        channel(1, 0, "rotation"),
        channel(2, 1, "scale"),
        channel(3, 2, "weights"),
        channel(1, 3, "rotation"),
        channel(0, 6, "translation"),
    ];
    file.push("animations", json!({ "name": "bend", "samplers": samplers, "channels": channels }));
}
