//! Faults that only cost the faulty part: the rest of the scene is shown, with a warning.

use glam::Vec3;
use lumivox_scene::{AlphaMode, LightKind, LoadOptions, Sampler, Scene, SceneError, Wrap};
use serde_json::{Value, json};

use crate::common::{
    File, data_uri, encode, fault, load, load_from_memory, png, textured_cube, world_triangles,
    write,
};

/// The warnings of a file that loads.
fn warnings(file: &File) -> String {
    file.load().unwrap().notes.warnings.join("\n")
}

/// The triangle with a material, which causes no warning.
fn bare_triangle() -> File {
    let mut file = File::triangle();
    file.push("materials", json!({ "name": "paint" }));
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file
}

/// The triangle with colours and normals from these images.
fn painted(color: &Value, normal: &Value) -> File {
    let mut file = File::triangle();
    file.push("images", color.clone());
    file.push("images", normal.clone());
    file.push("textures", json!({ "source": 0 }));
    file.push("textures", json!({ "source": 1 }));
    file.push(
        "materials",
        json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
            "normalTexture": { "index": 1 },
        }),
    );
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file
}

const LFS: &str = "image 0\" cannot be used: it is a pointer of Git LFS in the place of the file";
const CUT: &str = "image \"wood\" cannot be used: it was cut off";
const PAGE: &str = "image 0\" cannot be used: it is a web page";

/// A PNG with a correct header and truncated texels, which is only found while decoding.
fn cut_png() -> Vec<u8> {
    let texels: Vec<u8> = (0..64 * 64 * 4).map(|i| (i * 97 % 251) as u8).collect();
    let whole = png(64, 64, &texels);
    whole[..whole.len() / 2].to_vec()
}

#[test]
fn a_bad_image_is_shown_like_a_missing_one() {
    let good = json!({ "uri": data_uri("image/png", &png(1, 1, &[1, 2, 3, 255])) });
    let missing = painted(&json!({ "uri": "gone.png" }), &good).load().unwrap();
    let wide = encode(&image::GrayImage::new(16_385, 1).into(), image::ImageFormat::Png);
    for (bad, needles) in [
        (json!({ "uri": data_uri("image/png", b"GIF89a no picture") }), "save it as a plain PNG"),
        (json!({ "uri": data_uri("image/png", b"\x89PNG\r\n\x1a\n") }), "download it again"),
        (
            json!({ "uri": data_uri("image/png", b"version https://git-lfs.github.com/spec/v1\n") }),
            LFS,
        ),
        (json!({ "uri": data_uri("image/png", b" <!DOCTYPE html><title>404</title>") }), PAGE),
        (json!({ "name": "wood", "uri": data_uri("image/png", &cut_png()) }), CUT),
        (json!({ "uri": data_uri("image/png", &wide) }), "scale it down"),
        (json!({ "uri": "data:image/png;base64,****" }), "base64"),
        (json!({ "uri": "../outside.png" }), "--allow-outside"),
        (json!({ "name": "nothing" }), "neither"),
        (json!({ "bufferView": 1_000, "mimeType": "image/png" }), "1000 is malformed: it does not"),
    ] {
        let file = painted(&bad, &good);
        let scene = file.load().unwrap();
        assert_eq!(scene.textures, missing.textures, "{bad}");
        assert_eq!(scene.materials, missing.materials, "{bad}");
        let said = scene.notes.warnings.join("\n");
        assert!(said.contains(needles) && said.contains("a stand-in is shown"), "{said}");
        // Saving as a PNG is no remedy for a broken PNG.
        assert!(!(needles == "download it again" && said.contains("PNG or JPEG")), "{said}");

        let scene = painted(&good, &bad).load().unwrap();
        assert_eq!(scene.textures.len(), 1);
        assert!(scene.materials[0].normal_texture.is_none(), "{bad}");
    }
    // Also two bad images, or one image for both.
    let bad = json!({ "uri": data_uri("image/png", &cut_png()) });
    for second in [&bad, &json!({ "uri": data_uri("image/png", b"nothing") })] {
        let scene = painted(&bad, second).load().unwrap();
        assert_eq!(scene.triangle_count(), 1);
        assert_eq!(scene.notes.warnings.len(), 2, "{:?}", scene.notes.warnings);
    }
}

#[test]
fn a_bad_image_falls_back_to_its_alternative() {
    let mut file =
        painted(&json!({ "name": "cut", "uri": data_uri("image/png", &cut_png()) }), &json!({}));
    file.json["materials"][0].as_object_mut().unwrap().remove("normalTexture");
    file.json["images"][1] = json!({ "uri": data_uri("image/png", &png(1, 1, &[7, 8, 9, 255])) });
    file.json["textures"][0] =
        json!({ "source": 1, "extensions": { "EXT_texture_webp": { "source": 0 } } });
    let scene = file.load().unwrap();
    assert_eq!(scene.textures[0].rgba8, [7, 8, 9, 255]);
    let said = scene.notes.warnings.join("\n");
    assert!(said.contains("\"cut\"") && said.contains("as a fallback is used"), "{said}");
}

#[test]
fn a_bad_animation_is_dropped_and_the_mesh_kept() {
    let good = |file: &mut File| {
        let values = file.vectors(&[[0.0; 3], [1.0, 0.0, 0.0]]);
        file.animation("good", &[0.0, 2.0], &[(0, "translation", "LINEAR", values)])
    };
    let bad = |change: fn(&mut Value)| {
        let mut file = File::triangle();
        let values = file.vectors(&[[0.0; 3], [1.0, 0.0, 0.0]]);
        file.animation("bad", &[0.0, 1.0], &[(0, "translation", "LINEAR", values)]);
        change(&mut file.json["animations"][0]);
        good(&mut file);
        file
    };
    let changes: [fn(&mut Value); 13] = [
        |a| a["channels"][0]["target"]["node"] = json!(99),
        |a| a["channels"][0]["sampler"] = json!(9),
        |a| a["samplers"][0]["input"] = json!(99),
        |a| a["samplers"][0]["output"] = json!(99),
        |a| a["samplers"][0]["interpolation"] = json!("BOUNCE"),
        |a| a["samplers"][0] = json!({}),
        |a| a["channels"][0] = json!({ "sampler": 0 }),
        |a| a["channels"] = json!("all of them"),
        |a| a["channels"][0]["target"]["path"] = json!("rotation"),
        |a| a["samplers"][0]["output"] = a["samplers"][0]["input"].clone(),
        |a| a["samplers"][0]["input"] = a["samplers"][0]["output"].clone(),
        |a| *a = json!({ "name": "bad" }),
        |a| a["name"] = json!(7),
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let file = bad(change);
        let scene = file.load().unwrap_or_else(|error| panic!("{index}: {error}"));
        assert_eq!(scene.triangle_count(), 1, "{index}");
        let said = scene.notes.warnings.join("\n");
        assert!(said.contains("left out") && !said.contains("scene.glb"), "{index}: {said}");
        // Animations keep the file's numbers.
        let animations = scene.animations();
        assert_eq!((animations.len(), animations[0].duration_s), (2, 0.0), "{index}");
        assert_eq!((animations[1].name.as_str(), animations[1].duration_s), ("good", 2.0));
    }
    // Other channels of the animation stay.
    let mut file = File::triangle();
    let values = file.vectors(&[[0.0; 3], [f32::NAN, 0.0, 0.0]]);
    let scales = file.vectors(&[[1.0; 3], [2.0; 3]]);
    let channels = [(0, "translation", "LINEAR", values), (0, "scale", "LINEAR", scales)];
    file.animation("half", &[0.0, 1.0], &channels);
    let mut scene = file.load().unwrap();
    let said = scene.notes.warnings.join("\n");
    assert!(said.contains("animation \"half\": 1 of its 2 channels were left out"), "{said}");
    scene.pose(lumivox_scene::AnimationChoice::All, 1.0).unwrap();
    assert_eq!(scene.bounds().max.x, 2.0);
}

#[test]
fn a_scene_need_not_name_nodes() {
    let mut file = File::triangle();
    file.json["scenes"] = json!([{ "name": "full", "nodes": [0] }, { "name": "bare" }]);
    assert_eq!(file.load().unwrap().triangle_count(), 1);
    file.json["scene"] = json!(1);
    assert!(fault(&file).contains("no triangles"), "{}", fault(&file));
    let mut options = LoadOptions { scene: Some("full".to_owned()), ..LoadOptions::default() };
    let scene = Scene::from_memory("scene.glb", &file.glb(), &mut options).unwrap();
    assert_eq!(scene.notes.scenes, ["full", "bare"]);
    // A file without nodes.
    let nothing = br#"{ "asset": { "version": "2.0" }, "meshes": [] }"#;
    let error = load_from_memory("scene.gltf", nothing).unwrap_err();
    assert!(matches!(&error, SceneError::NoTriangles { .. }), "{error}");
}

#[test]
fn an_empty_scene_names_the_others() {
    let mut file = File::triangle();
    file.json["scenes"] = json!([{ "name": "empty" }, { "name": "full", "nodes": [0] }, {}]);
    let error = fault(&file);
    assert!(error.contains("with meshes, for --scene-in-file: 1 \"full\")"), "{error}");
    file.json["scenes"][1]["nodes"] = json!([]);
    assert!(!fault(&file).contains("--scene-in-file"));
}

/// A number that is not finite only costs its vertex, and gives a warning.
#[test]
fn non_finite_numbers_are_replaced() {
    let sound = textured_cube().load().unwrap();
    for (semantic, size, lost, words) in [
        ("POSITION", 3, 2, "2 triangles with a corner that is not finite were left out"),
        ("NORMAL", 3, 0, "1 normals without a direction were replaced"),
        ("TEXCOORD_0", 2, 0, "1 texture coordinates are not finite and became zero"),
        ("TANGENT", 4, 0, ""),
        ("COLOR_0", 4, 0, "1 vertices have no colour, or one that is not finite"),
    ] {
        for bad in [f32::NAN, f32::NEG_INFINITY] {
            let mut file = textured_cube();
            let attributes = &file.json["meshes"][0]["primitives"][0]["attributes"];
            let accessor = match attributes[semantic].as_u64() {
                Some(accessor) => accessor as usize,
                None => file.vectors(&[[1.0, 0.0, 0.0, 1.0]; 24]),
            };
            let view = file.json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
            let begin = file.json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
            // The first corner of the first side belongs to two triangles.
            let at = begin + 4 * (size - 1);
            file.binary[at..at + 4].copy_from_slice(&bad.to_le_bytes());
            file.json["meshes"][0]["primitives"][0]["attributes"][semantic] = json!(accessor);
            let scene = file.load().unwrap();
            assert_eq!(scene.triangle_count() + lost, sound.triangle_count(), "{semantic}");
            let told = scene.notes.warnings.join("\n");
            assert!(told.contains(words), "{semantic}: {told}");
            if lost == 0 {
                assert_eq!(scene.meshes[0].normals, sound.meshes[0].normals, "{semantic}");
            }
        }
    }
    // An unused position does not matter.
    let mut file = File::triangle();
    let positions =
        file.vectors(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f32::NAN, 0.0, 0.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    assert_eq!(warnings(&file), warnings(&File::triangle()));
}

/// A node with a scale of zero along one axis is shown flat.
#[test]
fn a_scale_of_zero_flattens() {
    let whole = textured_cube().load().unwrap();
    for matrix in [false, true] {
        let mut file = textured_cube();
        file.json["nodes"][0] = if matrix {
            json!({ "mesh": 0, "matrix": [3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, -1, 0, 1] })
        } else {
            json!({ "mesh": 0, "scale": [3, 0, 3], "translation": [0, -1, 0] })
        };
        let scene = file.load().unwrap();
        assert_eq!(scene.triangle_count(), whole.triangle_count());
        let size = scene.bounds().size();
        assert!(size.y < 1e-4 && size.x == 6.0 && size.z == 6.0, "{size}");
        let up = |(_, normal): &&([Vec3; 3], Vec3)| normal.y > 0.999;
        let triangles = world_triangles(&scene);
        // Two triangles face up and two down.
        assert_eq!(triangles.iter().filter(up).count(), 2);
        for ([a, b, c], normal) in triangles.iter().filter(up) {
            assert!((*b - *a).cross(*c - *a).normalize().dot(*normal) > 0.999);
        }
    }
    // A camera and a lamp on such a node still have a direction; on a node scaled to zero along all
    // axes they have none.
    let mut file = File::triangle();
    file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }),
    );
    let turned = [0.0, std::f32::consts::FRAC_1_SQRT_2, 0.0, std::f32::consts::FRAC_1_SQRT_2];
    file.node(json!({ "camera": 0, "rotation": turned, "scale": [1, 1, 0] }), true);
    let camera = &file.load().unwrap().cameras[0];
    assert!((camera.forward + Vec3::X).length() < 1e-5, "{}", camera.forward);
}

/// Cameras and lights have their own or their node's name, and are found by either.
#[test]
fn cameras_and_lights_are_found_by_node_name() {
    let mut file = File::triangle();
    let lens = json!({ "yfov": 1, "znear": 1 });
    file.push("cameras", json!({ "type": "perspective", "perspective": lens }));
    file.push("cameras", json!({ "name": "lens", "type": "perspective", "perspective": lens }));
    for (name, camera) in [("front", 0), ("left", 1), ("right", 1)] {
        file.node(json!({ "name": name, "camera": camera }), true);
    }
    file.node(json!({ "camera": 0 }), true);
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    let lights = json!([{ "type": "point", "name": "bulb" }]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    let on = json!({ "KHR_lights_punctual": { "light": 0 } });
    file.node(json!({ "name": "lens", "extensions": on }), true);
    let scene = file.load().unwrap();
    let names: Vec<_> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["front", "lens", "right", "camera 0"]);
    assert_eq!(scene.lights[0].name, "bulb");
    for (node, name) in [("left", "lens"), ("lens", "bulb"), ("right", "right"), ("gone", "gone")] {
        assert_eq!(scene.name_on(node), name);
    }
}

/// Violations of the format that other programs accept.
#[test]
fn minor_format_violations_are_ignored() {
    let sound = File::triangle().load().unwrap();
    let changes: [fn(&mut Value); 2] = [
        |json| json["buffers"] = json!([{ "byteLength": 1_u64 << 40 }]),
        |json| json["nodes"][0]["rotation"] = json!([0, 0, 0, 0]),
    ];
    for change in changes {
        let mut file = File::triangle();
        change(&mut file.json);
        assert_eq!(file.load().unwrap().instances, sound.instances);
    }
    let text = String::from_utf8(File::triangle().embedded()).unwrap();
    let odd = text.replacen("\"count\":3", "\"count\":3,\"min\":[NaN,-Infinity,Infinity]", 1);
    let odd = odd.replace("\"stand\"", "\"NaN \\\" Infinity\"") + "\0\0\0";
    let scene = load("scene.gltf", odd.as_bytes()).unwrap();
    assert_eq!(scene.meshes, sound.meshes);
    assert_eq!(scene.instances[0].name, "NaN \" Infinity");
    assert!(scene.notes.warnings[0].contains("not finite became zero"), "{:?}", scene.notes);
}

/// Values that the format forbids, and that other programs ignore or understand.
#[test]
fn unknown_values_do_not_prevent_loading() {
    type Change = fn(&mut Value);
    fn attribute(json: &mut Value, name: &str) {
        json["meshes"][0]["primitives"][0]["attributes"][name] = json!(99);
    }
    fn with_parent(json: &mut Value, roots: [usize; 2]) {
        json["nodes"] = json!([json["nodes"][0].clone(), { "children": [0] }]);
        json["scenes"][0]["nodes"] = json!(roots);
    }
    let sound = textured_cube().load().unwrap();
    let changes: [(Change, &str); 18] = [
        (|json| json["samplers"][0]["minFilter"] = json!(7), "sampler 0: a filter"),
        (|json| json["bufferViews"][0]["target"] = json!(0), ""),
        (|json| json["bufferViews"][0]["byteStride"] = json!(0), ""),
        (|json| json["bufferViews"][3]["byteStride"] = json!(2), ""),
        (|json| json["materials"][0]["alphaMode"] = json!("mask"), "\"mask\" is unknown"),
        (|json| json["nodes"][0]["mesh"] = json!(0.0), ""),
        (|json| json["scene"] = json!(0.0), ""),
        (|json| json["accessors"][0]["count"] = json!(24.0), ""),
        (|json| json["accessors"][0]["componentType"] = json!(5126.0), ""),
        (|json| json["images"][0]["uri"] = json!(""), ""),
        (|json| json["buffers"] = json!([{ "uri": "", "byteLength": 1 }]), ""),
        (|json| json["scenes"][0]["nodes"] = json!([0, 0]), "1 roots of the scene"),
        (|json| with_parent(json, [0, 1]), "1 roots of the scene"),
        (|json| with_parent(json, [1, 0]), "1 roots of the scene"),
        (|json| attribute(json, "_BATCHID"), ""),
        (|json| attribute(json, "BATCHID"), "names unknown to glTF"),
        (|json| attribute(json, "TEXCOORD"), "names unknown to glTF"),
        (|json| attribute(json, "COLOR_x"), "names unknown to glTF"),
    ];
    for (index, (change, words)) in changes.into_iter().enumerate() {
        let mut file = textured_cube();
        change(&mut file.json);
        let scene = file.load().unwrap_or_else(|error| panic!("{index}: {error}"));
        assert_eq!(scene.meshes, sound.meshes, "{index}");
        assert_eq!(scene.materials, sound.materials, "{index}");
        assert_eq!((scene.instances.len(), &scene.textures), (1, &sound.textures), "{index}");
        let told = scene.notes.warnings.join("\n");
        assert_eq!(told.is_empty(), words.is_empty(), "{index}: {told}");
        assert!(told.contains(words), "{index}: {told}");
    }
    // Values without an obvious meaning become defaults.
    let mut file = textured_cube();
    file.json["samplers"][0] = json!({ "magFilter": 9987, "wrapS": 10496, "wrapT": 33648 });
    file.json["materials"][0]["alphaMode"] = json!("GLASS");
    let scene = file.load().unwrap();
    let expected = Sampler { wrap_v: Wrap::MirroredRepeat, ..Sampler::default() };
    assert_eq!((scene.textures[0].sampler, scene.notes.warnings.len()), (expected, 2));
    assert_eq!(scene.materials[0].alpha, AlphaMode::Opaque);
    // A wrong length in the header of a GLB.
    let whole = textured_cube().glb();
    for length in [0, 20, whole.len() as u32 - 12, u32::MAX] {
        let mut glb = whole.clone();
        glb[8..12].copy_from_slice(&length.to_le_bytes());
        assert_eq!(load("scene.glb", &glb).unwrap().meshes, sound.meshes, "{length}");
    }
    let error = load("scene.glb", &whole[..whole.len() - 4]).unwrap_err().to_string();
    assert!(error.contains("cut off"), "{error}");
}

#[test]
fn lights_out_of_range_give_warnings() {
    let light = |light: Value| {
        let mut file = bare_triangle();
        file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
        file.node(json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }), true);
        let scene = file.load().unwrap();
        (scene.lights[0].clone(), scene.notes.warnings.join("\n"))
    };
    for (inner, outer, expected_deg, words) in [
        (20.0, 45.0, [20.0, 45.0], "count as degrees"),
        (0.0, 1.6, [0.0, 90.0], "limited to 0 to pi/2"),
        (0.0, 180.0, [0.0, 90.0], "limited to 0 to pi/2"),
        (-0.1, 1.0, [0.0, 57.29578], "limited to 0 to pi/2"),
        (0.0, 0.0, [0.0, 45.0], "45 degrees"),
    ] {
        let spot = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        let (light, told) = light(json!({ "type": "spot", "spot": spot }));
        let found = light.cone_rad().unwrap().map(f32::to_degrees);
        assert!((found[0] - expected_deg[0]).abs() + (found[1] - expected_deg[1]).abs() < 1e-3);
        assert!(told.starts_with("light 0 at node 1: ") && told.contains(words), "{told}");
    }
    let (light, told) = light(json!({ "type": "point", "intensity": -3.0 }));
    assert_eq!((light.kind, light.intensity), (LightKind::Point, 0.0));
    assert!(told.contains("counts as 0"), "{told}");
}

/// URIs as found in real files, and data URIs in all spellings.
#[test]
fn existing_files_decide_how_uris_are_decoded() {
    let folder = tempfile::tempdir().unwrap();
    let file = File::triangle();
    let names = ["50%.bin", "a%20b.bin", "my data.bin", "Case.BIN", "b%ff.bin"];
    for name in names {
        write(folder.path(), name, &file.binary);
    }
    for uri in [
        "50%.bin",
        "50%25.bin",
        "a%20b.bin",
        "my%20data.bin",
        "my data.bin",
        "./sub/../my%20data.bin",
        "sub\\..\\case.bin",
        "C:\\models\\Case.bin",
        "b%ff.bin",
        "my%20data.bin?v=2#top",
    ] {
        let scene = Scene::load(write(folder.path(), "scene.gltf", &file.naming(uri)));
        assert_eq!(scene.unwrap().triangle_count(), 1, "{uri}");
    }
    let base64 = data_uri("application/octet-stream", &file.binary);
    let (head, body) = base64.split_once(',').unwrap();
    let escaped: String =
        file.binary.iter().fold(String::new(), |text, byte| text + &format!("%{byte:02x}"));
    for uri in [
        format!("{head},{}\n{}", &body[..33], &body[33..]),
        format!("{head}, {}", body.replace('A', "%41").replace('=', "%3D")),
        format!("DATA:;Base64,{}", body.replace('+', "-").replace('/', "_")),
        format!("data:application/octet-stream,{escaped}"),
    ] {
        let scene = Scene::load(write(folder.path(), "scene.gltf", &file.naming(&uri)));
        assert_eq!(scene.unwrap().triangle_count(), 1, "{uri}");
    }
}

#[test]
fn required_extensions_that_only_refine_are_ignored() {
    let mut file = bare_triangle();
    file.json["extensionsUsed"] = json!(["KHR_materials_variants", "KHR_audio_emitter"]);
    file.json["extensionsRequired"] = file.json["extensionsUsed"].clone();
    let said = warnings(&file);
    assert_eq!(
        said,
        "the glTF extension KHR_materials_variants is not supported and was ignored: the first look \
         of each surface is shown"
    );
    // Required, but not listed among the used extensions.
    file.json["extensionsUsed"] = json!([]);
    assert_eq!(warnings(&file), said);
}

#[test]
fn other_required_extensions_are_ignored_when_asked() {
    let mut file = bare_triangle();
    file.json["extensionsUsed"] = json!(["EXT_new_geometry", "EXT_optional"]);
    file.json["extensionsRequired"] = json!(["EXT_new_geometry"]);
    let error = fault(&file);
    for needle in ["EXT_new_geometry", "--ignore-required", "supported: EXT_mesh_gpu_instancing"] {
        assert!(error.contains(needle), "{error}");
    }
    let mut options = LoadOptions { ignore_required: true, ..LoadOptions::default() };
    let scene = Scene::from_memory("scene.glb", &file.glb(), &mut options).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    assert_eq!(
        scene.notes.warnings,
        [
            "the file requires the glTF extension EXT_new_geometry, which is not supported and was \
             ignored: what is shown may be wrong",
            "the glTF extension EXT_optional is not supported and was ignored",
        ]
    );
    assert_eq!(scene.notes.extensions_required, ["EXT_new_geometry"]);
}

#[test]
fn other_gltf_versions_are_distinguished_from_broken_files() {
    // A file of 2016, with things identified by names.
    let old = json!({
        "asset": { "version": "1.0", "profile": { "api": "WebGL" } },
        "scene": "main",
        "scenes": { "main": { "nodes": ["box"] } },
        "nodes": { "box": { "meshes": ["box"] } },
        "meshes": { "box": { "primitives": [{ "attributes": { "POSITION": "a" } }] } },
    });
    let message = |json: &Value| {
        let error = load("scene.gltf", json.to_string().as_bytes()).unwrap_err();
        assert!(matches!(&error, SceneError::Version { .. }), "{error}");
        error.to_string()
    };
    let text = message(&old);
    assert!(text.contains("scene.gltf: is glTF 1.0, but only glTF 2.0 is read"), "{text}");
    assert!(text.contains("gltf-pipeline"), "{text}");
    let mut nameless = old.clone();
    nameless.as_object_mut().unwrap().remove("asset");
    assert!(message(&nameless).contains("glTF 1.0"));
    let mut older = old.clone();
    older["asset"]["version"] = json!(0.8);
    assert!(message(&older).contains("glTF 0.8"));
    let mut file = File::triangle();
    file.json["asset"]["version"] = json!("3.0");
    let text = fault(&file);
    assert!(text.contains("is glTF 3.0") && text.contains("export it as glTF 2.0"), "{text}");
    // A file that only needs version 2.0 is read.
    file.json["asset"] = json!({ "version": "2.1", "minVersion": "2.0" });
    file.load().unwrap();
    let mut container = File::triangle().glb();
    container[4] = 1;
    let error = load("scene.glb", &container).unwrap_err().to_string();
    assert!(error.contains("is glTF 1.0"), "{error}");
}
