//! Compares pictures by FLIP with references that a person has checked.
//!
//! The references are `tests/snapshots/NAME.png`. References that are missing, of another size or
//! no longer rendered fail: no picture becomes a reference automatically. `LUMIVOX_BLESS=1` writes
//! all; look at each before you commit it.
//!
//! If a comparison fails, the rendered picture and a picture of the differences are in the
//! `snapshots` folder that the message names.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use glam::UVec2;
use image::RgbImage;
use lumivox::{Directionality, TraceResolution, TraceSettings};
use lumivox_render::{Exposure, Overlay, RenderSettings, Renderer, ShadowMethod, View, Wireframe};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

use crate::common::kept::MAX_MEAN_FLIP;
use crate::common::{builtin, gpu, picture, renderer, turned, zoo};

/// Small enough to render all pictures in a minute on a software driver, large enough to see
/// errors.
fn small() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(160, 90),
        resolution: 64,
        frames: 8,
        ..RenderSettings::default()
    }
}

/// A picture with a stored reference.
struct Snapshot {
    name: String,
    scene: &'static str,
    settings: RenderSettings,
}

impl Snapshot {
    fn new(name: impl Into<String>, scene: &'static str, settings: RenderSettings) -> Self {
        Self { name: name.into(), scene, settings }
    }
}

/// The turned Cornell box.
const TURNED: &str = "cornell-turned";

/// All built-in scenes, except large ones and those whose light other tests compare with closed
/// forms or zero.
fn scenes() -> Vec<Snapshot> {
    let known = ["furnace", "panel", "two-rooms-closed"];
    let names = lumivox_scene::builtin::names().iter().copied();
    names
        .filter(|name| !known.contains(name))
        .filter(|name| !lumivox_scene::builtin::is_large(name))
        .map(|scene| Snapshot::new(scene, scene, small()))
        .collect()
}

/// One of every material.
fn materials() -> Vec<Snapshot> {
    // For transparency: see `MAX_MEAN_FLIP`. The stops are from automatic exposure.
    let settings = RenderSettings { frames: 64, exposure: Exposure::Stops(-1.826), ..small() };
    vec![Snapshot::new("materials", "materials", settings)]
}

/// Views other than the final one. The view of normals shows the turned scene: along an axis,
/// normals have components of 0, exactly between two 8-bit codes.
fn views() -> Vec<Snapshot> {
    let views = [
        ("cornell", View::Direct),
        ("cornell", View::Indirect),
        ("cornell", View::Occlusion),
        ("cornell", View::Voxels),
        ("cornell", View::Albedo),
        (TURNED, View::Normal),
    ];
    views
        .map(|(scene, view)| {
            let settings = RenderSettings { view, ..small() };
            Snapshot::new(format!("{scene}-{}", view.name()), scene, settings)
        })
        .into()
}

/// Overlays over pictures, and a picture of wires only.
fn overlays() -> Vec<Snapshot> {
    let over = Overlay { wireframe: Wireframe::Over, grid_box: true, ..Overlay::default() };
    [
        ("wire-voxels", RenderSettings { view: View::WireVoxels, voxel_level: 2, ..small() }),
        ("wireframe", RenderSettings { overlay: over, ..small() }),
    ]
    .map(|(what, settings)| Snapshot::new(format!("cornell-{what}"), "cornell", settings))
    .into()
}

/// Cornell, each time with another setting that selects separate code.
fn variants() -> Vec<Snapshot> {
    let half = TraceSettings { resolution: TraceResolution::Half, ..TraceSettings::default() };
    let directionality = Directionality::Isotropic;
    [
        ("cone-shadows", RenderSettings { shadows: ShadowMethod::Cone, ..small() }),
        ("isotropic", RenderSettings { directionality, ..small() }),
        ("half", RenderSettings { trace: half, ..small() }),
    ]
    .map(|(what, settings)| Snapshot::new(format!("cornell-{what}"), "cornell", settings))
    .into()
}

#[test]
#[ignore = "slow: over three seconds"]
fn scenes_look_as_before() {
    check(scenes());
}

#[test]
#[ignore = "slow: over three seconds"]
fn materials_look_as_before() {
    check(materials());
}

#[test]
fn views_look_as_before() {
    check(views());
}

#[test]
#[ignore = "slow: over three seconds"]
fn overlays_look_as_before() {
    check(overlays());
}

#[test]
#[ignore = "slow: over three seconds"]
fn variants_look_as_before() {
    check(variants());
}

/// References that no test reads would never be deleted.
#[test]
fn every_snapshot_file_belongs_to_a_test() {
    let snapshots = [scenes(), materials(), views(), overlays(), variants()].into_iter().flatten();
    let known: BTreeSet<String> = snapshots.map(|snapshot| snapshot.name).collect();
    if is_blessing() {
        // Another test may create the folder later.
        return;
    }
    let files = std::fs::read_dir(reference_path("cornell").with_file_name(""))
        .expect("tests/snapshots is there")
        .map(|entry| entry.expect("an entry").path());
    let unused: Vec<PathBuf> = files
        .filter(|file| {
            let stem = file.file_stem().unwrap_or_default().to_string_lossy();
            !known.contains(stem.as_ref()) || file.extension().is_none_or(|e| e != "png")
        })
        .collect();
    assert!(unused.is_empty(), "no test reads these files; delete them: {unused:?}");
}

/// Tests the comparison: it detects a shift by a pixel and 10 % more light, and no difference
/// between equal pictures.
#[test]
fn the_comparison_sees_small_changes() {
    let size = UVec2::new(160, 90);
    let gradient = |dx: u32, gain: f32| {
        RgbImage::from_fn(size.x, size.y, |x, y| {
            let checker = f32::from((((x + dx) / 8 + y / 8) % 2) as u8);
            image::Rgb([((60.0 + 100.0 * checker) * gain) as u8, 90, 120])
        })
    };
    let reference = gradient(0, 1.0);
    assert!(flip(&reference, &reference).0 <= 0.0);
    for (what, changed) in [("a pixel", gradient(1, 1.0)), ("10 %", gradient(0, 1.1))] {
        let (mean, _) = flip(&reference, &changed);
        println!("{what}: {mean}");
        assert!(mean > MAX_MEAN_FLIP, "a change by {what} has a mean FLIP error of {mean} only");
    }
}

/// Renders all snapshots and compares each with its reference, or writes the reference if
/// requested. Consecutive snapshots of one scene share a renderer.
fn check(snapshots: Vec<Snapshot>) {
    let gpu = gpu();
    let mut failures = Vec::new();
    let mut last: Option<(&str, Renderer)> = None;
    for Snapshot { name, scene, settings } in snapshots {
        let mut renderer = match last.take() {
            Some((same, mut renderer)) if same == scene => {
                pollster::block_on(renderer.set_settings(settings, &mut |_| {}))
                    .expect("valid settings");
                renderer
            }
            _ if scene == "materials" => renderer(&gpu, &zoo::scene(), settings),
            _ if scene == TURNED => renderer(&gpu, &turned("cornell"), settings),
            _ => renderer(&gpu, &builtin(scene), settings),
        };
        let picture = picture(&mut renderer);
        last = Some((scene, renderer));
        let rgb = picture.ldr.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        let actual = RgbImage::from_raw(picture.size.x, picture.size.y, rgb);
        let actual = actual.expect("three bytes a pixel");
        let path = reference_path(&name);
        if is_blessing() {
            save(&actual, &path);
            // Not `println!`, whose output is captured if the test passes.
            let said = writeln!(std::io::stderr(), "LUMIVOX_BLESS=1 wrote {}", path.display());
            said.expect("stderr takes a line");
        } else if let Err(failure) = compare(&name, &actual, &path) {
            failures.push(failure);
        }
    }
    assert!(
        failures.is_empty(),
        "{}\nOn {}. Look at the pictures; where the new ones are right, write them as references with\n  \
         LUMIVOX_BLESS=1 ./test -- -p lumivox-render snapshots -- --include-ignored\nand commit them with the change \
         that explains them.",
        failures.join("\n"),
        lumivox_render::describe(&gpu.adapter_info)
    );
}

/// Whether references are written instead of compared.
fn is_blessing() -> bool {
    match std::env::var("LUMIVOX_BLESS").as_deref() {
        Err(std::env::VarError::NotPresent) | Ok("" | "0") => false,
        Ok("1") => true,
        other => panic!("LUMIVOX_BLESS is {other:?}; it may be 1, or not be set"),
    }
}

fn reference_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots").join(format!("{name}.png"))
}

/// Saves a picture of a failed comparison in cargo's target folder, which git ignores; returns its
/// path.
fn leave_behind(name: &str, image: &RgbImage) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("snapshots").join(format!("{name}.png"));
    save(image, &path);
    path
}

fn save(image: &RgbImage, path: &Path) {
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder for the picture");
    image
        .save(path)
        .unwrap_or_else(|error| panic!("{} cannot be written: {error}", path.display()));
}

/// Compares a picture with its reference.
fn compare(name: &str, actual: &RgbImage, path: &Path) -> Result<(), String> {
    let left = |actual: &RgbImage| leave_behind(&format!("{name}-actual"), actual);
    let shown = path.display();
    let reference = match image::open(path) {
        Ok(reference) => reference.to_rgb8(),
        Err(error) => {
            let actual = left(actual);
            return Err(format!(
                "{name}: no reference ({shown}: {error}); rendered was {}",
                actual.display()
            ));
        }
    };
    if reference.dimensions() != actual.dimensions() {
        return Err(format!(
            "{name}: the reference {shown} has {:?} pixels, the picture {:?}: {}",
            reference.dimensions(),
            actual.dimensions(),
            left(actual).display()
        ));
    }
    let (mean, difference) = flip(&reference, actual);
    println!("{name}: mean FLIP error {mean:.5}");
    if mean <= MAX_MEAN_FLIP {
        return Ok(());
    }
    Err(format!(
        "{name}: mean FLIP error {mean:.4}, at most {MAX_MEAN_FLIP} is allowed\n  \
         reference:  {shown}\n  actual:     {}\n  difference: {}",
        left(actual).display(),
        leave_behind(&format!("{name}-difference"), &difference).display()
    ))
}

/// The mean FLIP error, 0 to 1 (Andersson et al. 2020, "FLIP: A difference evaluator for
/// alternating images"), and a picture of it: from black (equal) over red to bright yellow.
fn flip(reference: &RgbImage, actual: &RgbImage) -> (f32, RgbImage) {
    let [reference, actual] = [reference, actual]
        .map(|image| FlipImageRgb8::with_data(image.width(), image.height(), image));
    let error = nv_flip::flip(reference, actual, DEFAULT_PIXELS_PER_DEGREE);
    let mean = FlipPool::from_image(&error).mean();
    let colors = error.apply_color_lut(&nv_flip::magma_lut());
    let difference = RgbImage::from_raw(colors.width(), colors.height(), colors.to_vec());
    (mean, difference.expect("three bytes a pixel"))
}
