//! References to things that do not exist: the rest of the scene is shown, with a warning.

use lumivox_scene::Scene;
use serde_json::{Value, json};

use crate::common::{File, textured_cube};

type Change = fn(&mut Value);

/// A textured cube after a change to its JSON, and its warnings.
fn changed(change: Change) -> (Scene, String) {
    let mut file: File = textured_cube();
    change(&mut file.json);
    let scene = file.load().unwrap();
    let told = scene.notes.warnings.join("\n");
    (scene, told)
}

#[test]
fn a_dangling_reference_costs_only_its_target() {
    let sound = textured_cube().load().unwrap();
    let changes: [(Change, &str); 5] = [
        (
            |json| json["scene"] = json!(7),
            "it marks scene 7, but there are only 1; the first is shown",
        ),
        (
            |json| json["nodes"][0]["camera"] = json!(3),
            "node 0 names camera 3, but there are only 0; that was left out",
        ),
        (
            |json| {
                json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 9 } });
            },
            "node 0 names light 9, but there are only 0; that was left out",
        ),
        (
            |json| {
                json["textures"][0]["extensions"] = json!({ "EXT_texture_webp": { "source": 9 } });
            },
            "texture 0: its EXT_texture_webp names an image that does not exist; that was left out",
        ),
        (
            |json| {
                json["materials"][0]["extensions"] =
                    json!({ "KHR_materials_sheen": { "sheenColorTexture": { "index": 9 } } });
            },
            "material \"paint\", its KHR_materials_sheen names a texture that does not exist; it \
             was left out",
        ),
    ];
    for (change, words) in changes {
        let (scene, told) = changed(change);
        assert_eq!(told, words);
        assert_eq!(scene.meshes, sound.meshes);
        assert_eq!(scene.materials, sound.materials);
        assert_eq!((scene.instances.len(), &scene.textures), (1, &sound.textures));
    }
    let (scene, told) = changed(|json| {
        json["scene"] = json!(0);
        json.as_object_mut().unwrap().remove("scenes");
    });
    assert_eq!(
        (told.as_str(), scene.meshes == sound.meshes),
        ("it marks scene 0, but there are only 0; all its nodes are shown", true)
    );
}

#[test]
fn a_dangling_texture_looks_like_a_missing_image() {
    let (missing, _) = changed(|json| json["images"][0] = json!({ "uri": "gone.png" }));
    let (scene, told) = changed(|json| {
        json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = json!(5);
        json["materials"][0]["normalTexture"]["index"] = json!(6);
    });
    let said = |key: &str, index: usize| {
        format!(
            "material \"paint\": its {key} is texture {index}, but there are only 1; it counts as \
             missing"
        )
    };
    assert_eq!(told, said("normalTexture", 6) + "\n" + &said("baseColorTexture", 5));
    assert_eq!(scene.materials, missing.materials);
    assert_eq!(scene.textures, missing.textures);
    // In an extension, and without any texture.
    let (scene, told) = changed(|json| {
        json["textures"] = json!([]);
        json["materials"][0] = json!({ "emissiveFactor": [1, 1, 1], "emissiveTexture":
            { "index": 0 }, "extensions": { "KHR_materials_clearcoat":
            { "clearcoatTexture": { "index": 0 } } } });
    });
    assert_eq!(told.matches("it counts as missing").count(), 2, "{told}");
    assert_eq!(scene.materials[0].emissive, glam::Vec3::ZERO);
    let (scene, told) = changed(|json| json["textures"][0]["source"] = json!(9));
    assert!(told.starts_with("texture 0: its source is image 9, but there are only 1"), "{told}");
    assert_eq!(scene.materials, missing.materials);
    let (_, told) = changed(|json| json["textures"][0]["sampler"] = json!(9));
    assert_eq!(told, "texture 0 names sampler 9, but there are only 1; the default one is used");
}

#[test]
fn a_dangling_material_becomes_the_default_material() {
    let (bare, _) = changed(|json| {
        json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("material");
    });
    let (scene, told) = changed(|json| json["meshes"][0]["primitives"][0]["material"] = json!(99));
    assert_eq!(scene.materials, bare.materials);
    let words = "mesh \"thing\" names material 99, but there are only 1; it has the default look";
    assert!(told.starts_with(words), "{told}");
}
