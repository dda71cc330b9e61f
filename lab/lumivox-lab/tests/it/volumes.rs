//! `lumivox-lab volumes`: memory and times of kinds of volumes.

use std::fs;

use serde_json::Value;

use crate::common::{INPUT, expect_error, folder, lumivox as lab, names};

fn row<'a>(report: &'a Value, name: &str, resolution: u32) -> &'a Value {
    let rows = report["rows"].as_array().unwrap();
    let is_it = |row: &&Value| row["name"] == name && row["resolution"] == resolution;
    rows.iter().find(is_it).unwrap_or_else(|| panic!("{name} at {resolution} in {report}"))
}

#[test]
#[ignore = "slow: over three seconds"]
fn octree_memory_grows_with_the_surface() {
    let folder = folder();
    let line = "volumes builtin:cornell --resolutions 32,64 --no-trace --alternatives -o chart.svg";
    let report = lab(folder.path(), &format!("{line} --json")).expect_ok().json();
    let number =
        |name, resolution, key: &str| row(&report, name, resolution)[key].as_f64().unwrap();
    let growth = |name| number(name, 64, "bytes") / number(name, 32, "bytes");
    assert!(growth("dense") > 7.0, "{}", growth("dense"));
    // The surface grows fourfold; only a small table grows eightfold.
    assert!(growth("octree") < 5.0, "{}", growth("octree"));
    assert!(number("octree", 64, "bytes") < 0.3 * number("dense", 64, "bytes"));
    for name in ["dense", "octree", "locks"] {
        assert!(number(name, 64, "voxels") > 20_000.0, "{name}");
        assert!(
            number(name, 64, "build_ms") > 0.0 && number(name, 64, "update_ms") > 0.0,
            "{name}"
        );
    }
    assert!(number("locks", 64, "lock_passes") >= 1.0);
    assert!(row(&report, "octree", 64)["lock_passes"].is_null());
    let chart = fs::read_to_string(folder.path().join("chart.svg")).unwrap();
    assert!(chart.contains("octree") && chart.contains("dense"), "{chart}");
    assert_eq!(names(folder.path()), ["chart.svg"]);

    let png = "volumes builtin:cornell -o a.png";
    expect_error(folder.path(), png, INPUT, &["a.png", ".svg"]);

    let text = lab(folder.path(), "volumes builtin:cornell --resolutions 32 --size 32x24")
        .expect_ok()
        .stdout;
    for word in ["dense", "octree", "a voxel", "trace", " ms", "MiB"] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
}
