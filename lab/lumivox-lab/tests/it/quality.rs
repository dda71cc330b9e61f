//! `lumivox-lab quality`: the page on errors, and how a stopped run is continued.

use std::fs;

use crate::common::{INPUT, expect_error, folder, lumivox as lab, names};
#[cfg(unix)]
use crate::common::{STOPPED, command, interrupt, process};

#[test]
#[ignore = "slow: over three seconds"]
fn quality_docs_writes_the_page_and_resumes_cached_work() {
    let folder = folder();
    let line = "quality docs furnace --presets balanced,high --resolutions 16,24 --size 16x12 --samples \
                32 --frames 2 --offsets 1 --cache kept";
    lab(folder.path(), line).expect_ok();
    let page = fs::read_to_string(folder.path().join("docs/quality.md")).unwrap();
    for part in [
        "# How far from the truth",
        "| furnace | high |",
        "images/quality/furnace.png",
        "turned by",
    ] {
        assert!(page.contains(part), "{part} is missing in {page}");
    }
    let pictures = names(&folder.path().join("docs/images/quality"));
    assert_eq!(pictures, ["error-against-cost.svg", "furnace.png"]);
    // Nothing is measured again: the page shows a modified measurement.
    let kept = folder.path().join("kept/measurements.json");
    let text = fs::read_to_string(&kept).unwrap();
    let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
    json["entries"]["furnace 0,0,0 high 24"]["figures"]["one_bounce"]["bias_percent"] = 77.7.into();
    fs::write(&kept, json.to_string()).unwrap();
    lab(folder.path(), line).expect_ok();
    let page = fs::read_to_string(folder.path().join("docs/quality.md")).unwrap();
    assert!(page.contains("+77.7") && page.contains("missed"), "{page}");
    let other = line.replace("--frames 2", "--frames 3");
    expect_error(folder.path(), &other, INPUT, &["measurements.json", "delete it"]);
    expect_error(folder.path(), "quality docs nonsense", INPUT, &["nonsense", "cornell"]);
}

/// Ctrl-C stops the program between two measurements, with its own exit code; finished measurements
/// are kept.
#[cfg(unix)]
#[test]
#[ignore = "slow: over three seconds"]
fn interrupted_measurements_can_be_resumed() {
    use std::io::{BufRead as _, BufReader, Read as _};
    use std::process::Stdio;
    let folder = folder();
    let line = "quality page cornell --cache cache --presets fast,balanced,high --resolutions 16,24 \
                --size 16x12 --samples 32 --frames 1 --offsets 1";
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut child = command(folder.path(), &words)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    while !said.contains("3 of ") {
        assert!(stderr.read_line(&mut said).unwrap() > 0, "it ended early: {said}");
    }
    interrupt(&child);
    stderr.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(STOPPED), "{said}");
    assert!(
        said.contains("measurements; cache has them, and the same command continues"),
        "{said}"
    );
    let kept = fs::read(folder.path().join("cache/measurements.json")).unwrap();
    let kept: serde_json::Value = serde_json::from_slice(&kept).unwrap();
    let count = kept["entries"].as_object().unwrap().len();
    assert!(count >= 2 && said.contains(&format!("stopped after {count} of ")), "{said}");
    assert_eq!(names(&folder.path().join("cache")), ["cornell.exr", "measurements.json"]);
    let run = process(folder.path(), &words, "").expect_ok();
    assert!(!run.stderr.contains("warning: 1 of "), "{}", run.stderr);
    assert!(run.stderr.contains(&format!("warning: {} of ", count + 1)), "{}", run.stderr);
}
