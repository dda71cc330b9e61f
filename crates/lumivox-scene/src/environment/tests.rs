//! Panoramas from files that these tests write.

use std::io::Cursor;
use std::path::PathBuf;

use glam::Vec3;
use image::{ImageFormat, Rgb, Rgb32FImage, RgbImage};

use crate::{EnvironmentMap, SceneError};

/// A picture with a gradient, a bright texel and values above 1.
fn texel(x: u32, y: u32) -> [f32; 3] {
    if (x, y) == (5, 1) {
        return [1000.0, 800.0, 250.0];
    }
    [0.25 * (1 + x) as f32, 0.5 + y as f32, 2.0]
}

fn picture(width: u32, height: u32) -> Rgb32FImage {
    Rgb32FImage::from_fn(width, height, |x, y| Rgb(texel(x, y)))
}

struct Folder {
    folder: tempfile::TempDir,
}

impl Folder {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn file(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    fn load(&self, name: &str, bytes: &[u8]) -> Result<EnvironmentMap, SceneError> {
        EnvironmentMap::load(self.file(name, bytes))
    }
}

fn hdr_bytes(picture: &Rgb32FImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Hdr).unwrap();
    bytes.into_inner()
}

fn exr_bytes(
    width: usize,
    height: usize,
    pixel: impl Fn(exr::prelude::Vec2<usize>) -> (f32, f32, f32) + Sync,
) -> Vec<u8> {
    use exr::prelude::*;
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((width, height), SpecificChannels::rgb(pixel))
        .write()
        .to_buffered(&mut bytes)
        .unwrap();
    bytes.into_inner()
}

fn close(actual: [f32; 3], expected: [f32; 3], share: f32) {
    // The exponent of a Radiance texel is that of its largest channel.
    let most = Vec3::from(expected).max_element();
    let error = (Vec3::from(actual) - Vec3::from(expected)).abs().max_element();
    assert!(error <= share * most, "{actual:?}, not {expected:?}");
}

#[test]
fn radiance_and_openexr_hold_the_same_texels() {
    let folder = Folder::new();
    let (width, height) = (16, 8);
    let hdr = folder.load("a.hdr", &hdr_bytes(&picture(width, height))).unwrap();
    let exr = exr_bytes(16, 8, |at| texel(at.0 as u32, at.1 as u32).into());
    let exr = folder.load("a sky.exr", &exr).unwrap();
    assert_eq!((hdr.name.as_str(), exr.name.as_str()), ("a", "a sky"));
    for map in [&hdr, &exr] {
        assert_eq!((map.width, map.height), (width, height));
        assert!(map.warnings.is_empty(), "{:?}", map.warnings);
        for (index, rgb) in map.rgb.iter().enumerate() {
            let expected = texel(index as u32 % width, index as u32 / width);
            // Channels share one exponent, and have 8 bits of mantissa.
            close(*rgb, expected, 1.0 / 128.0);
        }
    }
}

/// A bright texel lights the surfaces that face it: the picture's middle is -z, its right half +x,
/// its top +y.
#[test]
fn panorama_texels_light_the_documented_directions() {
    let (width, height) = (64, 32);
    let cases = [
        ((31, 15), Vec3::NEG_Z),
        ((47, 15), Vec3::X),
        ((15, 15), Vec3::NEG_X),
        ((0, 15), Vec3::Z),
        ((20, 0), Vec3::Y),
        ((20, 31), Vec3::NEG_Y),
    ];
    for ((x, y), direction) in cases {
        let mut map = EnvironmentMap { width, height, ..EnvironmentMap::default() };
        map.rgb = vec![[0.0; 3]; (width * height) as usize];
        map.rgb[(y * width + x) as usize] = [7.0; 3];
        // A texel is 0.1 rad wide, so its middle is up to 0.07 rad from `direction`.
        assert!(map.direction(x as f32 + 0.5, y as f32 + 0.5).dot(direction) > 0.99);
        let facing = map.irradiance(direction).x;
        let expected = 7.0 * map.solid_angle_sr(y) as f32;
        assert!((facing / expected - 1.0).abs() < 0.01, "{direction}: {facing} {expected}");
        assert!(map.irradiance(-direction).x == 0.0);
    }
}

#[test]
fn constant_surroundings_have_their_closed_forms() {
    let (width, height) = (128, 64);
    let rgb = vec![[2.0, 3.0, 4.0]; (width * height) as usize];
    let map = EnvironmentMap { width, height, rgb, ..EnvironmentMap::default() };
    assert!((map.mean_radiance() - Vec3::new(2.0, 3.0, 4.0)).abs().max_element() < 1e-5);
    for normal in [Vec3::Y, Vec3::X, Vec3::new(0.6, 0.0, -0.8)] {
        let error = map.irradiance(normal) / std::f32::consts::PI - Vec3::new(2.0, 3.0, 4.0);
        assert!(error.abs().max_element() < 2e-3, "{error}");
    }
}

/// The exposure of a camera is divided out; signatures of other programs are accepted.
#[test]
fn radiance_files_undo_exposure_and_colour_correction() {
    let folder = Folder::new();
    let bytes = hdr_bytes(&picture(16, 8));
    let text = b"#?RADIANCE\n";
    assert!(bytes.starts_with(text));
    let mut changed = b"#?RGBE\nEXPOSURE=2\nEXPOSURE= 4\nCOLORCORR=1 0.5 1\n".to_vec();
    changed.extend_from_slice(&bytes[text.len()..]);
    let map = folder.load("a.pic", &changed).unwrap();
    close(map.rgb[0], [0.25 / 8.0, 0.5 / 4.0, 2.0 / 8.0], 1.0 / 128.0);
}

#[test]
fn display_pictures_are_decoded_from_srgb_with_a_warning() {
    let folder = Folder::new();
    let mut bytes = Cursor::new(Vec::new());
    let picture = RgbImage::from_fn(8, 4, |x, _| Rgb([if x == 0 { 255 } else { 188 }, 10, 0]));
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    // The first bytes decide the format, not the name.
    let map = folder.load("sky.hdr", &bytes.into_inner()).unwrap();
    assert_eq!(map.rgb[0][0], 1.0);
    // sRGB 188 is half the light (0.5029); 10 is in the linear part of the curve.
    close(map.rgb[1], [0.502_886, 0.003_035, 0.0], 1e-5);
    assert!(map.warnings[0].contains("cut off at white"), "{:?}", map.warnings);
}

#[test]
fn invalid_radiance_is_repaired_with_a_warning() {
    let folder = Folder::new();
    let bytes = exr_bytes(8, 4, |at| match (at.0, at.1) {
        (0, 0) => (-1.0, f32::NAN, 1.0),
        (1, 0) => (f32::INFINITY, -2.0, 5.0),
        (2, 0) => (3e38, 1.0, 1.0),
        _ => (1.0, 1.0, 1.0),
    });
    let map = folder.load("a.exr", &bytes).unwrap();
    assert_eq!(map.rgb[..3], [[0.0, 0.0, 1.0], [5.0, 0.0, 5.0], [5.0, 1.0, 1.0]]);
    let told = map.warnings.join("; ");
    for part in
        ["2 negative", "1 undefined (NaN)", "2 infinite or far too large values, which count as 5"]
    {
        assert!(told.contains(part), "{told}");
    }
}

#[test]
fn unusual_panorama_sizes_give_a_warning() {
    let folder = Folder::new();
    let map = folder.load("cross.hdr", &hdr_bytes(&picture(12, 16))).unwrap();
    assert!(map.warnings[0].contains("12 x 16"), "{:?}", map.warnings);
}

/// Blender prefixes the channels of a layer; a data window may be smaller than the picture.
#[test]
fn openexr_layers_and_data_windows_are_read() {
    use exr::prelude::*;
    let folder = Folder::new();
    // The origin of the display window does not matter: the stored part lies 2 to the right of it
    // and 1 below.
    for (left, top) in [(0, 0), (5, -7), (-3, 20)] {
        let mut bytes = Cursor::new(Vec::new());
        let channels = SpecificChannels::build()
            .with_channel("View Layer.Combined.R")
            .with_channel("View Layer.Combined.G")
            .with_channel("View Layer.Combined.B")
            .with_pixel_fn(|at| (at.0 as f32, at.1 as f32, 9.0_f32));
        let mut attributes = LayerAttributes::named("layer");
        attributes.layer_position = Vec2(left + 2, top + 1);
        attributes.white_luminance = Some(100.0);
        let layer = Layer::new((4, 2), attributes, Encoding::FAST_LOSSLESS, channels);
        let mut image = Image::from_layer(layer);
        image.attributes.display_window = IntegerBounds::new((left, top), (8, 4));
        image.write().to_buffered(&mut bytes).unwrap();
        let map = folder.load("a.exr", &bytes.into_inner()).unwrap();
        assert_eq!((map.width, map.height), (8, 4));
        assert_eq!(map.rgb[8 + 2], [0.0, 0.0, 900.0]);
        assert_eq!(map.rgb[2 * 8 + 5], [300.0, 100.0, 900.0]);
        assert_eq!(map.rgb[0], [0.0; 3]);
        assert!(map.warnings[0].contains("4 x 2 of its 8 x 4"), "{:?}", map.warnings);
    }
}

#[test]
fn openexr_may_be_grey() {
    use exr::prelude::*;
    let folder = Folder::new();
    let mut bytes = Cursor::new(Vec::new());
    let channels =
        SpecificChannels::build().with_channel("Y").with_pixel_fn(|at| (at.0 as f32 + 0.5,));
    Image::from_channels((4, 2), channels).write().to_buffered(&mut bytes).unwrap();
    let map = folder.load("a.exr", &bytes.into_inner()).unwrap();
    assert_eq!(map.rgb[3], [3.5; 3]);
}

#[test]
fn rows_may_run_in_either_direction() {
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
    let texels: Vec<u8> = (1..=8).flat_map(|value| [value * 16, 0, 0, 128]).collect();
    let read = |axes: &str| {
        let bytes = [header.as_bytes(), axes.as_bytes(), &texels].concat();
        let map = EnvironmentMap::from_memory("sky.hdr", &bytes).unwrap();
        map.rgb.iter().map(|texel| (texel[0] * 16.0).round() as u32).collect::<Vec<_>>()
    };
    // sRGB's white in XYZ.
    let xyz = [0x79, 0x80, 0x8b, 0x80].repeat(2);
    let xyz =
        [b"#?RADIANCE\nra_xyze a.hdr\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 2\n", &xyz[..]].concat();
    close(EnvironmentMap::from_memory("sky.hdr", &xyz).unwrap().rgb[1], [0.5; 3], 0.02);
    for (axes, order) in [
        ("-Y 2 +X 4\n", [1, 2, 3, 4, 5, 6, 7, 8]),
        ("+Y 2 +X 4\n", [5, 6, 7, 8, 1, 2, 3, 4]),
        ("-Y 2 -X 4\n", [4, 3, 2, 1, 8, 7, 6, 5]),
        ("+Y 2 -X 4\n", [8, 7, 6, 5, 4, 3, 2, 1]),
        ("+X 4 -Y 2\n", [1, 3, 5, 7, 2, 4, 6, 8]),
        ("+X 4 +Y 2\n", [2, 4, 6, 8, 1, 3, 5, 7]),
        ("-X 4 -Y 2\n", [7, 5, 3, 1, 8, 6, 4, 2]),
    ] {
        let first = read(axes);
        let unit = read("-Y 2 +X 4\n")[0];
        assert_eq!(first, order.map(|value| value * unit), "{axes}");
    }
}

#[test]
fn bad_files_say_what_is_wrong() {
    use exr::prelude::*;
    let folder = Folder::new();
    let message = |name: &str, bytes: &[u8]| folder.load(name, bytes).unwrap_err().to_string();

    let missing = EnvironmentMap::load(folder.folder.path().join("none.hdr")).unwrap_err();
    assert!(matches!(missing, SceneError::Read { .. }), "{missing}");
    assert!(matches!(EnvironmentMap::load(folder.folder.path()), Err(SceneError::Read { .. })));

    let text = message("a.hdr", b"what is this");
    assert!(text.contains("a.hdr") && text.contains("give a Radiance (.hdr)"), "{text}");

    // A decompression bomb: few bytes, many texels.
    let bomb = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n\x01\x02\x03\x04";
    let text = message("a.hdr", bomb);
    assert!(text.contains("claims 16384 x 8192 texels in"), "{text}");
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4294967295 +X 4294967295\n";
    assert!(!message("a.hdr", huge).is_empty());
    let large = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 40000\n";
    let text = message("a.hdr", large);
    assert!(text.contains("40000 x 20000") && text.contains("scale it down"), "{text}");

    let mut bytes = Cursor::new(Vec::new());
    let channels = SpecificChannels::build().with_channel("Z").with_pixel_fn(|_| (1.0_f32,));
    Image::from_channels((4, 2), channels).write().to_buffered(&mut bytes).unwrap();
    let text = message("depth.exr", &bytes.into_inner());
    assert!(text.contains("but Z") && text.contains("plain RGB"), "{text}");
}

/// Cut and changed files of each kind: an error or a map, never a panic.
#[test]
fn broken_files_never_panic() {
    let folder = Folder::new();
    let hdr = hdr_bytes(&picture(16, 8));
    let exr = exr_bytes(16, 8, |at| texel(at.0 as u32, at.1 as u32).into());
    let mut random = 1_u32;
    for whole in [hdr, exr] {
        for _ in 0..300 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let at = (random >> 8) as usize % bytes.len();
                bytes[at] = (random >> 3) as u8;
            }
            if random.is_multiple_of(3) {
                bytes.truncate((random >> 5) as usize % whole.len());
            }
            if let Ok(map) = folder.load("a", &bytes) {
                assert!(map.rgb.iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
            }
        }
    }
    // Run lengths of zero: the decoder's factor grows with each.
    let mut runs = b"#?RADIANCE\n\n-Y 1 +X 16\n\x09\x09\x09\x09".to_vec();
    runs.extend([1, 1, 1, 0].repeat(12));
    folder.load("a.hdr", &runs).unwrap_err();
}

#[test]
fn radiance_headers_may_have_other_line_ends() {
    let whole = hdr_bytes(&picture(16, 8));
    let map = EnvironmentMap::from_memory("a.hdr", &whole).unwrap();
    let texels = whole.windows(2).position(|pair| pair == b"\n\n").unwrap() + 2;
    let texels = texels + whole[texels..].iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let head = String::from_utf8(whole[..texels].to_vec()).unwrap();
    for head in [head.replace('\n', "\r\n"), head.replacen("\n\n", "\r\n\r\n", 1)] {
        let bytes = [head.as_bytes(), &whole[texels..]].concat();
        assert_eq!(EnvironmentMap::from_memory("a.hdr", &bytes).unwrap().rgb, map.rgb);
    }
    let message =
        |bytes: &[u8]| EnvironmentMap::from_memory("a.hdr", bytes).unwrap_err().to_string();
    let bytes = [head.replacen("\n\n", "\n", 1).as_bytes(), &whole[texels..]].concat();
    let text = message(&bytes);
    assert!(text.contains("its header lacks the empty line before the size"), "{text}");
    let text = message(&whole[..texels - 3]);
    assert!(text.contains("it was cut off: it ends before the texels"), "{text}");
    for length in [texels, whole.len() - 1] {
        let text = message(&whole[..length]);
        assert!(text.contains("it was cut off: it ends before its last row"), "{text}");
        assert!(text.contains("export or download it again"), "{text}");
    }
}

#[test]
fn openexr_may_be_xyz() {
    use exr::prelude::*;
    let mut bytes = Cursor::new(Vec::new());
    let channels = SpecificChannels::build()
        .with_channel("X")
        .with_channel("Y")
        .with_channel("Z")
        .with_pixel_fn(|_| (0.9505_f32, 1.0_f32, 1.089_f32));
    Image::from_channels((4, 2), channels).write().to_buffered(&mut bytes).unwrap();
    let map = EnvironmentMap::from_memory("a.exr", &bytes.into_inner()).unwrap();
    close(map.rgb[0], [1.0; 3], 1e-3);
    assert!(map.warnings[0].contains("count as colours in CIE XYZ"), "{:?}", map.warnings);
}

#[test]
fn a_warning_names_the_openexr_layer_that_is_shown() {
    use exr::prelude::*;
    let mut bytes = Cursor::new(Vec::new());
    let channels = SpecificChannels::build()
        .with_channel("Glow.R")
        .with_channel("Glow.G")
        .with_channel("Glow.B")
        .with_channel("View.Combined.R")
        .with_channel("View.Combined.G")
        .with_channel("View.Combined.B")
        .with_pixel_fn(|_| (9.0_f32, 9.0_f32, 9.0_f32, 1.0_f32, 2.0_f32, 3.0_f32));
    Image::from_channels((4, 2), channels).write().to_buffered(&mut bytes).unwrap();
    let map = EnvironmentMap::from_memory("a.exr", &bytes.into_inner()).unwrap();
    assert_eq!(map.rgb[0], [1.0, 2.0, 3.0]);
    assert_eq!(
        map.warnings,
        ["the environment map has 2 layers with colours: \"View.Combined\" is shown, and not \
          \"Glow\"; save another one alone to see it"]
    );
    // Layers in separate parts of a file.
    let layer = |name: &str, red: f32| {
        let channels = SpecificChannels::rgb(move |_: Vec2<usize>| (red, 0.0_f32, 0.0_f32));
        Layer::new((4, 2), LayerAttributes::named(name), Encoding::FAST_LOSSLESS, channels)
    };
    let image = Image::empty(ImageAttributes::new(IntegerBounds::from_dimensions((4, 2))));
    let image = image.with_layer(layer("left", 5.0)).with_layer(layer("right", 6.0));
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    let map = EnvironmentMap::from_memory("a.exr", &bytes.into_inner()).unwrap();
    let words = "2 layers with colours: \"left\" is shown, and not \"right\"";
    assert!(map.warnings[0].contains(words) && map.rgb[0][0] == 5.0, "{:?}", map.warnings);
}
