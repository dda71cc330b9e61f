//! `lumivox-lab rooms`: measures random rooms.

use std::fs;

use crate::common::{INPUT, USAGE, expect_error, folder, in_this_process, lumivox as lab, names};

/// A lamp by night, and daylight through a window: errors of sensors are 0.6 and 1.3 %, of pictures
/// 0.2 and 0.5 % (lavapipe); the noise of the reference is 0.5 and 1.8 %.
#[test]
#[ignore = "slow: over three seconds"]
fn rooms_are_measured_within_six_percent() {
    let folder = folder();
    let line = "rooms --seed 8 --count 2 --kinds plain --resolution 64 --samples 4096 --frames 8 \
                --size 16x12 --keep kept --json rooms.json";
    let told = lab(folder.path(), line).expect_ok();
    for part in ["| all | 2 |", "| plain | 2 |", "| light: day | 1 |", "--seed 8"] {
        assert!(told.stdout.contains(part), "{part} is missing in {}", told.stdout);
    }
    let report = fs::read_to_string(folder.path().join("rooms.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    for (index, light) in ["lamp", "day"].into_iter().enumerate() {
        let room = &report["rooms"][index];
        assert_eq!(
            (room["seed"].as_u64(), room["light"].as_str()),
            (Some(8 + index as u64), Some(light))
        );
        let number = |name: &str| room[name].as_f64().unwrap_or_else(|| panic!("{name}: {room}"));
        assert!(number("error_percent").abs() < 6.0, "{room}");
        assert!(number("bias_percent").abs() < 6.0, "{room}");
        assert!(number("faulty_pixels") == 0.0, "{room}");
        assert!(number("noise_percent") > 0.0 && number("rmse_percent") >= 0.0, "{room}");
    }

    // The written room gives the same readings.
    let files = names(&folder.path().join("kept"));
    assert_eq!(files, ["plain-8.csv", "plain-8.glb", "plain-9.csv", "plain-9.glb"]);
    let line =
        "measure kept/plain-8.glb --points kept/plain-8.csv --resolution 64 --frames 8 --json";
    let words: Vec<&str> = line.split_whitespace().collect();
    let measured = in_this_process(lumivox_app::run, folder.path(), &words, "");
    let Some(again) = measured.map(|run| run.expect_ok().json()) else { return };
    let lux = |readings: &serde_json::Value| -> Vec<f64> {
        readings.as_array().unwrap().iter().map(|lux| lux.as_f64().unwrap()).collect()
    };
    let (cones, again) = (lux(&report["rooms"][0]["cones"]), lux(&again["readings"]["lux"]));
    for (a, b) in cones.iter().zip(&again) {
        assert!((a / b - 1.0).abs() < 1e-3, "{cones:?} {again:?}");
    }
}

#[test]
fn unknown_kinds_and_counts_are_refused() {
    let folder = folder();
    expect_error(folder.path(), "rooms --kinds cellar", USAGE, &["cellar", "room-in-room"]);
    expect_error(folder.path(), "rooms --count 0", INPUT, &["1 to 1000000"]);
}
