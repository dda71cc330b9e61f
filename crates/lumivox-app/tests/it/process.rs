//! The program as a process: tests that its library cannot cover.

use std::fs;
use std::process::Stdio;

use crate::common::{CORNER, GPU, INPUT, OUTPUT, USAGE, command, folder, glb, names, process};

/// A command for another program, run in a folder.
#[cfg(target_os = "linux")]
fn command_through(program: &str, folder: &std::path::Path) -> std::process::Command {
    let mut command = std::process::Command::new(program);
    command.current_dir(folder).env_remove("RUST_LOG");
    command
}

/// Small enough for a software driver.
const SMALL: [&str; 6] = ["--size", "16x9", "--frames", "1", "--resolution", "16"];

#[test]
fn exit_codes_match_the_kind_of_error() {
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
fn run_reads_commands_from_stdin() {
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
fn a_closed_stdout_is_not_an_error() {
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

/// Sets the Vulkan loader's variables for the drivers' files.
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

/// A full or closed stderr does not change the exit code.
#[cfg(target_os = "linux")]
#[test]
fn an_unwritable_stderr_does_not_change_the_exit_code() {
    let folder = folder();
    fs::write(folder.path().join("corner.glb"), glb(&CORNER)).unwrap();
    let render = ["render", "corner.glb", "-o", "a.png", "-v"];
    let render: Vec<&str> = render.into_iter().chain(SMALL).collect();
    for stderr in ["2>/dev/full", "2>&-"] {
        for (words, code) in [
            (&["scenes"][..], 0),
            (&render, 0),
            (&["info", "missing.glb"], INPUT),
            (&["paint"], USAGE),
            (&["render", "corner.glb", "-o", "a.png", "--frames", "0"], INPUT),
        ] {
            let status = command_through("sh", folder.path())
                .args(["-c", &format!("exec \"$0\" \"$@\" >/dev/null {stderr}")])
                .arg(env!("CARGO_BIN_EXE_lumivox"))
                .args(words)
                .status()
                .unwrap();
            assert_eq!(status.code(), Some(code), "{words:?} {stderr}");
        }
    }
}

/// Runs the script that builds and starts the program, with a fake cargo that prints what cargo
/// prints during builds.
#[cfg(target_os = "linux")]
#[test]
fn the_launcher_works_without_a_writable_stderr() {
    use std::os::unix::fs::{PermissionsExt as _, symlink};
    let folder = folder();
    let (tools, built) = (folder.path().join("tools"), folder.path().join("target/release"));
    fs::create_dir(&tools).unwrap();
    fs::create_dir_all(&built).unwrap();
    symlink(env!("CARGO_BIN_EXE_lumivox"), built.join("lumivox")).unwrap();
    let cargo = tools.join("cargo");
    let script = "#!/bin/sh\nif [ \"$1\" = --version ]; then echo 'cargo 1.999.0'; exit; fi\n\
                  printf '    Building [=> ] 3/9: a\\r    Finished release\\nwarning: a\\n' >&2\n";
    fs::write(&cargo, script).unwrap();
    fs::set_permissions(&cargo, fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", tools.display(), std::env::var("PATH").unwrap());
    let launcher = concat!(env!("CARGO_MANIFEST_DIR"), "/../../lumivox");
    for stderr in ["2>/dev/full", "2>&-", "2>/dev/null"] {
        let status = command_through("sh", folder.path())
            .args(["-c", &format!("exec \"$0\" scenes >/dev/null {stderr}"), launcher])
            .env("PATH", &path)
            .env("CARGO_TARGET_DIR", folder.path().join("target"))
            .env("LUMIVOX_SKIP_DRIVER_CHECK", "1")
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(0), "{stderr}");
    }
}

/// Mesa's layer asks the desktop for its preferred GPU, and prints an "error:" if there is none.
#[cfg(target_os = "linux")]
#[test]
fn without_a_desktop_nothing_is_printed_to_stderr() {
    let folder = folder();
    let mut command = command(folder.path(), &["info"]);
    for name in
        ["XDG_RUNTIME_DIR", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY", "NODEVICE_SELECT"]
    {
        command.env_remove(name);
    }
    let output = command.output().unwrap();
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
    assert_eq!(output.status.code(), Some(0));
}

/// Needs a process: the library ignores the log's environment variable.
#[test]
fn rust_log_sets_the_log_level() {
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
    // As the help says, `lumivox` matches all crates whose names start with it.
    assert!(said("lumivox=trace").contains("info: "));
    assert_eq!(said("lumivox=error"), "");
}

/// A build without a window knows the command, and says how to get a window.
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
