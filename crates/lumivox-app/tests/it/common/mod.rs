//! Runs of the program, and scenes for it.

mod runner;

use std::path::Path;

use serde_json::{Value, json};
use tempfile::TempDir;

#[allow(unused_imports, reason = "each program's tests use most of them")]
pub use runner::{command, in_this_process, lumivox, lumivox_with, process};

/// How a run of the program ended.
#[derive(Debug)]
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    /// The run; panics if it failed.
    #[track_caller]
    pub fn expect_ok(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        self
    }

    /// The JSON on stdout.
    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.stdout).unwrap()
    }
}

/// The exit codes of errors.
pub const USAGE: i32 = 2;
pub const INPUT: i32 = 3;
pub const GPU: i32 = 4;
pub const OUTPUT: i32 = 5;
/// The exit code after Ctrl-C.
#[cfg(unix)]
pub const STOPPED: i32 = 130;

/// Runs `line`, and expects it to fail with `code`, to say all of `needles`, and to change nothing.
#[track_caller]
pub fn expect_error(folder: &Path, line: &str, code: i32, needles: &[&str]) {
    let before = names(folder);
    let run = lumivox(folder, line);
    assert_eq!(run.code, code, "lumivox {line}: {}", run.stderr);
    assert!(run.stderr.contains("error: "), "lumivox {line}: {}", run.stderr);
    for needle in needles {
        assert!(run.stderr.contains(needle), "lumivox {line}: no \"{needle}\" in {}", run.stderr);
    }
    for word in ["panicked", "defect", "RUST_BACKTRACE"] {
        assert!(!run.stderr.contains(word), "lumivox {line}: {}", run.stderr);
    }
    assert_eq!(run.stdout, "", "lumivox {line}");
    assert_eq!(names(folder), before, "lumivox {line}");
}

/// Sends a process the signal of Ctrl-C.
#[cfg(unix)]
pub fn interrupt(child: &std::process::Child) {
    signal(child, "-INT");
}

/// Suspends a process until it is killed.
#[cfg(unix)]
pub fn freeze(child: &std::process::Child) {
    signal(child, "-STOP");
}

#[cfg(unix)]
fn signal(child: &std::process::Child, signal: &str) {
    let kill = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(kill.unwrap().success());
}

pub fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// The sorted names of all files in a folder, including hidden ones.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = folder.read_dir().unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A `.glb` file of triangles between `positions`, three each, under a lamp.
pub fn glb(positions: &[[f32; 3]]) -> Vec<u8> {
    let bin: Vec<u8> = positions.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    let corner = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
        let along = |axis: usize| positions.iter().map(move |position| position[axis]);
        (0..3).map(|axis| along(axis).reduce(pick).unwrap_or(0.0)).collect()
    };
    let number = |value: f32| if value.is_finite() { json!(value) } else { json!(0) };
    let bound = |pick| corner(pick).into_iter().map(number).collect::<Vec<_>>();
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0 },
            {
                "translation": [0.2, 2, 0.3],
                "extensions": { "KHR_lights_punctual": { "light": 0 } },
            },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "type": "VEC3",
            "count": positions.len(), "min": bound(f32::min), "max": bound(f32::max),
        }],
        "bufferViews": [{ "buffer": 0, "byteLength": bin.len() }],
        "buffers": [{ "byteLength": bin.len() }],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {
            "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 100 }] },
        },
    });
    container(&document.to_string(), &bin)
}

/// A binary glTF container (glTF 2.0, section 4.4).
pub fn container(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, padding, content) in [(b"JSON", b' ', json.as_bytes()), (b"BIN\0", 0, bin)] {
        let padded = content.len().next_multiple_of(4);
        chunks.extend_from_slice(&(padded as u32).to_le_bytes());
        chunks.extend_from_slice(kind);
        chunks.extend_from_slice(content);
        chunks.resize(chunks.len() + padded - content.len(), padding);
    }
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend_from_slice(&(12 + chunks.len() as u32).to_le_bytes());
    file.extend_from_slice(&chunks);
    file
}

/// A floor and a wall.
pub const CORNER: [[f32; 3]; 12] = [
    [-1.0, 0.0, -1.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, -1.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [1.0, 2.0, -1.0],
    [-1.0, 0.0, -1.0],
    [1.0, 2.0, -1.0],
    [-1.0, 2.0, -1.0],
];

/// A `.glb` file of two scenes: "room" with [`CORNER`], a plate that slides over it, a lamp and a
/// camera; "plate" with only the plate and the lamp. Two animations: "slide" (2 s) along x by 1.5
/// m, and "rise" (1 s) along y by 1 m.
pub fn moving_glb() -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    let mut accessors = Vec::new();
    let mut put = |values: &[f32], components: usize| {
        let kind = ["SCALAR", "VEC2", "VEC3"][components - 1];
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        views.push(json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() }));
        bin.extend(bytes);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let along = |axis: usize| values.iter().copied().skip(axis).step_by(components);
            (0..components).map(|axis| along(axis).reduce(pick).unwrap()).collect()
        };
        accessors.push(json!({
            "bufferView": views.len() - 1, "componentType": 5126, "type": kind,
            "count": values.len() / components, "min": bound(f32::min), "max": bound(f32::max),
        }));
        accessors.len() - 1
    };
    let corner = put(CORNER.as_flattened(), 3);
    let plate = put(&[-0.9, 0.3, 0.0, -0.3, 0.3, 0.0, -0.6, 0.9, 0.0], 3);
    let two_seconds = put(&[0.0, 2.0], 1);
    let slide = put(&[0.0, 0.0, 0.0, 1.5, 0.0, 0.0], 3);
    let one_second = put(&[0.0, 1.0], 1);
    let rise = put(&[0.0, 0.0, 0.0, 0.0, 1.0, 0.0], 3);
    let animation = |name: &str, input: usize, output: usize| {
        json!({
            "name": name,
            "samplers": [{ "input": input, "output": output }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        })
    };
    let document = json!({
        "asset": { "version": "2.0", "generator": "the tests of Lumivox" },
        "scene": 0,
        "scenes": [
            { "name": "room", "nodes": [0, 1, 2, 3] },
            { "name": "plate", "nodes": [1, 2] },
        ],
        "nodes": [
            { "mesh": 0 },
            { "mesh": 1 },
            {
                "translation": [0.2, 1.8, 1.5],
                "extensions": { "KHR_lights_punctual": { "light": 0 } },
            },
            { "name": "eye", "camera": 0, "translation": [0.0, 0.8, 3.5] },
        ],
        "cameras": [{ "name": "eye", "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.01 } }],
        "materials": [{ "name": "paint", "doubleSided": true }],
        "meshes": [
            { "name": "corner", "primitives": [{ "attributes": { "POSITION": corner } }] },
            {
                "name": "plate",
                "primitives": [{ "attributes": { "POSITION": plate }, "material": 0 }],
            },
        ],
        "animations": [
            animation("slide", two_seconds, slide),
            animation("rise", one_second, rise),
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bin.len() }],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {
            "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 50 }] },
        },
    });
    container(&document.to_string(), &bin)
}
