//! Materials of OBJ files, valid and invalid.

use glam::{Vec2, Vec3, Vec4};
use lumivox_scene::{
    AlphaMode, LoadOptions, Material, MemoryBudget, MetallicRoughness, Phong, Scene, Shading, Wrap,
};
use proptest::prelude::*;

use crate::common::{encode, png, write};

/// A triangle with the material `m` of `house.mtl`, and files beside it.
fn with(mtl: &str, files: &[(&str, Vec<u8>)]) -> Scene {
    with_options(mtl, files, &mut LoadOptions::default())
}

fn with_options(mtl: &str, files: &[(&str, Vec<u8>)], options: &mut LoadOptions<'_>) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        write(folder.path(), name, bytes);
    }
    write(folder.path(), "house.mtl", format!("newmtl m\n{mtl}\n").as_bytes());
    let obj = "mtllib house.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\n\
               f 1/1 2/2 3/3\n";
    Scene::load_with(write(folder.path(), "house.obj", obj.as_bytes()), options).unwrap()
}

fn material(scene: &Scene) -> &Material {
    &scene.materials[scene.instances[0].material]
}

fn phong(scene: &Scene) -> Phong {
    let Shading::Phong(phong) = material(scene).shading else { panic!("{:?}", material(scene)) };
    phong
}

fn physical(scene: &Scene) -> MetallicRoughness {
    let Shading::MetallicRoughness(m) = material(scene).shading else {
        panic!("{:?}", material(scene))
    };
    m
}

fn warns(scene: &Scene, words: &str) -> bool {
    scene.notes.warnings.iter().any(|warning| warning.contains(words))
}

/// A PNG of one texel.
fn dot(color: [u8; 4]) -> Vec<u8> {
    png(1, 1, &color)
}

#[test]
fn plain_materials_become_phong() {
    let scene =
        with("Ka 1 1 1\nKd 0.6 0.5 0.4\nKs 0.2 0.2 0.2\nNs 96\nNi 1.45\nillum 2\nKe 3 2 1", &[]);
    assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
    let p = phong(&scene);
    assert_eq!(p.diffuse, Vec3::new(0.6, 0.5, 0.4));
    assert_eq!((p.specular, p.shininess, p.opacity), (Vec3::splat(0.2), 96.0, 1.0));
    assert_eq!(material(&scene).emissive, Vec3::new(3.0, 2.0, 1.0));
    assert_eq!(material(&scene).alpha, AlphaMode::Opaque);
    assert!(material(&scene).double_sided);
    assert_eq!(material(&scene).name, "m");
    // One number stands for all three channels.
    assert_eq!(phong(&with("Kd 0.3", &[])).diffuse, Vec3::splat(0.3));
}

#[test]
fn no_surface_reflects_more_than_it_receives() {
    let scene = with("Kd 0.8 0.5 1\nKs 0.5 0.5 0.5", &[]);
    assert!((phong(&scene).specular - Vec3::new(0.2, 0.5, 0.0)).length() < 1e-6);
    assert!(warns(&scene, "1 materials would reflect more"));
    // An image darkens the diffuse part, which leaves more for `Ks`.
    let scene =
        with("Kd 1 1 1\nKs 0.5 0.5 0.5\nmap_Kd a.png", &[("a.png", dot([0, 128, 255, 255]))]);
    let s = phong(&scene).specular;
    assert!((s - Vec3::new(0.5, 0.5, 0.0)).length() < 1e-6, "{s}");
    let scene = with("Kd 2 0 0\nKs 0.5 0.5 0.5\nillum 1", &[]);
    assert!(warns(&scene, "Kd of [2, 0, 0] was limited"), "{:?}", scene.notes.warnings);
    assert_eq!(phong(&scene).specular, Vec3::ZERO);
}

#[test]
fn opacity_is_read_from_d_tr_and_maps() {
    for (text, opacity) in [("d 0.25", 0.25), ("Tr 0.75", 0.25), ("d 0.5\nTr 0", 0.5)] {
        let scene = with(text, &[]);
        assert_eq!(phong(&scene).opacity, opacity);
        assert_eq!(material(&scene).alpha, AlphaMode::Blend);
    }
    assert_eq!(material(&with("d 1\nTr 0", &[])).alpha, AlphaMode::Opaque);
    assert!(warns(&with("Tr 1", &[]), "counts as opaque"));

    // A mask, of another size than the colour.
    let mask = png(2, 1, &[0, 0, 0, 255, 255, 255, 255, 255]);
    let files = [("c.png", dot([10, 20, 30, 7])), ("m.png", mask)];
    let scene = with("Kd 1 1 1\nmap_Kd c.png\nmap_d m.png", &files);
    assert_eq!(material(&scene).alpha, AlphaMode::Mask { cutoff: 0.5 });
    let texture = &scene.textures[phong(&scene).diffuse_texture.unwrap().texture];
    assert_eq!(texture.rgba8, [10, 20, 30, 0, 10, 20, 30, 255]);
    // A grey mask means blending; the image's alpha is used if it has any; all without an image of
    // the colour.
    let scene = with("map_d m.png", &[("m.png", dot([128, 128, 128, 255]))]);
    assert_eq!(material(&scene).alpha, AlphaMode::Blend);
    assert_eq!(scene.textures[0].rgba8, [255, 255, 255, 128]);
    let scene = with("map_d m.png", &[("m.png", dot([255, 255, 255, 100]))]);
    assert_eq!(scene.textures[0].rgba8, [255, 255, 255, 100]);
    let scene = with("map_d -imfchan r m.png", &[("m.png", dot([9, 255, 255, 100]))]);
    assert_eq!(scene.textures[0].rgba8[3], 9);
    // The alpha of `map_Kd` is ignored, with a warning.
    let scene = with("map_Kd c.png", &[("c.png", dot([10, 20, 30, 7]))]);
    assert_eq!(scene.textures[0].rgba8, [10, 20, 30, 255]);
    assert_eq!(material(&scene).alpha, AlphaMode::Opaque);
    assert!(warns(&scene, "name the image as map_d"));
}

#[test]
fn images_are_found_decoded_and_placed() {
    let texel = [200, 100, 50, 255];
    let image = image::RgbaImage::from_pixel(1, 1, image::Rgba(texel));
    let opaque = image::DynamicImage::from(image).into_rgb8();
    for (name, format) in [
        ("Wood Planks.PNG", image::ImageFormat::Png),
        ("Wood Planks.TGA", image::ImageFormat::Tga),
        ("Wood Planks.bmp", image::ImageFormat::Bmp),
    ] {
        let bytes = encode(&opaque.clone().into(), format);
        let asked = name.to_lowercase();
        let mtl = format!("Kd 0 0 0\nmap_Kd -s 2 3 -clamp on C:\\maps\\{asked}");
        let scene = with(&mtl, &[(name, bytes)]);
        assert_eq!(scene.textures[0].rgba8, texel, "{name}");
        assert_eq!(scene.textures[0].sampler.wrap_u, Wrap::ClampToEdge);
        let reference = phong(&scene).diffuse_texture.unwrap();
        let moved = reference.transform.transform_point2(Vec2::new(0.5, 1.0));
        assert!((moved - Vec2::new(1.0, 1.0)).length() < 1e-6, "{moved}");
        assert_eq!(phong(&scene).diffuse, Vec3::ONE);
        assert!(warns(&scene, "Kd 0 would make map_Kd black"));
    }
}

#[test]
fn missing_images_get_a_visible_stand_in() {
    for (name, files, words) in [
        ("gone.png", vec![], "does not exist"),
        ("../gone.png", vec![], "leaves the scene's folder"),
        ("bad.png", vec![("bad.png", b"no image".to_vec())], "cannot be decoded"),
    ] {
        let scene = with(&format!("map_Kd {name}"), &files);
        assert!(warns(&scene, words) && warns(&scene, "checker"), "{:?}", scene.notes.warnings);
        let texture = &scene.textures[phong(&scene).diffuse_texture.unwrap().texture];
        assert_eq!(texture.rgba8[..8], [255, 0, 255, 255, 0, 0, 0, 255]);
        // Images that are not colours are left out.
        let scene =
            with(&format!("map_d {name}\nnorm {name}\nPr 1\nmap_Pr {name}\nmap_Ke {name}"), &files);
        assert!(scene.textures.is_empty());
        assert_eq!(scene.notes.warnings.len(), 4, "{:?}", scene.notes.warnings);
    }
    // Missing libraries and materials.
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let path = write(folder.path(), "house.obj", obj.as_bytes());
    let scene = Scene::load(&path).unwrap();
    assert!(warns(&scene, "the material library \"gone.mtl\" does not exist"));
    assert!(warns(&scene, "the material \"m\" is in no material library"));
    assert_eq!(physical(&scene).base_color, Vec4::new(0.5, 0.5, 0.5, 1.0));
    assert!(material(&scene).double_sided);
    // A library with the scene's name replaces a missing one.
    write(folder.path(), "house.mtl", b"newmtl m\nKd 1 0 0\n");
    let scene = Scene::load(&path).unwrap();
    assert!(warns(&scene, "of the scene's own name"));
    assert_eq!(phong(&scene).diffuse, Vec3::X);
}

#[test]
fn several_libraries_and_names_with_spaces() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "a b.mtl", b"newmtl red brick\nKd 1 0 0\nmtllib a b.mtl\n");
    write(folder.path(), "c.mtl", b"newmtl red brick\nKd 0 0 0\nnewmtl \xfcber\nKd 0 1 0\n");
    write(folder.path(), "d.mtl", b"Kd 1 1 1\nnewmtl\nnewmtl blue\nKd 0 0 1\n");
    let mut obj = b"mtllib a b.mtl\nmtllib c.mtl d.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n".to_vec();
    for name in [&b"red brick"[..], b"\xfcber", b"blue"] {
        obj.extend([b"usemtl ", name, b"\nf 1 2 3\n"].concat());
    }
    let scene = Scene::load(write(folder.path(), "house.obj", &obj)).unwrap();
    let colors: Vec<_> = scene
        .instances
        .iter()
        .map(|i| match scene.materials[i.material].shading {
            Shading::Phong(p) => p.diffuse,
            _ => Vec3::NAN,
        })
        .collect();
    assert_eq!(colors, [Vec3::X, Vec3::Y, Vec3::Z]);
    assert!(warns(&scene, "a b.mtl, line 3: \"mtllib\" was ignored: it is unknown"));
    assert!(warns(&scene, "d.mtl, line 1: \"Kd\" was ignored: it comes before"));
}

/// The colours of an OBJ file with a triangle for each of `materials`.
fn colors(files: &[(&str, &str)], libraries: &str, materials: &[&str]) -> Vec<Vec3> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        write(folder.path(), name, text.as_bytes());
    }
    let faces: Vec<_> =
        materials.iter().map(|name| format!("g {name}\nusemtl {name}\nf 1 2 3")).collect();
    let obj = format!("{libraries}\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{}\n", faces.join("\n"));
    let scene = Scene::load(write(folder.path(), "house.obj", obj.as_bytes())).unwrap();
    let color = |i: &lumivox_scene::Instance| match scene.materials[i.material].shading {
        Shading::Phong(p) => p.diffuse,
        _ => Vec3::NAN,
    };
    scene.instances.iter().map(color).collect()
}

#[test]
fn existing_files_disambiguate_library_names() {
    let files = [
        ("box red.mtl", "newmtl red\nKd 1 0 0\n"),
        ("box green.mtl", "newmtl green\nKd 0 1 0\n"),
        ("blue.mtl", "newmtl blue\nKd 0 0 1\n"),
    ];
    let expected = [Vec3::X, Vec3::Y, Vec3::Z];
    for libraries in [
        "mtllib box red.mtl box green.mtl blue.mtl",
        "mtllib blue.mtl box red.mtl   box green.mtl # a comment",
        "mtllib gone away.mtl box green.mtl blue.mtl gone.mtl box red.mtl",
        "mtllib \"box red.mtl\" \"Box Green.mtl\" 'blue.mtl'",
    ] {
        assert_eq!(colors(&files, libraries, &["red", "green", "blue"]), expected, "{libraries}");
    }
    // Names of materials: an exact match is preferred.
    let files = [(
        "house.mtl",
        "newmtl red\nKd 1 0 0\nnewmtl Red\nKd 0 1 0\nnewmtl \"blue\" # sky\nKd 0 0 1\n",
    )];
    let names = ["red", "Red", "BLUE # of the sky", "\"red\"", "\"Red\" # two"];
    let found = colors(&files, "mtllib house.mtl", &names);
    assert_eq!(found, [Vec3::X, Vec3::Y, Vec3::Z, Vec3::X, Vec3::X]);
}

#[test]
fn image_options_may_precede_or_follow_the_name() {
    let files = [("a b.png", dot([9, 9, 9, 255]))];
    for line in [
        "map_Kd -s 2 2 1 a%20b.png",
        "map_Kd a b.png -s 2 2 1",
        "map_Kd -s 2 2 1 \"a b.png\" # wood",
        "map_Kd -rotate 90 -s 2 2 1 a b.png",
        "map_Kd \"a b.png\" -s 2 2 -flip",
    ] {
        let scene = with(line, &files);
        let texture = phong(&scene).diffuse_texture.unwrap();
        assert_eq!(scene.textures[0].rgba8, [9, 9, 9, 255], "{line}: {:?}", scene.notes.warnings);
        assert_eq!(
            texture.transform.matrix2,
            glam::Mat2::from_diagonal(Vec2::splat(2.0)),
            "{line}"
        );
        for option in ["-rotate", "-flip"] {
            assert_eq!(warns(&scene, option), line.contains(option), "{line}");
        }
    }
}

#[test]
fn physical_keys_make_metallic_roughness() {
    let files = [
        ("r.png", dot([60, 60, 60, 255])),
        ("m.png", png(2, 1, &[0, 0, 0, 255, 255, 255, 255, 255])),
    ];
    let scene = with(
        "Kd 0.9 0.8 0.1\nKs 1 1 1\nPr 0\nPm 1\nPs 0.5\nPc 0.3\nPcr 0.2\nNi 1.8\nd 0.5\nmap_Pr r.png\n\
         map_Pm m.png\naniso 0",
        &files,
    );
    assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
    let m = physical(&scene);
    assert_eq!(m.base_color, Vec4::new(0.9, 0.8, 0.1, 0.5));
    assert_eq!((m.roughness, m.metallic, m.ior), (1.0, 1.0, 1.8));
    let texture = &scene.textures[m.metallic_roughness_texture.unwrap().texture];
    assert_eq!(texture.rgba8, [255, 60, 0, 255, 255, 60, 255, 255]);
    let material = material(&scene);
    assert_eq!((material.clearcoat.strength, material.clearcoat.roughness), (0.3, 0.2));
    assert_eq!(material.sheen.color, Vec3::splat(0.5));
    assert_eq!(material.alpha, AlphaMode::Blend);
    assert_eq!(physical(&with("Pm 1\nNs 0", &[])).roughness, 1.0);
}

#[test]
fn bumps_are_normals_or_heights() {
    let normals = png(1, 1, &[128, 128, 255, 255]);
    let heights = png(4, 1, &[0, 0, 0, 255, 90, 90, 90, 255, 180, 180, 180, 255, 90, 90, 90, 255]);
    let files = [("n.png", normals), ("h.png", heights)];
    let scene = with("norm n.png\nbump h.png", &files);
    assert_eq!(scene.textures[0].rgba8, [128, 128, 255, 255]);
    let scene = with("map_Bump -bm 0.5 n.png", &files);
    assert_eq!(scene.textures[0].rgba8, [128, 128, 255, 255]);
    assert_eq!(material(&scene).normal_scale, 0.5);
    let scene = with("bump -bm 20 h.png", &files);
    assert!(warns(&scene, "heights became a normal map"));
    assert_eq!(material(&scene).normal_scale, 1.0);
    let texels: Vec<_> = scene.textures[0].rgba8.chunks(4).map(|t| t[0]).collect();
    // The second texel rises to the right, so its normal leans left; the lowest and highest texels
    // are flat.
    assert!(texels[1] < 100 && texels[3] > 155, "{texels:?}");
    assert!(texels[0].abs_diff(128) <= 1 && texels[2].abs_diff(128) <= 1, "{texels:?}");
    // Tangents follow the normal map.
    let tangent = scene.meshes[0].tangents[0];
    assert!((tangent.truncate() - Vec3::X).length() < 1e-6, "{tangent}");
}

#[test]
fn values_assumed_for_missing_keys_are_reported() {
    for (text, diffuse, words) in [
        ("Ka 0.8 0.1 0.2", Vec3::new(0.8, 0.1, 0.2), "Ka is its diffuse colour"),
        ("Ka 1 1 1", Vec3::splat(0.5), ""),
        ("Kd 1 1 1\nNi 1.5\nillum 7\nd 1", Vec3::ONE, "1 materials are glass by their illum"),
        ("Kd 1 1 1\nNi 1\nillum 4", Vec3::ONE, ""),
        ("Kd 1 1 1\nillum 9\nd 0.3", Vec3::ONE, ""),
    ] {
        let scene = with(text, &[]);
        assert_eq!(phong(&scene).diffuse, diffuse, "{text}");
        assert_eq!(scene.notes.warnings.is_empty(), words.is_empty(), "{text}");
        assert!(words.is_empty() || warns(&scene, words), "{:?}", scene.notes.warnings);
    }
}

#[test]
fn constant_colors_take_no_light() {
    let scene = with("Kd 0.1 0.2 0.3\nillum 0", &[]);
    let Shading::Unlit(unlit) = material(&scene).shading else { panic!() };
    assert_eq!(unlit.color, Vec4::new(0.1, 0.2, 0.3, 1.0));
    assert!(warns(&scene, "illum 0"));
}

#[test]
fn unsupported_statements_are_reported() {
    let scene = with(
        "refl -type sphere a.png\ndisp a.png\nmap_Ns a.png\nTf 0.5 0.5 0.5\naniso 0.3\nKd spectral a.rfl\n\
         Ks 1 x 1\nd -halo 0.5\nd nan\nwhat 3\nmap_Kd\nKe xyz 0.9505 1 1.089",
        &[],
    );
    assert_eq!(scene.notes.warnings.len(), 11, "{:#?}", scene.notes.warnings);
    assert!((material(&scene).emissive - Vec3::ONE).length() < 1e-3);
    assert_eq!(phong(&scene).opacity, 0.5);
}

#[test]
fn textures_keep_to_the_budget_and_are_loaded_once() {
    let files = [("a.png", png(32, 32, &[90; 32 * 32 * 4]))];
    let budget = MemoryBudget { texture_bytes: 1024, ..MemoryBudget::default() };
    let mut stages = Vec::new();
    let mut listen = |progress: lumivox_scene::LoadProgress| stages.push(progress.stage);
    let mut options = LoadOptions { budget, progress: Some(&mut listen), ..LoadOptions::default() };
    let scene = with_options("map_Kd a.png\nmap_Ke a.png", &files, &mut options);
    assert_eq!(scene.textures.len(), 1);
    assert_eq!((scene.textures[0].width, scene.textures[0].rgba8.len()), (16, 1024));
    assert!(warns(&scene, "shrunk to 1/2 "));
    assert_eq!(material(&scene).emissive, Vec3::ONE);
    assert!(stages.contains(&"textures"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn arbitrary_statements_never_panic(
        lines in proptest::collection::vec(
            "(K[dse]|N[si]|d|Tr|illum|P[rmsc]|Pcr|map_(K[dse]|d|P[rms])|bump|norm|newmtl) \
             (-(s|o|bm|mm|clamp|imfchan|t) )?([-0-9. ]{0,9}|nan|a.png|b.png|on)", 0..30),
        image in proptest::collection::vec(any::<u8>(), 16),
    ) {
        with(&lines.join("\n"), &[("a.png", png(2, 2, &image)), ("b.png", png(1, 4, &image))]);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        with(&text, &[("a.png", bytes)]);
    }
}

#[test]
fn partly_supported_statements_are_reported_as_such() {
    let files = [("a.png", png(1, 1, &[9, 9, 9, 255]))];
    let scene = with("map_Kd -texres 512 a.png\nd -halo 0.5", &files);
    assert_eq!(
        scene.notes.warnings,
        [
            "house.mtl, line 2: \"map_Kd\" is used without its options -texres, which are not supported",
            "house.mtl, line 3: \"d\" is the same for all angles: -halo is not supported",
        ]
    );
    assert_eq!(scene.textures[0].rgba8, [9, 9, 9, 255]);
}

#[test]
fn duplicate_material_names_are_reported() {
    let scene = with("Kd 1 0 0\nnewmtl m\nKd 0 1 0", &[]);
    assert!(warns(
        &scene,
        "house.mtl: the material \"m\" is defined more than once; the first counts"
    ));
    assert_eq!(phong(&scene).diffuse, Vec3::X);
}

#[test]
fn a_bad_material_library_does_not_prevent_loading() {
    let folder = tempfile::tempdir().unwrap();
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let path = write(folder.path(), "house.obj", obj.as_bytes());
    for (text, words) in [
        (
            "",
            "the material library \"a.mtl\" has no materials (no line begins with newmtl); export it",
        ),
        ("# nothing\n", "the material library \"a.mtl\" has no materials"),
        ("<!DOCTYPE html>\n<p>404", "the material library \"a.mtl\" was ignored: it is a web page"),
    ] {
        write(folder.path(), "a.mtl", text.as_bytes());
        let scene = Scene::load(&path).unwrap();
        assert!(warns(&scene, words), "{:?}", scene.notes.warnings);
    }
}
