//! Bad input: a clear message, the right exit code, no panic, and nothing left behind.

use std::fs;
use std::path::Path;

use crate::common::{CORNER, GPU, INPUT, OUTPUT, USAGE, container, expect_error, folder, glb};

#[test]
fn broken_scene_files_are_refused() {
    let folder = folder();
    let file = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let good = glb(&CORNER);
    file("empty.glb", b"");
    file("empty.gltf", b"");
    file("cut.glb", &good[..good.len() - 20]);
    file("head.glb", &good[..10]);
    file("broken.gltf", b"{ \"asset\": { \"version\": ");
    file("broken.glb", &container("{ \"asset\": ", &[]));
    file("nan.glb", &glb(&[[f32::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    file("none.glb", &container("{ \"asset\": { \"version\": \"2.0\" } }", &[]));
    file("point.glb", &glb(&[[1.0, 2.0, 3.0]; 3]));
    file("line.glb", &glb(&[[0.0; 3], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]));
    file("scene.blend", b"BLENDER");
    fs::create_dir(folder.path().join("folder.glb")).unwrap();
    for (name, needle) in [
        ("missing.glb", "cannot read the file"),
        ("empty.glb", "malformed"),
        ("empty.gltf", "malformed"),
        ("cut.glb", "malformed"),
        ("head.glb", "malformed"),
        ("broken.gltf", "malformed"),
        ("broken.glb", "malformed"),
        ("nan.glb", "not finite"),
        ("none.glb", "triangles"),
        ("point.glb", "size zero"),
        ("line.glb", "triangles"),
        ("scene.blend", ".gltf, .glb, .obj"),
        ("folder.glb", "is a folder"),
    ] {
        let line = format!("render {name} -o a.png");
        expect_error(folder.path(), &line, INPUT, &[name, needle]);
        let line = format!("info {name}");
        expect_error(folder.path(), &line, INPUT, &[name, needle]);
    }
    expect_error(folder.path(), "voxels point.glb", INPUT, &["point.glb"]);
}

#[test]
fn unknown_names_are_refused_with_the_known_ones() {
    let folder = folder();
    let path = folder.path();
    let known = ["\"nowhere\"", "cornell", "atrium"];
    for command in ["render -o a.png", "voxels", "info"] {
        expect_error(path, &format!("{command} builtin:nowhere"), INPUT, &known);
    }
    let line = "render cornell -o a.png";
    expect_error(path, line, INPUT, &["did you mean builtin:cornell?"]);
    let line = "render builtin:cornell -o a.png --camera nowhere";
    expect_error(path, line, INPUT, &["cornell", "nowhere", "framing"]);
    let line = "render builtin:cornell -o a.png --camera 99";
    expect_error(path, line, INPUT, &["cornell", "number 99", "framing"]);
    let line = "render builtin:cornell -o a.png --adapter nowhere";
    expect_error(path, line, GPU, &["\"nowhere\"", "there are: "]);
    expect_error(path, "voxels builtin:cornell --adapter nowhere", GPU, &["\"nowhere\""]);
}

#[test]
fn option_values_out_of_range_are_refused() {
    let folder = folder();
    for (option, value, needle) in [
        ("--size", "0x0", "from 1 to 32768"),
        ("--size", "100000x100000", "from 1 to 32768"),
        ("--size", "-1x5", "from 1 to 32768"),
        ("--cones", "7", "6, 9 or 12"),
        ("--cones", "-6", "6, 9 or 12"),
        ("--texture-memory", "-1GiB", "from 1 KiB"),
        ("--resolution", "7", "multiple of 8 from 16 to 1024"),
        ("--resolution", "100000", "multiple of 8 from 16 to 1024"),
        ("--resolution", "-8", "multiple of 8 from 16 to 1024"),
        ("--grid-offset", "0,1,0", "below 1"),
        ("--grid-offset", "-1,0,0", "from 0 to below 1"),
        ("--frames", "0", "from 1 to 65536"),
        ("--bounces", "65", "from 0 to 64"),
        ("--level", "11", "from 0 to 10"),
        ("--exposure", "nan", "from -64 to 64"),
        ("--exposure", "-65", "from -64 to 64"),
        ("--shadow-resolution", "1", "from 16 to 32768"),
        ("--voxel-per-diameter", "2", "from 0.05 to 1"),
        ("--clearance", "0.01", "from 0.1 to 1, or 0"),
        ("--normal-offset", "inf", "from 0 to 4"),
        ("--step", "0", "from 0.25 to 1"),
        ("--min-transmittance", "-0.1", "from 0 to 0.25"),
        ("--specular-share", "0", "from 0.02 to 1"),
        ("--occlusion-distance", "-1", "from 0 to"),
        ("--sun", "0,0,0", "must not be 0,0,0"),
        ("--sun", "0,1,0,-5", "illuminance in lux"),
        ("--environment", "-1,0,0", "red is a number from 0"),
        ("--camera", "0,0,0,0,0,0", "different points"),
        ("--camera", "nan,0,0,1,1,1", "not a finite number"),
    ] {
        let line = format!("render builtin:cornell -o a.png {option} {value}");
        expect_error(folder.path(), &line, INPUT, &[option, value, needle]);
    }
    // The number of levels is not known before the grid exists.
    let line = "render builtin:cornell -o a.png --resolution 16 --size 8x8 --level 5";
    expect_error(folder.path(), line, INPUT, &["voxel level", "from 0 to 2"]);
}

#[test]
fn usage_errors_name_the_wrong_argument() {
    let folder = folder();
    let path = folder.path();
    for (line, needle) in [
        ("render", "--output"),
        ("render builtin:cornell", "--output"),
        ("paint", "paint"),
        ("render builtin:cornell -o a.png --size big", "WIDTHxHEIGHT"),
        ("render builtin:cornell -o a.png --frames many", "whole number"),
        ("render builtin:cornell -o a.png --view everything", "occlusion"),
        ("render builtin:cornell -o a.png --cones six", "6, 9 or 12"),
        ("render builtin:cornell -o a.png --half --full", "--full"),
        ("render builtin:cornell -o a.png --sun up", "X,Y,Z"),
        ("render builtin:cornell -o a.png --colour", "--colour"),
    ] {
        expect_error(path, line, USAGE, &[needle]);
    }
}

#[test]
fn requests_beyond_gpu_limits_name_the_limit() {
    let folder = folder();
    let line = "render builtin:cornell -o a.png --portable --size 16384x16";
    let needles = ["max_texture_dimension_2d", "16384x16", "at most 8192x8192"];
    expect_error(folder.path(), line, GPU, &needles);
    let line = "voxels builtin:cornell --portable --resolution 1024";
    expect_error(
        folder.path(),
        line,
        GPU,
        &["max_storage_buffer_binding_size", "a resolution of 512 would fit"],
    );
}

#[test]
fn unwritable_outputs_are_refused_before_loading() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").unwrap();
    fs::create_dir(folder.path().join("folder.png")).unwrap();
    // The scene is missing, too: this shows that the output is checked first.
    for (output, code, needle) in [
        ("a.jpg", INPUT, ".exr"),
        ("a", INPUT, ".png"),
        ("missing/a.png", OUTPUT, "there is no folder missing"),
        ("file/a.png", OUTPUT, "is a file, not a folder"),
        ("folder.png", OUTPUT, "in the way"),
    ] {
        let line = format!("render missing.glb -o {output}");
        expect_error(folder.path(), &line, code, &[output, needle]);
    }
}

#[cfg(unix)]
#[test]
fn a_read_only_output_folder_is_refused() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder();
    let locked = folder.path().join("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    // The superuser ignores permissions, except below /proc.
    let locked = if fs::write(locked.join("test"), "").is_ok() { "/proc" } else { "locked" };
    if Path::new("/proc/self").exists() || locked == "locked" {
        let line = format!("render builtin:cornell -o {locked}/a.png");
        let needles = [locked, "a.png", "no file can be made"];
        expect_error(folder.path(), &line, OUTPUT, &needles);
    }
}
