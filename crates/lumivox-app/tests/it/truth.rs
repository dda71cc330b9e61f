//! `lumivox compare SCENE`: renderings against their path-traced truth.

use std::fs;

use crate::common::{INPUT, USAGE, expect_error, folder, lumivox, names};

/// Small enough for a test, accurate enough for figures.
const SMALL: &str = "--size 32x24 --samples 32 --frames 4 --resolution 32 --offsets 1";

#[test]
#[ignore = "slow: over three seconds"]
fn a_scene_is_compared_with_its_truth() {
    let folder = folder();
    let line = format!("compare builtin:cornell {SMALL} --reference truth.exr -o strip.png --json");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(report["scene"], "cornell");
    assert_eq!(report["samples"], 32);
    for layer in ["one_bounce", "full", "final"] {
        let figure = |name: &str| report[layer][name].as_f64().unwrap();
        // 32 voxels in a Cornell box: within 15 % of the truth, but not equal to it.
        assert!(figure("bias_percent").abs() < 15.0, "{layer}: {report}");
        assert!(figure("rmse_with_noise_percent") > figure("noise_percent") * 0.5, "{layer}");
        assert!((0.0..1.0).contains(&figure("flip")), "{layer}");
        assert!(figure("p95_percent") > 0.0, "{layer}");
    }
    assert!(report["samples_per_pixel"].as_f64().unwrap() > 10.0);
    assert_eq!(names(folder.path()), ["strip.png", "truth.exr"]);
    let strip = image::open(folder.path().join("strip.png")).unwrap().to_rgb8();
    assert!(strip.width() > 900 && strip.height() > 600, "{:?}", strip.dimensions());

    // The saved reference gives the same figures.
    let again = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(again["full"], report["full"]);
    // The reference is rejected for another scene.
    let other = format!("compare builtin:furnace {SMALL} --reference truth.exr");
    expect_error(folder.path(), &other, INPUT, &["truth.exr", "another scene", "delete it"]);
    let more = line.replace("--samples 32", "--samples 64");
    expect_error(folder.path(), &more, INPUT, &["truth.exr", "32 samples", "64"]);
    fs::write(folder.path().join("truth.exr"), "no picture").unwrap();
    expect_error(folder.path(), &line, INPUT, &["truth.exr", "cannot read the reference"]);
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_black_reference_reports_only_the_leak() {
    let folder = folder();
    let line = format!("compare builtin:two-rooms-closed {SMALL} --json");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    // The truth is black, so there are no figures.
    assert!(report.get("one_bounce").is_none(), "{report}");
    let leak = report["leak_percent"].as_f64().unwrap();
    assert!((0.0..0.1).contains(&leak), "{leak} %");
    let full = report["leak_full_percent"].as_f64().unwrap();
    assert!((0.0..0.1).contains(&full), "{full} %");
}

#[test]
fn compare_needs_either_a_scene_or_images() {
    let folder = folder();
    expect_error(folder.path(), "compare", USAGE, &["SCENE"]);
    let both = "compare builtin:cornell --images a.exr b.exr";
    expect_error(folder.path(), both, USAGE, &["--images"]);
}
