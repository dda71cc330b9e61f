use lumivox_scene::builtin::{is_large, names};
use lumivox_scene::{Texture, TextureRef};

use super::*;

fn settings() -> RenderSettings {
    RenderSettings { resolution: 64, ..RenderSettings::default() }
}

/// Large scenes and turned copies are left out: they take the same code, and more time.
#[test]
fn builtin_scenes_are_described() {
    for name in names().iter().filter(|name| !is_large(name) && !name.ends_with("-rotated")) {
        let scene = lumivox_scene::builtin::scene(name).unwrap();
        let report = Report::new(&scene, &settings()).unwrap();
        let text = report.text();
        assert!(text.starts_with(name), "{text}");
        for camera in &scene.cameras {
            assert!(text.contains(&camera.name), "{text}");
        }
        for material in &scene.materials {
            assert!(text.contains(&material.name), "{text}");
        }
        assert!(text.contains("voxel list"), "{text}");
        serde_json::to_string(&report).unwrap();
    }
}

#[test]
fn info_lists_the_roles_of_each_texture() {
    let mut scene = lumivox_scene::builtin::scene("cornell").unwrap();
    let texture = Texture {
        name: "weave".to_owned(),
        width: 2,
        height: 1,
        rgba8: vec![0; 8],
        sampler: lumivox_scene::Sampler::default(),
    };
    scene.textures = vec![texture.clone(), Texture { name: "idle".to_owned(), ..texture }];
    scene.materials[0].normal_texture = Some(TextureRef::new(0));
    scene.materials[0].sheen.texture = Some(TextureRef::new(0));
    scene.materials[1].normal_texture = Some(TextureRef::new(0));
    let report = Report::new(&scene, &settings()).unwrap();
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["texture_list"][0]["roles"], serde_json::json!(["normal", "sheen"]));
    assert_eq!(json["texture_list"][0]["materials"], 2);
    assert_eq!(json["texture_list"][1]["materials"], 0);
    assert_eq!(json["texture_bytes"], 16);
    assert_eq!(json["material_list"][1]["textures"][0]["role"], "normal");
}

#[test]
fn long_lists_are_shortened_in_text_but_not_json() {
    let mut scene = lumivox_scene::builtin::scene("cornell").unwrap();
    let first = scene.materials[0].clone();
    scene.materials.extend((0..100).map(|i| Material { name: format!("m{i}"), ..first.clone() }));
    let report = Report::new(&scene, &settings()).unwrap();
    assert!(report.text().contains("more; --json has all"), "{}", report.text());
    assert_eq!(report.material_list.len(), scene.materials.len());
}
