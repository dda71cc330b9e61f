//! Broken and malicious rigs: an error that names the file and the part, or a warning; never a
//! panic or an invalid scene.

use std::sync::LazyLock;

use lumivox_scene::{AnimationChoice, Scene};
use proptest::prelude::*;
use serde_json::json;

use crate::common::tube::{Tube, tube};
use crate::common::{File, fault, load_from_memory};

/// The error of the tube after a change.
fn changed(change: impl FnOnce(&mut Tube)) -> String {
    let mut made = tube();
    change(&mut made);
    fault(&made.file)
}

/// The triangle with an animation of these times and translations.
fn moved(times_s: &[f32], values: &[[f32; 3]], interpolation: &str) -> File {
    let mut file = File::triangle();
    let values = file.vectors(values);
    file.animation("go", times_s, &[(0, "translation", interpolation, values)]);
    file
}

/// The position of an accessor's first byte.
fn begin_of(file: &File, accessor: u64) -> usize {
    let view = file.json["accessors"][accessor as usize]["bufferView"].as_u64().unwrap();
    file.json["bufferViews"][view as usize]["byteOffset"].as_u64().unwrap() as usize
}

#[test]
fn invalid_joints_are_refused() {
    // The tube's joints are bytes; there is no fourth bone.
    let joint = |made: &mut Tube, at: usize, byte: u8| {
        let attributes = &made.file.json["meshes"][0]["primitives"][0]["attributes"];
        let begin = begin_of(&made.file, attributes["JOINTS_0"].as_u64().unwrap());
        made.file.binary[begin + at] = byte;
    };
    let error = changed(|made| joint(made, 0, 3));
    assert!(error.contains("a joint of vertex 0") && error.contains("only 3 joints"), "{error}");
    // The fourth joint of each vertex has weight zero, so any index is allowed.
    let mut unused = tube();
    joint(&mut unused, 3, 255);
    unused.file.load().unwrap();

    let attributes = |made: &mut Tube, change: fn(&mut serde_json::Value)| {
        change(&mut made.file.json["meshes"][0]["primitives"][0]["attributes"]);
    };
    let error = changed(|made| attributes(made, |a| a["JOINTS_0"] = a["POSITION"].clone()));
    assert!(error.contains("3 components instead of 4"), "{error}");
    let error = changed(|made| attributes(made, |a| a["JOINTS_0"] = a["WEIGHTS_0"].clone()));
    assert!(error.contains("joint of vertex"), "{error}");
    let error = changed(|made| {
        attributes(made, |a| {
            a.as_object_mut().unwrap().remove("WEIGHTS_0");
        });
    });
    assert!(error.contains("joints without weights"), "{error}");
    let error = changed(|made| {
        let few = made.file.vectors(&[[1.0, 0.0, 0.0, 0.0]; 2]);
        made.file.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(few);
    });
    assert!(error.contains("differ in length"), "{error}");

    // A skinned mesh without joints stays on its node, with a warning.
    let mut bare = tube();
    attributes(&mut bare, |a| {
        a.as_object_mut().unwrap().remove("JOINTS_0");
    });
    let scene = bare.file.load().unwrap();
    assert!(scene.notes.warnings.join(" ").contains("no joints for its skin"));
}

#[test]
fn invalid_skins_are_refused() {
    let error = changed(|made| made.file.json["skins"][0]["joints"] = json!([]));
    assert!(error.contains("no joints") || error.contains("malformed"), "{error}");
    let error = changed(|made| made.file.json["skins"][0]["joints"] = json!([0, 1, 99]));
    assert!(error.contains("does not exist"), "{error}");
    let error = changed(|made| {
        let joints = made.joints;
        made.file.json["skins"][0]["joints"] = json!([joints[0], joints[1], joints[2], joints[2]]);
    });
    assert!(error.contains("3 inverse bind matrices for 4 joints"), "{error}");
    let error = changed(|made| made.file.json["skins"][0]["inverseBindMatrices"] = json!(0));
    assert!(error.contains("instead of 16"), "{error}");
    // A cycle of bones outside the scene is harmless.
    let mut ring = tube();
    let [first, _, last] = ring.joints;
    ring.file.json["nodes"][last]["children"] = json!([first]);
    ring.file.json["scenes"][0]["nodes"] = json!([ring.body]);
    ring.file.load().unwrap();
    let error = changed(|made| {
        let [first, _, last] = made.joints;
        made.file.json["nodes"][last]["children"] = json!([first]);
    });
    assert!(error.contains("own ancestor"), "{error}");
}

#[test]
fn zero_scale_bones_hide_their_triangles() {
    let mut made = tube();
    made.file.json["nodes"][made.joints[2]]["scale"] = json!([0, 0, 0]);
    let scene = made.file.load().unwrap();
    // The tube ends below the vertices of the third bone.
    assert!(scene.bounds().max.y < 2.5, "{:?}", scene.bounds());
    assert!(scene.meshes[0].normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
    made.file.json["nodes"][made.joints[0]]["scale"] = json!([0, 0, 0]);
    assert!(fault(&made.file).contains("no triangles"));
}

/// A NaN in a position, displacement, weight or bind matrix only costs the part that a warning
/// names.
#[test]
fn non_finite_numbers_cost_a_deformed_mesh_little() {
    let sound = tube().file.load().unwrap();
    for (number, triangles, words) in [
        ("POSITION", 2, "triangles with a corner that is not finite"),
        ("target", 0, "morph target 0: 1 positions are not finite"),
        ("WEIGHTS_0", 0, "1 vertices have joint weights that are negative or not finite"),
        ("bind", 0, "1 inverse bind matrices are not finite"),
    ] {
        let mut made = tube();
        let primitive = &made.file.json["meshes"][0]["primitives"][0];
        let accessor = match number {
            "target" => &primitive["targets"][0]["POSITION"],
            "bind" => &made.file.json["skins"][0]["inverseBindMatrices"],
            attribute => &primitive["attributes"][attribute],
        };
        let at = begin_of(&made.file, accessor.as_u64().unwrap());
        made.file.binary[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        let mut scene = made.file.load().unwrap();
        let warnings = scene.notes.warnings.join("\n");
        assert!(warnings.contains(words), "{warnings}");
        assert_eq!(scene.triangle_count() + triangles, sound.triangle_count(), "{number}");
        let mut posed = sound.clone();
        for scene in [&mut scene, &mut posed] {
            scene.pose(AnimationChoice::All, 2.0).unwrap();
        }
        // All other vertices are unchanged.
        let (broken, whole) = (&scene.meshes[0].positions[1..], &posed.meshes[0].positions[1..]);
        if number != "bind" {
            assert_eq!(broken, whole, "{number}");
        }
        assert!(broken.iter().all(|position| position.is_finite()));
    }
}

#[test]
fn invalid_morph_targets_are_refused() {
    let error = changed(|made| {
        let few = made.file.vectors(&[[1.0, 0.0, 0.0]; 2]);
        made.file.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = json!(few);
    });
    assert!(error.contains("morph target 0") && error.contains("2 positions"), "{error}");
    let error = changed(|made| {
        made.file.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = json!(99);
    });
    assert!(error.contains("malformed"), "{error}");
    let error = changed(|made| made.file.json["nodes"][made.body]["weights"] = json!([1e39]));
    assert!(error.contains("weight") || error.contains("JSON"), "{error}");

    // Too few and too many weights, and targets of unsupported attributes.
    for weights in [json!([]), json!([0.0, 5.0, 5.0])] {
        let mut odd = tube();
        odd.file.json["nodes"][odd.body]["weights"] = weights;
        odd.file.load().unwrap();
    }
    let mut colorful = tube();
    colorful.file.json["meshes"][0]["primitives"][0]["targets"][0]["COLOR_0"] = json!(0);
    let scene = colorful.file.load().unwrap();
    assert!(scene.notes.warnings.join(" ").contains("what they do to COLOR_0"));
}

#[test]
fn morph_weights_stay_within_the_budget() {
    // 20 000 targets on 20 000 nodes would need 400 million weights.
    let mut file = File::triangle();
    let targets = vec![json!({}); 20_000];
    file.json["meshes"][0]["primitives"][0]["targets"] = json!(targets);
    file.json["meshes"][0]["weights"] = json!(vec![1; 20_000]);
    for _ in 0..20_000 {
        file.node(json!({ "mesh": 0 }), true);
    }
    let error = fault(&file);
    assert!(error.contains("too many weights"), "{error}");
}

#[test]
fn invalid_key_frames_are_left_out() {
    let two = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    let left_out = |file: &File| {
        let scene = file.load().unwrap();
        assert_eq!(scene.triangle_count(), 1);
        let said = scene.notes.warnings.join("\n");
        assert!(said.contains("left out"), "{said}");
        said
    };
    let error = left_out(&moved(&[1.0, 0.5], &two, "LINEAR"));
    assert!(error.contains("animation \"go\", channel 0"), "{error}");
    assert!(error.contains("fall from 1 to 0.5 s"), "{error}");
    let error = left_out(&moved(&[0.0, f32::NAN], &two, "LINEAR"));
    assert!(error.contains("number 1 of its times"), "{error}");
    let wild = [[0.0, f32::INFINITY, 0.0]; 2];
    let error = left_out(&moved(&[0.0, 1.0], &wild, "LINEAR"));
    assert!(error.contains("number 1 of its values"), "{error}");
    let error = left_out(&moved(&[0.0, 1.0, 2.0], &two, "LINEAR"));
    assert!(error.contains("6 numbers for 3 keys"), "{error}");
    let error = left_out(&moved(&[0.0, 1.0], &two, "CUBICSPLINE"));
    assert!(error.contains("6 numbers for 2 keys of 9"), "{error}");
    let error = left_out(&moved(&[0.0, 1.0], &two, "BOUNCE"));
    assert!(error.contains("its value is not allowed"), "{error}");

    let mut still = moved(&[], &[], "LINEAR");
    let scene = still.load().unwrap();
    assert!(scene.notes.warnings.join(" ").contains("no keys"), "{:?}", scene.notes);
    assert_eq!(scene.animations()[0].duration_s, 0.0);
    still.json["animations"][0]["channels"] = json!([]);
    still.load().unwrap();

    let warned = |file: File| file.load().unwrap().notes.warnings.join(" ");
    let odd = |path: &'static str| {
        let mut file = moved(&[0.0, 1.0], &two, "LINEAR");
        file.json["animations"][0]["channels"][0]["target"]["path"] = json!(path);
        file
    };
    assert!(warned(odd("colour")).contains("only translation"));
    assert!(warned(odd("weights")).contains("no morph targets"));

    let mut zero = File::triangle();
    let turns = zero.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0; 4]]);
    zero.animation("spin", &[0.0, 1.0], &[(0, "rotation", "LINEAR", turns)]);
    assert!(left_out(&zero).contains("key 1 is a rotation of length zero"));

    let mut flat = moved(&[0.0, 1.0], &two, "LINEAR");
    flat.json["nodes"][0]["matrix"] = json!(vec![0.0; 16]);
    flat.node(json!({ "mesh": 0 }), true);
    assert!(left_out(&flat).contains("its matrix is flat"));
}

#[test]
fn key_counts_beyond_the_data_are_reported() {
    let mut file = moved(&[0.0, 1.0], &[[0.0; 3]; 2], "LINEAR");
    let last = file.json["accessors"].as_array().unwrap().len() - 1;
    file.json["accessors"][last]["count"] = json!(4_000_000_000_u64);
    let warnings = |file: &File| file.load().unwrap().notes.warnings.join("\n");
    assert!(warnings(&file).contains("do not fit"));
    file.json["accessors"][last].as_object_mut().unwrap().remove("bufferView");
    assert!(warnings(&file).contains("without data"));
}

#[test]
fn overflowing_transforms_name_the_node_and_can_recover() {
    let huge = [[0.0, 0.0, 0.0], [3e38, 0.0, 0.0]];
    let mut file = moved(&[0.0, 1.0], &huge, "LINEAR");
    let parent = file.node(json!({ "children": [0], "scale": [10, 1, 1] }), false);
    file.json["scenes"][0]["nodes"] = json!([parent]);
    let mut scene = file.load().unwrap();
    let error = scene.pose(AnimationChoice::All, 1.0).unwrap_err().to_string();
    assert!(error.contains("stand, its transform to the world"), "{error}");
    scene.pose(AnimationChoice::All, 0.0).unwrap();
    assert_eq!(scene.triangle_count(), 1);
}

/// Bones, targets, mirrors, copies, lights and cameras in one small file.
fn rich() -> File {
    let mut file = File::triangle();
    let view = file.view(&[0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    let joints = file.accessor(view, 5121, 3, "VEC4");
    let weights = file.vectors(&[[0.5, 0.5, 0.0, 0.0]; 3]);
    let target = file.vectors(&[[0.0, 0.0, 1.0]; 3]);
    let primitive = &mut file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["JOINTS_0"] = json!(joints);
    primitive["attributes"]["WEIGHTS_0"] = json!(weights);
    primitive["targets"] = json!([{ "POSITION": target }]);
    file.json["nodes"][0]["skin"] = json!(0);
    let low = file.node(json!({ "translation": [0, 1, 0] }), false);
    let top = file.node(json!({ "children": [low] }), true);
    file.push("skins", json!({ "joints": [top, low] }));
    file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }),
    );
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual", "EXT_mesh_gpu_instancing"]);
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    let places = file.vectors(&[[3.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let many = file.node(
        json!({
            "mesh": 0, "camera": 0,
            "extensions": {
                "KHR_lights_punctual": { "light": 0 },
                "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } },
            },
        }),
        true,
    );
    let moves = file.vectors(&[[0.0; 3], [1.0, 2.0, 3.0]]);
    let turns = file.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8]]);
    let scales = file.vectors(&[[1.0; 3], [-1.0, 1.0, 1.0]]);
    let swell = file.floats(&[0.0, 1.0]);
    file.animation(
        "all",
        &[0.0, 1.0],
        &[
            (low, "rotation", "LINEAR", turns),
            (top, "translation", "STEP", moves),
            (many, "scale", "LINEAR", scales),
            (many, "weights", "LINEAR", swell),
            (0, "weights", "LINEAR", swell),
        ],
    );
    file
}

/// Validation changes nothing in a scene that loads, after each pose that succeeds.
fn pose_all(loaded: Result<Scene, lumivox_scene::SceneError>) {
    let Ok(mut scene) = loaded else { return };
    for time_s in [0.0, 0.4, 0.5, 1.0] {
        if scene.pose(AnimationChoice::All, time_s).is_ok() {
            let mut valid = scene.clone();
            // Numbers near the largest float may overflow in world space, which validation reports.
            if valid.validate().is_ok() {
                assert_eq!(valid, scene);
            }
        }
    }
}

#[test]
fn the_unmodified_test_file_loads() {
    let scene = rich().load().unwrap();
    assert_eq!(scene.instances.len(), 3);
    assert_eq!(scene.notes.warnings.len(), 1, "{:?}", scene.notes.warnings);
    pose_all(Ok(scene));
}

/// Made once: making it takes longer than loading it.
static RICH: LazyLock<Vec<u8>> = LazyLock::new(|| rich().glb());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn flipped_bytes_never_panic(
        flips in prop::collection::vec((any::<prop::sample::Index>(), 1_u8..), 1..6)
    ) {
        let mut bytes = RICH.clone();
        for (at, mask) in flips {
            let at = at.index(bytes.len());
            bytes[at] ^= mask;
        }
        pose_all(load_from_memory("scene.glb", &bytes));
    }

    #[test]
    fn changed_digits_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..6)
    ) {
        let mut bytes = RICH.clone();
        let digits: Vec<usize> = (20..bytes.len()).filter(|&i| bytes[i].is_ascii_digit()).collect();
        for (at, digit) in changes {
            bytes[digits[at.index(digits.len())]] = digit;
        }
        pose_all(load_from_memory("scene.glb", &bytes));
    }
}
