//! Sequences as users see them: files, index, resuming, errors.

use std::collections::HashSet;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::common::{INPUT, OUTPUT, USAGE, expect_error, folder, lumivox, names};
#[cfg(unix)]
use crate::common::{Run, STOPPED, command, freeze, interrupt};

/// Small enough for a software driver.
const SMALL: &str = "--size 32x18 --frames 1 --resolution 16 --shadow-resolution 64";
/// Three pictures round the Cornell box.
const ORBIT: &str = "--orbit 90 --time 0..1 --fps 3";

fn index(folder: &Path, file: &str) -> Value {
    serde_json::from_slice(&fs::read(folder.join(file)).unwrap()).unwrap()
}

fn write_path(folder: &Path, keys: &Value) {
    fs::write(folder.join("path.json"), keys.to_string()).unwrap();
}

#[test]
fn a_folder_gets_numbered_pictures_and_an_index() {
    let folder = folder();
    let line = format!("render builtin:cornell -o turn {SMALL} {ORBIT} --json");
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(names(folder.path()), ["turn"]);
    let turn = folder.path().join("turn");
    assert_eq!(names(&turn), ["0000.png", "0001.png", "0002.png", "index.json"]);
    assert_eq!(report["pictures"], 3);
    assert_eq!(report["rendered"], 3);
    assert!(report["voxels"].as_u64().unwrap() > 0, "{report}");
    assert_eq!(report["settings"]["resolution"], 16);

    let index = index(&turn, "index.json");
    assert_eq!(index["frame_count"], 3);
    assert_eq!(index["settings"]["orbit"], 90.0);
    assert_eq!(index["settings"]["fps"], 3.0);
    assert_eq!(index["settings"]["scene"]["name"], "builtin:cornell");
    assert_eq!(index["settings"]["size"], json!([32, 18]));
    let stops = index["exposure"].as_f64().unwrap();
    let frames = index["frames"].as_array().unwrap();
    let mut places = HashSet::new();
    for (number, frame) in frames.iter().enumerate() {
        assert_eq!(frame["number"], number);
        let file = turn.join(frame["file"].as_str().unwrap());
        let bytes = fs::read(file).unwrap();
        assert_eq!(frame["bytes"], bytes.len());
        assert_eq!(bytes[16..24], [0, 0, 0, 32, 0, 0, 0, 18]);
        let time_s = frame["time_s"].as_f64().unwrap();
        assert!((time_s - number as f64 / 3.0).abs() < 1e-9, "{time_s}");
        // One exposure for all.
        assert_eq!(frame["exposure"].as_f64(), Some(stops));
        places.insert(frame["camera"]["position"].to_string());
    }
    assert_eq!(places.len(), 3, "the camera moves");
    let pictures: HashSet<_> = ["0000.png", "0001.png", "0002.png"]
        .map(|name| fs::read(turn.join(name)).unwrap())
        .into_iter()
        .collect();
    assert_eq!(pictures.len(), 3, "the pictures differ");
}

#[test]
fn the_first_picture_of_an_orbit_is_the_still() {
    let folder = folder();
    let still = format!("render builtin:cornell -o still#1.exr {SMALL}");
    lumivox(folder.path(), &still).expect_ok();
    let turn = format!("render builtin:cornell -o turn_##.exr {SMALL} {ORBIT}");
    lumivox(folder.path(), &turn).expect_ok();
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("still#1.exr") == read("turn_00.exr"));
    let expected = ["still#1.exr", "turn_00.exr", "turn_01.exr", "turn_02.exr", "turn_index.json"];
    assert_eq!(names(folder.path()), expected);
}

#[test]
fn only_missing_pictures_are_rendered_again_with_same_bits() {
    let folder = folder();
    let line = format!("render builtin:cornell -o turn {SMALL} {ORBIT}");
    lumivox(folder.path(), &line).expect_ok();
    let turn = folder.path().join("turn");
    let pictures = || ["0000.png", "0001.png", "0002.png"].map(|n| fs::read(turn.join(n)).unwrap());
    let changed = || fs::metadata(turn.join("0001.png")).unwrap().modified().unwrap();
    let (before, time) = (pictures(), changed());
    let run = lumivox(folder.path(), &line).expect_ok();
    assert!(run.stdout.contains("3 of them were there already"), "{}", run.stdout);

    // As after a power cut, one picture is truncated and one missing; the common exposure stays.
    fs::write(turn.join("0000.png"), &before[0][..40]).unwrap();
    fs::remove_file(turn.join("0002.png")).unwrap();
    let report = lumivox(folder.path(), &format!("{line} --json")).expect_ok().json();
    assert_eq!(report["rendered"], 2);
    assert!(pictures() == before, "the same pictures");
    assert_eq!(changed(), time, "the middle one was left alone");

    // Other settings are an error, unless all pictures are rendered again.
    let other = line.replace("--frames 1", "--frames 2");
    expect_error(folder.path(), &other, INPUT, &["index.json", "frames was 1, is 2", "--restart"]);
    let slower = line.replace("--fps 3", "--fps 2");
    expect_error(folder.path(), &slower, INPUT, &["fps was 3.0, is 2.0", "--restart"]);
    lumivox(folder.path(), &format!("{slower} --restart")).expect_ok();
    assert_eq!(names(&turn), ["0000.png", "0001.png", "index.json"]);
    assert_eq!(index(&turn, "index.json")["frame_count"], 2);
}

/// With history, pictures are the same after any interruption. Without history, each picture is as
/// if rendered on its own.
#[test]
#[ignore = "slow: over three seconds"]
fn a_resumed_film_with_history_has_the_same_bits() {
    let folder = folder();
    let path = folder.path();
    let small = SMALL.replace("--frames 1", "--frames 2");
    let line = format!("render builtin:cornell -o film_#.png {small} --preset realtime {ORBIT}");
    lumivox(path, &line).expect_ok();
    let read = |file: &str| fs::read(path.join(file)).unwrap();
    let film = || ["film_0.png", "film_1.png", "film_2.png"].map(read);
    let before = film();
    assert_eq!(index(path, "film_index.json")["settings"]["history"], "kept");
    fs::remove_file(path.join("film_2.png")).unwrap();
    let run = lumivox(path, &line).expect_ok();
    assert!(run.stdout.contains("2 rendered again"), "{}", run.stdout);
    assert!(film() == before, "the last was missing: other pictures");
    for file in ["film_0.png", "film_2.png"] {
        fs::remove_file(path.join(file)).unwrap();
    }
    let report = lumivox(path, &format!("{line} --json")).expect_ok().json();
    assert_eq!([&report["rendered"], &report["rendered_again"]], [2, 1]);
    assert!(film() == before, "the first and the last were missing: other pictures");

    let alone = format!("{line} --history none").replace("film_#", "alone_#");
    let other = format!("{line} --history none");
    let told = "history was \"kept\", is \"none\"";
    expect_error(path, &other, INPUT, &["film_index.json", told, "--restart"]);
    lumivox(path, &alone).expect_ok();
    assert!(read("alone_0.png") == before[0], "the first picture has no history");
    assert!(read("alone_2.png") != before[2], "the last one has");
    // This picture was rendered without the two before it.
    let last = read("alone_2.png");
    fs::remove_file(path.join("alone_2.png")).unwrap();
    let report = lumivox(path, &format!("{alone} --json")).expect_ok().json();
    assert_eq!([&report["rendered"], &report["rendered_again"]], [1, 0]);
    assert!(read("alone_2.png") == last);
}

/// With history, pictures of one frame sample different places in the pixels, so edges become
/// smooth.
#[test]
fn a_film_of_single_frames_has_smooth_edges() {
    let folder = folder();
    let path = folder.path();
    let view = "--preset realtime --view albedo --orbit 0 --time 0..1 --fps 3";
    for (history, is_same) in [("kept", false), ("none", true)] {
        let line =
            format!("render builtin:cornell -o {history}_#.png {SMALL} {view} --history {history}");
        lumivox(path, &line).expect_ok();
        let read = |number: u32| fs::read(path.join(format!("{history}_{number}.png"))).unwrap();
        assert_eq!(read(0) == read(2), is_same, "{history}");
    }
}

/// If the settings keep no light of earlier frames, there is no history, and nothing is rendered
/// again.
#[test]
fn without_temporal_settings_no_frame_is_rendered_again() {
    let folder = folder();
    let path = folder.path();
    let line = format!("render builtin:cornell -o a_#.exr {SMALL} {ORBIT} --json");
    lumivox(path, &line).expect_ok();
    assert_eq!(index(path, "a_index.json")["settings"]["history"], "none");
    let before = fs::read(path.join("a_2.exr")).unwrap();
    fs::remove_file(path.join("a_2.exr")).unwrap();
    let report = lumivox(path, &format!("{line} --history none")).expect_ok().json();
    assert_eq!([&report["rendered"], &report["rendered_again"]], [1, 0]);
    assert!(fs::read(path.join("a_2.exr")).unwrap() == before);
}

/// Starts a sequence of forty pictures in `turn`, and waits until `picture` exists. The index must
/// exist before the first picture, so that the sequence can be resumed.
#[cfg(unix)]
fn started(folder: &Path, picture: &str) -> std::process::Child {
    use std::process::Stdio;
    use std::time::{Duration, Instant};

    let mut child = command(folder, &FORTY.split_whitespace().collect::<Vec<_>>())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let turn = folder.join("turn");
    while !turn.join(picture).exists() {
        let has_picture = turn.join("0000.png").exists();
        assert!(!has_picture || turn.join("index.json").exists(), "a picture without an index");
        assert!(child.try_wait().unwrap().is_none(), "it has ended without {picture}");
        assert!(start.elapsed() < Duration::from_mins(5), "{picture} does not come");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

/// Enough pictures that the tests act before all of them are rendered.
#[cfg(unix)]
const FORTY: &str = "render builtin:cornell -o turn --size 32x18 --frames 1 --resolution 16 \
                     --shadow-resolution 64 --orbit 360 --time 0..4 --fps 10";

/// Ctrl-C leaves only complete pictures and an index that lists them, and has its own exit code.
#[cfg(unix)]
#[test]
#[ignore = "slow: over three seconds"]
fn an_interrupted_sequence_can_be_resumed() {
    let folder = folder();
    let child = started(folder.path(), "0002.png");
    interrupt(&child);
    let run: Run = child.wait_with_output().unwrap().into();
    assert_eq!(run.code, STOPPED, "{}", run.stderr);
    assert!(!run.stderr.contains("error: ") && run.stdout.is_empty(), "{}", run.stderr);
    let turn = folder.path().join("turn");
    let frames = index(&turn, "index.json")["frames"].as_array().unwrap().len();
    let told = format!("stopped: {frames} of 40 pictures are there; the same command continues");
    assert!(run.stderr.contains(&told), "{}", run.stderr);
    let mut expected: Vec<String> = (0..frames).map(|number| format!("{number:04}.png")).collect();
    expected.push("index.json".to_owned());
    assert_eq!(names(&turn), expected);
    let report = lumivox(folder.path(), &format!("{FORTY} --json")).expect_ok().json();
    assert_eq!(report["rendered"], 40 - frames);
}

/// Two processes would overwrite each other's index. The second continues once the first is killed.
#[cfg(unix)]
#[test]
#[ignore = "slow: over three seconds"]
fn a_second_process_is_refused_until_the_first_has_ended() {
    let folder = folder();
    let mut child = started(folder.path(), "0001.png");
    // While suspended, the first process cannot end before the second has started.
    freeze(&child);
    let run = lumivox(folder.path(), FORTY);
    assert_eq!(run.code, OUTPUT, "{}", run.stderr);
    let needle = "turn/index.json: another process renders this sequence; wait until it has ended";
    assert!(run.stderr.contains(needle), "{}", run.stderr);
    // Other sequences in the folder are not locked.
    let other = FORTY.replace("-o turn", "-o turn/b_##.png").replace("0..4", "0..0.2");
    lumivox(folder.path(), &other).expect_ok();
    // The lock file of a dead process is not locked.
    child.kill().unwrap();
    child.wait().unwrap();
    let turn = folder.path().join("turn");
    let lock = turn.join(".index.json.lock");
    assert!(lock.exists());
    let frames = || index(&turn, "index.json")["frames"].as_array().unwrap().len();
    let done = frames();
    assert!((1..40).contains(&done), "{done} were done");
    let report = lumivox(folder.path(), &format!("{FORTY} --json")).expect_ok().json();
    assert_eq!(report["pictures"], 40);
    assert_eq!(report["rendered"], 40 - done);
    assert_eq!(frames(), 40);
    assert!(!lock.exists());
}

#[test]
fn a_camera_path_file_moves_the_camera() {
    let folder = folder();
    write_path(
        folder.path(),
        &json!([
            { "time_s": 1, "position": [0.3, 1, 4], "target": [0, 1, 0], "fov_deg": 50 },
            { "time_s": 1.5, "camera": 0 },
            { "time_s": 2, "position": [-0.3, 1, 4], "target": [0, 1, 0], "fov_deg": 30 },
        ]),
    );
    let line = format!("render builtin:cornell -o a_#.exr {SMALL} --camera-path path.json --fps 4");
    lumivox(folder.path(), &line).expect_ok();
    let index = index(folder.path(), "a_index.json");
    let frames = index["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 4, "from 1 s to just before 2 s");
    assert_eq!(frames[0]["time_s"], 1.0);
    assert_eq!(frames[0]["file"], "a_0.exr");
    let x = |frame: &Value| frame["camera"]["position"][0].as_f64().unwrap();
    assert!((x(&frames[0]) - 0.3).abs() < 1e-6 && x(&frames[3]) < x(&frames[0]), "{frames:?}");
    let fov = frames[0]["camera"]["vertical_fov_deg"].as_f64().unwrap();
    assert!((fov - 50.0).abs() < 1e-3);
    assert_eq!(index["settings"]["camera_path"].as_array().unwrap().len(), 3);

    // With a single time, the path gives a still.
    let line = format!(
        "render builtin:cornell -o still.exr {SMALL} --camera-path path.json --time 1 --json"
    );
    let report = lumivox(folder.path(), &line).expect_ok().json();
    assert_eq!(report["camera"]["name"], "camera path");
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(read("still.exr") == read("a_0.exr"));
}

#[test]
fn each_picture_may_find_its_own_exposure() {
    let folder = folder();
    let line = format!("render builtin:cornell -o turn {SMALL} {ORBIT} --exposure auto-each");
    lumivox(folder.path(), &line).expect_ok();
    let index = index(&folder.path().join("turn"), "index.json");
    assert!(index["exposure"].is_null());
    let stops: HashSet<String> =
        index["frames"].as_array().unwrap().iter().map(|f| f["exposure"].to_string()).collect();
    assert_eq!(stops.len(), 3, "{stops:?}");
}

#[test]
fn conflicting_sequence_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("file"), "").unwrap();
    write_path(path, &json!([{ "time_s": 0, "camera": 0 }, { "time_s": 1, "camera": "nowhere" }]));
    for (line, code, needles) in [
        ("-o a.png --orbit 90", INPUT, ["a.png", "a_####.png"]),
        ("-o a.jpg --orbit 90", INPUT, ["a.jpg", ".exr"]),
        ("-o a_#_#.png --orbit 90", INPUT, ["a_#_#.png", "together"]),
        ("-o a_#.png --orbit 90 --fps 30", INPUT, ["120 pictures", "write ###"]),
        ("-o missing/turn/ --orbit 90", OUTPUT, ["missing/turn", "there is no folder missing"]),
        ("-o file/turn/ --orbit 90", OUTPUT, ["file/turn", "is a file, not a folder"]),
        ("-o turn/", INPUT, ["nothing moves", "--orbit"]),
        ("-o turn/ --time 0..1", INPUT, ["nothing moves", "--camera-path"]),
        ("-o a.png --time 1", INPUT, ["nothing moves", "cornell"]),
        // One time means one picture, and `turn` is not a picture's name.
        ("-o turn --orbit 90 --time 1", INPUT, ["turn", ".png"]),
        ("-o turn/ --orbit 90 --time 1", INPUT, ["an orbit is a sequence", "START..END"]),
        ("-o turn --orbit 90 --time 2..1", INPUT, ["--time", "end after it starts"]),
        ("-o turn --orbit 90 --time soon", USAGE, ["--time", "START..END"]),
        ("-o turn --orbit round", USAGE, ["--orbit", "number"]),
        ("-o turn --orbit 1e9", INPUT, ["--orbit", "36000"]),
        ("-o turn --orbit 90 --fps 0", INPUT, ["--fps", "0.001"]),
        ("-o turn --orbit 90 --time 0..10000 --fps 1000", INPUT, ["10000000 pictures", "--fps"]),
        ("-o a.png --animation walk", INPUT, ["no animation \"walk\"", "there are: none"]),
        ("-o turn --camera-path none.json", INPUT, ["none.json", "cannot read"]),
        ("-o turn --camera-path file", INPUT, ["file", "malformed"]),
        ("-o turn --camera-path path.json", INPUT, ["path.json: key 1", "\"nowhere\""]),
        ("-o turn --camera-path path.json --orbit 9", USAGE, ["--orbit", "--camera-path"]),
        ("-o turn --camera-path path.json --camera 0", USAGE, ["--camera", "cannot be used"]),
        ("-o a.png --exposure auto-all", USAGE, ["--exposure", "auto-each"]),
    ] {
        expect_error(path, &format!("render builtin:cornell {line}"), code, &needles);
    }
    fs::create_dir(path.join("full")).unwrap();
    fs::write(path.join("full/0000.png"), "a photograph").unwrap();
    let line = "render builtin:cornell -o full --orbit 90";
    expect_error(path, line, OUTPUT, &["full/0000.png", "no index", "--restart"]);
}
