//! Our pictures beside those of the program itself.
//!
//! `tests/vxct` has what VXCT (2019-10-07, 64 voxels, on a software GPU) showed of
//! `scenes/cornell.scene` and `scenes/gallery.scene`, from its start camera and its positions 1 and
//! 2, with different components: pictures of 640x360, each 2x2 pixels averaged.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::UVec2;
use image::{Rgb, RgbImage};
use lumivox::Directionality;
use lumivox_render::{Exposure, RenderSettings, Renderer, ToneMap, View};
use lumivox_scene::Scene;
use lumivox_vxct::{VxctSettings, vxct_display};

use crate::common::kept::MAX_MEAN_CODES;
use crate::common::{builtin, camera, gpu, picture, renderer};

/// Maximum mean absolute difference per channel, of 255.
const MOST: f64 = 3.0;

/// The size of VXCT's pictures before averaging.
const SIZE: UVec2 = UVec2::new(640, 360);

/// The console's settings for a picture.
fn settings(what: &str) -> RenderSettings {
    let usual = VxctSettings::for_resolution(64);
    let nothing =
        VxctSettings { phong: false, diffuse: false, specular: false, shadows: false, ..usual };
    let (vxct, view, voxel_level) = match what {
        "phong" => (VxctSettings { indirect_light: false, ..usual }, View::Final, 0),
        "all" => (usual, View::Final, 0),
        "all-with-phong-specular" => {
            (VxctSettings { phong_specular: true, ..usual }, View::Final, 0)
        }
        "side-cones" => (VxctSettings { side_cones: true, ..usual }, View::Final, 0),
        "phong-only" => (VxctSettings { phong: true, ..nothing }, View::Final, 0),
        "diffuse-only" => (VxctSettings { diffuse: true, ..nothing }, View::Final, 0),
        "specular-only" => (VxctSettings { specular: true, ..nothing }, View::Final, 0),
        "shadows-only" => (VxctSettings { shadows: true, ..nothing }, View::Final, 0),
        "loclod0" => (usual, View::Lod, 0),
        "loclod2" => (usual, View::Lod, 2),
        other => panic!("tests/vxct has {other}, which no console says"),
    };
    RenderSettings {
        size: SIZE,
        resolution: 64,
        frames: 1,
        exposure: Exposure::Stops(0.0),
        tone_map: ToneMap::Raw,
        look: Some(Arc::new(vxct)),
        view,
        voxel_level,
        ..RenderSettings::default()
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn scene(name: &str) -> Scene {
    Scene::load(root().join("scenes").join(format!("{name}.scene"))).expect("a scene of ours")
}

/// The picture, each 2x2 pixels averaged.
fn halved(ldr: &[[u8; 4]], size: UVec2) -> RgbImage {
    RgbImage::from_fn(size.x / 2, size.y / 2, |x, y| {
        let sum = |channel: usize| -> u32 {
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let at = |(dx, dy): (u32, u32)| ((2 * y + dy) * size.x + 2 * x + dx) as usize;
            corners.into_iter().map(|corner| u32::from(ldr[at(corner)][channel])).sum()
        };
        Rgb([0, 1, 2].map(|channel| ((sum(channel) + 2) / 4) as u8))
    })
}

fn mean_difference(ours: &RgbImage, theirs: &RgbImage) -> f64 {
    let pairs = ours.as_raw().iter().zip(theirs.as_raw());
    pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / ours.as_raw().len() as f64
}

/// Theirs, ours, and eight times the difference, beside each other.
fn strip(theirs: &RgbImage, ours: &RgbImage) -> RgbImage {
    let (width, height) = ours.dimensions();
    RgbImage::from_fn(3 * width, height, |x, y| {
        let at = |image: &RgbImage| *image.get_pixel(x % width, y);
        match x / width {
            0 => at(theirs),
            1 => at(ours),
            _ => {
                let (a, b) = (at(theirs).0, at(ours).0);
                Rgb([0, 1, 2].map(|c: usize| a[c].abs_diff(b[c]).saturating_mul(8)))
            }
        }
    })
}

/// Stacks pictures vertically.
fn stack(strips: &[RgbImage]) -> RgbImage {
    let (width, height) = strips[0].dimensions();
    RgbImage::from_fn(width, height * strips.len() as u32, |x, y| {
        *strips[(y / height) as usize].get_pixel(x, y % height)
    })
}

/// Every component, from three places.
#[test]
#[ignore = "slow: twelve pictures of 640x360 pixels"]
fn box_pictures_match_vxct() {
    compare("cornell");
}

/// Compares all components on the gallery's models.
#[test]
#[ignore = "release: ten pictures of 640x360 pixels"]
fn gallery_pictures_match_vxct_at_release() {
    compare("gallery");
}

/// Compares all pictures of a scene with the program's.
fn compare(name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vxct");
    let mut failures = Vec::new();
    let mut files: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("tests/vxct is there")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.file_stem().is_some_and(|s| s.to_string_lossy().starts_with(name)))
        .collect();
    files.sort();
    assert!(files.len() > 9, "{files:?}");
    let scene = scene(name);
    let mut known: Option<Renderer> = None;
    let mut strips = Vec::new();
    for file in files {
        let stem = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let (_, rest) = stem.split_once('-').expect("scene-camera-component");
        let (place, what) = rest.split_once('-').expect("scene-camera-component");
        let mut renderer =
            known.take().unwrap_or_else(|| renderer(&gpu(), &scene, settings("all")));
        renderer.set_camera(camera(&scene, if place == "start" { "vxct" } else { place }));
        pollster::block_on(renderer.set_settings(settings(what), &mut |_| {})).expect("settings");
        let ours = halved(&picture(&mut renderer).ldr, SIZE);
        let theirs = image::open(&file).expect("a picture").to_rgb8();
        let difference = mean_difference(&ours, &theirs);
        println!("{stem}: {difference:.2} of 255");
        if difference > MOST {
            failures.push(format!("{stem}: {difference:.2} of 255"));
        }
        strips.push(strip(&theirs, &ours));
        known = Some(renderer);
    }
    if is_blessing() {
        let path = root().join(format!("docs/images/vxct-look/{name}.jpg"));
        let file = std::fs::File::create(&path).expect("a folder for pictures");
        let mut jpeg = image::codecs::jpeg::JpegEncoder::new_with_quality(file, 90);
        jpeg.encode_image(&stack(&strips)).expect("a picture");
        let said = writeln!(std::io::stderr(), "LUMIVOX_BLESS=1 wrote {}", path.display());
        said.expect("stderr takes a line");
    }
    assert!(failures.is_empty(), "more than {MOST} of 255 off: {failures:#?}");
}

/// A scene that was not made for VXCT looks as before.
#[test]
fn a_box_matches_its_snapshot() {
    let scene = builtin("cornell");
    let display = vxct_display(&scene);
    let settings = RenderSettings {
        size: UVec2::new(160, 90),
        resolution: 64,
        frames: 8,
        look: Some(Arc::new(VxctSettings::for_resolution(64))),
        directionality: Directionality::Isotropic,
        bounces: 1,
        exposure: display.exposure,
        tone_map: display.tone_map,
        ..RenderSettings::default()
    };
    let shown = picture(&mut renderer(&gpu(), &scene, settings));
    let at = |x: u32, y: u32| shown.ldr[(y * shown.size.x + x) as usize];
    let shown = RgbImage::from_fn(shown.size.x, shown.size.y, |x, y| {
        let [r, g, b, _] = at(x, y);
        Rgb([r, g, b])
    });
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots/cornell.png");
    if is_blessing() {
        shown.save(&path).expect("a picture");
    }
    let before = image::open(&path).expect("a picture").to_rgb8();
    let difference = mean_difference(&shown, &before);
    println!("cornell: {difference} of 255");
    assert!(difference < MAX_MEAN_CODES, "{difference} of 255");
}

/// Whether references are written.
fn is_blessing() -> bool {
    std::env::var("LUMIVOX_BLESS").is_ok_and(|value| value == "1")
}
