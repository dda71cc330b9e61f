//! The program as users see it: help, lists, reports, pictures.

use std::fs;

use crate::common::{CORNER, folder, glb, lumivox, names, process};

/// Small enough for a software driver.
const SMALL: &str = "--size 64x36 --frames 2 --resolution 32";

#[test]
fn without_arguments_it_shows_the_help() {
    let folder = folder();
    let bare = lumivox(folder.path(), "").expect_ok();
    let asked = lumivox(folder.path(), "-h").expect_ok();
    for run in [bare, asked] {
        assert!(run.stdout.contains("Usage: lumivox"), "{}", run.stdout);
        for word in ["render", "info", "voxels", "scenes", "Exit codes"] {
            assert!(run.stdout.contains(word), "{word}");
        }
        assert_eq!(run.stderr, "");
    }
    let version = lumivox(folder.path(), "--version").expect_ok().stdout;
    assert_eq!(version, format!("lumivox {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn every_command_has_help() {
    let folder = folder();
    for command in ["render", "info", "voxels", "convert", "compare", "scenes"] {
        let long = lumivox(folder.path(), &format!("{command} --help")).expect_ok();
        let asked = lumivox(folder.path(), &format!("help {command}")).expect_ok();
        assert_eq!(long.stdout, asked.stdout);
        assert!(long.stdout.contains(&format!("Usage: lumivox {command}")), "{}", long.stdout);
        lumivox(folder.path(), &format!("{command} -h")).expect_ok();
    }
    let help = lumivox(folder.path(), "help render").expect_ok().stdout;
    for text in [
        "[default: 640x360]",
        "[default: 128]",
        "[default: 16]",
        "[default: final]",
        "[default: balanced]",
        "- occlusion:",
        "in pixels",
        "with LUX lux",
        "in metres",
        "Examples:",
        "Exit codes:",
    ] {
        assert!(help.contains(text), "{text} is missing in {help}");
    }
    assert!(help.lines().all(|line| line.chars().count() <= 100), "{help}");
}

#[test]
fn a_scene_is_converted_and_stays_the_same() {
    let folder = folder();
    let run = lumivox(folder.path(), "convert builtin:cornell -o box.glb").expect_ok();
    assert!(run.stdout.starts_with("box.glb: "), "{}", run.stdout);
    lumivox(folder.path(), "convert box.glb -o again.glb").expect_ok();
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("box.glb") == read("again.glb"), "what is read and written again changes");
    let info = |scene: &str| {
        let text = lumivox(folder.path(), &format!("info {scene} --json")).expect_ok().stdout;
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        ["triangles", "materials", "lights", "cameras"].map(|key| json[key].clone())
    };
    assert_eq!(info("builtin:cornell"), info("box.glb"));
    for (line, needle) in [
        ("convert builtin:cornell -o box.obj", ".glb"),
        ("convert builtin:cornell -o nowhere/box.glb", "there is no folder"),
        ("convert builtin:cornell -o still.glb --time 1", "nothing moves"),
    ] {
        let run = lumivox(folder.path(), line);
        assert!(run.code != 0 && run.stderr.contains(needle), "{line}: {}", run.stderr);
    }
    assert_eq!(names(folder.path()), ["again.glb", "box.glb"]);
}

#[test]
fn the_scenes_are_listed() {
    let folder = folder();
    let list = lumivox(folder.path(), "scenes").expect_ok().stdout;
    for name in ["cornell", "two-rooms", "atrium", "furnace", "panel", "spheres", "arcade"] {
        assert!(list.contains(name), "{name} is missing in {list}");
    }
}

#[test]
fn info_describes_the_machine() {
    let folder = folder();
    let text = lumivox(folder.path(), "info").expect_ok().stdout;
    assert!(text.contains("largest storage binding"), "{text}");
    let report = lumivox(folder.path(), "info --json").expect_ok().json();
    let adapter = &report["adapters"][0];
    assert_eq!(report["default_adapter"], adapter["name"]);
    assert!(adapter["problem"].is_null(), "{adapter}");
    assert!(adapter["largest_volume"]["resolution"].as_u64().unwrap() >= 128, "{adapter}");
    assert!(adapter["max_texture_2d"].as_u64().unwrap() >= 8192, "{adapter}");
}

#[test]
fn info_describes_a_scene() {
    let folder = folder();
    fs::write(folder.path().join("corner.glb"), glb(&CORNER)).unwrap();
    let text = lumivox(folder.path(), "info corner.glb").expect_ok().stdout;
    assert!(text.starts_with("corner\n"), "{text}");
    let report = lumivox(folder.path(), "info corner.glb --json").expect_ok().json();
    assert_eq!(report["triangles"], 4);
    assert_eq!(report["bounds_max"], serde_json::json!([1.0, 2.0, 1.0]));
    assert_eq!(report["light_list"][0]["kind"], "point");
    assert_eq!(report["light_list"][0]["strength"], 100.0);
    let report = lumivox(folder.path(), "info builtin:cornell --json").expect_ok().json();
    assert!(report["camera_list"][0]["vertical_fov_deg"].as_f64().unwrap() > 1.0);
    let counts = ["static_triangles", "static_instances", "dynamic_triangles", "dynamic_instances"];
    assert_eq!(counts.map(|name| report[name].as_u64()), [Some(40), Some(7), Some(0), Some(0)]);
}

#[test]
fn voxels_are_counted() {
    let folder = folder();
    let line = "voxels builtin:cornell --resolution 32";
    let report = lumivox(folder.path(), &format!("{line} --json")).expect_ok().json();
    let voxels = report["voxels"].as_u64().unwrap();
    assert!(voxels > 0 && report["faces"].as_u64().unwrap() >= voxels, "{report}");
    assert_eq!(report["levels"][0]["nodes"].as_u64(), Some(voxels));
    assert_eq!(report["triangles"], report["scene"]["triangles"]);
    assert_eq!(report["skipped"], 0);
    let memory = report["memory"].as_array().unwrap();
    let sum: u64 = memory.iter().map(|part| part["bytes"].as_u64().unwrap()).sum();
    assert_eq!(report["memory_bytes"].as_u64(), Some(sum));
    assert!(report["stages"].as_array().unwrap().iter().all(|s| s["ms"].as_f64().unwrap() >= 0.0));
    assert!(report["wall_ms"].as_f64().unwrap() > 0.0);
    let text = lumivox(folder.path(), &format!("{line} --isotropic --grid-offset 0.5,0,0"));
    let text = text.expect_ok().stdout;
    for word in ["voxels", "faces", "level", "total", "stage", "One voxelization"] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_voxelizer_is_chosen() {
    let folder = folder();
    let report = |method: &str| {
        let line = format!("voxels builtin:cornell --resolution 32 --voxelizer {method} --json");
        lumivox(folder.path(), &line).expect_ok().json()
    };
    let (exact, dominant) = (report("exact"), report("dominant-axis"));
    assert_eq!(exact["voxelizer"], "exact");
    assert_eq!(dominant["voxelizer"], "dominant-axis");
    assert!(dominant["voxels"].as_u64().unwrap() < exact["voxels"].as_u64().unwrap());
    let line = format!("render builtin:cornell -o a.png {SMALL} --voxelizer three-plane --json");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(report["settings"]["voxelizer"], "three-plane");
}

#[test]
fn info_counts_hidden_and_unvoxelized_instances() {
    let folder = folder();
    let text = "scene { model { primitive = cube } model { primitive = cube active = false } \
                model { primitive = cube static = true } model { primitive = cube static = true } }";
    fs::write(folder.path().join("a.scene"), text).unwrap();
    let info = lumivox(folder.path(), "info a.scene --json").expect_ok().json();
    let counts = ["instances", "triangles", "hidden_instances", "unvoxelized_instances"];
    assert_eq!(counts.map(|name| info[name].as_u64()), [Some(3), Some(36), Some(1), Some(2)]);
    let text = lumivox(folder.path(), "info a.scene").expect_ok().stdout;
    assert!(text.contains("1 instance hidden, 2 not voxelized"), "{text}");
}

#[test]
fn a_picture_is_rendered_and_reported() {
    let folder = folder();
    let line = format!("render builtin:cornell -o a.png {SMALL} --json");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(names(folder.path()), ["a.png"]);
    let png = fs::read(folder.path().join("a.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    // Width and height, in the header chunk.
    assert_eq!(png[16..24], [0, 0, 0, 64, 0, 0, 0, 36]);

    assert_eq!(report["file"], "a.png");
    assert_eq!(report["size"], serde_json::json!([64, 36]));
    assert_eq!(report["scene"]["name"], "cornell");
    assert_eq!(report["settings"]["frames"], 2);
    assert_eq!(report["settings"]["resolution"], 32);
    assert_eq!(report["settings"]["occlusion_distance"], "unlimited");
    assert!(report["voxels"].as_u64().unwrap() > 0, "{report}");
    assert!(report["faces"].as_u64().unwrap() > 0, "{report}");
    assert!(report["memory_bytes"].as_u64().unwrap() > 0, "{report}");
    assert!(report["exposure"].as_f64().unwrap().is_finite(), "{report}");
    assert!(report["seconds"]["total"].as_f64().unwrap() > 0.0, "{report}");
    assert!(report["adapter"]["name"].as_str().is_some_and(|name| !name.is_empty()), "{report}");
    let stages: Vec<_> = report["stages"].as_array().unwrap().iter().collect();
    for name in ["voxelize", "G-buffer", "trace"] {
        let stage = stages.iter().find(|stage| stage["stage"] == name);
        assert!(stage.is_some_and(|stage| stage["ms"].as_f64().unwrap() > 0.0), "{name}: {report}");
    }
}

#[test]
fn two_runs_give_the_same_bytes() {
    let folder = folder();
    let line = |name: &str| format!("render builtin:cornell -o {name}.exr {SMALL}");
    // Run on the device that tests share, and in a separate process.
    let here = lumivox(folder.path(), &line("a"));
    let alone = process(folder.path(), &line("b").split(' ').collect::<Vec<_>>(), "");
    let [first, second] = [("a", here), ("b", alone)].map(|(name, run)| {
        let text = run.expect_ok().stdout;
        assert!(text.starts_with(&format!("{name}.exr: 64x36")), "{text}");
        fs::read(folder.path().join(format!("{name}.exr"))).unwrap()
    });
    assert!(first == second, "the two files differ");
    assert_eq!(names(folder.path()), ["a.exr", "b.exr"]);
}

#[test]
fn a_file_is_rendered_under_every_kind_of_light() {
    let folder = folder();
    fs::write(folder.path().join("corner.glb"), glb(&CORNER)).unwrap();
    fs::write(folder.path().join("a.png"), "an older file").unwrap();
    let line = format!(
        "render corner.glb -o a.png {SMALL} --sun 1,2,1,5000 --environment 10,20,30 \
         --camera 1.5,1.5,3,0,0.5,0,50 --preset fast --shadows cone --exposure -8 -v"
    );
    let run = lumivox(folder.path(), &line).expect_ok();
    assert!(run.stdout.contains("exposure -8"), "{}", run.stdout);
    assert!(run.stdout.contains("2 lights"), "{}", run.stdout);
    assert!(run.stdout.contains("stage and pass"), "{}", run.stdout);
    assert!(run.stdout.contains("total"), "{}", run.stdout);
    assert!(run.stderr.contains("info: running on"), "{}", run.stderr);
    assert!(fs::read(folder.path().join("a.png")).unwrap().starts_with(b"\x89PNG"));
}

/// Pictures stop at little noise unless `--frames` is given, also in a sequence.
#[test]
#[ignore = "slow: over three seconds"]
fn rendering_stops_when_noise_is_low() {
    let folder = folder();
    let path = folder.path();
    let render = |options: &str| {
        let line = format!("render builtin:furnace --size 64x36 --resolution 32 {options} --json");
        lumivox(path, &line).expect_ok().json()
    };
    let stopped = render("-o stopped.exr");
    let frames = stopped["settings"]["frames"].as_u64().unwrap();
    assert!((4..16).contains(&frames), "{stopped}");
    let noise = stopped["noise"].as_f64().unwrap();
    assert!((0.0..=0.04).contains(&noise), "{noise}");
    let all = render("-o all.exr --frames 16");
    assert_eq!(all["settings"]["frames"], 16);
    assert!(all["noise"].is_null());
    render(&format!("-o given.exr --frames {frames}"));
    let bytes = |name: &str| fs::read(path.join(name)).unwrap();
    assert!(bytes("stopped.exr") == bytes("given.exr"));
    assert!(bytes("stopped.exr") != bytes("all.exr"));
    render("-o turn_##.exr --orbit 90 --time 0..1 --fps 2");
    assert!(bytes("stopped.exr") == bytes("turn_00.exr"));
}

#[test]
fn render_can_show_the_voxels() {
    let folder = folder();
    let line = "render builtin:panel -o a.png --size 32x18 --frames 1 --resolution 16 \
                --view voxels --level 1 --camera framing --isotropic --portable --json";
    let report = lumivox(folder.path(), line).expect_ok().json();
    assert_eq!(report["settings"]["view"], "voxels");
    assert_eq!(report["settings"]["directionality"], "isotropic");
    assert_eq!(report["camera"]["name"], "framing");
}

#[test]
fn voxels_reports_octree_nodes_and_bricks() {
    let folder = folder();
    let line = "voxels builtin:cornell --resolution 32 --volume octree --octree-builder";
    let report = lumivox(folder.path(), &format!("{line} locks --json")).expect_ok().json();
    let octree = |name: &str| report["octree"][name].as_u64().unwrap();
    assert_eq!(octree("nodes"), 8 * octree("groups"));
    assert!(octree("groups") > 100 && octree("bricks") > 100 && octree("lock_passes") > 0);
    let ranked = lumivox(folder.path(), &format!("{line} ranks")).expect_ok().stdout;
    assert!(ranked.contains(" bricks; built by ranks"), "{ranked}");
    let dense = lumivox(folder.path(), "voxels builtin:cornell --resolution 32 --json").expect_ok();
    assert!(dense.json()["octree"].is_null());
}

#[test]
fn a_scene_without_models_has_no_infinite_bounds() {
    let folder = folder();
    fs::write(folder.path().join("a.scene"), "scene { }").unwrap();
    let text = lumivox(folder.path(), "info a.scene").expect_ok().stdout;
    assert!(text.contains("none: nothing is shown") && !text.contains("inf,"), "{text}");
    let info = lumivox(folder.path(), "info a.scene --json").expect_ok().json();
    assert!(info["bounds_min"].is_null() && info["bounds_max"].is_null());
    let voxels = lumivox(folder.path(), "voxels a.scene");
    assert!(voxels.code != 0 && !voxels.stderr.contains("inf"), "{}", voxels.stderr);
}

/// Accepts VXCT's parameters and its names of scenes.
#[test]
fn the_vxct_preset_accepts_vxct_parameters() {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    let text = "scene { model { primitive = cube } light { position { x = 1 y = 1 z = 2 } } }";
    fs::write(folder.path().join("scenes/dice.txt"), text).unwrap();
    let line = "render dice --size 32x18 --frames 1 --resolution 16 --preset vxct";
    lumivox(folder.path(), &format!("{line} -o a.png")).expect_ok();
    let other = "--vxct indirect_light=off --vxct front_cone=on";
    lumivox(folder.path(), &format!("{line} -o b.png {other}")).expect_ok();
    let read = |name| fs::read(folder.path().join(name)).unwrap();
    assert_ne!(read("a.png"), read("b.png"));
    for (options, needles) in [
        ("--preset vxct --vxct shadow=2", "one of indirect_light, phong"),
        ("--preset vxct --vxct shadow_str=99", "from 0 to 16"),
        ("--preset fast --vxct shadow_str=2", "add --preset vxct"),
    ] {
        let run = lumivox(folder.path(), &format!("render dice {options} -o c.png"));
        assert!(run.code != 0 && run.stderr.contains(needles), "{options}: {}", run.stderr);
    }
}
