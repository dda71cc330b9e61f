//! `lumivox bake`: its file, its figures, and mistakes.

use std::fs;
use std::path::Path;

use crate::common::{INPUT, OUTPUT, USAGE, expect_error, folder, lumivox, names};

/// The size in texels of a volume's file, and the red channel of its texels.
fn texels(file: &Path) -> ([u32; 3], Vec<f32>) {
    let file = ktx2::Reader::new(fs::read(file).unwrap()).unwrap();
    let header = file.header();
    let size = [header.pixel_width, header.pixel_height, header.pixel_depth];
    let level = file.levels().next().unwrap();
    let red = |texel: &[u8]| half::f16::from_le_bytes([texel[0], texel[1]]).to_f32();
    (size, level.data.chunks(8).map(red).collect())
}

#[test]
#[ignore = "slow: over three seconds"]
fn probes_in_a_furnace_see_its_light_from_all_sides() {
    let folder = folder();
    let path = folder.path();
    for (method, tolerance) in
        [("cones --resolution 64 --frames 64", 0.1), ("paths --samples 256", 0.08)]
    {
        let line = format!(
            "bake builtin:furnace -o light.ktx2 --box -0.4,-0.4,-0.4,0.4,0.2,0.4 --spacing 0.2 --method {method}"
        );
        let text = lumivox(path, &line).expect_ok().stdout;
        assert!(text.contains("4 x 3 x 4 probes, 0 of them in solid things"), "{text}");
        assert!(
            text.contains("Transform::from_xyz(0.0, -0.1, 0.0).with_scale(vec3(0.8, 0.6, 0.8))"),
            "{text}"
        );
        let (size, light) = texels(&path.join("light.ktx2"));
        assert_eq!((size, light.len()), ([4, 6, 12], 288));
        // The furnace emits 1 cd/m2 and reflects half of the incident light: radiance is 2
        // everywhere.
        for (texel, light) in light.into_iter().enumerate() {
            assert!((light / 2.0 - 1.0).abs() < tolerance, "{method}: {light} at {texel}");
        }
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn probe_sides_facing_a_red_wall_are_red() {
    let folder = folder();
    let path = folder.path();
    let line = "bake builtin:cornell -o box.ktx2 --spacing 0.5 --json";
    let report = lumivox(path, &format!("{line} --resolution 32 --frames 8")).expect_ok().json();
    assert_eq!(report["cells"], serde_json::json!([4, 4, 4]));
    assert_eq!((&report["probes"], &report["intensity"]), (&64.into(), &1.0.into()));
    let file = ktx2::Reader::new(fs::read(path.join("box.ktx2")).unwrap()).unwrap();
    let level = file.levels().next().unwrap();
    // The red wall is at the lowest x, the green one at the highest. Sum the light along x at the
    // probes in the middle of the box.
    let color = |is_against: bool| {
        let mut sum = [0.0; 3];
        for (z, y, x) in
            (0..4).flat_map(|z| (1..3).flat_map(move |y| (1..3).map(move |x| (z, y, x))))
        {
            let at = 8 * ((z * 8 + y + if is_against { 4 } else { 0 }) * 4 + x);
            for (channel, sum) in sum.iter_mut().enumerate() {
                let bytes = &level.data[at + 2 * channel..at + 2 * channel + 2];
                *sum += half::f16::from_le_bytes([bytes[0], bytes[1]]).to_f32();
            }
        }
        sum[0] / sum[1]
    };
    let (towards_green, towards_red) = (color(false), color(true));
    assert!(towards_red > 2.0 * towards_green, "{towards_red}, {towards_green}");
}

/// A floor of two metres with a second UV set, as glTF: `left` of the map's width is free.
fn floor(left: f32) -> String {
    let corners = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    let uvs = [[left, 1.0], [1.0, 1.0], [1.0, 0.0], [left, 0.0]];
    let mut bytes: Vec<u8> =
        corners.iter().flatten().flat_map(|number: &f32| number.to_le_bytes()).collect();
    bytes.extend([0.0_f32, 1.0, 0.0].repeat(4).iter().flat_map(|number| number.to_le_bytes()));
    bytes.extend(uvs.iter().flatten().flat_map(|number| number.to_le_bytes()));
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    let numbers: Vec<String> = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    let vectors = |view: u32, kind: &str, count: u32| {
        serde_json::json!({
            "bufferView": view, "componentType": if view == 3 { 5123 } else { 5126 }, "type": kind,
            "count": count, "min": [-1, 0, -1], "max": [1, 0, 1],
        })
    };
    let view = |at: u32, length: u32| serde_json::json!({ "buffer": 0, "byteOffset": at, "byteLength": length });
    let mut indices = vectors(3, "SCALAR", 6);
    let mut uvs = vectors(2, "VEC2", 4);
    for accessor in [&mut indices, &mut uvs] {
        accessor.as_object_mut().unwrap().retain(|key, _| key != "min" && key != "max");
    }
    serde_json::json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "ground", "mesh": 0 }],
        "meshes": [{ "name": "floor", "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_1": 2 }, "indices": 3,
        }] }],
        "accessors": [vectors(0, "VEC3", 4), vectors(1, "VEC3", 4), uvs, indices],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 32), view(128, 12)],
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream,{}", numbers.concat()),
        }],
    })
    .to_string()
}

/// Under a uniform sky of 3 cd/m2, irradiance divided by pi is 3 cd/m2 on an open floor.
#[test]
fn a_lightmap_of_a_floor_under_a_uniform_sky_has_its_light() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("floor.gltf"), floor(0.5)).unwrap();
    let line =
        "bake floor.gltf --lightmap --environment 3,3,3 --size 16 --method paths --samples 64";
    let report = lumivox(path, &format!("{line} -o light.ktx2 --json")).expect_ok().json();
    assert_eq!(report["nodes"][0]["name"], "ground");
    assert_eq!(report["nodes"][0]["rect"], serde_json::json!([0.0, 0.0, 1.0, 1.0]));
    // The right half, and a column beside it.
    assert_eq!((&report["covered"], &report["buried"]), (&(9 * 16).into(), &0.into()));
    let (size, light) = texels(&path.join("light.ktx2"));
    assert_eq!(size, [16, 16, 0]);
    assert!(light.iter().all(|light| (light / 3.0 - 1.0).abs() < 0.01), "{light:?}");
    let text = lumivox(path, &format!("{line} -o light.exr")).expect_ok().stdout;
    assert!(text.contains("16 x 16 texels, 144 of them on surfaces"), "{text}");
    assert!(text.contains("lightMap.channel = 1;"), "{text}");
}

#[test]
fn scenes_without_a_second_uv_set_have_no_lightmap() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("floor.gltf"), floor(-2.0)).unwrap();
    for (line, needles) in [
        (
            "bake builtin:cornell --lightmap -o light.exr",
            ["builtin:cornell: mesh \"floor", "(TEXCOORD_1); unwrap it: in Blender"],
        ),
        (
            "bake floor.gltf --lightmap -o light.exr",
            ["floor.gltf: mesh \"floor\"", "reach from [-2.0, 0.0] to [1.0, 1.0]"],
        ),
        ("bake floor.gltf --lightmap -o light.png", ["light.png", ".exr or .ktx2"]),
        ("bake floor.gltf --lightmap -o light.exr --size 9999", ["--size", "16 to 4096"]),
    ] {
        expect_error(path, line, INPUT, &needles);
    }
    for line in ["--lightmap --spacing 1", "--direct", "--lightmap --size 64 --density 8"] {
        let line = format!("bake builtin:cornell -o light.ktx2 {line}");
        expect_error(path, &line, USAGE, &[]);
    }
}

#[test]
fn bad_bake_options_are_refused() {
    let folder = folder();
    let path = folder.path();
    let long = "--box 0,0,0,1,1,400 --spacing 0.5";
    for (line, exit, needle) in [
        ("-o light.png", INPUT, "light.png: unknown kind of file; end the name in .ktx2"),
        (
            "-o light.ktx2 --spacing 0.001",
            INPUT,
            "at most 262144 are baked; use a greater one, or a smaller --box",
        ),
        (&format!("-o light.ktx2 {long}"), INPUT, "GPUs take 2048 along an edge"),
        ("-o light.ktx2 --box 0,0,0,1,0,1", INPUT, "two corners that differ in all three numbers"),
        ("-o nowhere/light.ktx2", OUTPUT, "nowhere"),
        ("", USAGE, "--output"),
    ] {
        expect_error(path, &format!("bake builtin:cornell {line}"), exit, &[needle]);
    }
    assert!(names(path).is_empty());
}
