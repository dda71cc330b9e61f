//! `lumivox-lab motion`: sequences of steps against the path-traced truth of each.

use std::fs;

use serde_json::Value;

use crate::common::{
    INPUT, OUTPUT, USAGE, expect_error, folder, lumivox as lab, moving_glb, names,
};

/// Small enough for a test.
const SMALL: &str = "--size 32x18 --samples 32 --resolution 32 --steps 2 --preset fast";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// At present the renderer restarts at every change: light changes at once, and leaves no trail.
#[test]
#[ignore = "slow: over three seconds"]
fn a_switched_lamp_is_measured_step_by_step() {
    let folder = folder();
    let line = format!("motion --sequence switch {SMALL} --truth truth --json - -o pictures");
    let report = lab(folder.path(), &line).expect_ok().json();
    assert_eq!(report["size"], serde_json::json!([32, 18]));
    assert_eq!(report["samples"], 32);
    let switch = &report["sequences"][0];
    assert_eq!((&switch["sequence"], &switch["scene"]), (&"switch".into(), &"cornell".into()));
    assert_eq!((number(&switch["steps"]), number(&switch["truths"])), (50.0, 50.0));
    assert_eq!(number(&switch["in_motion"]["steps"]), 32.0);
    for layer in ["full", "picture"] {
        let spread = &switch["in_motion"][layer];
        assert!(number(&spread["bias_percent"]["median"]).abs() < 30.0, "{layer}: {spread}");
        let rmse = &spread["rmse_percent"];
        assert!(number(&rmse["worst"]) >= number(&rmse["median"]), "{layer}: {spread}");
        // At rest, the irradiance's error may be only the truth's noise.
        let of_still = &spread["rmse_of_still"];
        assert!(of_still.is_null() || number(&of_still["median"]) > 1.0, "{layer}: {spread}");
        assert!(number(&spread["flip"]["median"]) > 0.0, "{layer}: {spread}");
    }
    assert!(number(&switch["flicker"]["display"]["worst"]) < 0.1, "{}", switch["flicker"]);
    for (change, name) in ["off", "on"].into_iter().enumerate() {
        let latency = &switch["latency"][change];
        assert_eq!(latency["change"].as_str().or(latency["name"].as_str()), Some(name));
        let first = number(&latency["there"][0]["percent"]);
        assert!((first - 100.0).abs() < 15.0, "{latency}");
        let trail = &switch["trail"][change]["left"];
        assert_eq!(trail.as_array().map(Vec::len), Some(3), "{trail}");
        assert!(number(&trail[2]["percent"]).abs() < 5.0, "{trail}");
    }
    assert!(switch["disoccluded"].is_null(), "the camera is still: {}", switch["disoccluded"]);
    assert!(switch["leak_percent"].is_null(), "the panel still glows");
    assert_eq!(switch["at_stop"], serde_json::json!([]));
    let cost = &switch["cost"];
    for name in ["ms", "samples_per_pixel", "waits", "allocated_bytes"] {
        let [median, p95, worst] = ["median", "p95", "worst"].map(|of| number(&cost[name][of]));
        assert!(median <= p95 && p95 <= worst && worst > 0.0, "{name}: {cost}");
    }
    assert_eq!(
        names(&folder.path().join("pictures")),
        ["error-against-cost.svg", "error-by-step.svg", "switch-strip.png", "switch.png"]
    );
    // Two poses have a truth each.
    assert_eq!(names(&folder.path().join("truth")).len(), 2);
}

#[test]
#[ignore = "slow: over three seconds"]
fn the_orbit_sequence_reports_disocclusion_and_the_stop() {
    let folder = folder();
    let line = format!("motion builtin:cornell --sequence orbit {SMALL} --json figures.json");
    let text = lab(folder.path(), &line).expect_ok().stdout;
    for word in ["orbit, cornell", "in motion", "at stop", "disoccluded", "flicker", "ms", "waits"]
    {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
    let report = fs::read_to_string(folder.path().join("figures.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    let orbit = &report["sequences"][0];
    let new = &orbit["disoccluded"];
    assert_eq!(number(&new["steps"]), 2.0);
    let percent = number(&new["percent_of_pixels"]);
    assert!(percent > 0.5 && percent < 30.0, "{new}");
    assert!(number(&new["full"]["rmse_percent"]) > 0.0, "{new}");
    let stop = orbit["at_stop"].as_array().unwrap();
    let after: Vec<f64> = stop.iter().map(|stop| number(&stop["after"])).collect();
    assert_eq!(after, [0.0, 1.0, 4.0, 16.0, 64.0]);
    let rmse = |index: usize| number(&stop[index]["full"]["rmse_with_noise_percent"]);
    assert!(rmse(4) < rmse(0), "frames are averaged: {} to {}", rmse(0), rmse(4));
    let on_screen = |index: usize, name: &str| number(&stop[index]["on_screen"][name]);
    let [first, last] = [0, 4].map(|index| on_screen(index, "rmse_with_noise"));
    assert!(last < first && first < 0.5, "{first} to {last}");
    let changes = [0, 4].map(|index| on_screen(index, "change_rmse"));
    assert!(changes[1] < 0.2 * changes[0], "what rests hardly changes: {changes:?}");
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_scene_file_is_measured_in_its_own_animation() {
    let folder = folder();
    fs::write(folder.path().join("moving.glb"), moving_glb()).unwrap();
    let line = format!("motion moving.glb {SMALL} --json -");
    let report = lab(folder.path(), &line).expect_ok().json();
    let sequence = &report["sequences"][0];
    assert_eq!(sequence["sequence"], "animation");
    assert_eq!(number(&sequence["in_motion"]["steps"]), 2.0);
}

#[test]
#[ignore = "release: traces paths of three sequences, and renders each with all presets"]
fn the_page_has_all_tables_and_pictures_at_release() {
    let folder = folder();
    let small = SMALL.replace(" --preset fast", "");
    let line = format!("motion --doc docs --sequence door,lamp,orbit {small} --cache kept");
    assert_eq!(lab(folder.path(), &line).expect_ok().stdout, "docs/motion.md\n");
    let read = || fs::read_to_string(folder.path().join("docs/motion.md")).unwrap();
    let page = read();
    // A second run measures nothing: its times would differ.
    lab(folder.path(), &line).expect_ok();
    assert_eq!(read(), page);
    for text in [
        "## Error in motion",
        "## Beside published figures",
        "| Lumivox, `realtime`, at rest after 64 frames | cornell | 0.",
        "| 38 scenes | 0.0703 | 0.0699 | 0.0699 | -6.9 % | 0.0025 |",
        "## Flicker",
        "## What has just become visible",
        "## After a change",
        "## Light where there is none",
        "## Cost",
        "| door | fast | full |",
        "| door | realtime | picture |",
        "| lamp | realtime | full |",
        "| door | closed | fast |",
        "images/motion/door-strip.png",
        "images/motion/lamp.png",
    ] {
        assert!(page.contains(text), "{text} is missing in {page}");
    }
    let pictures = names(&folder.path().join("docs/images/motion"));
    for picture in pictures.iter().filter(|name| !name.starts_with("error")) {
        assert!(page.contains(picture.as_str()), "{picture} is not on the page");
    }
    assert_eq!(pictures.len(), 8, "{pictures:?}");
}

#[test]
fn invalid_motion_options_are_refused() {
    let folder = folder();
    for (rest, code, needles) in [
        ("--sequence jump", INPUT, &["\"jump\"", "orbit", "switch"][..]),
        ("builtin:furnace --sequence switch", INPUT, &["no lamp", "orbit"]),
        ("builtin:atrium --sequence block", INPUT, &["builtin:cornell", "atrium"]),
        ("--sequence animation", INPUT, &["SCENE with an animation"]),
        ("builtin:nothing", INPUT, &["nothing", "cornell"]),
        ("--sequence orbit --preset vxct", INPUT, &["vxct", "choose another"]),
        ("--sequence orbit --json nowhere/a.json", OUTPUT, &["there is no folder nowhere"]),
        ("builtin:cornell --doc docs", USAGE, &["--doc"]),
        ("--sequence orbit --steps 0", INPUT, &["--steps", "1"]),
        ("--sequence orbit --samples 16", INPUT, &["--samples", "32"]),
    ] {
        expect_error(folder.path(), &format!("motion {rest}"), code, needles);
    }
}
