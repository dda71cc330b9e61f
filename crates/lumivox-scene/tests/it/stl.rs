//! STL files, valid and invalid.

use std::fmt::Write as _;

use glam::Vec3;
use lumivox_scene::{LoadOptions, MemoryBudget, Scene, SceneError, UpAxis};
use proptest::prelude::*;

use crate::common::{load, load_from_memory, world_triangles, write};

type Triangle = [[f32; 3]; 3];

/// Two faces of a roof with an angle of 90 degrees between their normals, and the ridge along y.
const ROOF: [Triangle; 2] = [
    [[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 2.0, 1.0]],
    [[1.0, 0.0, 0.0], [0.0, 2.0, 1.0], [0.0, 0.0, 1.0]],
];

fn binary(header: &[u8], count: u32, triangles: &[Triangle], attribute: u16) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(count.to_le_bytes());
    for triangle in triangles {
        // A wrong normal.
        bytes.extend([f32::NAN, 7.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(triangle.iter().flatten().flat_map(|v| v.to_le_bytes()));
        bytes.extend(attribute.to_le_bytes());
    }
    bytes
}

fn text(name: &str, triangles: &[Triangle]) -> String {
    let mut text = format!("solid {name}\n");
    for triangle in triangles {
        text += " facet normal 0 0 0\n  outer loop\n";
        for [x, y, z] in triangle {
            writeln!(text, "   vertex {x} {y:e} {z}").unwrap();
        }
        text += "  endloop\n endfacet\n";
    }
    text + &format!("endsolid {name}\n")
}

fn fault(bytes: &[u8]) -> String {
    let error = load("part.stl", bytes).unwrap_err().to_string();
    assert!(error.contains("part.stl: "), "{error}");
    error
}

fn assert_roof(scene: &Scene) {
    let triangles = world_triangles(scene);
    assert_eq!(triangles.len(), 2);
    for ((corners, normal), expected) in triangles.iter().zip(ROOF) {
        assert_eq!(*corners, expected.map(Vec3::from_array));
        let [a, b, c] = *corners;
        assert!((*normal - (b - a).cross(c - a).normalize()).length() < 1e-6);
    }
    assert!(scene.materials[scene.instances[0].material].double_sided);
}

#[test]
fn binary_and_text_are_the_same_scene() {
    let scene = load("part.stl", &binary(b"made by hand", 2, &ROOF, 0)).unwrap();
    assert_roof(&scene);
    let warnings = &scene.notes.warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("matte grey"), "{warnings:?}");
    for text in [text("roof", &ROOF), text("roof", &ROOF).to_uppercase().replace('\n', "\r\n")] {
        let scene = load("part.stl", text.as_bytes()).unwrap();
        assert_roof(&scene);
        assert!(scene.instances[0].name.eq_ignore_ascii_case("roof"));
        assert_eq!(scene.notes.warnings.len(), 1);
    }
    // All facets in one line, and a name that is not ASCII.
    let line = text("t\u{fc}r", &ROOF).replace('\n', " ").replacen("facet", "\nfacet", 1);
    assert_roof(&load("part.stl", line.as_bytes()).unwrap());
    let mut latin = text("t?r", &ROOF).into_bytes();
    latin[7] = 0xfc;
    assert_roof(&load("part.stl", &latin).unwrap());
}

#[test]
fn a_binary_header_may_begin_like_text() {
    assert_roof(&load("part.stl", &binary(b"solid made by hand", 2, &ROOF, 0)).unwrap());
    // Also with a wrong count, since text has no zero bytes.
    assert_roof(&load("part.stl", &binary(b"solid", 0, &ROOF, 0)).unwrap());
}

#[test]
fn wrong_counts_and_attributes_are_told() {
    for count in [0, 1, 3, u32::MAX] {
        let scene = load("part.stl", &binary(b"", count, &ROOF, 0)).unwrap();
        assert_roof(&scene);
        let warning = format!("declares {count} triangles but has room for 2");
        assert!(scene.notes.warnings.iter().any(|w| w.contains(&warning)));
    }
    let mut cut = binary(b"", 2, &ROOF, 0);
    cut.truncate(84 + 50 + 49);
    let scene = load("part.stl", &cut).unwrap();
    assert_eq!(scene.triangle_count(), 1);
    assert!(scene.notes.warnings.iter().any(|w| w.contains("cut off")));
    let scene = load("part.stl", &binary(b"COLOR=", 2, &ROOF, 0x8abc)).unwrap();
    assert!(scene.notes.warnings.iter().any(|w| w.contains("attribute bytes")));
}

#[test]
fn solids_are_instances() {
    let both = text("a", &ROOF[..1]) + &text("", &[]) + &text("b c", &ROOF[1..]);
    let scene = load("part.stl", both.as_bytes()).unwrap();
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["a", "b c"]);
    assert_roof(&scene);
}

#[test]
fn edges_are_smoothed_where_asked() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "part.stl", &binary(b"", 2, &ROOF, 0));
    for (degrees, vertices) in [(0.0_f32, 6), (89.0, 6), (91.0, 4)] {
        let crease_rad = Some(degrees.to_radians());
        let mut options = LoadOptions { crease_rad, ..LoadOptions::default() };
        let scene = Scene::load_with(&path, &mut options).unwrap();
        assert_eq!(scene.meshes[0].positions.len(), vertices, "{degrees}");
        let ridge = scene.meshes[0].positions.iter().position(|p| p.z == 1.0).unwrap();
        let normal = scene.meshes[0].normals[ridge];
        assert_eq!(normal.abs_diff_eq(Vec3::Z, 1e-6), degrees > 90.0, "{normal}");
    }
}

#[test]
fn unit_and_up_options_are_applied() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "part.stl", &binary(b"", 2, &ROOF, 0));
    let mut options = LoadOptions { up: UpAxis::Z, unit_m: 0.001, ..LoadOptions::default() };
    let scene = Scene::load_with(&path, &mut options).unwrap();
    let bounds = scene.bounds();
    assert!((bounds.min - Vec3::new(-0.001, 0.0, -0.002)).length() < 1e-9, "{bounds:?}");
    assert!((bounds.max - Vec3::new(0.001, 0.001, 0.0)).length() < 1e-9, "{bounds:?}");
    for (_, normal) in world_triangles(&scene) {
        assert!((normal.y - 0.5_f32.sqrt()).abs() < 1e-6);
    }
    options.unit_m = -1.0;
    let error = Scene::load_with(&path, &mut options).unwrap_err();
    assert!(matches!(error, SceneError::OutOfRange { .. }));
}

#[test]
fn progress_ends_at_the_length() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = binary(b"", 60_000, &vec![ROOF[0]; 60_000], 0);
    let path = write(folder.path(), "part.stl", &bytes);
    let mut told = Vec::new();
    let mut listen = |progress| told.push(progress);
    let mut options = LoadOptions { progress: Some(&mut listen), ..LoadOptions::default() };
    Scene::load_with(&path, &mut options).unwrap();
    assert!(told.len() > 2);
    assert!(told.windows(2).all(|w| w[0].done <= w[1].done));
    let last = told.last().unwrap();
    assert_eq!((last.stage, last.done, last.total), ("reading", 3_000_084, 3_000_084));
}

#[test]
fn geometry_beyond_the_budget_is_refused_with_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let budget = MemoryBudget { geometry_bytes: 1 << 20, ..MemoryBudget::default() };
    let triangles = vec![ROOF[0]; 10_000];
    for bytes in [binary(b"", 10_000, &triangles, 0), text("", &triangles).into_bytes()] {
        let path = write(folder.path(), "part.stl", &bytes);
        let mut options = LoadOptions { budget, ..LoadOptions::default() };
        let error = Scene::load_with(&path, &mut options).unwrap_err();
        assert!(matches!(&error, SceneError::TooLarge { .. }), "{error}");
        assert!(error.to_string().contains("budget is 1.0 MiB"), "{error}");
    }
}

#[test]
fn a_non_finite_position_drops_its_triangle() {
    let mut odd = ROOF;
    odd[1][2][0] = f32::INFINITY;
    let folder = tempfile::tempdir().unwrap();
    for bytes in [binary(b"", 2, &odd, 0), text("a", &odd).into_bytes()] {
        let path = write(folder.path(), "part.stl", &bytes);
        for crease_rad in [None, Some(1.0)] {
            let mut options = LoadOptions { crease_rad, ..LoadOptions::default() };
            let scene = Scene::load_with(&path, &mut options).unwrap();
            assert_eq!(scene.triangle_count(), 1);
            let told = "1 triangles with a corner that is not finite were left out";
            assert!(scene.notes.warnings.iter().any(|warning| warning.contains(told)));
        }
    }
}

#[test]
fn end_keywords_may_be_two_words() {
    let two = text("roof", &ROOF).replace("end", "end ");
    for text in [two.clone(), two.to_uppercase(), two.replace("end solid roof", "endsolid")] {
        let scene = load("part.stl", text.as_bytes()).unwrap();
        assert_roof(&scene);
        assert_eq!(scene.notes.warnings.len(), 1, "{:?}", scene.notes.warnings);
    }
    let both = two + &text("second", &ROOF[..1]);
    let scene = load("part.stl", both.as_bytes()).unwrap();
    assert_eq!(scene.instances[1].name, "second");
    let line = text("roof", &ROOF).replace('\n', " ");
    let bare = text("roof", &ROOF).replace("solid roof\n", "");
    let around = format!("made by hand\n{}the end\n", text("roof", &ROOF));
    let wide: Vec<u8> =
        format!("\u{feff}{line}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (bytes, name) in [
        (line.clone().into_bytes(), "roof"),
        (bare.into_bytes(), "solid 0"),
        (around.into_bytes(), "roof"),
        (format!("\u{feff}{line}").into_bytes(), "roof"),
        (wide, "roof"),
    ] {
        let scene = load("part.stl", &bytes).unwrap();
        assert_roof(&scene);
        assert_eq!(scene.instances[0].name, name);
    }
    let words = text("roof", &ROOF).replace("solid roof\n", "\n").replace(' ', "\n");
    assert_roof(&load("part.stl", words.as_bytes()).unwrap());
    let comment = text("roof", &ROOF).replace("endloop", "endloop # a comment");
    assert_roof(&load("part.stl", comment.as_bytes()).unwrap());
}

#[test]
fn broken_files_say_why() {
    assert!(fault(b"").contains("empty"));
    assert!(fault(b"hello").contains("neither text"));
    assert!(fault(b"solid nothing\nendsolid").contains("no facets"));
    assert!(fault(&binary(b"", 0, &[], 0)).contains("no facets"));
    let whole = text("a", &ROOF);
    let cut = &whole[..whole.rfind("vertex").unwrap()];
    assert!(fault(cut.as_bytes()).contains("middle of a facet"));
    let reason = fault(whole.replacen("vertex -1", "vertex x", 1).as_bytes());
    assert!(reason.contains("line 4") && reason.contains("\"x\""), "{reason}");
    assert!(fault(whole.replacen("outer", "inner", 1).as_bytes()).contains("\"inner\""));
    let point = [[[3.0; 3]; 3]];
    assert!(matches!(
        load("part.stl", &binary(b"", 1, &point, 0)).unwrap_err(),
        SceneError::ZeroSize { .. }
    ));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let _ = load_from_memory("part.stl", &bytes);
        let mut head = binary(b"", 2, &[], 0);
        head.extend(&bytes);
        let _ = load_from_memory("part.stl", &head);
    }

    #[test]
    fn damaged_files_never_panic(
        at in 0_usize..400, byte in any::<u8>(), end in 0_usize..400, crease in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        for mut bytes in [binary(b"", 2, &ROOF, 0), text("a", &ROOF).into_bytes()] {
            bytes.truncate(end.max(1));
            let at = at % bytes.len();
            bytes[at] = byte;
            let path = write(folder.path(), "part.stl", &bytes);
            let crease_rad = crease.then_some(1.0);
            let _ = Scene::load_with(&path, &mut LoadOptions { crease_rad, ..LoadOptions::default() });
        }
    }
}

#[test]
fn big_endian_files_are_read_and_told() {
    let little = binary(b"made elsewhere", 2, &ROOF, 0);
    let (head, triangles) = little.split_at(80);
    let swapped = |bytes: &[u8]| bytes.chunks(4).flat_map(|n| n.iter().rev().copied()).collect();
    let mut big = head.to_vec();
    big.extend::<Vec<u8>>(swapped(&triangles[..4]));
    for triangle in triangles[4..].chunks(50) {
        big.extend::<Vec<u8>>(swapped(&triangle[..48]));
        big.extend(&triangle[48..]);
    }
    let scene = load("part.stl", &big).unwrap();
    assert_roof(&scene);
    let words = "its numbers are big-endian, against the format, and were read so";
    assert!(scene.notes.warnings.iter().any(|told| told == words), "{:?}", scene.notes.warnings);
}

#[test]
fn solid_names_may_contain_format_keywords() {
    for name in ["facet", "endsolid", "facet normal", "my facet normal x", "outer loop vertex 1"] {
        let whole = text(name, &ROOF);
        let scene = load("part.stl", whole.as_bytes()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_roof(&scene);
        assert_eq!((scene.instances[0].name.as_str(), scene.notes.warnings.len()), (name, 1));
        assert_roof(&load("part.stl", whole.replace('\n', " ").as_bytes()).unwrap());
    }
}
