//! Hostile or broken input: names with terminal escapes, pipes in place of files, unknown
//! extensions.

use std::fs;
#[cfg(unix)]
use std::path::Path;

use serde_json::{Value, json};

use crate::common::{CORNER, INPUT, Run, container, folder, glb, lumivox, lumivox_with};

/// A name that clears the screen, retitles the terminal, contains a C1 control character, forges
/// lines, and reverses text.
const EVIL: &str =
    "\u{1b}[2J\u{1b}]0;owned\u{7}\u{9b}31m\rerror: forged\nwarning: forged\u{202e}txt\u{7f}";

/// The corner with all parts named [`EVIL`], and a missing image.
fn evil_glb() -> Vec<u8> {
    let bin: Vec<u8> = CORNER.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let document = json!({
        "asset": { "version": "2.0", "generator": EVIL },
        "scene": 0,
        "scenes": [{ "name": EVIL, "nodes": [0, 1, 2] }, { "name": EVIL }],
        "nodes": [
            { "name": EVIL, "mesh": 0 },
            { "name": EVIL, "camera": 0, "translation": [0, 1, 4] },
            {
                "name": EVIL, "translation": [0, 1.5, 0.5],
                "extensions": { "KHR_lights_punctual": { "light": 0 } },
            },
        ],
        "cameras": [{
            "name": EVIL, "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.01 },
        }],
        "images": [{ "name": EVIL, "uri": "gone.png" }],
        "textures": [{ "source": 0 }],
        "materials": [{
            "name": EVIL, "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } },
        }],
        "meshes": [{
            "name": EVIL, "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }],
        }],
        "animations": [{ "name": EVIL, "channels": [], "samplers": [] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": CORNER.len(),
            "min": [-1, 0, -1], "max": [1, 2, 1],
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": bin.len() }],
        "buffers": [{ "byteLength": bin.len() }],
        "extensionsUsed": [EVIL, "KHR_lights_punctual"],
        "extensions": {
            "KHR_lights_punctual": { "lights": [{ "name": EVIL, "type": "point", "intensity": 100 }] },
        },
    });
    container(&document.to_string(), &bin)
}

/// Checks that a terminal shows the text literally, and that no line is forged.
#[track_caller]
fn assert_is_shown(text: &str) {
    let obeyed = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c);
    assert!(!text.contains(obeyed), "{text:?}");
    let forged =
        |line: &str| line.starts_with("error: forged") || line.starts_with("warning: forged");
    assert!(!text.lines().any(forged), "{text}");
}

#[track_caller]
fn assert_run_is_shown(run: &Run) {
    assert_is_shown(&run.stdout);
    assert_is_shown(&run.stderr);
}

const SMALL: &str = "--size 16x9 --frames 1 --resolution 16 --shadow-resolution 64";

#[test]
fn names_in_scenes_are_escaped_for_the_terminal() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("evil.glb"), evil_glb()).unwrap();
    let shown = "\\x1b[2J\\x1b]0;owned\\x07\\u{9b}31m";
    let info = lumivox(path, "info evil.glb").expect_ok();
    assert_run_is_shown(&info);
    // In tables: material, texture, light, camera, animation; also generator, scenes, extension
    // and warnings.
    assert!(info.stdout.matches(shown).count() >= 8, "{}", info.stdout);
    assert!(info.stdout.contains("warning: image \"\\x1b[2J"), "{}", info.stdout);
    // The log, on stderr.
    let render = lumivox(path, &format!("render evil.glb -o a.png {SMALL} -v")).expect_ok();
    assert_run_is_shown(&render);
    assert!(render.stderr.contains("warning: evil.glb: image \"\\x1b[2J"), "{}", render.stderr);
    assert!(render.stdout.contains(&format!("camera {shown}")), "{}", render.stdout);
    // Errors that repeat names.
    for (line, code) in [
        ("info evil.glb --scene-in-file nowhere".to_owned(), INPUT),
        (format!("render evil.glb -o a.png {SMALL} --camera nowhere"), INPUT),
        (format!("render evil.glb -o a.png {SMALL} --animation nowhere"), INPUT),
    ] {
        let run = lumivox(path, &line);
        assert_eq!(run.code, code, "{line}: {}", run.stderr);
        assert_run_is_shown(&run);
        assert!(run.stderr.contains("\\x1b[2J"), "{line}: {}", run.stderr);
    }
}

#[test]
fn json_output_keeps_names_unchanged() {
    let folder = folder();
    fs::write(folder.path().join("evil.glb"), evil_glb()).unwrap();
    let run = lumivox(folder.path(), "info evil.glb --json").expect_ok();
    let report = run.json();
    for name in [
        &report["generator"],
        &report["material_list"][0]["name"],
        &report["light_list"][0]["name"],
        &report["camera_list"][0]["name"],
        &report["animations"][0]["name"],
        &report["scenes"][0],
    ] {
        // A light's or camera's name may include its node's.
        assert!(name.as_str().is_some_and(|name| name.contains(EVIL)), "{name}");
    }
    assert!(report["warnings"].to_string().contains("\\u001b[2J"), "{report}");
    // The JSON has no terminal escapes, either.
    assert_is_shown(&run.stdout);
}

#[test]
fn names_printed_by_the_console_can_be_read_back() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("evil.glb"), evil_glb()).unwrap();
    let words = ["run", "-", "--scene", "evil.glb", "--size", "16x9"];
    // Names of objects, materials and lights have spaces in place of control characters; all names
    // have escapes in place of direction marks.
    let hide = "hide \" [2J ]0;owned  31m error: forged warning: forged\\u{202e}txt \"";
    let camera = "camera \"\\u{1b}[2J\\u{1b}]0;owned\\u{7}\\u{9b}31m\\u{d}error: forged\\u{a}warning: \
                  forged\\u{202e}txt\\u{7f}\"";
    let lists = "objects\nmaterials\nlights\ncameras\nanimation\n";
    let script = format!("{lists}{hide}\n{camera}\nscript\nscript kept.txt\n");
    let run = lumivox_with(path, &words, &script).expect_ok();
    assert_run_is_shown(&run);
    assert!(run.stdout.contains(hide), "{}", run.stdout);
    // The written script gives the same names.
    let kept = fs::read_to_string(path.join("kept.txt")).unwrap();
    assert_is_shown(&kept);
    let again = lumivox_with(path, &["run", "-"], &format!("{kept}\nscript\n")).expect_ok();
    assert!(again.stdout.contains(hide), "{}", again.stdout);
}

#[cfg(unix)]
#[test]
fn file_names_are_escaped_for_the_terminal() {
    use crate::common::process;
    let folder = folder();
    let path = folder.path();
    let evil = "a\u{1b}[31m\nerror: forged.glb";
    fs::write(path.join(evil), glb(&CORNER)).unwrap();
    for words in [
        &["info", evil][..],
        &["info", "b\u{1b}[31m\nerror: forged.glb"],
        // Too many names, or a name instead of a value, as if a shell had filled them in.
        &["info", evil, evil],
        &["info", evil, "--resolution", evil],
    ] {
        assert_run_is_shown(&lumivox_with(path, words, ""));
        assert_run_is_shown(&process(path, words, ""));
    }
    let report = lumivox_with(path, &["info", evil, "--json"], "").expect_ok().json();
    assert_eq!(report["name"], Value::from("a\u{1b}[31m\nerror: forged"));
}

/// Runs the program, which must end by itself: opening a pipe without a writer would block forever.
#[cfg(unix)]
#[track_caller]
fn ends(folder: &Path, line: &str) -> Run {
    use crate::common::command;
    use std::process::Stdio;
    use std::time::{Duration, Instant};
    let mut child = command(folder, &line.split_whitespace().collect::<Vec<_>>())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_mins(2) {
            child.kill().unwrap();
            panic!("{line} waits");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.wait_with_output().unwrap().into()
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_wherever_a_file_is_named() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("corner.glb"), glb(&CORNER)).unwrap();
    for name in ["turn", "cache"] {
        fs::create_dir(path.join(name)).unwrap();
    }
    let pipes = [
        "way.json",
        "script.txt",
        "truth.exr",
        "sums",
        "turn/index.json",
        "cache/measurements.json",
    ];
    for pipe in pipes {
        let made = std::process::Command::new("mkfifo").arg(path.join(pipe)).status().unwrap();
        assert!(made.success());
    }
    let small = "--size 16x9";
    for (line, pipe) in [
        (format!("render corner.glb -o turn {small} --camera-path way.json"), "way.json"),
        (format!("render corner.glb -o turn {small} --orbit 9"), "index.json"),
        ("run script.txt".to_owned(), "script.txt"),
        ("compare --images truth.exr truth.exr".to_owned(), "truth.exr"),
        (format!("compare corner.glb {small} --reference truth.exr"), "truth.exr"),
        (format!("reference corner.glb -o a.exr {small} --checkpoint sums --resume"), "sums"),
        ("bench --quick --cache cache".to_owned(), "measurements.json"),
    ] {
        let run = ends(path, &line);
        assert!(run.code == INPUT || run.code == crate::common::OUTPUT, "{line}: {}", run.stderr);
        assert!(run.stderr.contains("it is a pipe, not a file"), "{line}: {}", run.stderr);
        assert!(run.stderr.contains(pipe), "{line}: {}", run.stderr);
    }
    // Devices are rejected, too.
    let run = ends(path, "render corner.glb -o a.png --environment /dev/zero");
    assert_eq!(run.code, INPUT, "{}", run.stderr);
    assert!(run.stderr.contains("it is a device, not a file"), "{}", run.stderr);
}

/// A required but unsupported extension is an error that names the option to ignore it, in every
/// command that opens a scene.
#[test]
fn required_extensions_are_ignored_when_asked() {
    let folder = folder();
    let path = folder.path();
    let with = |extension: &str| {
        let bin: Vec<u8> = CORNER.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        let document = json!({
            "asset": { "version": "2.0" },
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
            "accessors": [{
                "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": CORNER.len(),
                "min": [-1, 0, -1], "max": [1, 2, 1],
            }],
            "bufferViews": [{ "buffer": 0, "byteLength": bin.len() }],
            "buffers": [{ "byteLength": bin.len() }],
            "extensionsUsed": [extension],
            "extensionsRequired": [extension],
        });
        container(&document.to_string(), &bin)
    };
    fs::write(path.join("new.glb"), with("EXT_from_the_future")).unwrap();
    fs::write(path.join("shoe.glb"), with("KHR_materials_variants")).unwrap();
    let shoe = lumivox(path, "info shoe.glb").expect_ok().stdout;
    assert!(shoe.contains("KHR_materials_variants is not supported and was ignored"), "{shoe}");
    for line in [
        "info new.glb".to_owned(),
        format!("render new.glb -o a.png {SMALL}"),
        "voxels new.glb --resolution 16".to_owned(),
        "convert new.glb -o b.glb".to_owned(),
        "reference new.glb -o a.exr --size 16x9 --samples 1".to_owned(),
        "run -c echo --scene new.glb --size 16x9".to_owned(),
    ] {
        let needles = ["new.glb", "EXT_from_the_future", "--ignore-required"];
        crate::common::expect_error(path, &line, INPUT, &needles);
        let run = lumivox(path, &format!("{line} --ignore-required")).expect_ok();
        let said = run.stdout + &run.stderr;
        assert!(said.contains("requires the glTF extension EXT_from_the_future"), "{line}: {said}");
    }
    let line = "info builtin:cornell --ignore-required";
    crate::common::expect_error(path, line, INPUT, &["--ignore-required", "files"]);
    let loaded =
        lumivox_with(path, &["run", "-"], "load new.glb --ignore-required\nload\n").expect_ok();
    assert!(loaded.stdout.contains("new.glb --ignore-required"), "{}", loaded.stdout);
}

/// A stray vertex makes the scene useless; the message names it.
#[test]
fn a_stray_vertex_is_named() {
    let folder = folder();
    let path = folder.path();
    let mut stray = [[0.0; 3]; 15];
    stray[..12].copy_from_slice(&CORNER);
    stray[12..].copy_from_slice(&[[0.0, 0.5, 0.0], [0.0, 1.0, 0.0], [1e30, 0.0, 0.0]]);
    fs::write(path.join("stray.glb"), glb(&stray)).unwrap();
    let place = "vertex 14 of the mesh \"mesh 0\" lies at (1.000e30, 0.000e0, 0.000e0) m";
    for line in [format!("render stray.glb -o a.png {SMALL}"), "voxels stray.glb".to_owned()] {
        let told = lumivox(path, &line).stderr;
        assert!(told.contains(place) && told.contains("move or remove it"), "{line}: {told}");
    }
    // The message also appears if the picture shows a speck.
    stray[14] = [1e6, 0.0, 0.0];
    fs::write(path.join("stray.glb"), glb(&stray)).unwrap();
    let run = lumivox(path, &format!("render stray.glb -o a.png {SMALL}")).expect_ok();
    assert!(run.stderr.contains("warning: stray.glb: vertex 14 of the mesh"), "{}", run.stderr);
}
