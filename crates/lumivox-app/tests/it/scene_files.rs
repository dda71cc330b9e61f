//! How files are read, and what `info` reports.

use std::fs;

use serde_json::json;

use crate::common::{
    CORNER, INPUT, OUTPUT, USAGE, container, expect_error, folder, glb, lumivox, moving_glb,
};

const SMALL: &str = "--size 32x18 --frames 1 --resolution 16 --shadow-resolution 64";

#[test]
fn info_json_describes_the_whole_scene() {
    let folder = folder();
    fs::write(folder.path().join("moving.glb"), moving_glb()).unwrap();
    let report =
        lumivox(folder.path(), "info moving.glb --json --resolution 64").expect_ok().json();
    assert_eq!(report["generator"], "the tests of Lumivox");
    assert_eq!(report["extensions_used"], json!(["KHR_lights_punctual"]));
    assert_eq!(report["extensions_required"], json!([]));
    assert_eq!(report["scenes"], json!(["room", "plate"]));
    assert_eq!(report["animations"][0], json!({ "name": "slide", "duration_s": 2.0 }));
    assert_eq!(report["animations"][1]["name"], "rise");
    assert_eq!(report["triangles"], 5);
    assert_eq!(report["vertices"], 15);
    assert_eq!(report["default_camera"]["name"], "eye");
    let paint = report["material_list"].as_array().unwrap();
    let paint = paint.iter().find(|material| material["name"] == "paint").unwrap();
    assert_eq!(paint["double_sided"], true);
    assert_eq!(paint["kind"], "metallic-roughness");
    let memory = report["memory"].as_array().unwrap();
    let list = memory.iter().find(|part| part["name"] == "voxel list (about)").unwrap();
    assert!(list["bytes"].as_u64().unwrap() > 1 << 20, "{list}");
    assert_eq!(report["resolution"], 64);
    let text = lumivox(folder.path(), "info moving.glb").expect_ok().stdout;
    for needle in [
        "written by",
        "0 \"room\", 1 \"plate\"",
        "slide",
        "paint",
        "both sides",
        "voxel list",
        "eye",
    ] {
        assert!(text.contains(needle), "{needle} is missing in {text}");
    }
}

#[test]
fn one_of_several_scenes_is_chosen() {
    let folder = folder();
    fs::write(folder.path().join("moving.glb"), moving_glb()).unwrap();
    for (choice, triangles) in [("", 5), ("--scene-in-file plate", 1), ("--scene-in-file 0", 5)] {
        let line = format!("info moving.glb {choice} --json");
        let report = lumivox(folder.path(), &line).expect_ok().json();
        assert_eq!(report["triangles"], triangles, "{choice}");
    }
}

#[test]
fn unit_and_up_options_change_the_bounds() {
    let folder = folder();
    fs::write(folder.path().join("corner.glb"), glb(&CORNER)).unwrap();
    let bounds = |options: &str| {
        let line = format!("info corner.glb {options} --json");
        let report = lumivox(folder.path(), &line).expect_ok().json();
        let corner = |name: &str| -> Vec<f64> {
            let values = report[name].as_array().unwrap().iter();
            values.map(|value| value.as_f64().unwrap()).collect()
        };
        [corner("bounds_min"), corner("bounds_max")]
    };
    assert_eq!(bounds(""), [[-1.0, 0.0, -1.0], [1.0, 2.0, 1.0]]);
    let [min, max] = bounds("--up z --unit 2");
    // The wall lies flat: y becomes -z.
    assert_eq!([min, max], [[-2.0, -2.0, -4.0], [2.0, 2.0, 0.0]]);
    let [_, max] = bounds("--unit in");
    assert!((max[1] - 2.0 * 0.0254).abs() < 1e-6, "{max:?}");
}

#[test]
fn files_outside_the_folder_need_allow_outside() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("scene")).unwrap();
    let triangle: Vec<u8> = CORNER[..3].iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    fs::write(path.join("outside.bin"), &triangle).unwrap();
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3,
            "min": [-1, 0, -1], "max": [1, 0, 1],
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": triangle.len() }],
        "buffers": [{ "byteLength": triangle.len(), "uri": "../outside.bin" }],
    });
    fs::write(path.join("scene/a.gltf"), document.to_string()).unwrap();
    let line = "info scene/a.gltf --json";
    expect_error(path, line, INPUT, &["scene/a.gltf", "outside.bin", "own folder"]);
    let report = lumivox(path, &format!("{line} --allow-outside")).expect_ok().json();
    assert_eq!(report["triangles"], 1);
}

#[test]
fn invalid_scene_file_options_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("corner.glb"), glb(&CORNER)).unwrap();
    for (line, code, needles) in [
        ("info corner.glb --unit inch", USAGE, ["--unit", "mm, cm, m"]),
        ("info corner.glb --unit 0", INPUT, ["--unit", "1e-9"]),
        ("info corner.glb --up x", USAGE, ["--up", "possible values"]),
        ("info corner.glb --crease 181", INPUT, ["--crease", "from 0 to 180"]),
        ("info corner.glb --texture-memory much", USAGE, ["--texture-memory", "2GiB"]),
        ("info corner.glb --geometry-memory 5B", INPUT, ["--geometry-memory", "1 KiB"]),
        ("info builtin:cornell --unit mm", INPUT, ["builtin:cornell", "--unit"]),
        ("info builtin:cornell --up z", INPUT, ["builtin:cornell", "--up"]),
        ("voxels builtin:cornell --scene-in-file 0", INPUT, ["--scene-in-file", "files"]),
    ] {
        expect_error(folder.path(), line, code, &needles);
    }
}

/// An uncompressed Radiance picture of one colour.
fn panorama(width: usize, rgbe: [u8; 4]) -> Vec<u8> {
    let height = width / 2;
    let mut file =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    for _ in 0..width * height {
        file.extend(rgbe);
    }
    file
}

#[test]
#[ignore = "slow: over three seconds"]
fn surroundings_can_be_radiance_a_file_or_sky() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("corner.glb"), glb(&CORNER)).unwrap();
    // 0.5 * 2^(132 - 128) = 8 cd/m² everywhere; six texels are too few for compression.
    fs::write(path.join("eight.hdr"), panorama(6, [128, 128, 128, 132])).unwrap();
    let render = |options: &str| {
        let line = format!("render corner.glb -o a.exr {SMALL} --bounces 1 {options}");
        lumivox(path, &line).expect_ok();
        fs::read(path.join("a.exr")).unwrap()
    };
    let plain = render("");
    let [file, bright, numbers, sky] = [
        "--environment eight.hdr",
        "--environment eight.hdr --environment-intensity 3 --environment-rotation 90",
        "--environment 8,8,8",
        "--sky 40,120 --turbidity 3",
    ]
    .map(render);
    assert!(plain != file && file != bright && sky != file && sky != numbers);

    for (options, code, needles) in [
        ("--environment missing.hdr", INPUT, ["missing.hdr", "cannot read"]),
        ("--environment corner.glb", INPUT, ["corner.glb", ".hdr"]),
        ("--environment dark", USAGE, ["--environment", ".exr"]),
        ("--environment 1,2,3 --sky 0,1,0", USAGE, ["--environment", "--sky"]),
        ("--environment-rotation 400", INPUT, ["--environment-rotation", "-360 to 360"]),
        ("--environment-intensity=-1", INPUT, ["--environment-intensity", "from 0"]),
        ("--sky noon", USAGE, ["--sky", "ELEVATION,AZIMUTH"]),
        ("--sky 91,0", INPUT, ["--sky", "-90 to 90"]),
        ("--sky 45,0 --turbidity 11", INPUT, ["--turbidity", "from 1 to 10"]),
        ("--turbidity 3", USAGE, ["--sky", "required"]),
    ] {
        let line = format!("render corner.glb -o b.exr {options}");
        expect_error(path, &line, code, &needles);
    }
    let line = "render corner.glb -o missing/b.exr --environment missing.hdr";
    expect_error(path, line, OUTPUT, &["missing/b.exr"]);
}

#[test]
#[ignore = "slow: over three seconds"]
fn dark_scenes_are_lit_unless_disabled() {
    let folder = folder();
    let path = folder.path();
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": CORNER.len(),
            "min": [-1, 0, -1], "max": [1, 2, 1],
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": CORNER.len() * 12 }],
        "buffers": [{ "byteLength": CORNER.len() * 12 }],
    });
    let bytes: Vec<u8> = CORNER.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    fs::write(path.join("dark.glb"), container(&document.to_string(), &bytes)).unwrap();
    let line = format!("render dark.glb -o a.png {SMALL} --exposure 0 --json");
    let notes = |json: &serde_json::Value| json["notes"].to_string();
    let lit = lumivox(path, &line).expect_ok().json();
    assert!(notes(&lit).contains("a studio of 1536 lux: it has none of its own"), "{lit}");
    assert!(notes(&lit).contains("--surroundings sky or none"), "{lit}");
    assert!(notes(&lit).contains("--camera inside"), "{lit}");
    assert_eq!(lit["scene"]["lights"], 0);
    let picture = fs::read(path.join("a.png")).unwrap();
    let text = lumivox(path, line.trim_end_matches(" --json")).expect_ok().stdout;
    assert!(text.contains("\n  light    a studio of 1536 lux"), "{text}");
    assert!(text.contains("\n  camera   from outside"), "{text}");
    for left in ["--no-default-light", "--surroundings none"] {
        let dark = lumivox(path, &format!("{line} {left}")).expect_ok().json();
        assert!(!notes(&dark).contains("a studio of"), "{dark}");
        // The picture is black; the notes say so, with a remedy.
        assert!(notes(&dark).contains("the picture is black"), "{dark}");
        assert!(notes(&dark).contains("--surroundings studio or sky"), "{dark}");
        assert!(picture != fs::read(path.join("a.png")).unwrap());
    }
    let sky = lumivox(path, &format!("{line} --surroundings sky")).expect_ok().json();
    assert_eq!(sky["scene"]["lights"], 1);
    let report = lumivox(path, "info dark.glb --json").expect_ok().json();
    assert!(
        report["default_light"].as_str().is_some_and(|light| light.contains("studio")),
        "{report}"
    );
    assert_eq!(report["default_camera"]["name"], "framing");
    let text = lumivox(path, "info dark.glb").expect_ok().stdout;
    assert!(text.contains("too little light, added: a studio"), "{text}");
}
