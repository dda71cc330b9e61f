//! Materials of glTF files, and their extensions.

use glam::{Vec3, Vec4};
use lumivox_scene::{AlphaMode, Material, Scene, Shading, Texture};
use serde_json::{Value, json};

use crate::common::{File, png, shading};

/// A file with one material, and textures of one texel each.
fn painted(material: Value, texels: &[[u8; 4]]) -> File {
    let mut file = File::triangle();
    for texel in texels {
        let image = file.view(&png(1, 1, texel));
        let image = file.push("images", json!({ "bufferView": image, "mimeType": "image/png" }));
        file.push("textures", json!({ "source": image }));
    }
    file.push("materials", material);
    file.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    file
}

/// Loads a [`painted`] triangle without a warning.
fn paint(material: Value, texels: &[[u8; 4]]) -> Scene {
    let scene = painted(material, texels).load().unwrap();
    assert!(scene.notes.warnings.is_empty(), "{:?}", scene.notes.warnings);
    scene
}

fn material(scene: &Scene) -> &Material {
    &scene.materials[0]
}

fn texel(scene: &Scene, texture: Option<lumivox_scene::TextureRef>) -> [u8; 4] {
    let Texture { width, height, rgba8, .. } = &scene.textures[texture.unwrap().texture];
    assert_eq!((*width, *height), (1, 1));
    rgba8[..].try_into().unwrap()
}

#[test]
fn emission_and_extension_factors_are_read() {
    let scene = paint(
        json!({
            "emissiveFactor": [1, 0.5, 0],
            "alphaMode": "BLEND",
            "extensions": {
                "KHR_materials_emissive_strength": { "emissiveStrength": 40 },
                "KHR_materials_specular": {
                    "specularFactor": 0.25, "specularColorFactor": [2, 0.5, 0],
                },
                "KHR_materials_ior": { "ior": 1.33 },
            },
        }),
        &[],
    );
    assert_eq!(material(&scene).emissive, Vec3::new(40.0, 20.0, 0.0));
    assert_eq!(material(&scene).alpha, AlphaMode::Blend);
    let pbr = shading(&scene, 0);
    assert!((pbr.specular, pbr.ior) == (0.25, 1.33));
    assert_eq!(pbr.specular_color, Vec3::new(2.0, 0.5, 0.0));

    let scene = painted(json!({ "extensions": { "KHR_materials_ior": { "ior": 0.5 } } }), &[]);
    let scene = scene.load().unwrap();
    assert_eq!(shading(&scene, 0).ior, 1.0);
    assert!(scene.notes.warnings[0].contains("index of refraction"));
    let scene = paint(json!({ "extensions": { "KHR_materials_ior": { "ior": 0 } } }), &[]);
    assert_eq!(shading(&scene, 0).ior, 0.0);
}

#[test]
fn two_specular_textures_become_one() {
    let specular = |extension: Value| {
        let texels = [[10, 20, 30, 40], [50, 60, 70, 80]];
        let scene =
            paint(json!({ "extensions": { "KHR_materials_specular": extension } }), &texels);
        texel(&scene, shading(&scene, 0).specular_texture)
    };
    let (color, strength) = (json!({ "index": 0 }), json!({ "index": 1 }));
    let both = json!({ "specularColorTexture": color, "specularTexture": strength });
    assert_eq!(specular(both), [10, 20, 30, 80]);
    // The channels of the other texture are 1.
    assert_eq!(specular(json!({ "specularColorTexture": color })), [10, 20, 30, 255]);
    assert_eq!(specular(json!({ "specularTexture": strength })), [255, 255, 255, 80]);
    // One image for both is used unchanged.
    let same = json!({ "specularColorTexture": color, "specularTexture": color });
    assert_eq!(specular(same), [10, 20, 30, 40]);
}

#[test]
fn clearcoat_factors_and_textures_are_read() {
    let texels = [[10, 20, 30, 40], [50, 60, 70, 80]];
    let coat = json!({
        "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25,
        "clearcoatTexture": { "index": 0 }, "clearcoatRoughnessTexture": { "index": 1 },
    });
    let of = |coat: &Value| json!({ "extensions": { "KHR_materials_clearcoat": coat } });
    let scene = paint(of(&coat), &texels);
    let clearcoat = material(&scene).clearcoat;
    assert!((clearcoat.strength, clearcoat.roughness) == (0.5, 0.25));
    assert_eq!(texel(&scene, clearcoat.texture), [10, 60, 255, 255]);

    let mut lonely = coat.clone();
    lonely.as_object_mut().unwrap().remove("clearcoatTexture");
    lonely["clearcoatNormalTexture"] = json!({ "index": 1 });
    let scene = painted(of(&lonely), &texels).load().unwrap();
    assert_eq!(texel(&scene, material(&scene).clearcoat.texture), [255, 60, 255, 255]);
    assert!(scene.notes.warnings[0].contains("clearcoat's own normal texture"));

    // Textures with different placements cannot be combined; a warning says so.
    let mut apart = coat.clone();
    apart["clearcoatRoughnessTexture"] = json!({
        "index": 1, "extensions": { "KHR_texture_transform": { "scale": [2, 2] } },
    });
    let scene = painted(of(&apart), &texels).load().unwrap();
    assert!(scene.notes.warnings[0].contains("lie differently"), "{:?}", scene.notes.warnings);

    let mut wrong = coat;
    wrong["clearcoatTexture"]["index"] = json!(2);
    let scene = painted(of(&wrong), &texels).load().unwrap();
    let words = "its KHR_materials_clearcoat names a texture that does not exist";
    assert!(scene.notes.warnings.iter().any(|told| told.contains(words)), "{:?}", scene.notes);
}

#[test]
fn sheen_and_transmission_are_read() {
    let texels = [[10, 20, 30, 40], [50, 60, 70, 80]];
    let scene = paint(
        json!({ "extensions": {
            "KHR_materials_sheen": {
                "sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.75,
                "sheenColorTexture": { "index": 0 }, "sheenRoughnessTexture": { "index": 1 },
            },
            "KHR_materials_transmission": {
                "transmissionFactor": 0.5, "transmissionTexture": { "index": 1 },
            },
        } }),
        &texels,
    );
    let (sheen, transmission) = (material(&scene).sheen, material(&scene).transmission);
    assert_eq!(sheen.color, Vec3::new(0.5, 0.25, 1.0));
    assert_eq!(sheen.roughness, 0.75);
    assert_eq!(texel(&scene, sheen.texture), [10, 20, 30, 80]);
    assert_eq!(transmission.factor, 0.5);
    assert_eq!(texel(&scene, transmission.texture), [50, 60, 70, 80]);
    // The factor exceeds the range of the format.
    let sheen = json!({ "sheenColorFactor": [2, 0, 0] });
    let scene = painted(json!({ "extensions": { "KHR_materials_sheen": sheen } }), &[]);
    let scene = scene.load().unwrap();
    assert_eq!(material(&scene).sheen.color, Vec3::X);
    assert!(scene.notes.warnings[0].contains("sheen colour"));
}

#[test]
fn unlit_materials_keep_only_their_colour() {
    let scene = paint(
        json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.25, 1, 0.5], "baseColorTexture": { "index": 0 },
            },
            "emissiveFactor": [1, 1, 1],
            "extensions": { "KHR_materials_unlit": {} },
        }),
        &[[1, 2, 3, 4]],
    );
    let Shading::Unlit(unlit) = material(&scene).shading else { panic!("unlit") };
    assert_eq!(unlit.color, Vec4::new(0.5, 0.25, 1.0, 0.5));
    assert_eq!(texel(&scene, unlit.color_texture), [1, 2, 3, 4]);
    assert_eq!(material(&scene).emissive, Vec3::ZERO);
}

#[test]
fn specular_glossiness_factors_are_converted() {
    let scene = paint(
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.5, 0.25, 1, 0.75], "specularFactor": [0.5, 0.25, 0],
            "glossinessFactor": 0.75,
        } } }),
        &[],
    );
    let pbr = shading(&scene, 0);
    assert_eq!(pbr.base_color, Vec4::new(0.25, 0.125, 0.5, 0.75));
    assert_eq!(pbr.specular_color, Vec3::new(0.5, 0.25, 0.0));
    assert!((pbr.metallic, pbr.roughness, pbr.ior, pbr.specular) == (0.0, 0.25, 0.0, 1.0));
}

#[test]
fn specular_glossiness_textures_are_converted() {
    // sRGB 188 is a linear 0.5029.
    let texels = [[255, 188, 0, 200], [188, 0, 0, 51]];
    let model = |factor: f32| {
        json!({ "extensions": { "KHR_materials_pbrSpecularGlossiness": {
            "diffuseTexture": { "index": 0 }, "specularGlossinessTexture": { "index": 1 },
            "specularFactor": [factor, 1, 1], "glossinessFactor": 0.5,
        } } })
    };
    let scene = paint(model(1.0), &texels);
    let pbr = shading(&scene, 0);
    // White times 1 - 0.5029 is sRGB 187; 188 times 1 - 0.5029 is 137.
    assert_eq!(texel(&scene, pbr.base_color_texture), [187, 137, 0, 200]);
    assert_eq!(texel(&scene, pbr.specular_texture), [188, 0, 0, 255]);
    // The glossiness is 0.5 * 51 / 255 = 0.1.
    assert_eq!(texel(&scene, pbr.metallic_roughness_texture)[1], 230);
    assert!((pbr.metallic, pbr.roughness, pbr.ior) == (0.0, 1.0, 0.0));
    assert_eq!(pbr.specular_color, Vec3::ONE);
    assert_eq!(pbr.base_color, Vec4::ONE);
    // The factor also affects the diffuse part.
    let scene = paint(model(0.0), &texels);
    assert_eq!(texel(&scene, shading(&scene, 0).base_color_texture), [255, 188, 0, 200]);
}

#[test]
fn factors_beyond_their_range_are_limited() {
    let pbr = json!({ "baseColorFactor": [1.5, 0, 0, 1], "roughnessFactor": -1 });
    let scene = painted(json!({ "pbrMetallicRoughness": pbr }), &[]).load().unwrap();
    assert_eq!(shading(&scene, 0).base_color, Vec4::new(1.0, 0.0, 0.0, 1.0));
    assert_eq!(shading(&scene, 0).roughness, 0.0);
    assert_eq!(scene.notes.warnings.len(), 2);
}

#[test]
fn ignored_extensions_and_primitives_are_reported() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] =
        json!(["KHR_materials_volume", "KHR_xmp_json_ld", "VENDOR_thing", "KHR_materials_sheen"]);
    file.json["extensionsRequired"] = json!(["KHR_xmp_json_ld", "KHR_materials_sheen"]);
    let primitives = file.json["meshes"][0]["primitives"].as_array_mut().unwrap();
    primitives.push(json!({ "attributes": { "POSITION": 0 }, "mode": 1 }));
    primitives.push(json!({ "attributes": { "NORMAL": 0 } }));
    let scene = file.load().unwrap();
    assert_eq!(scene.triangle_count(), 1);
    let all = scene.notes.warnings.join("\n");
    for word in ["KHR_materials_volume", "thin pane", "VENDOR_thing", "lines", "without positions"]
    {
        assert!(all.contains(word), "{word} in:\n{all}");
    }
    assert!(!all.contains("xmp") && !all.contains("sheen"), "{all}");
}
