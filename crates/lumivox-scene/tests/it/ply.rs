//! PLY files, valid and invalid.

use glam::{Vec2, Vec3};
use lumivox_scene::{LoadOptions, MemoryBudget, Scene, SceneError};
use proptest::prelude::*;

use crate::common::{load, load_from_memory, write};

/// A square, and an upright triangle on its edge, with all properties that are read, and some
/// others.
const HEADER: &str = "comment made by hand
obj_info of no use
element camera 1
property float view
property list uchar int ids
element vertex 5
property double x
property float y
property float z
property short quality
property float nx
property float ny
property float nz
property uchar red
property uchar green
property uchar blue
property uchar alpha
property float s
property float t
property list uchar float more
element face 2
property uchar flags
property list uchar int vertex_indices
property list uint short more
element edge 1
property int vertex1
property int vertex2
end_header
";

#[derive(Clone, Copy)]
enum Value {
    U8(u8),
    I16(i16),
    I32(i32),
    U32(u32),
    F32(f32),
    F64(f64),
}
use Value::{F32, F64, I16, I32, U8, U32};

/// The body, with an element per row.
fn rows() -> Vec<Vec<Value>> {
    let mut rows = vec![vec![F32(1.5), U8(2), I32(7), I32(8)]];
    let places = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1]];
    for (i, [x, y, z]) in places.into_iter().enumerate() {
        let mut row = vec![F64(f64::from(x)), F32(y as f32), F32(z as f32), I16(-3)];
        row.extend([F32(0.0), F32(0.0), F32(2.0)]);
        row.extend([U8(255), U8(128), U8(0), U8(51)]);
        row.extend([F32(0.25), F32(i as f32)]);
        row.extend([U8(i as u8)]);
        row.extend((0..i).map(|_| F32(9.0)));
        rows.push(row);
    }
    rows.push(vec![U8(1), U8(4), I32(0), I32(1), I32(2), I32(3), U32(1), I16(5)]);
    rows.push(vec![U8(1), U8(3), I32(0), I32(1), I32(4), U32(0)]);
    rows.push(vec![I32(0), I32(1)]);
    rows
}

fn file(format: &str, header: &str, rows: &[Vec<Value>]) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {format} 1.0\n{header}").into_bytes();
    for row in rows {
        for value in row {
            match (format, *value) {
                ("ascii", U8(v)) => bytes.extend(format!("{v} ").bytes()),
                ("ascii", I16(v)) => bytes.extend(format!("{v}\t").bytes()),
                ("ascii", I32(v)) => bytes.extend(format!("{v} ").bytes()),
                ("ascii", U32(v)) => bytes.extend(format!("{v} ").bytes()),
                ("ascii", F32(v)) => bytes.extend(format!("{v} ").bytes()),
                ("ascii", F64(v)) => bytes.extend(format!("{v:e} ").bytes()),
                (_, U8(v)) => bytes.push(v),
                ("binary_little_endian", I16(v)) => bytes.extend(v.to_le_bytes()),
                ("binary_little_endian", I32(v)) => bytes.extend(v.to_le_bytes()),
                ("binary_little_endian", U32(v)) => bytes.extend(v.to_le_bytes()),
                ("binary_little_endian", F32(v)) => bytes.extend(v.to_le_bytes()),
                ("binary_little_endian", F64(v)) => bytes.extend(v.to_le_bytes()),
                (_, I16(v)) => bytes.extend(v.to_be_bytes()),
                (_, I32(v)) => bytes.extend(v.to_be_bytes()),
                (_, U32(v)) => bytes.extend(v.to_be_bytes()),
                (_, F32(v)) => bytes.extend(v.to_be_bytes()),
                (_, F64(v)) => bytes.extend(v.to_be_bytes()),
            }
        }
        if format == "ascii" {
            bytes.push(b'\n');
        }
    }
    bytes
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

/// A text file of positions and faces.
fn plain(vertices: &[&str], faces: &[&str]) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_index\nend_header\n\
         {}\n{}\n",
        vertices.len(),
        faces.len(),
        vertices.join("\n"),
        faces.join("\n")
    )
}

fn fault(bytes: &[u8]) -> String {
    let error = load("scan.ply", bytes).unwrap_err().to_string();
    assert!(error.contains("scan.ply: "), "{error}");
    error
}

#[test]
fn all_encodings_load_the_same_scene() {
    let scenes = FORMATS.map(|format| load("scan.ply", &file(format, HEADER, &rows())).unwrap());
    assert_eq!(scenes[0], scenes[1]);
    assert_eq!(scenes[0], scenes[2]);
    let mesh = &scenes[0].meshes[0];
    assert_eq!(mesh.indices, [0, 1, 2, 0, 2, 3, 0, 1, 4]);
    assert_eq!(mesh.positions[4], Vec3::new(1.0, 0.0, 1.0));
    assert_eq!(mesh.normals, [Vec3::Z; 5]);
    assert_eq!(mesh.uvs[3], Vec2::new(0.25, -2.0));
    let color = mesh.colors[2];
    assert!((color.x - 1.0).abs() < 1e-6 && (color.y - 0.2159).abs() < 1e-4, "{color}");
    assert!(color.z == 0.0 && (color.w - 0.2).abs() < 1e-6, "{color}");
    assert_eq!(scenes[0].instances[0].name, "scan");
    assert!(scenes[0].materials[0].double_sided);
}

#[test]
fn headers_may_end_with_lf_crlf_or_cr() {
    let expected = load("scan.ply", &file(FORMATS[1], HEADER, &rows())).unwrap();
    for ending in ["\r\n", "\r"] {
        // A body that begins with a line feed must keep it.
        let mut changed = rows();
        changed[0][0] = F32(f32::from_bits(0x0a0a_0a0a));
        let bytes = file(FORMATS[1], "", &changed);
        let body = &bytes[file(FORMATS[1], "", &[]).len()..];
        let header = format!("ply\nformat binary_little_endian 1.0\n{HEADER}");
        let mut bytes = header.replace('\n', ending).into_bytes();
        bytes.extend(body);
        assert_eq!(load("scan.ply", &bytes).unwrap(), expected, "{ending:?}");
    }
}

#[test]
fn without_normals_surfaces_are_smooth_unless_asked() {
    let roof = plain(&["-1 0 0", "0 0 1", "0 2 1", "1 0 0"], &["3 0 1 2", "3 3 2 1"]);
    let scene = load("scan.ply", roof.as_bytes()).unwrap();
    assert_eq!(scene.meshes[0].positions.len(), 4);
    assert!((scene.meshes[0].normals[1] - Vec3::Z).length() < 1e-6);
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "scan.ply", roof.as_bytes());
    let mut options = LoadOptions { crease_rad: Some(1.0), ..LoadOptions::default() };
    let scene = Scene::load_with(&path, &mut options).unwrap();
    assert_eq!(scene.meshes[0].positions.len(), 6);
    assert!(scene.meshes[0].normals.iter().all(|n| n.x.abs() > 0.7));
}

#[test]
fn headers_have_marks_and_capitals_and_colours_may_be_bytes_in_floats() {
    let text = plain(&["0 0 0", "1 0 0", "0 1 0"], &["3 0 1 2"]);
    let expected = load("scan.ply", text.as_bytes()).unwrap().meshes;
    let capitals = text.replace("float x", "FLOAT X").replace("element vertex", "element VERTEX");
    for odd in [format!("\u{feff}{text}"), capitals] {
        assert_eq!(load("scan.ply", odd.as_bytes()).unwrap().meshes, expected);
    }
    for kind in ["float", "int", "ushort"] {
        let colors =
            ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat();
        let bytes = text.replace("float z\n", &format!("float z\n{colors}"));
        let bytes = bytes.replace("0 0 0\n", "0 0 0 255 128 0\n");
        let bytes = bytes.replace("1 0 0\n", "1 0 0 0 0 0\n").replace("0 1 0\n", "0 1 0 0 0 0\n");
        let scene = load("scan.ply", bytes.as_bytes()).unwrap();
        let color = scene.meshes[0].colors[0];
        let off = (color - glam::Vec4::new(1.0, 0.2159, 0.0, 1.0)).length();
        assert!(off < 1e-3, "{kind}: {color}");
    }
}

#[test]
fn elements_may_come_in_any_order_and_share_lines() {
    let points = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"];
    let text = plain(&points, &["4 0 1 2 3", "3 0 1 2"]);
    let expected = load("scan.ply", text.as_bytes()).unwrap().meshes;
    let (head, body) = text.split_once("end_header\n").unwrap();
    let (vertex, face) = head.split_at(head.find("element face").unwrap());
    let format = vertex.find("element").unwrap();
    let faces_first = format!(
        "{}{face}{}end_header\n4 0 1 2 3\n3 0 1 2\n{}\n",
        &vertex[..format],
        &vertex[format..],
        points.join("\n")
    );
    let ten_words = body.split_whitespace().collect::<Vec<_>>();
    let ten_words: Vec<_> = ten_words.chunks(10).map(|words| words.join(" ")).collect();
    for odd in [
        faces_first,
        format!("{head}end_header\n{}", body.replace('\n', " ")),
        format!("{head}end_header\n{}", ten_words.join("\n")),
        text.replace("vertex_index", "vertex_indexes"),
        text.replace("vertex_index", "tri"),
    ] {
        let scene = load("scan.ply", odd.as_bytes()).unwrap();
        assert_eq!(scene.meshes, expected, "{odd}");
        let is_told = scene.notes.warnings.iter().any(|w| w.contains("counts as vertex_indices"));
        assert_eq!(is_told, !odd.contains("vertex_index\n"), "{odd}");
    }
    // Surplus words are harmless.
    let surplus = text.replace("0 0 0\n", "0 0 0 7 7 7\n").replace("3 0 1 2\n", "3 0 1 2 9 9\n");
    assert_eq!(load("scan.ply", surplus.as_bytes()).unwrap().meshes, expected);
}

/// The Point Cloud Library packs the bytes of a colour into the bits of a float or an integer.
#[test]
fn packed_colors_are_unpacked() {
    let header = HEADER.replace("quality", "quality\nproperty TYPE rgba");
    let header = header.replace("property uchar ", "property uchar old_");
    for format in FORMATS {
        for (kind, pack) in [
            ("float", (|bits| F32(f32::from_bits(bits))) as fn(u32) -> Value),
            ("uint", U32),
            ("int", |bits| I32(bits.cast_signed())),
        ] {
            // As a float the bits are NaN, which text cannot express.
            let bits = if format == "ascii" { 0x00c8_6400 } else { 0xffc8_6400 };
            let mut rows = rows();
            rows[1..6].iter_mut().for_each(|row| row.insert(4, pack(bits)));
            let header = header.replace("TYPE", kind);
            let scene = load("scan.ply", &file(format, &header, &rows)).unwrap();
            let color = scene.meshes[0].colors[1];
            let alpha = (bits >> 24) as f32 / 255.0;
            let expected = glam::Vec4::new(0.5776, 0.1274, 0.0, alpha);
            assert!((color - expected).length() < 1e-3, "{format} {kind}: {color}");
        }
    }
}

#[test]
fn unsupported_texture_files_are_reported() {
    let text = plain(&["0 0 0", "1 0 0", "0 1 0"], &["3 0 1 2"])
        .replace("1.0\n", "1.0\ncomment TextureFile my scan.png\n");
    let scene = load("scan.ply", text.as_bytes()).unwrap();
    assert!(scene.notes.warnings.iter().any(|w| w.contains("\"my scan.png\" is not shown")));
}

#[test]
fn triangle_strips_are_loaded() {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
                property float z\nelement tristrips 1\nproperty list int int vertex_indices\n\
                end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n9 0 1 2 3 -1 1 4 3 -1\n";
    let scene = load("scan.ply", text.as_bytes()).unwrap();
    assert_eq!(scene.meshes[0].indices, [0, 1, 2, 1, 3, 2, 1, 4, 3]);
}

#[test]
fn non_finite_positions_matter_only_if_used() {
    let vertices = ["0 0 0", "1 0 0", "0 1 0", "nan 0 0"];
    let scene = load("scan.ply", plain(&vertices, &["3 0 1 2"]).as_bytes()).unwrap();
    let without = load("scan.ply", plain(&vertices[..3], &["3 0 1 2"]).as_bytes()).unwrap();
    assert_eq!(scene.notes.warnings, without.notes.warnings);
    let scene = load("scan.ply", plain(&vertices, &["3 0 1 2", "3 0 1 3"]).as_bytes()).unwrap();
    let told = "1 triangles with a corner that is not finite were left out";
    assert!(scene.notes.warnings.iter().any(|w| w.contains(told)));
    assert_eq!((scene.triangle_count(), scene.meshes[0].normals[0]), (1, Vec3::Z));
    let reason = fault(plain(&vertices, &["3 0 1 3"]).as_bytes());
    assert!(reason.contains("numbers that are not finite"), "{reason}");
}

#[test]
fn broken_files_say_why() {
    assert!(fault(b"").contains("within the header"));
    assert!(fault(b"plying\n").contains("begin with \"ply\""));
    assert!(fault(b"ply\nformat ascii 1.0\nend_header\n").contains("no vertices"));
    assert!(fault(b"ply\nend_header\n").contains("no \"format\""));
    assert!(fault(b"ply\nformat morse 1.0\n").contains("\"morse\""));
    assert!(fault(b"ply\nformat ascii 1.0\nproperty int x\n").contains("line 3"));
    assert!(fault(b"ply\nformat ascii 1.0\nelement vertex many\n").contains("\"many\""));
    assert!(fault(b"ply\nformat ascii 1.0\nelement a 1\nproperty quad x\n").contains("\"quad\""));
    assert!(fault(&[b"ply\ncomment ".to_vec(), vec![b'x'; 2 << 20]].concat()).contains("longer"));

    let cloud = plain(&["0 0 0", "1 0 0"], &[]);
    let reason = fault(cloud.as_bytes());
    assert!(reason.contains("cloud of 2 points") && reason.contains("reconstruct"), "{reason}");
    let points = ["0 0 0", "1 0 0", "0 1 0"];
    for (face, expected) in [
        ("3 0 1 3", "is 3, but there are only 3 vertices"),
        ("3 0 1 -1", "negative"),
        ("3 0 1 99999999999", "too large"),
        ("3 0 1", "cut off"),
        ("3 0 1 x", "\"x\" is not a number"),
        ("2 0 1", "cloud of 3 points"),
    ] {
        let reason = fault(plain(&points, &[face]).as_bytes());
        assert!(reason.contains(expected), "{reason}");
    }
    let reason = fault(plain(&points, &["3 0 1 2"]).replace("float z", "float w").as_bytes());
    assert!(reason.contains("lacks x, y or z"), "{reason}");
}

#[test]
fn huge_counts_take_no_memory() {
    let huge = u64::MAX;
    for format in FORMATS {
        for element in ["vertex", "face", "other"] {
            let header = HEADER.replace("element camera 1", &format!("element {element} {huge}"));
            let reason = fault(&file(format, &header, &rows()));
            assert!(reason.contains("cut off") || reason.contains("lacks x"), "{reason}");
        }
        let header = HEADER
            .replace("element camera 1", &format!("element nothing {huge}\nelement camera 1"));
        load("scan.ply", &file(format, &header, &rows())).unwrap();
        // A list with too large a length.
        let mut long = rows();
        let header =
            HEADER.replace("list uchar int vertex_indices", "list uint int vertex_indices");
        long[6][1] = U32(u32::MAX);
        assert!(fault(&file(format, &header, &long)).contains("scan.ply: "));
    }
}

#[test]
fn geometry_beyond_the_budget_is_refused_with_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let many = plain(&vec!["0 0 0"; 30_000], &["3 0 1 2"]);
    let path = write(folder.path(), "scan.ply", many.as_bytes());
    let budget = MemoryBudget { geometry_bytes: 1 << 20, ..MemoryBudget::default() };
    let error = Scene::load_with(&path, &mut LoadOptions { budget, ..LoadOptions::default() });
    let error = error.unwrap_err();
    assert!(matches!(&error, SceneError::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("its 30000 vertices"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = load_from_memory("scan.ply", &bytes);
        for format in FORMATS {
            let mut head = file(format, HEADER, &[]);
            head.extend(&bytes);
            let _ = load_from_memory("scan.ply", &head);
        }
    }

    #[test]
    fn damaged_files_never_panic(at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in 0_usize..40) {
        for format in FORMATS {
            let mut bytes = file(format, HEADER, &rows());
            let at = at.index(bytes.len());
            bytes[at] = byte;
            bytes.truncate(bytes.len() - cut);
            let _ = load_from_memory("scan.ply", &bytes);
        }
    }
}

#[test]
fn trailing_data_is_reported() {
    let told = |format: &str, more: &[u8]| {
        let whole = [file(format, HEADER, &rows()), more.to_vec()].concat();
        let scene = load("scan.ply", &whole).unwrap();
        scene.notes.warnings.into_iter().find(|told| told.contains("behind all"))
    };
    for (format, more, words) in [
        ("ascii", &b"\n3 0 1 2\n3 0 1 3\n"[..], "2 lines"),
        ("binary_little_endian", &[7; 26], "26 bytes"),
        ("binary_big_endian", &[0; 13], "13 bytes"),
    ] {
        let words = format!(
            "{words} behind all that its header declares were ignored; if something is missing, the \
             header counts too little"
        );
        assert_eq!(told(format, more), Some(words));
        assert_eq!(told(format, b"\n"), None);
        assert_eq!(told(format, b""), None);
    }
}
