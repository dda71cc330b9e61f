//! The examples, run as programs: their pictures are compared with approved ones.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::stage::alone;

const FRAMES: u32 = 24;
const SIZE: &str = "96x54";
/// The largest RMS difference of sRGB values: noise of other rotations of the cones is about 0.01.
const TOLERANCE: f32 = 0.03;

/// Runs an example, and compares its last picture; `LUMIVOX_BLESS=1` replaces the expected one.
#[track_caller]
fn looks_right(name: &str) {
    looks_right_on(None, name, FRAMES);
}

/// `looks_right` on the Vulkan driver of a manifest.
#[track_caller]
fn looks_right_on(driver: Option<&str>, name: &str, frames: u32) {
    let _alone = alone();
    let folder = std::env::current_exe().expect("a path");
    let target = folder.parent().and_then(Path::parent).expect("a folder of programs");
    let program = target.join("examples").join(name);
    assert!(program.exists(), "{} is not there: build the examples", program.display());
    let out = PathBuf::from("target/pictures/examples");
    let mut command = Command::new(program);
    command.env("BEVY_ASSET_ROOT", env!("CARGO_MANIFEST_DIR"));
    if let Some(driver) = driver {
        assert!(Path::new(driver).exists(), "{driver} is not there: install Chromium");
        command.env("VK_DRIVER_FILES", driver).env("VK_ICD_FILENAMES", driver);
    }
    let run = command
        .args(["--lit", "--frames", &frames.to_string(), "--size", SIZE, "--out"])
        .arg(&out)
        .output()
        .expect("it runs");
    let told = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{told}{}", String::from_utf8_lossy(&run.stderr));
    println!("{told}");
    let file = format!("{name}-2.png");
    let (made, expected) = (out.join(&file), Path::new("tests/pictures").join(&file));
    if std::env::var_os("LUMIVOX_BLESS").is_some() {
        std::fs::create_dir_all("tests/pictures").expect("a folder");
        std::fs::copy(&made, &expected).expect("copied");
        return;
    }
    let [found, there] = [&made, &expected].map(|path| {
        let picture =
            image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        picture.into_rgb32f()
    });
    assert_eq!(found.dimensions(), there.dimensions());
    let squares =
        found.as_raw().iter().zip(there.as_raw()).map(|(one, other)| (one - other).powi(2));
    let rms = (squares.sum::<f32>() / found.as_raw().len() as f32).sqrt();
    println!("{name}: off by {rms}");
    assert!(rms < TOLERANCE, "{} is off by {rms} from {}", made.display(), expected.display());
}

#[test]
fn cornell_looks_right() {
    looks_right("cornell");
}

#[test]
#[ignore = "release: other tests hold what it shows, and its picture takes half a minute"]
fn torch_looks_right_at_release() {
    looks_right("torch");
}

#[test]
fn atrium_looks_right() {
    looks_right("atrium");
}

#[test]
#[ignore = "slow: Bevy's atmosphere crashes Mesa 22's software driver, so it takes Chromium's SwiftShader"]
fn terrain_looks_right_at_release() {
    looks_right_on(Some("/usr/lib/chromium/vk_swiftshader_icd.json"), "terrain", 6);
}

#[test]
#[ignore = "release: other tests hold what it shows, and its picture takes half a minute"]
fn baked_looks_right_at_release() {
    looks_right("baked");
}
