//! `lumivox measure`: its figures, its files, and mistakes.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{INPUT, OUTPUT, USAGE, expect_error, folder, glb, lumivox, names};

/// Options for quick voxels.
const SMALL: &str = "--resolution 32 --frames 4 --bounces 1";

/// A floor of 8 m by 8 m under the lamp of [`glb`], 100 cd at 0.2, 2, 0.3.
fn floor(folder: &Path) {
    let corner = |x: f32, z: f32| [4.0 * x, 0.0, 4.0 * z];
    let (a, b, c, d) = (corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0));
    fs::write(folder.join("floor.glb"), glb(&[a, b, c, a, c, d])).unwrap();
}

fn numbers(report: &Value, column: &str) -> Vec<f64> {
    let values = report["readings"][column].as_array().unwrap();
    values.iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn points_read_the_inverse_square_of_their_lamp() {
    let folder = folder();
    let path = folder.path();
    floor(path);
    let points = "name,x,y,z,nx,ny,nz\nbelow,0.2,0.5,0.3,0,1,0\naside,1.2,0.5,0.3,0,2,0\ndown,0.2,1,0.3,0,-1,0\n";
    fs::write(path.join("points.csv"), points).unwrap();
    let beside = 100.0 * 1.5 / (1.0_f64 + 1.5 * 1.5).powf(1.5);
    for method in ["cones", "paths --samples 64"] {
        let line = format!("measure floor.glb --points points.csv {SMALL} --method {method}");
        let report = lumivox(path, &format!("{line} --json -o lux.csv")).expect_ok().json();
        assert_eq!((&report["unit"], &report["count"]), (&"lux".into(), &3.into()));
        let direct = numbers(&report, "direct_lux");
        for (found, expected) in direct.iter().zip([100.0 / 2.25, beside, 0.0]) {
            assert!((found - expected).abs() <= 1e-4 * expected, "{method}: {found}, {expected}");
        }
        let lux = numbers(&report, "lux");
        assert!(lux[2] > 0.0, "{method}: the floor reflects to what faces down");
        let is_traced = method != "cones";
        assert_eq!(report["readings"]["standard_error_lux"].is_array(), is_traced);
        // The table has the same numbers.
        let table = fs::read_to_string(path.join("lux.csv")).unwrap();
        let mut lines = table.lines();
        assert!(lines.next().unwrap().starts_with("x,y,z,nx,ny,nz,lux,"), "{table}");
        for (line, lux) in lines.zip(lux) {
            let cell: f64 = line.split(',').nth(6).unwrap().parse().unwrap();
            assert!((cell - lux).abs() < 1e-6 * lux.max(1.0), "{line}: {lux}");
        }
        let text = lumivox(path, &line).expect_ok().stdout;
        assert!(text.contains("0.2,0.5,0.3: 44.4"), "{text}");
    }
}

/// A strip above a floor, near zero and in UTM coordinates.
#[test]
fn points_use_the_coordinates_of_the_scene_file() {
    let folder = folder();
    let path = folder.path();
    let place = |at: [f64; 3], far: f64| {
        let [x, y, z] = [at[0] + 500_123.457 * far, at[1], at[2] + 4_649_776.891 * far];
        [x, y, z].map(|number| ((number * 1e3).round() / 1e3).to_string())
    };
    let mut lux = Vec::new();
    for (name, far) in [("near", 0.0), ("utm", 1.0)] {
        let quads = [[-2.0, 0.0, -2.0, 4.0, 4.0], [0.1, 0.05, 0.0, 0.06, 2.0]];
        let corners = quads.iter().flat_map(|&[x, y, z, width, depth]| {
            [(0.0, 0.0), (0.0, depth), (width, depth), (width, 0.0)]
                .map(|by| [x + by.0, y, z + by.1])
        });
        let lines = corners.map(|corner| format!("v {}\n", place(corner, far).join(" ")));
        let text = lines.collect::<String>() + "f 1 2 3 4\nf 5 6 7 8\n";
        fs::write(path.join(format!("{name}.obj")), text).unwrap();
        let point = place([0.13, 0.01, 1.0], far).join(",");
        fs::write(path.join("points.csv"), format!("x,y,z\n{point}\n")).unwrap();
        let line = format!(
            "measure {name}.obj --points points.csv --method paths --samples 256 --environment 1000,1000,1000"
        );
        let report = lumivox(path, &format!("{line} -o lux.csv --json")).expect_ok().json();
        let table = fs::read_to_string(path.join("lux.csv")).unwrap();
        assert!(table.lines().nth(1).unwrap().starts_with(&format!("{point},0,1,0,")), "{table}");
        lux.push(numbers(&report, "lux")[0]);
    }
    // The point is below a strip whose corners 32-bit floats would move by half its width.
    assert!(lux[0] < 2500.0 && (lux[1] / lux[0] - 1.0).abs() < 0.03, "{lux:?}");
}

/// The lamp of [`glb`] lies in the plane of a ceiling, within the resolution of f32, as CAD
/// programs for buildings place it.
#[test]
#[ignore = "slow: over three seconds"]
fn every_method_lights_a_room_with_a_flush_lamp() {
    let folder = folder();
    let path = folder.path();
    for height in [2.0_f32, 2.0_f32.next_up(), 2.0_f32.next_down()] {
        let corner = |x: f32, y: f32, z: f32| [3.0 * x, y, 3.0 * z];
        let quad = |y: f32, x: f32| {
            let [a, b] = [corner(-x, y, 1.0), corner(x, y, 1.0)];
            let [c, d] = [corner(x, y, -1.0), corner(-x, y, -1.0)];
            [a, b, c, a, c, d]
        };
        fs::write(path.join("room.glb"), glb(&[quad(0.0, 1.0), quad(height, -1.0)].concat()))
            .unwrap();
        let places = [(0.2, 0.3), (1.2, 0.3), (-2.0, -1.5)];
        let rows = places.map(|(x, z)| format!("{x},0.01,{z},0,1,0\n")).concat();
        fs::write(path.join("points.csv"), format!("x,y,z,nx,ny,nz\n{rows}")).unwrap();
        for method in ["paths --samples 4", "cones", "cones --shadows cone"] {
            let line = "measure room.glb --points points.csv --resolution 32 --frames 1 --bounces 0 --json";
            let report = lumivox(path, &format!("{line} --method {method}")).expect_ok().json();
            for (found, (x, z)) in numbers(&report, "direct_lux").iter().zip(places) {
                let away = (f64::hypot(x - 0.2, z - 0.3), 1.99);
                let expected = 100.0 * away.1 / f64::hypot(away.0, away.1).powi(3);
                assert!(
                    (found - expected).abs() <= 1e-3 * expected,
                    "{height}, {method}, at {x}, {z}: {found} lux, not {expected}"
                );
            }
        }
    }
}

/// A block of one metre on 10 km of ground: a texel of the sun's map is as large as a house.
#[test]
#[ignore = "slow: over three seconds"]
fn shadows_finer_than_the_shadow_map_are_reported() {
    let folder = folder();
    let path = folder.path();
    let far = 5000.0;
    let mut corners = vec![[-far, 0.0, -far], [-far, 0.0, far], [far, 0.0, far]];
    corners.extend([[-far, 0.0, -far], [far, 0.0, far], [far, 0.0, -far]]);
    // The side that faces the sun, which is towards +z.
    let (a, b, c, d) = ([0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]);
    corners.extend([a, b, c, a, c, d]);
    fs::write(path.join("block.glb"), glb(&corners)).unwrap();
    fs::write(path.join("points.csv"), "x,y,z\n0.5,0,2\n0.5,0,0.5\n0.5,0,-3\n").unwrap();
    let line = format!("measure block.glb --points points.csv {SMALL} --sky 30,180");
    let text = lumivox(path, &format!("{line} -o lost.json")).expect_ok().stdout;
    let report: Value = serde_json::from_slice(&fs::read(path.join("lost.json")).unwrap()).unwrap();
    assert_eq!(report["in_lost_shade"], serde_json::json!([1]), "{report}");
    assert!(text.contains("1 of them in shade") && text.contains("--method paths"), "{text}");
    for method in ["--method paths --samples 16", "--volume cascades"] {
        let report = lumivox(path, &format!("{line} {method} --json")).expect_ok().json();
        assert_eq!(report["in_lost_shade"], serde_json::json!([]), "{method}");
        // Only the sky lights the place behind, not the sun.
        let [open, behind] = [0, 1].map(|place| numbers(&report, "lux")[place]);
        assert!(behind < 0.2 * open, "{method}: {behind} of {open} lux");
    }
}

#[test]
fn a_workplane_is_written_as_csv_json_and_png() {
    let folder = folder();
    let path = folder.path();
    floor(path);
    let line = format!(
        "measure floor.glb {SMALL} --workplane 0.5 --area -2,-1,2,1 --spacing 0.5 --scale 0..50 -o plane.csv -o \
         plane.json -o plane.png"
    );
    let text = lumivox(path, &line).expect_ok().stdout;
    assert!(text.contains("workplane at 0.5 m; cones, 4 frames (32 places)"), "{text}");
    assert_eq!(names(path), ["floor.glb", "plane.csv", "plane.json", "plane.png"]);
    let report: Value =
        serde_json::from_slice(&fs::read(path.join("plane.json")).unwrap()).unwrap();
    assert_eq!(report["size"], serde_json::json!([8, 4]));
    let (x, z) = (numbers(&report, "x"), numbers(&report, "z"));
    assert_eq!((x[0], z[0], x[7], z[31]), (-1.75, -0.75, 1.75, 0.75));
    let lux = numbers(&report, "lux");
    let mean = lux.iter().sum::<f64>() / 32.0;
    let least = lux.iter().copied().fold(f64::INFINITY, f64::min);
    let near = |name: &str, value: f64| {
        let told = report[name].as_f64().unwrap();
        assert!((told - value).abs() < 1e-6 * value, "{name}: {told}, {value}");
    };
    near("mean", mean);
    near("minimum", least);
    near("uniformity", least / mean);
    let table = fs::read_to_string(path.join("plane.csv")).unwrap();
    assert_eq!(table.lines().count(), 33);
    let picture = image::open(path.join("plane.png")).unwrap();
    assert!(picture.width() > 480 && picture.height() > 400);
    // A second measurement gives the same bytes.
    let before = fs::read(path.join("plane.png")).unwrap();
    lumivox(path, &line).expect_ok();
    assert!(before == fs::read(path.join("plane.png")).unwrap());
    assert_eq!(table, fs::read_to_string(path.join("plane.csv")).unwrap());
}

#[test]
#[ignore = "slow: over three seconds"]
fn pictures_and_rays_read_luminance() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("rays.csv"), "0,0.5,3,0,0,-1\n0,3,0,0,1,0\n").unwrap();
    let sky = "--environment 300,300,300";
    let line =
        format!("measure builtin:panel --rays rays.csv --method paths --samples 32 {sky} --json");
    let report = lumivox(path, &line).expect_ok().json();
    assert_eq!(report["unit"], "cd/m2");
    let sky = numbers(&report, "cd_m2")[1];
    assert!((sky - 300.0).abs() < 0.01, "{sky}");
    for method in ["cones --frames 2 --resolution 32", "paths --samples 32"] {
        let line = format!("measure builtin:cornell --picture --size 32x18 --method {method}");
        let report = lumivox(path, &format!("{line} --json -o a.png")).expect_ok().json();
        assert_eq!((&report["count"], &report["what"]), (&576.into(), &"picture".into()));
        assert!(report["mean"].as_f64().unwrap() > 0.1, "{report}");
        assert_eq!(report["noise_percent"].is_number(), method.starts_with("paths"));
    }
    // No light is added to a scene without light, unless requested.
    fs::write(path.join("up.csv"), "0,1.5,0\n").unwrap();
    let line = format!("measure builtin:panel --points up.csv {SMALL} --json");
    assert_eq!(lumivox(path, &line).expect_ok().json()["mean"], 0.0);
    let lit = lumivox(path, &format!("{line} --surroundings sky")).expect_ok().json();
    assert!(lit["mean"].as_f64().unwrap() > 1000.0, "{lit}");
}

#[test]
fn bad_measure_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("p.csv"), "x,y,z\n0,0,0\n0,nan,0\n").unwrap();
    fs::write(path.join("far.csv"), "0,1,0\n0,1000000,0\n").unwrap();
    fs::write(path.join("r.csv"), "0,0,0,0,0,1\n").unwrap();
    let box_of = "measure builtin:cornell";
    for (options, code, needles) in [
        ("", USAGE, &["--points <FILE>", "--workplane"][..]),
        ("--picture --workplane 1", USAGE, &["cannot be used with"]),
        ("--points none.csv", INPUT, &["none.csv", "cannot read the places"]),
        ("--points p.csv", INPUT, &["p.csv", "line 3, column y", "\"nan\""]),
        ("--points far.csv", INPUT, &["place 2 at 0,1000000,0", "--up"]),
        ("--rays r.csv", INPUT, &["--method paths"]),
        ("--points r.csv -o a.png", INPUT, &["a.png", "no picture"]),
        ("--picture -o a.txt", INPUT, &["a.txt", ".csv, .json or .png"]),
        ("--picture -o no/a.png", OUTPUT, &["there is no folder no"]),
        ("--workplane 1 --spacing 0", INPUT, &["spacing"]),
        ("--workplane 0.5 --spacing 0.001", INPUT, &["points", "at most 1048576"]),
        ("--workplane 1 --area 0,0,0,1", INPUT, &["two corners"]),
        ("--workplane 1 --scale 5..1 -o a.png", INPUT, &["LOW..HIGH"]),
        ("--picture --area 0,0,1,1", INPUT, &["--area", "--workplane"]),
        ("--picture --size 0x4", INPUT, &["width and height"]),
    ] {
        expect_error(path, &format!("{box_of} {options}"), code, needles);
    }
}
