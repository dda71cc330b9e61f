//! `lumivox reference`: its files, its reports, stopping and resuming.

use std::fs;
use std::path::Path;

use crate::common::{CORNER, INPUT, OUTPUT, USAGE, expect_error, folder, glb, lumivox, names};
#[cfg(unix)]
use crate::common::{Run, STOPPED, command};

/// Small enough for a software driver.
const SMALL: &str = "reference builtin:cornell --size 32x18";

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap()
}

#[test]
fn all_layers_are_in_an_openexr_file() {
    let folder = folder();
    let line = format!("{SMALL} -o a.exr --samples 32 --json");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(names(folder.path()), ["a.exr"]);
    assert_eq!(report["file"], "a.exr");
    assert_eq!(report["size"], serde_json::json!([32, 18]));
    assert_eq!(report["scene"]["name"], "cornell");
    assert_eq!(report["samples"], 32);
    assert_eq!(report["samples_before"], 0);
    assert_eq!(report["is_complete"], true);
    for layer in ["radiance", "direct", "one_bounce", "full"] {
        let noise = report["noise_percent"][layer].as_f64().unwrap();
        assert!(noise > 0.0 && noise < 200.0, "{layer}: {noise}");
    }
    assert!(report["seconds"].as_f64().unwrap() > 0.0, "{report}");
    assert!(report["adapter"]["name"].as_str().is_some_and(|name| !name.is_empty()), "{report}");

    let image = exr::prelude::read_all_flat_layers_from_file(folder.path().join("a.exr")).unwrap();
    let layer = &image.layer_data[0];
    assert_eq!((layer.size.x(), layer.size.y()), (32, 18));
    let found: Vec<String> =
        layer.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    let mut expected: Vec<String> =
        ["A", "occlusion.Y", "depth.Z"].map(str::to_owned).into_iter().collect();
    for name in ["", "direct.", "one_bounce.", "full.", "albedo."] {
        expected.extend(["R", "G", "B"].map(|channel| format!("{name}{channel}")));
    }
    expected.extend(["X", "Y", "Z"].map(|axis| format!("normal.{axis}")));
    for name in ["radiance", "direct", "one_bounce", "full", "occlusion"] {
        expected.push(format!("variance.{name}"));
    }
    expected.sort();
    assert_eq!(found, expected);
    for channel in &layer.channel_data.list {
        let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
        let is_sound = values.iter().all(|value| value.is_finite());
        assert!(is_sound && values.iter().any(|value| *value != 0.0), "{}", channel.name);
    }
}

#[test]
fn a_screen_picture_is_written_too() {
    let folder = folder();
    let text = lumivox(folder.path(), &format!("{SMALL} -o a.png --spp 32")).expect_ok().stdout;
    assert!(text.starts_with("a.png: 32 x 18, 32 samples a pixel, "), "{text}");
    assert!(text.contains("noise: picture ") && text.contains("all bounces "), "{text}");
    let png = read(folder.path(), "a.png");
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    assert_eq!(png[16..24], [0, 0, 0, 32, 0, 0, 0, 18]);
    // One batch is not enough to estimate the noise.
    let text = lumivox(folder.path(), &format!("{SMALL} -o a.png --samples 1")).expect_ok().stdout;
    assert!(text.contains("noise: unknown"), "{text}");
}

#[test]
fn a_resumed_run_gives_the_bytes_of_one_run() {
    let folder = folder();
    let path = folder.path();
    let run = |rest: &str| lumivox(path, &format!("{SMALL} {rest} --json")).expect_ok().json();
    run("-o whole.exr --samples 32");
    // Without a checkpoint to resume, it starts from zero.
    let first = run("-o part.exr --samples 16 --checkpoint sums --resume");
    assert_eq!(first["samples_before"], 0);
    let second = run("-o part.exr --samples 32 --checkpoint sums --resume");
    assert_eq!(second["samples_before"], 16);
    assert_eq!(second["samples"], 32);
    assert!(read(path, "whole.exr") == read(path, "part.exr"), "the files differ");
    // All samples exist: nothing is traced, but the picture is written again.
    let third = run("-o again.exr --samples 32 --checkpoint sums --resume");
    assert_eq!(third["samples_before"], 32);
    assert!(read(path, "whole.exr") == read(path, "again.exr"), "the files differ");
    // Without --resume it starts from zero.
    assert_eq!(run("-o new.exr --samples 16 --checkpoint sums")["samples_before"], 0);
    assert_eq!(names(path), ["again.exr", "new.exr", "part.exr", "sums", "whole.exr"]);
}

#[test]
fn checkpoints_of_other_runs_are_refused() {
    let folder = folder();
    let path = folder.path();
    lumivox(path, &format!("{SMALL} -o a.exr --samples 16 --checkpoint sums")).expect_ok();
    let resumed = "-o b.exr --samples 32 --checkpoint sums --resume";
    for (line, needle) in [
        (format!("{SMALL} {resumed} --seed 1"), "another scene, camera, seed"),
        (format!("{SMALL} {resumed} --bounces 1"), "number of bounces"),
        (format!("{SMALL} {resumed} --camera framing"), "camera"),
        (format!("reference builtin:panel --size 32x18 {resumed}"), "another scene"),
        (
            format!("reference builtin:cornell --size 30x18 {resumed}"),
            "32 x 18 pixels, but 30 x 18 were asked for",
        ),
    ] {
        expect_error(path, &line, INPUT, &["sums", needle]);
    }
    fs::write(path.join("sums"), "these are no sums").unwrap();
    expect_error(path, &format!("{SMALL} {resumed}"), INPUT, &["sums", "damaged"]);
}

#[test]
fn bad_reference_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("corner.glb"), glb(&CORNER)).unwrap();
    let line = "reference corner.glb -o a.exr";
    for (option, value, needle) in [
        ("--samples", "0", "from 1 to 16777216"),
        ("--seed", "-1", "from 0 to 4294967295"),
        ("--bounces", "5000", "from 0 to 4096"),
        ("--occlusion-distance", "-1", "from 0 to"),
    ] {
        expect_error(path, &format!("{line} {option} {value}"), INPUT, &[option, value, needle]);
    }
    expect_error(path, &format!("{line} --size 20000x10"), INPUT, &["20000", "16384"]);
    for (line, code, needle) in [
        ("reference corner.glb", USAGE, "--output"),
        ("reference corner.glb -o a.exr --resume", USAGE, "--checkpoint"),
        ("reference corner.glb -o a.exr --samples many", USAGE, "whole number"),
        ("reference corner.glb -o a.jpg", INPUT, ".exr"),
        ("reference missing.glb -o a.exr", INPUT, "missing.glb"),
        ("reference corner.glb -o missing/a.exr", OUTPUT, "there is no folder missing"),
        ("reference corner.glb -o a.exr --checkpoint missing/sums", OUTPUT, "there is no folder"),
    ] {
        expect_error(path, line, code, &[needle]);
    }
}

/// Starts a run, and presses Ctrl-C once it traces.
#[cfg(unix)]
fn interrupted(folder: &Path, line: &str) -> Run {
    use std::io::{BufRead as _, BufReader, Read as _};
    use std::process::Stdio;

    use crate::common::interrupt;

    let mut child = command(folder, &line.split_whitespace().collect::<Vec<_>>())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut said = String::new();
    while !said.contains("Ctrl-C writes the samples so far") {
        assert!(stderr.read_line(&mut said).unwrap() > 0, "it ended early: {said}");
    }
    interrupt(&child);
    let mut stdout = String::new();
    child.stdout.take().unwrap().read_to_string(&mut stdout).unwrap();
    stderr.read_to_string(&mut said).unwrap();
    let code = child.wait().unwrap().code().unwrap_or(-1);
    Run { code, stdout, stderr: said }
}

/// Ctrl-C finishes the batch and writes the samples so far. A resumed run has the bits and the
/// noise of one that was never stopped.
#[cfg(unix)]
#[test]
fn an_interrupted_run_resumes_with_the_same_bits() {
    let folder = folder();
    let path = folder.path();
    let many = format!("{SMALL} -v -o a.exr --samples 16777216 --checkpoint sums --json");
    let run = interrupted(path, &many);
    assert_eq!(run.code, STOPPED, "{}", run.stderr);
    let samples = run.json()["samples"].as_u64().unwrap();
    assert!(samples >= 16 && samples.is_multiple_of(16), "{samples} samples");
    assert_eq!(run.json()["is_complete"], false);
    let told = format!("stopped after {samples} of 16777216 samples, which a.exr has");
    assert!(run.stderr.contains(&told) && run.stderr.contains("--resume"), "{}", run.stderr);
    assert!(!run.stderr.contains("error: "), "{}", run.stderr);
    assert_eq!(names(path), ["a.exr", "sums"]);

    let more = samples + 32;
    let line = format!("{SMALL} -o b.exr --samples {more} --checkpoint sums --resume --json");
    let resumed = lumivox(path, &line).expect_ok().json();
    assert_eq!(resumed["samples_before"].as_u64(), Some(samples));
    let line = format!("{SMALL} -o whole.exr --samples {more} --json");
    let whole = lumivox(path, &line).expect_ok().json();
    assert_eq!(resumed["noise_percent"], whole["noise_percent"]);
    assert!(read(path, "b.exr") == read(path, "whole.exr"), "the files differ");
}

/// Two runs would mix their sums.
#[test]
fn two_runs_do_not_share_a_checkpoint() {
    let folder = folder();
    let path = folder.path();
    let line = format!("{SMALL} -o a.exr --samples 1 --checkpoint sums");
    let lock = fs::File::create(path.join(".sums.lock")).unwrap();
    lock.lock().unwrap();
    let needles = ["sums", "another process keeps its sums there"];
    expect_error(path, &line, OUTPUT, &needles);
    // As if that process had died: its lock file stays, but is not locked.
    drop(lock);
    lumivox(path, &line).expect_ok();
    assert_eq!(names(path), ["a.exr", "sums"]);
}
