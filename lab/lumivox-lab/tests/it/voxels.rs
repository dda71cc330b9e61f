//! `lumivox-lab voxelizers` and `lumivox-lab dynamic`: comparisons of voxels.

use std::fs;

use crate::common::{folder, lumivox as lab};

#[test]
#[ignore = "slow: over three seconds"]
fn voxelizers_are_compared() {
    let folder = folder();
    // Walls at an angle to the grid show both missing and extra voxels of the rasterizer.
    let line = "voxelizers builtin:cornell --rotate 17,31,5 --resolution 32";
    let run = lab(folder.path(), &format!("{line} -o a.png --size 80x60 --json"));
    let report = run.expect_ok().json();
    let method = |name: &str| {
        let methods = report["methods"].as_array().unwrap();
        methods.iter().find(|method| method["name"] == name).unwrap().clone()
    };
    let number = |name: &str, key: &str| method(name)[key].as_f64().unwrap();
    let exact = number("exact", "voxels");
    for name in ["exact", "dominant-axis", "conservative", "three-plane"] {
        let [voxels, missing, extra] = ["voxels", "missing", "extra"].map(|key| number(name, key));
        assert!((voxels - (exact - missing + extra)).abs() < 0.5, "{name}: {report}");
        assert!((number(name, "area") - 1.0).abs() < 0.02, "{name}: {report}");
        assert!(number(name, "wall_ms") > 0.0, "{name}: {report}");
    }
    for key in ["missing", "extra", "color_rmse", "missing_area"] {
        assert!(number("exact", key) == 0.0, "{key}: {report}");
    }
    assert!(number("conservative", "missing") == 0.0, "{report}");
    assert!(number("conservative", "extra") > 0.0, "{report}");
    assert!(number("dominant-axis", "missing") > number("three-plane", "missing"), "{report}");
    assert!(number("three-plane", "missing") > 0.1 * exact, "{report}");
    assert!(number("dominant-axis", "color_rmse") > 0.001, "{report}");
    let png = fs::read(folder.path().join("a.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));

    let text = lab(folder.path(), line).expect_ok().stdout;
    for word in ["three-plane", "missing", "too many", "colour RMSE", "Times on"] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn voxels_measures_the_savings_of_keeping_static_triangles() {
    let folder = folder();
    let line = "dynamic builtin:cornell --resolution 32 --share 0.1 --moves 2";
    let report = lab(folder.path(), &format!("{line} --json")).expect_ok().json();
    assert_eq!(report["has_same_bits"], true, "{report}");
    assert_eq!(report["dynamic_triangles"], 4, "{report}");
    assert_eq!(report["scene"]["triangles"], 40, "{report}");
    assert!(report["kept_bytes"].as_u64().unwrap() > 0);
    let changed = report["changed_share"].as_f64().unwrap();
    assert!(changed > 0.0 && changed < 1.0, "{report}");
    let stages: Vec<_> = report["stages"].as_array().unwrap().iter().map(|s| &s["stage"]).collect();
    for stage in ["voxelize", "changes", "volume", "light", "filter"] {
        assert!(stages.iter().any(|name| *name == stage), "{stage} is missing in {report}");
    }
    let text = lab(folder.path(), line).expect_ok().stdout;
    for word in ["that move", "static kept", "the same bits"] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
}
