//! A scene saved as GLB loads as the same scene, and the file follows the specification.

mod compare;
mod conformance;
mod strategy;

use compare::assert_same;
use glam::{Affine2, Vec2, Vec3};
use lumivox_scene::{
    Bounds, LoadOptions, Sampler, Scene, SceneError, Texture, TextureRef, builtin,
};
use proptest::prelude::*;

fn load(name: &str, glb: &[u8]) -> Scene {
    let file = format!("{name}.glb");
    Scene::from_memory(&file, glb, &mut LoadOptions::default()).unwrap()
}

/// Panics with the first difference of two files.
fn assert_same_file(once: &[u8], twice: &[u8]) {
    // Skips the lengths of the file and the JSON, which differ as a consequence.
    let text = |glb: &[u8], at: usize| {
        let end = glb.len().min(at + 150);
        String::from_utf8_lossy(&glb[at.saturating_sub(150).min(end)..end]).into_owned()
    };
    let first = (20..once.len().max(twice.len())).find(|&i| once.get(i) != twice.get(i));
    if let Some(at) = first {
        panic!("saved again, byte {at} differs: {}\n\n{}", text(once, at), text(twice, at));
    }
    assert!(once == twice);
}

/// Saves and loads a scene, twice.
fn round_trip(scene: &Scene) -> Scene {
    let glb = scene.to_glb().unwrap();
    conformance::check(&glb);
    let loaded = load(&scene.name, &glb);
    // An outlier causes a warning.
    let strays = usize::from(scene.outlier().is_some());
    assert_eq!(loaded.notes.warnings.len(), strays, "{:?}", loaded.notes.warnings);
    assert_eq!(loaded.notes.degenerate_triangles, 0);
    assert_same(scene, &loaded);
    assert_same_file(&glb, &loaded.to_glb().unwrap());
    assert_eq!(load(&scene.name, &glb), loaded);
    loaded
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn random_scenes_survive_to_the_bit(scene in strategy::scene()) {
        // If most positions are far from zero, loading sets an origin, and rounds other positions.
        prop_assume!(load(&scene.name, &scene.to_glb().unwrap()).origin == scene.origin);
        round_trip(&scene);
    }
}

#[test]
fn builtin_scenes_survive_to_the_bit() {
    // Large scenes test nothing more, but take as long as all others.
    for name in builtin::names().iter().filter(|name| !builtin::is_large(name)) {
        round_trip(&builtin::scene(name).unwrap());
    }
}

#[test]
fn an_empty_scene_with_a_box_survives() {
    let grid_bounds = Some(Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
    round_trip(&Scene { name: "empty".to_owned(), grid_bounds, ..Scene::default() });
}

#[test]
fn save_glb_writes_the_bytes_of_to_glb() {
    let scene = builtin::scene("cornell").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cornell.glb");
    std::fs::write(&path, "an old file").unwrap();
    scene.save_glb(&path).unwrap();
    assert!(std::fs::read(&path).unwrap() == scene.to_glb().unwrap());
    assert_same(&scene, &Scene::load(&path).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file was left");
}

#[test]
fn duplicate_meshes_are_stored_once() {
    let scene = builtin::scene("cornell").unwrap();
    let once = scene.to_glb().unwrap().len();
    let mut twice = scene.clone();
    let meshes = scene.meshes.len();
    twice.meshes.extend(scene.meshes.clone());
    for instance in &scene.instances {
        let mut copy = instance.clone();
        copy.mesh += meshes;
        twice.instances.push(copy);
    }
    let grown = twice.to_glb().unwrap().len() - once;
    // A node has a name, an index, and at most 16 numbers of a dozen digits.
    assert!(grown < scene.instances.len() * 300, "{grown} bytes");
}

#[test]
fn save_errors_name_the_file() {
    let scene = builtin::scene("cornell").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no such folder").join("cornell.glb");
    let fault = scene.save_glb(&path).unwrap_err();
    assert!(matches!(fault, SceneError::Write { .. }));
    assert!(fault.to_string().starts_with(&format!("{}: cannot write", path.display())));

    let mut broken = scene.clone();
    broken.instances[0].mesh = 99;
    let path = folder.path().join("broken.glb");
    let fault = broken.save_glb(&path).unwrap_err();
    assert!(matches!(fault, SceneError::IndexOutOfRange { index: 99, .. }));
    assert!(fault.to_string().contains("broken.glb"), "{fault}");
    assert!(!path.exists());

    let mut broken = scene.clone();
    broken.meshes[0].positions[0].x = f32::NAN;
    assert!(matches!(broken.to_glb(), Err(SceneError::NotFinite { .. })));
    assert!(matches!(Scene::default().to_glb(), Err(SceneError::NoTriangles { .. })));
}

/// Replaces a text in the JSON of a saved file by another of equal length.
fn with_json(glb: &[u8], text: &str, other: &str) -> Vec<u8> {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json = std::str::from_utf8(&glb[20..20 + length]).unwrap();
    assert!(json.contains(text));
    let mut changed = glb.to_vec();
    changed[20..20 + length].copy_from_slice(json.replace(text, other).as_bytes());
    changed
}

/// Another program may have changed the rest of the file.
#[test]
fn extras_that_do_not_fit_are_ignored_with_a_warning() {
    let mut scene = builtin::scene("cornell").unwrap();
    scene.environment.radiance = Vec3::ONE;
    let glb = scene.to_glb().unwrap();
    for (right, wrong) in [
        (r#""radiance":[1.0,1.0,1.0]"#, r#""radiance":[1.0,1.0,-1 ]"#),
        (r#""rotationRad":0.0"#, r#""rotationRad":"a""#),
    ] {
        let loaded = load("cornell", &with_json(&glb, right, wrong));
        assert_eq!(loaded.environment, lumivox_scene::Environment::default());
        assert_eq!(loaded.notes.warnings.len(), 1);
        assert!(loaded.notes.warnings[0].contains("environment"), "{:?}", loaded.notes.warnings);
    }
}

/// For programs that ignore the exact matrix, offset, rotation and scale are equivalent.
#[test]
fn texture_transforms_are_correct_without_extras() {
    for (scale, angle_rad) in [(Vec2::new(2.0, 0.5), 0.7), (Vec2::new(1.0, -3.0), -2.5)] {
        let mut scene = builtin::scene("cornell").unwrap();
        scene.textures.push(Texture {
            name: "grey".to_owned(),
            width: 1,
            height: 1,
            rgba8: vec![128, 128, 128, 255],
            sampler: Sampler::default(),
        });
        let offset = Vec2::new(0.25, 0.5);
        let transform = Affine2::from_scale_angle_translation(scale, angle_rad, offset);
        let place = Some(TextureRef { transform, ..TextureRef::new(0) });
        for material in &mut scene.materials {
            material.emissive_texture = place;
        }
        let glb = with_json(
            &scene.to_glb().unwrap(),
            r#"{"lumivox":{"matrix""#,
            r#"{"lumivox":{"xxxxxx""#,
        );
        let loaded = load("cornell", &glb).materials[0].emissive_texture.unwrap().transform;
        assert!(loaded.abs_diff_eq(transform, 1e-5), "{loaded:?} instead of {transform:?}");
    }
}
