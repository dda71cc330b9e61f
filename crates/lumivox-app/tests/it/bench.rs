//! `lumivox bench`: positive figures, the reasons of rows without figures, and readable reports.

use std::fs;

use serde_json::Value;

use crate::common::{GPU, INPUT, OUTPUT, USAGE, expect_error, folder, lumivox, names};

/// The smallest measurement of a scene.
const SMALLEST: &str = "bench --resolutions 16 --sizes 32x18 --presets balanced --frames 3";

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Checks times, and returns the names of the stages.
fn check_part(part: &Value) -> Vec<&str> {
    let check = |spread: &Value| {
        let (median, p95) = (number(&spread["median"]), number(&spread["p95"]));
        assert!(p95 > 0.0 && p95 >= median, "{part}");
        median
    };
    assert!(number(&part["runs"]) >= 3.0, "{part}");
    assert!(check(&part["whole"]) > 0.0, "{part}");
    let stages = part["stages"].as_array().unwrap();
    for stage in stages {
        // The median is 0 if fewer than half of the frames had the stage.
        assert!(check(&stage["ms"]) >= 0.0, "{part}");
    }
    stages.iter().map(|stage| stage["stage"].as_str().unwrap()).collect()
}

/// Checks that all rows of each table have as many cells as its heading; returns the number of
/// tables.
fn check_tables(page: &str) -> usize {
    let cells = |line: &str| line.replace("\\|", "").matches('|').count();
    let mut tables = 0;
    let mut columns = None;
    for line in page.lines() {
        if !line.starts_with('|') {
            columns = None;
            continue;
        }
        assert!(line.ends_with('|'), "{line}");
        tables += usize::from(columns.is_none());
        assert_eq!(cells(line), *columns.get_or_insert(cells(line)), "{line}");
    }
    tables
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_benchmark_reports_the_machine_and_every_stage() {
    let folder = folder();
    let line = format!("{SMALLEST} --scene builtin:cornell --volumes dense --json a.json -o a.md");
    let run = lumivox(folder.path(), &line).expect_ok();
    assert_eq!(run.stdout, "", "both reports are in files");
    assert_eq!(names(folder.path()), ["a.json", "a.md"]);
    let text = fs::read_to_string(folder.path().join("a.json")).unwrap();
    let report: Value = serde_json::from_str(&text).unwrap();
    let machine = &report["machine"];
    assert!(!machine["name"].as_str().unwrap().is_empty());
    assert!(number(&machine["limits"]["max_texture_dimension_3d"]) >= 2048.0);
    let method = report["timing"]["method"].as_str().unwrap();
    if machine["kind"] == "Cpu" {
        assert_eq!(method, "waited submits");
    }
    let rows = report["rows"].as_array().unwrap();
    let ids: Vec<&str> = rows.iter().map(|row| row["id"].as_str().unwrap()).collect();
    let id = "cornell/dense/16/balanced/32x18";
    assert_eq!(ids, [format!("{id}/still"), format!("{id}/moving")]);
    for row in rows {
        assert!(row["problem"].is_null(), "{row}");
        let figures = &row["figures"];
        assert!(number(&figures["voxels"]) > 500.0);
        assert!(number(&figures["memory_bytes"]) > number(&figures["volume_bytes"]));
        assert!(number(&figures["volume_bytes"]) > 0.0);
        let frame = check_part(&figures["frame"]);
        assert!(frame.contains(&"trace") && frame.contains(&"G-buffer"), "{frame:?}");
        let moves = row["motion"] == "moving";
        for stage in ["voxelize", "bounce"] {
            assert_eq!(frame.contains(&stage), moves, "{frame:?}");
        }
    }
    let still = &rows[0]["figures"];
    let change = check_part(&still["change"]);
    for stage in ["voxelize", "light", "bounce", "filter"] {
        assert!(change.contains(&stage), "{change:?}");
    }
    // Each pixel has six cones with several samples each.
    let cones = &still["cones"];
    assert_eq!(cones["is_counted"], true);
    assert!(number(&cones["samples"]) > 32.0 * 18.0 * 6.0, "{cones}");

    let page = fs::read_to_string(folder.path().join("a.md")).unwrap();
    assert_eq!(check_tables(&page), 6, "{page}");
    for word in [machine["name"].as_str().unwrap(), method, id, "p95", "Moving"] {
        assert!(page.contains(word), "{word} is missing in {page}");
    }
}

#[test]
fn cases_that_do_not_fit_are_listed_with_reason() {
    let folder = folder();
    let line = "bench --scene builtin:cornell --resolutions 1024 --volumes dense --presets fast \
                --sizes 32x18 --frames 3 --portable --json -";
    let report = lumivox(folder.path(), line).expect_ok().json();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2);
    for row in rows {
        assert!(row["figures"].is_null(), "{row}");
        let problem = row["problem"].as_str().unwrap();
        assert!(problem.contains("resolution"), "{problem}");
    }
    let page = lumivox(folder.path(), line.trim_end_matches("--json -")).expect_ok().stdout;
    // Free memory differs from run to run.
    let problem = rows[0]["problem"].as_str().unwrap().split(", but").next().unwrap();
    assert!(page.contains(problem), "{page}");
    check_tables(&page);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn invalid_benchmark_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    expect_error(path, "bench -o a.txt", INPUT, &["a.txt", ".md"]);
    expect_error(path, "bench --json a.txt", INPUT, &["a.txt", ".json"]);
    expect_error(path, "bench -o none/a.md", OUTPUT, &["none", "make it first"]);
    expect_error(path, "bench --scene builtin:none", INPUT, &["none", "cornell"]);
    expect_error(path, "bench --scene none.glb", INPUT, &["none.glb"]);
    expect_error(path, "bench --frames 2", INPUT, &["--frames", "3"]);
    expect_error(path, "bench --resolutions 20", INPUT, &["multiple of 8"]);
    expect_error(path, "bench --volumes tree", USAGE, &["dense", "octree"]);
    expect_error(path, "bench --import none.json", INPUT, &["none.json", "check the path"]);
    fs::write(path.join("other.json"), "[1]").unwrap();
    expect_error(path, "bench --import other.json", INPUT, &["other.json", "line 1", "page"]);
    expect_error(path, "bench --quick --import other.json", USAGE, &["--import", "--quick"]);
    expect_error(path, "bench --adapter none-of-that-name", GPU, &["none-of-that-name"]);
}
