//! Scenes that move, from the command line.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::common::{INPUT, expect_error, folder, lumivox, moving_glb};

/// Small enough for a software driver.
const SMALL: &str = "--size 32x18 --frames 1 --resolution 32 --bounces 1 --shadow-resolution 64";

fn moving() -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("moving.glb"), moving_glb()).unwrap();
    folder
}

fn still(folder: &Path, options: &str) -> Vec<u8> {
    let line = format!("render moving.glb -o still.exr {SMALL} {options}");
    lumivox(folder, &line).expect_ok();
    fs::read(folder.join("still.exr")).unwrap()
}

fn index(folder: &Path, file: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(file)).unwrap()).unwrap()
}

#[test]
#[ignore = "slow: over three seconds"]
fn the_time_option_renders_one_moment() {
    let folder = moving();
    let still = |options: &str| still(folder.path(), options);
    let rest = still("");
    let start = still("--time 0");
    let middle = still("--time 1");
    assert!(rest == start, "the file shows the start");
    assert!(middle != start, "it moves");
    assert!(middle == still("--time 1 --animation 0"));
    assert!(middle == still("--time 1 --animation slide"));
    let risen = still("--time 1 --animation rise");
    assert!(risen != middle && risen != start);
    assert!(risen == still("--time 7 --animation 1"), "beyond its end it stands still");
    assert!(start == still("--animation slide"), "without a time it is its start");
    let both = still("--time 1 --animation all");
    assert!(both != start && both != middle, "the later one in the file wins");
    assert!(rest == still("--animation none"));
    // A converted scene keeps the pose of `--time`.
    lumivox(folder.path(), "convert moving.glb -o moved.glb --time 1").expect_ok();
    fs::rename(folder.path().join("moved.glb"), folder.path().join("moving.glb")).unwrap();
    assert!(middle == still(""));
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_sequence_plays_the_animation_in_one_grid() {
    let folder = moving();
    let path = folder.path();
    let line = format!("render moving.glb -o play_#.exr {SMALL} --time 0..2 --fps 2 --json");
    let report = lumivox(path, &line).expect_ok().json();
    assert_eq!(report["pictures"], 4);
    let index = index(path, "play_index.json");
    assert_eq!(index["settings"]["animation"], "slide");
    let read = |number: usize| fs::read(path.join(format!("play_{number}.exr"))).unwrap();
    let pictures: HashSet<_> = (0..4).map(read).collect();
    assert_eq!(pictures.len(), 4, "each picture shows another pose");
    // One grid contains all poses of the scene.
    let voxel = report["grid"]["voxel_size_m"].as_f64().unwrap();
    let origin = report["grid"]["origin"][0].as_f64().unwrap();
    assert!(origin < -1.0 && voxel * 32.0 >= 2.0, "{report}");

    // A picture rendered on its own is the same: it has no history, and exposure and unit of
    // radiance do not depend on the first picture of a run.
    let before = read(2);
    fs::remove_file(path.join("play_2.exr")).unwrap();
    let again = lumivox(path, &line).expect_ok().json();
    assert_eq!(again["rendered"], 1);
    assert!(read(2) == before);
}

/// With history, a sequence is rendered frame by frame, and a resumed run gives the same pictures.
#[test]
#[ignore = "slow: over three seconds"]
fn a_resumed_animation_with_history_gives_the_same_bits() {
    let folder = moving();
    let path = folder.path();
    let line = "render moving.glb -o film_#.png --size 32x18 --frames 2 --resolution 32 \
                --shadow-resolution 64 --preset realtime --volume octree --time 0..2 --fps 2 \
                --history kept --json";
    lumivox(path, line).expect_ok();
    let files = [0, 1, 2, 3].map(|number| path.join(format!("film_{number}.png")));
    let read = || files.each_ref().map(|file| fs::read(file).unwrap());
    let before = read();
    fs::remove_file(&files[1]).unwrap();
    fs::remove_file(&files[3]).unwrap();
    let report = lumivox(path, line).expect_ok().json();
    assert_eq!(report["rendered_again"], 2);
    assert!(read() == before, "other pictures");
}

/// Machines that each render a range have the same grid, exposure and numbering, and may share a
/// folder.
#[test]
#[ignore = "slow: over three seconds"]
fn ranges_rendered_separately_match_the_whole_sequence() {
    let folder = moving();
    let path = folder.path();
    let line = format!("render moving.glb {SMALL} --time 0..2 --fps 2 --orbit 30 --json");
    lumivox(path, &format!("{line} -o whole_#.png")).expect_ok();
    // The last range comes first, and reaches beyond the end.
    for (range, pictures) in [("3..6", 1), ("0..3", 3)] {
        let run = lumivox(path, &format!("{line} -o part_#.png --pictures {range}"));
        let report = run.expect_ok().json();
        assert_eq!([&report["pictures"], &report["rendered"]], [pictures, pictures], "{range}");
    }
    for number in 0..4 {
        let read = |name: &str| fs::read(path.join(format!("{name}_{number}.png"))).unwrap();
        assert!(read("whole") == read("part"), "picture {number}");
    }
    let last = index(path, "part_index_3-6.json");
    assert_eq!(last["frames"].as_array().unwrap().len(), 1);
    assert_eq!([&last["frames"][0]["number"], &last["frame_count"]], [3, 4]);
    assert_eq!(last["exposure"], index(path, "whole_index.json")["exposure"]);
    let again = format!("{line} -o part_#.png --pictures 0..3");
    assert_eq!(lumivox(path, &again).expect_ok().json()["rendered"], 0, "a retry finds them");
    for (range, needles) in [
        ("4..5", ["--pictures 4..5", "has 4 pictures, numbered from 0"]),
        ("3..3", ["--pictures", "B above A"]),
    ] {
        let line = format!("{line} -o part_#.png --pictures {range}");
        expect_error(path, &line, INPUT, &needles);
    }
}

/// Renders only the moving plate: its left edge is at -0.9 m in the first of three pictures, and
/// its right edge at 0.9 m in the last.
#[test]
fn the_grid_holds_all_poses() {
    let folder = moving();
    let options = "--scene-in-file plate --time 0..2 --fps 1.25 --exposure 0 --json";
    let line = format!("render moving.glb -o plate_#.png {SMALL} {options}");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(report["pictures"], 3);
    let voxel = report["grid"]["voxel_size_m"].as_f64().unwrap();
    let origin = report["grid"]["origin"][0].as_f64().unwrap();
    assert!(origin < -0.9 && origin + 32.0 * voxel > 0.9, "{report}");
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_file_pattern_or_open_time_range_plays_everything() {
    let folder = moving();
    // Only the number of pictures matters; a fixed exposure needs no metering.
    let quick = SMALL.replace("--resolution 32", "--resolution 16 --exposure 0");
    for (options, pictures) in [
        ("--fps 1", 2),
        ("--fps 1 --animation rise", 1),
        ("--fps 2 --time 1..", 2),
        ("--fps 1 --animation all --orbit 90", 2),
    ] {
        let line = format!("render moving.glb -o a_#.png {quick} {options} --restart --json");
        let report = lumivox(folder.path(), &line).expect_ok().json();
        assert_eq!(report["pictures"], pictures, "{options}");
    }
}

#[test]
fn bad_animation_options_name_the_choices() {
    let folder = moving();
    let path = folder.path();
    for (options, needles) in [
        ("--animation jump", ["no animation \"jump\"", "0 \"slide\", 1 \"rise\""]),
        ("--animation 2", ["no animation \"2\"", "1 \"rise\""]),
        ("--scene-in-file cellar", ["\"cellar\"", "1 \"plate\""]),
        ("--time 3..", ["the range of time is empty", "ends at 2 s"]),
    ] {
        let line = format!("render moving.glb -o a_#.png {options}");
        expect_error(path, &line, INPUT, &needles);
    }
    let line = "render moving.glb -o a_#.png --time 1";
    expect_error(path, line, INPUT, &["a_#.png", "one time gives one picture"]);
}
