//! Kinds of volumes on the command line: their views, and refusals.

use std::fs;

use crate::common::{GPU, INPUT, USAGE, expect_error, folder, lumivox, names};

#[test]
fn rendering_from_an_octree_reports_its_memory() {
    let folder = folder();
    let line = "render builtin:cornell -o a.png --size 40x30 --resolution 32 --frames 1 \
                --bounces 1 --volume octree --octree-builder locks --json";
    let report = lumivox(folder.path(), line).expect_ok().json();
    assert_eq!(report["settings"]["volume"], "octree");
    let memory = report["memory"].as_array().unwrap();
    let has = |name: &str| memory.iter().any(|part| part["name"] == name);
    assert!(has("volume: bricks") && has("volume: nodes and their table"), "{report}");
}

#[test]
fn impossible_volume_settings_are_refused_with_a_remedy() {
    let folder = folder();
    let render = "render builtin:cornell -o a.png --size 40x30 --resolution 64 --frames 1";
    let small = format!("{render} --volume octree --volume-memory 1MiB");
    expect_error(folder.path(), &small, GPU, &["the octree", "1048576 are allowed", "resolution"]);
    let small = format!("{render} --view lod --volume-memory 1MiB");
    expect_error(folder.path(), &small, GPU, &["a dense volume", "1048576 are allowed"]);
    let view = format!("{render} --view bricks");
    expect_error(folder.path(), &view, INPUT, &["bricks", "--volume octree"]);
    expect_error(folder.path(), &format!("{render} --volume tree"), USAGE, &["dense", "octree"]);
    assert!(names(folder.path()).is_empty(), "a refused command left files");
}

#[test]
#[ignore = "slow: over three seconds"]
fn commands_take_every_volume_with_presets_or_refuse_it_by_name() {
    let folder = folder();
    let sizes = ["--resolution 16", "--resolution 16", "--cascade-resolution 32"];
    for (volume, size) in ["dense", "octree", "cascades"].into_iter().zip(sizes) {
        let small = format!("--volume {volume} {size}");
        let line = format!("voxels builtin:cornell {small} --json");
        let report = lumivox(folder.path(), &line).expect_ok().json();
        assert!(report["voxels"].as_u64().unwrap() > 100, "{report}");
        for preset in ["realtime", "high", "report"] {
            let line = format!(
                "render builtin:cornell {small} --preset {preset} --size 16x12 --frames 1 \
                 --shadow-resolution 64 -o {preset}.png"
            );
            if (volume, preset) == ("cascades", "report") {
                fs::remove_file(folder.path().join("report.png")).unwrap();
                let words = ["volume is cascades, with the injection photons", "octree"];
                expect_error(folder.path(), &line, INPUT, &words);
            } else {
                lumivox(folder.path(), &line).expect_ok();
            }
        }
    }
}
