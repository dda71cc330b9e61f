//! Pictures compared by FLIP with references that a person has checked.
//!
//! The references are `tests/snapshots/NAME.png`. A missing reference fails, and so does one of
//! another size or one that is no longer rendered: no picture becomes a reference by itself.
//! `LUMIVOX_BLESS=1` writes them all; look at each before it is committed.
//!
//! The rendered picture of a failing comparison, and the picture of its differences, are left in
//! the `snapshots` folder that the message names.

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

/// Small enough to render all of them in a minute on a software driver, large enough to see what is
/// wrong.
fn small() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(160, 90),
        resolution: 64,
        frames: 8,
        ..RenderSettings::default()
    }
}

/// A picture that is kept.
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

/// Every built-in scene but the large ones, and those whose light is compared with closed forms or
/// has to be zero.
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
    // Drawn transparency: see `MAX_MEAN_FLIP`. Automatic exposure chose these stops.
    let settings = RenderSettings { frames: 64, exposure: Exposure::Stops(-1.826), ..small() };
    vec![Snapshot::new("materials", "materials", settings)]
}

/// Views other than the final one. Normals along an axis have components of 0, which lie right
/// between two codes of 8 bits, so the normals are those of the turned scene.
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

/// Overlays over pictures, and only wires.
fn overlays() -> Vec<Snapshot> {
    let over = Overlay { wireframe: Wireframe::Over, grid_box: true, ..Overlay::default() };
    [
        ("wire-voxels", RenderSettings { view: View::WireVoxels, voxel_level: 2, ..small() }),
        ("wireframe", RenderSettings { overlay: over, ..small() }),
    ]
    .map(|(what, settings)| Snapshot::new(format!("cornell-{what}"), "cornell", settings))
    .into()
}

/// Cornell with one setting each that has code of its own.
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

/// A reference that no test reads would stay for ever.
#[test]
fn every_snapshot_file_belongs_to_a_test() {
    let snapshots = [scenes(), materials(), views(), overlays(), variants()].into_iter().flatten();
    let known: BTreeSet<String> = snapshots.map(|snapshot| snapshot.name).collect();
    if is_blessing() {
        // The folder may be another test's to make, a moment from now.
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

/// The comparison itself: it sees a shift of a pixel and a share of the light, and nothing in equal
/// pictures.
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

/// Renders all of them and compares each with its reference, or makes it the reference if that is
/// requested. One renderer shows those of a scene that follow each other.
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
            // Past the capture of passing tests' output: this is never silent.
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

/// Saves a picture of a failure below cargo's target folder, which git ignores; returns its path.
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

/// Holds a picture against its reference.
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
/// alternating images"), and a picture of it: black where nothing differs, over red to bright
/// yellow.
fn flip(reference: &RgbImage, actual: &RgbImage) -> (f32, RgbImage) {
    let [reference, actual] = [reference, actual]
        .map(|image| FlipImageRgb8::with_data(image.width(), image.height(), image));
    let error = nv_flip::flip(reference, actual, DEFAULT_PIXELS_PER_DEGREE);
    let mean = FlipPool::from_image(&error).mean();
    let colors = error.apply_color_lut(&nv_flip::magma_lut());
    let difference = RgbImage::from_raw(colors.width(), colors.height(), colors.to_vec());
    (mean, difference.expect("three bytes a pixel"))
}
