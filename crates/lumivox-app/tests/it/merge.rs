//! `lumivox reference --part` and `lumivox merge`.

use std::fs;
use std::path::Path;

use crate::common::{CORNER, INPUT, OUTPUT, USAGE, expect_error, folder, glb, lumivox, names};

/// Small enough for a software driver.
const SMALL: &str = "reference builtin:cornell --size 32x18";

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap()
}

#[test]
#[ignore = "slow: over three seconds"]
fn merged_parts_equal_one_run_in_any_order() {
    let folder = folder();
    let path = folder.path();
    lumivox(path, &format!("{SMALL} -o whole.exr --samples 64")).expect_ok();
    let line = format!("{SMALL} --batches 0..1 --part a --json");
    let report = lumivox(path, &line).expect_ok().json();
    assert_eq!(report["batches"], serde_json::json!([0, 1]));
    assert_eq!(report["samples"], 16);
    lumivox(path, &format!("{SMALL} --batches 1..3 --part b")).expect_ok();
    lumivox(path, &format!("{SMALL} --batches 3..4 --part c")).expect_ok();
    // A repeated part has the same bytes.
    lumivox(path, &format!("{SMALL} --batches 1..3 --part d")).expect_ok();
    assert!(read(path, "b") == read(path, "d"), "a part differs from run to run");
    for (number, parts) in ["a b c", "c a b", "b d c a b"].into_iter().enumerate() {
        let line = format!("merge {parts} -o merged{number}.exr --json");
        let report = lumivox(path, &line).expect_ok().json();
        assert_eq!((&report["samples"], &report["parts"]), (&64.into(), &3.into()));
        let merged = read(path, &format!("merged{number}.exr"));
        assert!(merged == read(path, "whole.exr"), "{parts}: other bytes than one run");
    }
    lumivox(path, &format!("{SMALL} -o whole.png --samples 64")).expect_ok();
    let text = lumivox(path, "merge a b c -o merged.png").expect_ok().stdout;
    assert!(text.starts_with("merged.png: 32 x 18, 64 samples a pixel from 3 parts; noise: p"));
    assert!(read(path, "merged.png") == read(path, "whole.png"));
}

#[test]
#[ignore = "slow: over three seconds"]
fn incompatible_parts_are_refused_by_name() {
    let folder = folder();
    let path = folder.path();
    for (options, part) in [
        ("--batches 0..2", "a"),
        ("--batches 1..3", "overlapping"),
        ("--batches 3..4", "later"),
        ("--batches 2..3 --seed 1", "seed"),
        ("--batches 2..3 --bounces 1", "bounces"),
    ] {
        lumivox(path, &format!("{SMALL} {options} --part {part}")).expect_ok();
    }
    fs::write(path.join("text"), "no part").unwrap();
    // The maker's name follows the magic number and the name's length.
    let mut other = read(path, "later");
    let cut = other.len() / 2;
    fs::write(path.join("half"), &other[..cut]).unwrap();
    other[14] ^= 1;
    fs::write(path.join("changed"), &other).unwrap();
    for (parts, needles) in [
        ("a overlapping", ["overlapping", "1..3 are in part those of another part, 0..2"]),
        ("a later", ["batches 2..3 are missing", "--batches 2..3"]),
        ("later", ["batches 0..3 are missing", "--batches 0..3"]),
        ("a seed", ["seed", "another scene, camera, size, seed"]),
        ("a bounces", ["bounces", "number of bounces"]),
        ("a text", ["text", "not a part of a reference"]),
        ("a half", ["half", "damaged"]),
        ("a changed", ["changed", "damaged"]),
        ("a none", ["none", "cannot read the part"]),
    ] {
        expect_error(path, &format!("merge {parts} -o out.exr"), INPUT, &needles);
    }
    assert!(!names(path).contains(&"out.exr".to_owned()));
}

#[test]
fn bad_part_and_merge_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("corner.glb"), glb(&CORNER)).unwrap();
    for (line, code, needle) in [
        ("reference corner.glb", USAGE, "--output"),
        ("reference corner.glb --batches 0..1 -o a.exr", USAGE, "--output"),
        ("reference corner.glb --part a -o a.exr", USAGE, "--part"),
        ("reference corner.glb --part a --batches 0..1 --samples 16", USAGE, "--samples"),
        ("reference corner.glb --part a --batches 1", USAGE, "A..B"),
        ("reference corner.glb --part a --batches 3..2", INPUT, "B above A"),
        ("reference corner.glb --part a --samples 20", INPUT, "a multiple of 16"),
        ("reference corner.glb --part missing/a", OUTPUT, "there is no folder missing"),
        ("merge -o a.exr", USAGE, "<PART>"),
        ("merge a", USAGE, "--output"),
        ("merge a -o a.jpg", INPUT, ".exr"),
    ] {
        expect_error(path, line, code, &[needle]);
    }
}
