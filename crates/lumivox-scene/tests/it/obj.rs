//! The geometry of OBJ files, valid and invalid.

use std::fmt::Write as _;

use glam::{Vec2, Vec3};
use lumivox_scene::{LoadOptions, MemoryBudget, Scene, SceneError, UpAxis};
use proptest::prelude::*;

use crate::common::{load, load_from_memory, world_triangles, write};

const ROOF: &str = "v -1 0 0\nv 0 0 1\nv 0 2 1\nv 1 0 0\n";

fn read(text: &str) -> Scene {
    load("house.obj", text.as_bytes()).unwrap()
}

fn fault(text: &str) -> String {
    let error = load("house.obj", text.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("house.obj: "), "{error}");
    error
}

fn warns(scene: &Scene, words: &str) -> bool {
    scene.notes.warnings.iter().any(|warning| warning.contains(words))
}

#[test]
fn corners_with_any_mix_of_indices_are_read() {
    let scene = read(
        "# made by hand\r\nv 0 0 0\r\nv\t1 0\t0 1.0\r\nv 1 1 \\\r\n 0\r\nv 0 1 0\r\n\
         vt 0 0\r\nvt 1 0.25 0\r\nvn 0 0 5\r\nvn 0 1 1\r\n\
         f 1/1/1 2/2/1 3/1/2\r\nf 1//1 3//1 4//1\r\nf -4/-2 -2/2 -1/1\r\nf 1 2 3 4\r\n",
    );
    let mesh = &scene.meshes[0];
    assert_eq!(scene.triangle_count(), 5);
    let corners = mesh.triangles().next().unwrap();
    assert_eq!(corners.map(|i| mesh.uvs[i]), [Vec2::Y, Vec2::new(1.0, 0.75), Vec2::Y]);
    assert_eq!(mesh.normals[corners[0]], Vec3::Z);
    assert!((mesh.normals[corners[2]] - Vec3::new(0.0, 0.5, 0.5).normalize()).length() < 1e-6);
    let flat = mesh.triangles().last().unwrap();
    assert_eq!(flat.map(|i| mesh.positions[i]), [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert!(mesh.normals[flat[0]] == Vec3::Z && mesh.uvs[flat[0]] == Vec2::ZERO);
    // The two faces with equal corners share vertices; flat faces do not.
    assert_eq!(mesh.positions.len(), 3 + 3 + 3 + 6);
}

#[test]
fn objects_groups_and_materials_are_instances() {
    let scene = read(&format!(
        "{ROOF}f 1 2 3\no hut\ng roof left\nf 1 2 3\ng\nf 4 3 2\nusemtl none\nf 1 2 3\n\
         o hut\ng roof left\nusemtl\nf 4 3 2\ng empty\n"
    ));
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["object", "hut/roof left", "hut", "hut", "hut/roof left"]);
    assert!(warns(&scene, "the material \"none\" is in no material library"));
}

#[test]
fn smoothing_groups_are_smooth_and_the_rest_is_flat() {
    let normals = |text: &str| {
        let scene = read(&format!("{ROOF}{text}"));
        let all = scene.meshes.iter().flat_map(|mesh| {
            let ridge = mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| p.z == 1.0);
            ridge.map(|(_, normal)| *normal).collect::<Vec<_>>()
        });
        all.collect::<Vec<_>>()
    };
    let smooth = |normals: &[Vec3]| normals.iter().all(|n| n.abs_diff_eq(Vec3::Z, 1e-6));
    let flat = |normals: &[Vec3]| normals.iter().all(|n| (n.x.abs() - 0.707).abs() < 1e-3);
    assert!(flat(&normals("f 1 2 3\nf 4 3 2\n")));
    assert!(flat(&normals("s off\nf 1 2 3\ns 0\nf 4 3 2\n")));
    assert!(flat(&normals("s 1\nf 1 2 3\ns 2\nf 4 3 2\n")));
    let shared = normals("s 1\nf 1 2 3\nf 4 3 2\n");
    assert!(smooth(&shared) && shared.len() == 2);
    // Also across materials and seams of the texture.
    assert!(smooth(&normals("s 7\nf 1 2 3\nusemtl b\nf 4 3 2\n")));
    assert!(smooth(&normals("vt 0 0\nvt 1 1\ns 1\nf 1/1 2/1 3/1\nf 4/2 3/2 2/2\n")));
}

#[test]
fn the_crease_option_decides_smoothing() {
    let folder = tempfile::tempdir().unwrap();
    // A seam of the texture is not a sharp edge.
    let text = format!("{ROOF}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 4/2 3/2 2/2\n");
    let path = write(folder.path(), "house.obj", text.as_bytes());
    for (degrees, is_smooth) in [(89.0_f32, false), (91.0, true)] {
        let crease_rad = Some(degrees.to_radians());
        let mut options = LoadOptions { crease_rad, ..LoadOptions::default() };
        let mesh = &Scene::load_with(&path, &mut options).unwrap().meshes[0];
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            if position.z == 1.0 {
                assert_eq!(normal.abs_diff_eq(Vec3::Z, 1e-6), is_smooth, "{normal}");
            }
        }
    }
}

#[test]
fn concave_polygons_are_triangulated_correctly() {
    let scene = read("v 0 0 0\nv 2 -1 0\nv 0 2 0\nv -2 -1 0\nf 2 3 4 1\n");
    let area: f32 = world_triangles(&scene)
        .iter()
        .map(|([a, b, c], _)| {
            let doubled = (*b - *a).cross(*c - *a).z;
            assert!(doubled > 0.0);
            doubled * 0.5
        })
        .sum();
    assert!((area - 4.0).abs() < 1e-5);
}

#[test]
fn vertices_have_colors() {
    let scene = read("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\nv 0 1 0\nf 1 2 3\n");
    let colors = &scene.meshes[0].colors;
    assert!((colors[0].y - 0.2140).abs() < 1e-3 && colors[2] == glam::Vec4::ONE, "{colors:?}");
    assert!(warns(&scene, "in their vertices' colours"));
    // Colours as bytes.
    let scene = read("v 0 0 0 255 0 0\nv 1 0 0 0 0 255\nv 0 1 0 0 128 0\nf 1 2 3\n");
    let colors = &scene.meshes[0].colors;
    assert!((colors[0].x - 1.0).abs() < 1e-5 && (colors[2].y - 0.2159).abs() < 1e-3);
}

/// `ZBrush` writes colours as comments, one word of eight digits for each vertex.
#[test]
fn zbrush_comments_become_vertex_colors() {
    let paint = "# a comment\n#MRGB ffff0000FF00ff00\n";
    let scene = read(&format!("{ROOF}{paint}#MRGB ff0000ff\nf 1 2 3\nf 4 3 2\n#MRGB 00808080ff"));
    let expected = read(
        "v -1 0 0 255 0 0\nv 0 0 1 0 255 0\nv 0 2 1 0 0 255\nv 1 0 0 128 128 128\nf 1 2 3\nf 4 3 2\n",
    );
    assert_eq!(scene.meshes, expected.meshes);
    // More colours than vertices.
    read(&format!("{paint}{ROOF}{}f 1 2 3\n", paint.repeat(9)));
}

#[test]
fn faces_may_precede_their_vertices() {
    let rest = "vt 0 0\nvt 1 1\nvt 1 0\nvn 0 0 1\n";
    let faces = "s 1\nf 1/1/1 2/2/1 3/3/1\ng b\ns off\nf 4/1 3/2 2/3\nf 1/1 2/2 3/3 4/1\n";
    let expected = read(&format!("{ROOF}{rest}{faces}"));
    for text in [format!("{faces}{ROOF}{rest}"), format!("{ROOF}{faces}s 7\ng c\n{rest}")] {
        assert_eq!(read(&text).meshes.len(), expected.meshes.len());
        assert_eq!(world_triangles(&read(&text)), world_triangles(&expected));
        assert!(!warns(&read(&text), "do not exist"));
    }
    // Negative indices count from the line of their face.
    let scene = read("v 0 0 0\nv 1 0 0\nf -2 -1 3\nv 0 1 0\nv 5 5 5\n");
    assert_eq!(scene.bounds().max, Vec3::new(1.0, 1.0, 0.0));
}

#[test]
fn skipped_elements_are_reported() {
    let scene = read(&format!(
        "{ROOF}l 1 2\np 1\nf 1 2 3\nf 1 2\ncstype bezier\ncurv 0 1 1 2 3\nend\ncall other.obj\n\
         vn nan nan nan\nvt nan 0\nf 1/1/1 2/1/1 3/1/1\nf 1/9/9 2/9/9 3/9/9\n"
    ));
    for words in [
        "2 lines and points",
        "1 free-form curves",
        "1 faces of fewer",
        "1 statements \"call\"",
        "3 texture coordinates are not finite",
        "3 corners name texture coordinates that do not exist",
        "3 corners name normals that do not exist",
        "3 normals without a direction",
    ] {
        assert!(warns(&scene, words), "{words}: {:?}", scene.notes.warnings);
    }
    assert_eq!(scene.triangle_count(), 3);
}

#[test]
fn non_finite_positions_drop_only_their_triangles() {
    let broken = "v nan 0 0\nv 0 1e99 0\nv 0 0 -nan(ind)\n";
    assert_eq!(read(&format!("{ROOF}{broken}f 1 2 3\n")), read(&format!("{ROOF}f 1 2 3\n")));
    for smooth in ["", "s 1\n"] {
        let scene = read(&format!("{ROOF}{broken}{smooth}f 1 2 3\nf 1 3 5\nf 1 2 3 4 6\n"));
        assert!(warns(&scene, "2 triangles with a corner that is not finite"));
        assert_eq!(scene.triangle_count(), 3);
        assert!(scene.meshes[0].normals.iter().all(|normal| normal.is_finite()));
    }
}

#[test]
fn vertices_missing_a_colour_are_reported() {
    let scene = read("v 0 0 0 1 0 0\nv 1 0 0 0 1 nan\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(scene.meshes[0].colors[1..], [glam::Vec4::ONE; 2]);
    assert!(warns(&scene, "2 vertices have no colour, or one that is not finite"));
    // A value slightly above 1 is a rounding error, not a byte.
    let scene = read("v 0 0 0 1.001 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
    assert_eq!(scene.meshes[0].colors[0], scene.meshes[0].colors[1]);
}

#[test]
fn capitals_and_marks_of_encodings_are_read() {
    let text = format!("{ROOF}vn 0 0 1\nf 1//1 2//1 3//1\ns OFF\nf 1 2 \\\n 4\n");
    let wide = |text: &str| {
        let units: Vec<u16> = format!("\u{feff}{text}").encode_utf16().collect();
        [u16::to_le_bytes, u16::to_be_bytes]
            .map(|bytes| units.iter().copied().flat_map(bytes).collect())
    };
    let [[a, b], [c, d]] = [wide(&text), wide(&text.replace('\n', "\r\n"))];
    let marked = format!("\u{feff}{text}").into_bytes();
    for odd in [text.to_uppercase().into_bytes(), marked, a, b, c, d] {
        assert_eq!(load("house.obj", &odd).unwrap(), read(&text));
    }
}

#[test]
fn comments_end_a_line() {
    let scene = read(
        "v 0 0 0 # a\nv 1 0 0 1 0 0 # b\nv 0 1 0#c\nvt 0 0 # d\nvn 0 0 1 # e\ns off # f\n\
         f 1/1/1 2/1/1 3/1/1 # g\nf 1/1/1 2/1/1 3/1/1# h 7\nusemtl # i\nl 1 2 # j\n",
    );
    assert_eq!(scene.triangle_count(), 2);
    assert!(!scene.notes.warnings.iter().any(|warning| warning.contains("unknown")));
}

#[test]
fn unit_axis_and_progress_options_work() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "house.obj", format!("{ROOF}f 1 2 3\n").as_bytes());
    let mut told = Vec::new();
    let mut listen = |progress| told.push(progress);
    let mut options = LoadOptions {
        up: UpAxis::Z,
        unit_m: 0.5,
        progress: Some(&mut listen),
        ..LoadOptions::default()
    };
    let bounds = Scene::load_with(&path, &mut options).unwrap().bounds();
    assert!((bounds.min - Vec3::new(-0.5, 0.0, -1.0)).length() < 1e-6, "{bounds:?}");
    assert!((bounds.max - Vec3::new(0.0, 0.5, 0.0)).length() < 1e-6, "{bounds:?}");
    let last = told.last().unwrap();
    assert!(last.stage == "reading" && last.done == last.total && last.total > 0);
}

#[test]
fn geometry_beyond_the_budget_is_refused_with_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let budget = MemoryBudget { geometry_bytes: 1 << 20, ..MemoryBudget::default() };
    for text in [
        format!("{ROOF}{}", "f 1 2 3\n".repeat(7_000)),
        "v 0 0 0\n".repeat(100_000),
        format!("{ROOF}f{}\n", " 1 2".repeat(100_000)),
    ] {
        let path = write(folder.path(), "house.obj", text.as_bytes());
        let mut options = LoadOptions { budget, ..LoadOptions::default() };
        let error = Scene::load_with(&path, &mut options).unwrap_err();
        assert!(matches!(&error, SceneError::TooLarge { .. }), "{error}");
    }
}

#[test]
fn broken_files_say_where() {
    assert!(fault("").contains("no faces"));
    assert!(fault("hello\nworld\n").contains("no faces"));
    for (text, expected) in [
        ("f 1 2 5\n", "a corner of line 5 is 5, but there are only 4 vertices"),
        (
            "f 1 2 -5\n",
            "it uses vertex -5, counted back from the last one, but only 4 come before it",
        ),
        ("f 1 2 99999999999999999999999\n", "there are only 4 vertices"),
        ("f 1 2 0\n", "counted from 1"),
        ("f 1 2 x\n", "\"x\" is not a corner"),
        ("f 1 2 3/x\n", "\"3/x\" is not a corner"),
        ("v 1 2\n", "2 numbers instead of 3"),
        ("v 1 2 z\n", "\"z\" is not a number"),
        ("v 1 2 nan\nf 1 2 5\n", "size zero"),
        ("vn 1\n", "1 numbers instead of 3"),
    ] {
        let reason = fault(&format!("{ROOF}{text}"));
        assert!(reason.contains(expected), "{text:?}: {reason}");
    }
    assert!(matches!(load("x.fbx", b"").unwrap_err(), SceneError::UnknownFormat { .. }));
}

#[test]
fn too_many_groups_are_joined_by_material() {
    let mut text = ROOF.to_owned();
    for i in 0..70_000 {
        write!(text, "g {i}\nf 1 2 3\n").unwrap();
    }
    let scene = read(&text);
    assert!(scene.meshes.len() <= 65_537);
    assert_eq!(scene.triangle_count(), 70_000);
    assert!(warns(&scene, "joined by their materials"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = load_from_memory("house.obj", &bytes);
    }

    #[test]
    fn arbitrary_statements_never_panic(
        lines in proptest::collection::vec(
            "(v|vt|vn|f|s|g|o|usemtl|mtllib|l) ([-0-9/. ]{0,12}|nan|off|[a-z]{1,3})\\\\?", 0..40),
        crease in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let text = format!("{ROOF}vt 0 0\nvn 0 0 1\nf 1 2 3\n{}", lines.join("\n"));
        let path = write(folder.path(), "house.obj", text.as_bytes());
        let crease_rad = crease.then_some(1.0);
        let _ = Scene::load_with(&path, &mut LoadOptions { crease_rad, ..LoadOptions::default() });
    }
}
