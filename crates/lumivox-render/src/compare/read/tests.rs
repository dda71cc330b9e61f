use std::fs;

use ::exr::meta::attribute::IntegerBounds;
use ::exr::meta::header::ImageAttributes;
use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    WritableImage as _,
};
use glam::Vec3;
use image::{ExtendedColorType, ImageEncoder as _};

use super::*;

fn read(bytes: &[u8], layer: Option<&str>) -> Result<PictureFile, CompareError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("picture");
    fs::write(&path, bytes).expect("writable");
    PictureFile::read(&path, layer)
}

type Part = Layer<AnyChannels<FlatSamples>>;

/// A part of 2 x 1 pixels. For each prefix, channel R has the given value, G 10 more, B 20 more;
/// the second pixel has 0.5 more.
fn part(name: Option<&str>, prefixes: &[(&str, f32)]) -> Part {
    let attributes = name.map_or_else(LayerAttributes::default, LayerAttributes::named);
    let channels = prefixes.iter().flat_map(|&(prefix, value)| {
        [("R", value), ("G", value + 10.0), ("B", value + 20.0)].map(|(channel, value)| {
            let samples = FlatSamples::F32(vec![value, value + 0.5]);
            AnyChannel::new(format!("{prefix}{channel}").as_str(), samples)
        })
    });
    let channels = AnyChannels::sort(channels.collect());
    Layer::new((2, 1), attributes, Encoding::UNCOMPRESSED, channels)
}

fn exr(parts: Vec<Part>, window: (i32, usize)) -> Vec<u8> {
    let window = IntegerBounds::new((window.0, 0), (window.1, 1));
    let mut bytes = Cursor::new(Vec::new());
    let image = Image::from_layers(ImageAttributes::new(window), parts);
    image.write().to_buffered(&mut bytes).expect("written");
    bytes.into_inner()
}

/// The first red value identifies the layer.
fn red(file: &PictureFile) -> f32 {
    file.picture.rgb[0][0]
}

#[test]
fn a_plain_exr_keeps_its_bits() {
    let bytes = exr(vec![part(None, &[("", 1.25)])], (0, 2));
    let file = read(&bytes, None).expect("a picture");
    assert_eq!(file.layer, None);
    assert_eq!(file.picture.size, UVec2::new(2, 1));
    assert_eq!(file.picture.rgb, [[1.25, 11.25, 21.25], [1.75, 11.75, 21.75]]);
    // The file has no named layers, so the requested name is ignored.
    assert_eq!(read(&bytes, Some("full")).expect("a picture"), file);
}

#[test]
fn layers_are_found_by_the_names_of_channels_and_parts() {
    let channels = exr(vec![part(None, &[("a.", 1.0), ("", 2.0), ("b.c.", 3.0)])], (0, 2));
    let parts = vec![part(Some("a"), &[("", 1.0)]), part(Some("b"), &[("b.c.", 3.0), ("d.", 4.0)])];
    let parts = exr(parts, (0, 2));
    for (bytes, layer, name, value) in [
        (&channels, None, None, 2.0),
        (&channels, Some("a"), Some("a"), 1.0),
        (&channels, Some("b.c"), Some("b.c"), 3.0),
        (&parts, None, Some("a"), 1.0),
        (&parts, Some("b.c"), Some("b.c"), 3.0),
        (&parts, Some("b.d"), Some("b.d"), 4.0),
    ] {
        let file = read(bytes, layer).expect("a picture");
        assert_eq!((file.layer.as_deref(), red(&file)), (name, value), "{layer:?}");
    }
    let message = read(&channels, Some("full")).expect_err("no such layer").to_string();
    assert!(message.contains("no layer \"full\""), "{message}");
    assert!(message.contains("one without a name, a, b.c"), "{message}");
}

#[test]
fn exr_units_apply_and_cropped_windows_are_refused() {
    let mut bright = part(None, &[("", 1.0)]);
    bright.attributes.white_luminance = Some(100.0);
    let file = read(&exr(vec![bright], (0, 2)), None).expect("a picture");
    assert_eq!(file.picture.rgb[0], [100.0, 1100.0, 2100.0]);
    for window in [(0, 3), (-1, 2)] {
        let cropped = exr(vec![part(None, &[("", 1.0)])], window);
        let message = read(&cropped, None).expect_err("a part of a picture").to_string();
        assert!(message.contains("save it uncropped"), "{message}");
    }
}

#[test]
fn pictures_for_screens_become_linear() {
    let mut bytes = Vec::new();
    let codes = [0, 128, 255, 255, 10, 55];
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(&codes, 2, 1, ExtendedColorType::Rgb8)
        .expect("written");
    let picture = read(&bytes, None).expect("a picture").picture;
    assert_eq!((picture.rgb[0][0], picture.rgb[0][2]), (0.0, 1.0));
    // Code 128 is a fifth of the light.
    assert!((picture.rgb[0][1] - 0.2159).abs() < 1e-4, "{picture:?}");
    let shown = |rgb: [f32; 3]| crate::ToneMap::Linear.encode(Vec3::from_array(rgb)) * 255.0;
    let again = picture.rgb.iter().flat_map(|&rgb| shown(rgb).to_array());
    assert!(again.zip(codes).all(|(code, expected)| (code - f32::from(expected)).abs() < 0.01));
}

#[test]
fn radiance_pictures_lose_their_exposure() {
    // One pixel of (1, 0.5, 0.25): mantissas of 128, 64 and 32 / 256, exponent 1.
    let file = |lines: &str| {
        let head = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{lines}\n-Y 1 +X 1\n");
        [head.as_bytes(), &[128, 64, 32, 129]].concat()
    };
    let pixel = |lines| read(&file(lines), None).expect("a picture").picture.rgb[0];
    assert_eq!(pixel(""), [1.0, 0.5, 0.25]);
    assert_eq!(pixel("EXPOSURE=4\n"), [0.25, 0.125, 0.0625]);
    let message = read(&file("EXPOSURE=0\n"), None).expect_err("no exposure").to_string();
    assert!(message.contains("EXPOSURE"), "{message}");
}

#[test]
fn files_that_are_not_pictures_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = PictureFile::read(&folder.path().join("missing.exr"), None);
    let message = missing.expect_err("no file").to_string();
    assert!(message.contains("missing.exr") && message.contains("check the path"), "{message}");
    let whole = exr(vec![part(None, &[("", 1.0)])], (0, 2));
    for (bytes, needle) in [
        (&b""[..], ".exr"),
        (b"no picture", ".exr"),
        (&whole[..whole.len() - 4], "save or download it again"),
        (&whole[..20], "save or download it again"),
        (b"\x89PNG\r\n\x1a\n", "save or download it again"),
        (b"#?RADIANCE\n\n-Y 100000 +X 100000\n", "more than 16384 x 8192"),
    ] {
        let message = read(bytes, None).expect_err("no picture").to_string();
        assert!(message.contains(needle), "{message}");
    }
}
