//! Textures of glTF files: the sources of images, their placement, and their results.

use glam::Vec2;
use lumivox_scene::{Filter, LoadOptions, LoadProgress, MemoryBudget, Scene, Wrap};
use serde_json::{Value, json};

use crate::common::{File, data_uri, encode, png, shading, textured_cube, write};

#[test]
fn images_and_buffers_in_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("my images")).unwrap();
    let mut file = textured_cube();
    let wide = image::DynamicImage::from(image::ImageBuffer::<image::Rgb<u16>, _>::from_pixel(
        3,
        1,
        image::Rgb([65_535, 32_896, 0]),
    ));
    write(folder.path(), "my images/deep.png", &encode(&wide, image::ImageFormat::Png));
    write(folder.path(), "cube.bin", &file.binary);
    file.json["images"] = json!([{ "uri": "my%20images/deep.png" }]);
    let scene = Scene::load(write(folder.path(), "cube.gltf", &file.naming("cube.bin"))).unwrap();
    // 16 bits per channel become 8, and alpha is opaque.
    assert_eq!(scene.textures[0].rgba8[..4], [255, 128, 0, 255]);
    assert_eq!((scene.textures[0].width, scene.textures[0].height), (3, 1));

    let gray = image::DynamicImage::from(image::GrayImage::from_pixel(8, 8, image::Luma([100])));
    let jpeg = encode(&gray, image::ImageFormat::Jpeg);
    // The declared type is wrong on purpose: the first bytes decide.
    file.json["images"] = json!([{ "uri": data_uri("image/png", &jpeg) }]);
    let scene = file.load().unwrap();
    assert!(scene.textures[0].rgba8[0].abs_diff(100) <= 2);
}

/// The triangle with images of these bytes, and a material with this texture.
fn with_texture(images: &[&[u8]], texture: Value, info: Value) -> File {
    let mut file = File::triangle();
    for image in images {
        let view = file.view(image);
        file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    }
    file.push("textures", texture);
    file.push(
        "materials",
        json!({
            "name": "paper", "pbrMetallicRoughness": { "baseColorTexture": info },
        }),
    );
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file
}

fn webp(texel: [u8; 4]) -> Vec<u8> {
    let image = image::RgbaImage::from_pixel(2, 2, image::Rgba(texel));
    encode(&image.into(), image::ImageFormat::WebP)
}

#[test]
fn webp_is_preferred_over_the_core_image() {
    let images = [&png(1, 1, &[1, 2, 3, 255])[..], &webp([40, 50, 60, 255])];
    let texture = json!({ "source": 0, "extensions": { "EXT_texture_webp": { "source": 1 } } });
    let mut file = with_texture(&images, texture, json!({ "index": 0 }));
    file.json["extensionsUsed"] = json!(["EXT_texture_webp"]);
    file.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    let scene = file.load().unwrap();
    assert_eq!(scene.textures.len(), 1);
    assert_eq!(scene.textures[0].rgba8[..4], [40, 50, 60, 255]);
    assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
    // If the extension's image is broken or missing, the core format's is used.
    for broken in [json!({ "uri": "gone.webp" }), json!({ "uri": "data:;base64,AAAA" })] {
        let mut file = file.clone();
        file.json["images"][1] = broken;
        let scene = file.load().unwrap();
        assert_eq!(scene.textures[0].rgba8[..4], [1, 2, 3, 255]);
        assert!(scene.notes.warnings[0].contains("fallback"), "{:?}", scene.notes.warnings);
    }
    file.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = json!(9);
    let scene = file.load().unwrap();
    assert_eq!(scene.textures[0].rgba8[..4], [1, 2, 3, 255]);
    assert!(scene.notes.warnings[0].contains("texture 0: its EXT_texture_webp"));
}

#[test]
fn a_missing_image_gets_a_visible_stand_in() {
    let mut file = with_texture(&[], json!({ "source": 0 }), json!({ "index": 0 }));
    file.push("images", json!({ "uri": "gone.png" }));
    file.json["materials"][0]["normalTexture"] = json!({ "index": 0 });
    file.json["materials"][0]["emissiveTexture"] = json!({ "index": 0 });
    file.json["materials"][0]["emissiveFactor"] = json!([9, 9, 9]);
    let scene = file.load().unwrap();
    let material = &scene.materials[0];
    assert!(material.normal_texture.is_none() && material.emissive_texture.is_none());
    // Without its texture the whole surface would emit.
    assert_eq!(material.emissive, glam::Vec3::ZERO);
    let board = &scene.textures[shading(&scene, 0).base_color_texture.unwrap().texture];
    assert_eq!((board.width, board.height), (8, 8));
    assert_eq!(board.rgba8[..8], [255, 0, 255, 255, 0, 0, 0, 255]);
    // One warning, although three textures use the image.
    assert_eq!(scene.notes.warnings.len(), 1, "{:?}", scene.notes.warnings);
    let warning = &scene.notes.warnings[0];
    assert!(warning.contains("gone.png") && warning.contains("stand-in"), "{warning}");

    // A texture without an image gives a warning, too.
    let file = with_texture(&[], json!({}), json!({ "index": 0 }));
    let scene = file.load().unwrap();
    assert!(scene.notes.warnings[0].contains("names no image"));
}

#[test]
fn texture_transforms_and_uv_sets_are_read() {
    let info = json!({ "index": 0, "texCoord": 0, "extensions": { "KHR_texture_transform": {
        "offset": [0.5, 0.25], "rotation": std::f32::consts::FRAC_PI_2, "scale": [2, 4],
        "texCoord": 1,
    } } });
    let mut file = with_texture(&[&png(1, 1, &[9; 4])], json!({ "source": 0 }), info);
    file.json["extensionsRequired"] = json!(["KHR_texture_transform"]);
    let uvs = file.vectors(&[[0.0_f32, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(uvs);
    let scene = file.load().unwrap();
    let reference = shading(&scene, 0).base_color_texture.unwrap();
    assert_eq!(reference.uv_set, 1);
    for (uv, expected) in [
        (Vec2::ZERO, Vec2::new(0.5, 0.25)),
        (Vec2::X, Vec2::new(0.5, -1.75)),
        (Vec2::Y, Vec2::new(4.5, 0.25)),
    ] {
        let moved = reference.transform.transform_point2(uv);
        assert!((moved - expected).length() < 1e-6, "{uv} to {moved}");
    }
    assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
}

#[test]
fn one_image_under_two_samplers_is_two_textures() {
    let mut file =
        with_texture(&[&png(1, 1, &[1, 2, 3, 255])], json!({ "source": 0 }), json!({ "index": 0 }));
    for filter in [9728, 9984, 9985, 9986, 9987] {
        let sampler = file.push("samplers", json!({ "minFilter": filter, "wrapS": 33071 }));
        let texture = file.push("textures", json!({ "source": 0, "sampler": sampler }));
        let pbr = json!({ "baseColorTexture": { "index": texture } });
        let material = file.push("materials", json!({ "pbrMetallicRoughness": pbr }));
        let primitives = file.json["meshes"][0]["primitives"].as_array_mut().unwrap();
        primitives.push(json!({ "attributes": { "POSITION": 0 }, "material": material }));
    }
    let scene = file.load().unwrap();
    let samplers: Vec<_> =
        scene.textures.iter().map(|t| (t.sampler.wrap_u, t.sampler.minify)).collect();
    assert_eq!(
        samplers,
        [
            (Wrap::Repeat, Filter::Linear),
            (Wrap::ClampToEdge, Filter::Nearest),
            (Wrap::ClampToEdge, Filter::Linear)
        ]
    );
    assert!(scene.textures.iter().all(|texture| texture.rgba8 == [1, 2, 3, 255]));
}

/// A file with textures of these sizes, as the base colour of a material each.
fn gallery(sizes: &[(u32, u32)]) -> File {
    let mut file = File::triangle();
    for (i, &(width, height)) in sizes.iter().enumerate() {
        // Black and white columns, whose mean is always half the light.
        let texels: Vec<u8> = (0..width * height)
            .flat_map(|t| [[0, 0, 0, 255], [255; 4]][(t % 2) as usize])
            .collect();
        let view = file.view(&png(width, height, &texels));
        let image = file.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
        let texture = file.push("textures", json!({ "source": image }));
        let pbr = json!({ "baseColorTexture": { "index": texture } });
        let material = file.push("materials", json!({ "pbrMetallicRoughness": pbr }));
        let primitives = file.json["meshes"][0]["primitives"].as_array_mut().unwrap();
        if i == 0 {
            primitives[0]["material"] = json!(material);
        } else {
            primitives.push(json!({ "attributes": { "POSITION": 0 }, "material": material }));
        }
    }
    file
}

#[test]
fn textures_shrink_into_their_budget() {
    let sizes = [(64, 64), (16, 8), (32, 32), (4, 1)];
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "gallery.glb", &gallery(&sizes).glb());
    let load = |texture_bytes: u64| {
        let budget = MemoryBudget { texture_bytes, ..MemoryBudget::default() };
        let scene =
            Scene::load_with(&path, &mut LoadOptions { budget, ..LoadOptions::default() }).unwrap();
        let sizes: Vec<_> = scene.textures.iter().map(|t| (t.width, t.height)).collect();
        (scene, sizes)
    };
    let all: u64 = sizes.iter().map(|&(w, h)| u64::from(w * h * 4)).sum();
    let (scene, same) = load(all);
    assert_eq!(same, sizes);
    assert!(scene.notes.warnings.is_empty());

    // One byte less: only the largest texture is halved.
    let (scene, fewer) = load(all - 1);
    assert_eq!(fewer, [(32, 32), (16, 8), (32, 32), (4, 1)]);
    assert_eq!(scene.notes.warnings.len(), 1);
    let warning = &scene.notes.warnings[0];
    for word in ["20.5 KiB", "1 of 4", "8.5 KiB", "budget"] {
        assert!(warning.contains(word), "{word} in {warning}");
    }
    assert_eq!(scene.textures[0].rgba8[..8], [188, 188, 188, 255, 188, 188, 188, 255]);

    // Textures are halved until all fit, the largest first.
    let (_, small) = load(1500);
    assert_eq!(small, [(8, 8), (16, 8), (8, 8), (4, 1)]);
    let (scene, single) = load(0);
    assert_eq!(single, [(1, 1); 4]);
    assert_eq!(scene.notes.warnings.len(), 1);
}

#[test]
fn texture_loading_reports_progress() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "gallery.glb", &gallery(&[(2, 2); 40]).glb());
    let mut steps = Vec::new();
    let mut listen = |progress: LoadProgress| {
        if progress.stage == "textures" {
            steps.push((progress.done, progress.total));
        }
    };
    let mut options = LoadOptions { progress: Some(&mut listen), ..LoadOptions::default() };
    Scene::load_with(&path, &mut options).unwrap();
    assert_eq!(steps.first(), Some(&(0, 40)));
    assert_eq!(steps.last(), Some(&(40, 40)));
    assert!(steps.is_sorted());
}

#[test]
fn an_image_with_an_excessive_size_is_refused() {
    // 48 bytes that claim 16384 x 16384 texels, uncompressed.
    let mut ktx = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    for word in [37_u32, 1, 16_384, 16_384, 0, 0, 1, 1, 0] {
        ktx.extend(word.to_le_bytes());
    }
    ktx.resize(200, 0);
    let file = with_texture(&[&ktx], json!({ "source": 0 }), json!({ "index": 0 }));
    let said = file.load().unwrap().notes.warnings.join("\n");
    assert!(said.contains("cannot hold") && said.contains("a stand-in is shown"), "{said}");
}
