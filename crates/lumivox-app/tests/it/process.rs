//! The program as a process: what no call of its library shows.

use std::fs;
use std::process::Stdio;

use crate::common::{CORNER, GPU, INPUT, OUTPUT, USAGE, command, folder, glb, names, process};

/// Small enough for a software driver.
const SMALL: [&str; 6] = ["--size", "16x9", "--frames", "1", "--resolution", "16"];

#[test]
fn it_ends_with_the_code_of_what_went_wrong() {
    let folder = folder();
    for (line, code) in [
        ("scenes", 0),
        ("paint", USAGE),
        ("info missing.glb", INPUT),
        ("voxels builtin:cornell --adapter nowhere", GPU),
        ("render builtin:cornell -o missing/a.png", OUTPUT),
    ] {
        let run = process(folder.path(), &line.split(' ').collect::<Vec<_>>(), "");
        assert_eq!(run.code, code, "{line}: {}", run.stderr);
        assert_eq!(run.stdout.is_empty(), code != 0, "{line}: {}", run.stdout);
        assert_eq!(run.stderr.contains("error: "), code != 0, "{line}: {}", run.stderr);
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn help_goes_to_stdout() {
    let run = process(folder().path(), &["help", "render"], "").expect_ok();
    assert!(run.stdout.contains("Usage: lumivox render"), "{}", run.stdout);
    assert_eq!(run.stderr, "");
    let run = process(folder().path(), &["render"], "");
    assert_eq!((run.code, run.stdout.as_str()), (USAGE, ""));
    assert!(run.stderr.contains("--output"), "{}", run.stderr);
}

#[test]
fn commands_come_over_a_pipe() {
    let folder = folder();
    let mut words = vec!["run", "-", "--scene", "builtin:cornell"];
    words.extend(SMALL);
    let run = process(folder.path(), &words, "echo first\nscreenshot a.png\necho last\n");
    let run = run.expect_ok();
    let said: Vec<&str> = run.stdout.lines().collect();
    assert_eq!(said.len(), 3, "{}", run.stdout);
    assert!(said[0] == "first" && said[1].starts_with("a.png: 16x9") && said[2] == "last");
    assert!(fs::read(folder.path().join("a.png")).unwrap().starts_with(b"\x89PNG"));
}

/// As in `lumivox help render | head`.
#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    for words in [["help", "render"], ["commands", "--markdown"], ["info", "builtin:cornell"]] {
        let mut child = command(folder().path(), &words)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{words:?}");
        assert_eq!(String::from_utf8(output.stderr).unwrap(), "", "{words:?}");
    }
}

/// Drivers are found by what these variables of the Vulkan loader name.
#[cfg(target_os = "linux")]
#[test]
fn without_a_gpu_it_says_what_to_do() {
    let folder = folder();
    let output = command(folder.path(), &["voxels", "builtin:cornell"])
        .env("VK_DRIVER_FILES", "/nowhere")
        .env("VK_ICD_FILENAMES", "/nowhere")
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(GPU), "{text}");
    assert!(text.contains("no GPU adapter") && text.contains("driver"), "{text}");
}

/// The environment variable of the log is the process's.
#[test]
fn the_log_is_as_loud_as_the_environment_asks() {
    let folder = folder();
    fs::write(folder.path().join("corner.glb"), glb(&CORNER)).unwrap();
    let said = |filter: &str| {
        let output = command(folder.path(), &["info", "corner.glb"])
            .env("RUST_LOG", filter)
            .output()
            .unwrap();
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(said(""), "");
    assert!(said("lumivox=trace,=").contains("warning: RUST_LOG cannot be understood"));
    // As in the help, which means all crates whose names begin so.
    assert!(said("lumivox=trace").contains("info: "));
    assert_eq!(said("lumivox=error"), "");
}

/// A build without a window knows the command, and how to get it.
#[cfg(not(feature = "window"))]
#[test]
fn a_build_without_a_window_says_how_to_make_one() {
    use crate::common::{expect_error, lumivox};
    let folder = folder();
    let help = lumivox(folder.path(), "view --help").expect_ok().stdout;
    assert!(help.contains("Usage: lumivox view") && help.contains("--fresh"), "{help}");
    let needles = ["has no window", "./lumivox view", "--features window"];
    expect_error(folder.path(), "view builtin:cornell", GPU, &needles);
    expect_error(folder.path(), "view missing.glb", INPUT, &["missing.glb"]);
}
