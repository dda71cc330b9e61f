//! The window, tested as a person uses it: by mouse, keys and pixels. Runs under Xvfb, on any
//! Vulkan driver.

mod devices;
mod habits;
mod support;

use std::fmt::Write as _;
use std::path::Path;
use std::process::Stdio;

use tempfile::TempDir;

use support::{Display, ESCAPE, F2, F11, RETURN, Seen, Window, command};

/// A folder with settings for the smallest window, without panels, so that the picture's position
/// is known.
fn home() -> TempDir {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("config/lumivox");
    std::fs::create_dir_all(&folder).unwrap();
    let config = r#"{"window": [480, 320], "left": false, "right": false, "console": false}"#;
    std::fs::write(folder.join("window.json"), config).unwrap();
    home
}

/// Options of a small, quick picture.
const QUICK: &str = "--preset fast --resolution 32 --frames 1 --bounces 1";

fn is_red([r, g, b]: [f32; 3]) -> bool {
    r > 60.0 && r > 1.6 * g && r > 1.6 * b
}

fn is_green([r, g, b]: [f32; 3]) -> bool {
    g > 60.0 && g > 1.3 * r && g > 1.3 * b
}

/// The Cornell box: a red wall on the left, a green one on the right.
fn is_cornell(seen: &Seen) -> bool {
    let middle = seen.width / 2;
    let left = seen.part((0, 0), (middle, seen.height));
    let right = seen.part((middle, 0), (seen.width, seen.height));
    left.share(is_red) > 0.03 && right.share(is_green) > 0.03
}

fn open_cornell(display: &Display, home: &Path) -> Window {
    let mut window = Window::open(display, home, &format!("builtin:cornell {QUICK}"));
    window.wait("Cornell box", |window| Some(window.picture()).filter(is_cornell));
    window
}

/// Waits until the picture equals `before`.
fn back(window: &mut Window, before: &Seen) {
    window.wait("picture of before", |window| {
        Some(()).filter(|()| window.picture().distance(before) < 1.0)
    });
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn mouse_and_keys_do_what_they_say() {
    let (display, home) = (Display::start(), home());
    let mut window = open_cornell(&display, home.path());
    let first = window.wait_rest();

    // Orbit: the picture follows the pointer, and the camera's line is sent once it rests. The
    // pointer does not return to its start, since pictures lag behind it.
    let lines = window.lines().len();
    window.point(240, 130);
    window.press();
    let mut x = 240;
    window.wait("picture that turns", |window| {
        x = if x >= 340 { 316 } else { x + 6 };
        window.point(x, 140);
        (window.picture().distance(&first) > 4.0).then_some(())
    });
    window.release();
    window.wait_line(lines, "> camera ");
    let turned = window.wait_rest();
    assert!(turned.distance(&first) > 4.0);

    // Return to the file's camera by typing into the window.
    window.key(F2);
    window.write("camera 0");
    let lines = window.lines().len();
    window.key(RETURN);
    window.wait_line(lines, "> camera 0");
    window.key(ESCAPE);
    window.key(F2);
    let again = window.wait("picture of before", |window| {
        Some(window.picture()).filter(|now| now.distance(&first) < 1.0)
    });

    // A click selects an object, H hides it and shows it again.
    let lines = window.lines().len();
    window.click(193, 200);
    let lines = window.wait_line(lines, "> select 'tall block'");
    window.key('h' as u32);
    window.wait_line(lines, "> hide 'tall block'");
    let hidden = window.wait_change("picture without the block", &again);
    window.wait_rest();
    window.key('h' as u32);
    let lines = window.wait_line(lines, "> show 'tall block'");
    window.wait_change("picture with the block", &hidden);

    // Esc clears the selection.
    window.key(ESCAPE);
    let lines = window.wait_line(lines, "> select");

    // Ctrl-Z undoes a change, Ctrl-Y redoes it.
    window.control('z' as u32);
    let lines = window.wait_line(lines, "undone: object \"tall block\"");
    window.wait_change("picture without the block", &again);
    window.control('y' as u32);
    let lines = window.wait_line(lines, "redone: object \"tall block\"");
    back(&mut window, &again);
    window.control('z' as u32);
    let lines = window.wait_line(lines, "undone: ");
    window.wait_change("picture without the block", &again);
    window.control('z' as u32);
    let lines = window.wait_line(lines, "undone: ");
    back(&mut window, &again);

    // A double click shows all of an object.
    window.click(193, 200);
    window.press();
    window.release();
    let lines = window.wait_line(lines, "> select 'tall block'");
    let lines = window.wait_line(lines, "> camera ");
    assert!(window.wait_rest().distance(&again) > 4.0);

    // Camera moves and selections cannot be undone. Cause the error last: its line makes the
    // picture smaller.
    window.control('z' as u32);
    let lines = window.wait_line(lines, "error: there is nothing to undo");
    // Without a window manager, the window does not become larger, but nothing fails.
    window.key(F11);
    window.wait_line(lines, "> fullscreen");
    assert_eq!(window.close(), 0);
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn the_window_survives_resizing_and_minimizing() {
    let (display, home) = (Display::start(), home());
    let mut window = open_cornell(&display, home.path());

    // After resizing, the picture has the new size in pixels.
    let lines = window.lines().len();
    window.resize(640, 420);
    window.wait("Cornell box of another size", |window| {
        Some(window.picture()).filter(|seen| seen.width == 620 && is_cornell(seen))
    });
    window.wait_rest();
    window.tell("size");
    let at = window.wait_line(lines, "size 6");
    assert!(window.lines()[at - 1].starts_with("size 640x"), "{:?}", window.lines());

    let shown = window.wait_rest();

    // While minimized, the window runs lines; once restored, it shows their result.
    window.unmap();
    let lines = window.lines().len();
    window.tell("hide 'short block'");
    window.tell("echo done");
    window.wait_line(lines, "done");
    window.map();
    window.wait_change("picture without the block", &shown);

    // Close the window while it is busy.
    window.tell("resolution 64");
    window.tell("frames 65536");
    let lines = window.lines().len();
    window.tell("wait 65536");
    window.tell("echo never");
    window.wait_line(lines, "> wait 65536");
    let said = window.lines();
    assert!(!said.iter().any(|line| line == "never"), "{said:?}");
    assert_eq!(window.close(), 0);
}

/// Writes a scene that takes much longer to read than a key press.
fn write_slow(folder: &Path) {
    let mut text = String::new();
    for vertex in 1..=1_500_000_u32 {
        let (x, y) = (vertex % 1000, vertex / 1000);
        writeln!(text, "v {x}.5 {y}.25 {}", x ^ y).unwrap();
        if vertex > 1001 {
            writeln!(text, "f {vertex} {} {}", vertex - 1, vertex - 1000).unwrap();
        }
    }
    std::fs::write(folder.join("slow.obj"), text).unwrap();
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn slow_loads_and_frames_do_not_block_input() {
    let (display, home) = (Display::start(), home());
    write_slow(home.path());
    let mut window = open_cornell(&display, home.path());
    let shown = window.wait_rest();

    // While a scene is being read, mouse and keys work on the open one; lines of the terminal
    // wait.
    let lines = window.lines().len();
    window.click(193, 200);
    let lines = window.wait_line(lines, "> select 'tall block'");
    window.tell("load slow.obj");
    window.tell("echo later");
    let lines = window.wait_line(lines, "> load slow.obj");
    window.key('h' as u32);
    let lines = window.wait_line(lines, "> hide 'tall block'");
    assert!(!window.lines().iter().any(|line| line == "later"), "{:?}", window.lines());
    window.tell("cancel");
    window.wait_change("picture without the block", &shown);
    let lines = window.wait_line(lines, "no longer waiting for slow.obj");
    let lines = window.wait_line(lines, "later");

    // A script ends if its scene is cancelled or cannot be read.
    window.tell("load slow.obj; echo never");
    let lines = window.wait_line(lines, "> load slow.obj");
    window.tell("cancel");
    let lines = window.wait_line(lines, "no longer waiting");
    window.tell("load gone.obj; echo never");
    let lines = window.wait_line(lines, "error: ");

    // Esc ends waiting for frames.
    window.tell("frames 65536");
    window.tell("wait 65536");
    window.tell("echo at last");
    let lines = window.wait_line(lines, "> wait 65536");
    window.wait("end of waiting", |window| {
        window.key(ESCAPE);
        window.lines().iter().skip(lines).any(|line| line == "at last").then_some(())
    });
    let said = window.lines();
    assert!(!said.iter().any(|line| line == "never"), "{said:?}");

    // Quitting does not wait for the scene.
    window.tell("load slow.obj");
    window.wait_line(lines, "> load slow.obj");
    window.control('q' as u32);
    assert_eq!(window.ended(), 0);
}

/// Width and height of a PNG file, from its header.
fn png_size(file: &Path) -> [u32; 2] {
    let bytes = std::fs::read(file).unwrap();
    assert_eq!(&bytes[1..4], b"PNG");
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn pictures_are_compared_and_saved() {
    let (display, home) = (Display::start(), home());
    let mut window = open_cornell(&display, home.path());
    let alone = window.wait_rest();

    // The reference, on the right, changes with its samples.
    let mut reference = |samples: u32| {
        let lines = window.lines().len();
        window.tell(&format!("compare_with reference {samples}"));
        window.wait_line(lines, &format!("complete: {samples} samples"));
        window.wait_rest()
    };
    let [few, many] = [1, 2].map(&mut reference);
    let right = |seen: &Seen| seen.part((seen.width / 2 + 20, 30), (seen.width, seen.height));
    let left = |seen: &Seen| seen.part((0, 30), (seen.width / 2 - 20, seen.height));
    let difference = right(&few).distance(&right(&many));
    assert!(difference > 1.0, "{difference}");
    assert!(left(&many).distance(&left(&alone)) < 1.0);
    assert!(is_cornell(&many));

    // After a change, the reference is dropped, and another is traced.
    let lines = window.lines().len();
    window.tell("hide 'tall block'");
    window.wait_line(lines, "complete: 2 samples");
    window.wait_change("reference without the block", &many);
    let lines = window.lines().len();
    window.tell("compare_with nothing");
    window.tell("show 'tall block'");
    window.wait_line(lines, "> show");
    back(&mut window, &alone);
    // A view that the volume does not have is an error, and the picture still updates.
    let lines = window.lines().len();
    window.tell("compare_with nodes");
    window.wait_line(lines, "error: ");
    let refused = window.wait_rest();
    window.tell("hide 'tall block'");
    window.wait_change("picture without the block", &refused);

    let lines = window.lines().len();
    window.tell("size");
    let at = window.wait_line(lines, "size ");
    let size = window.lines()[at - 1].clone();
    window.tell("screenshot saved.png");
    window.wait_line(at, "saved.png: ");
    let [width, height] = png_size(&home.path().join("saved.png"));
    assert_eq!(size, format!("size {width}x{height}"));
    assert_eq!(window.close(), 0);
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn settings_are_kept_between_runs() {
    let (display, home) = (Display::start(), home());
    let mut window = Window::open(&display, home.path(), "");
    // A window without a scene runs lines, too.
    window.tell("resolution 40");
    window.tell("bounces 3");
    window.tell("frames 1");
    window.tell("load builtin:cornell");
    window.wait("Cornell box", |window| Some(window.picture()).filter(is_cornell));
    window.tell("quit");
    assert_eq!(window.ended(), 0);
    drop(window);

    let ask = |line: &str, parameters: &[&str], expected: &[&str]| {
        let mut window = Window::open(&display, home.path(), line);
        for (parameter, expected) in parameters.iter().zip(expected) {
            window.tell(parameter);
            window.wait_line(0, expected);
        }
        window.tell("quit");
        assert_eq!(window.ended(), 0);
    };
    ask("", &["resolution", "bounces"], &["resolution 40", "bounces 3"]);
    // The command line overrides saved settings, but only for this run.
    ask("--bounces 5", &["resolution", "bounces"], &["resolution 40", "bounces 5"]);
    ask("", &["resolution", "bounces"], &["resolution 40", "bounces 3"]);
    ask("--fresh", &["resolution"], &["resolution 128"]);
    // A broken file causes a warning.
    let file = home.path().join("config/lumivox/window.json");
    let kept = std::fs::read_to_string(&file).unwrap();
    assert!(kept.contains("builtin:cornell"), "{kept}");
    std::fs::write(&file, "{ broken").unwrap();
    ask("", &["resolution"], &["window.json: cannot be read"]);
}

/// Writes a square of a colour.
fn write_scene(folder: &Path, name: &str, color: [f32; 3]) {
    let square = "mtllib a.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    std::fs::write(folder.join(format!("{name}.obj")), square).unwrap();
    let [r, g, b] = color;
    std::fs::write(folder.join("a.mtl"), format!("newmtl m\nKd {r} {g} {b}\n")).unwrap();
}

#[test]
#[ignore = "slow: a window under Xvfb, in real time"]
fn files_are_read_again_when_they_change() {
    let (display, home) = (Display::start(), home());
    write_scene(home.path(), "square", [0.8, 0.05, 0.05]);
    let line = format!("{QUICK} --environment 100,100,100 --camera 0,0,3,0,0,0");
    let mut window = Window::open(&display, home.path(), &format!("square.obj {line}"));
    let share = |is_like: fn([f32; 3]) -> bool| {
        move |window: &mut Window| (window.picture().share(is_like) > 0.1).then_some(())
    };
    window.wait("red square", share(is_red));

    // Change a file that the scene's file names.
    let lines = window.lines().len();
    write_scene(home.path(), "square", [0.05, 0.8, 0.05]);
    window.wait_line(lines, "again");
    window.wait("green square", share(is_green));

    // A broken file causes an error, and the scene stays.
    let lines = window.lines().len();
    std::fs::write(home.path().join("square.obj"), "f 1 2 3\n").unwrap();
    let lines = window.wait_line(lines, "stays as it was");
    window.wait_rest();
    assert!(window.picture().share(is_green) > 0.1);

    // Once repaired, it is read again.
    write_scene(home.path(), "square", [0.8, 0.05, 0.05]);
    window.wait_line(lines, "again");
    window.wait("red square", share(is_red));
    assert_eq!(window.close(), 0);
}

#[test]
fn without_a_display_it_says_what_to_do() {
    let home = home();
    let mut program = command("", home.path());
    program.arg("view").stdin(Stdio::null()).env_remove("DISPLAY");
    let output = program.output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(4), "{text}");
    assert!(text.contains("there is no display") && text.contains("lumivox render"), "{text}");
}
