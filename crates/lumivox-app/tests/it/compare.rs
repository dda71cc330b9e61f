//! `lumivox compare --images`: figures and strips of any two pictures.

use std::fs;
use std::path::Path;

use image::{Rgb, RgbImage};

use crate::common::{INPUT, OUTPUT, USAGE, expect_error, folder, lumivox, names};

/// Writes a grey picture whose pixels have the values `codes`, repeated.
fn png(path: &Path, width: u32, height: u32, codes: &[u8]) {
    let code = |x, y| codes[(y * width + x) as usize % codes.len()];
    RgbImage::from_fn(width, height, |x, y| Rgb([code(x, y); 3])).save(path).unwrap();
}

#[test]
#[ignore = "slow: over three seconds"]
fn two_renderings_are_compared() {
    let folder = folder();
    for (name, frames) in [("reference", 8), ("ours", 1)] {
        let line = format!(
            "render builtin:cornell -o {name}.exr --size 48x36 --resolution 32 --frames {frames}"
        );
        lumivox(folder.path(), &line).expect_ok();
    }
    let figures = |ours: &str| {
        let line = format!("compare --images reference.exr {ours}.exr --json");
        let report = lumivox(folder.path(), &line).expect_ok().json();
        assert_eq!(report["reference"], "reference.exr");
        assert_eq!(report["size"], serde_json::json!([48, 36]));
        ["rmse_percent", "bias_percent", "p95_percent", "flip"]
            .map(|name| report["final"][name].as_f64().unwrap())
    };
    let [reference, ours] = ["reference", "ours"].map(figures);
    assert!(reference.iter().all(|figure| figure.abs() == 0.0), "{reference:?}");
    // One frame is jagged and noisy.
    assert!(ours.iter().all(|figure| figure.abs() > 0.0) && ours[0] > 1.0, "{ours:?}");
    assert_eq!(names(folder.path()), ["ours.exr", "reference.exr"]);
}

#[test]
fn screens_are_compared_in_linear_light_and_drawn() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    // sRGB codes 188 and 137 are 0.5029 and 0.2502 of white.
    png(&at("reference.png"), 4, 3, &[188]);
    png(&at("ours.png"), 4, 3, &[137]);
    let run = lumivox(folder.path(), "compare --images reference.png ours.png -o strip.png");
    let text = run.expect_ok().stdout;
    assert!(text.starts_with("ours.png against reference.png, 4x3\n"), "{text}");
    for word in ["bias", "RMSE", "p95", "FLIP", "final", "-50.26 %", "strip.png: reference, ours"] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
    let strip = image::open(at("strip.png")).unwrap();
    // Three pictures side by side, each enlarged 90 times.
    assert!(strip.width() > 3 * 360 && strip.height() > 270, "{}", strip.width());
}

#[test]
fn errors_say_why_pictures_cannot_be_compared() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    png(&at("a.png"), 4, 3, &[188]);
    png(&at("wide.png"), 5, 3, &[188]);
    png(&at("black.png"), 4, 3, &[0]);
    fs::write(at("text.exr"), "no picture").unwrap();
    fs::create_dir(at("folder.png")).unwrap();
    for (rest, code, needles) in [
        ("", USAGE, &["--images"][..]),
        ("--images a.png", USAGE, &["2 values"]),
        ("--images a.png missing.exr", INPUT, &["missing.exr", "check the path"]),
        ("--images text.exr a.png", INPUT, &["text.exr", ".exr", "PNG or JPEG"]),
        ("--images a.png wide.png", INPUT, &["wide.png against a.png", "4x3", "5x3"]),
        ("--images black.png a.png", INPUT, &["black.png", "is black"]),
        ("--images a.png a.png --layer full", INPUT, &["a.png", "leave --layer out"]),
        ("--images a.png a.png -o strip.exr", INPUT, &["strip.exr", ".png"]),
        ("--images a.png a.png -o folder.png", OUTPUT, &["folder.png", "in the way"]),
        ("--images a.png a.png -o nowhere/a.png", OUTPUT, &["there is no folder nowhere"]),
    ] {
        expect_error(folder.path(), &format!("compare {rest}"), code, needles);
    }
}
