use std::collections::HashMap;
use std::sync::OnceLock;

use glam::{Mat4, UVec2, Vec3};
use lumivox::Preset;
use pollster::block_on;

use lumivox_scene::{LoadOptions, SightOptions, Staging};

use super::*;

#[test]
fn placements_round_trip_through_matrices() {
    let placement = Placement {
        position: Vec3::new(1.0, -2.0, 3.0),
        rotation_deg: Vec3::new(30.0, -40.0, 100.0),
        scale: Vec3::new(1.0, 2.0, 0.5),
    };
    let back = Placement::of(placement.matrix());
    assert!(back.position.abs_diff_eq(placement.position, 1e-5), "{back:?}");
    assert!(back.rotation_deg.abs_diff_eq(placement.rotation_deg, 1e-3), "{back:?}");
    assert!(back.scale.abs_diff_eq(placement.scale, 1e-5), "{back:?}");
}

/// The device of all tests: a test with its own device would have to create every pipeline again.
fn gpu() -> Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    let open = || {
        let options = lumivox_render::GpuOptions { portable: true, ..Default::default() };
        block_on(Gpu::new(&options)).expect("a GPU adapter, as ./test installs one")
    };
    GPU.get_or_init(open).clone()
}

pub(crate) fn small() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(32, 24),
        resolution: 32,
        frames: 2,
        bounces: 1,
        shadow_resolution: 64,
        ..RenderSettings::default()
    }
}

pub(crate) fn opened(scene: &str) -> PreparedScene {
    let scene = lumivox_scene::builtin::scene(scene).unwrap();
    PreparedScene::new(scene, &SightOptions::default(), &mut |_| {}).unwrap()
}

pub(crate) fn explorer(scene: &str) -> Explorer {
    let mut explorer = Explorer::new(gpu(), small(), PresetChoice::Cones(Preset::default()));
    explorer.open(opened(scene));
    explorer
}

fn shown(explorer: &mut Explorer) -> Option<lumivox_render::Picture> {
    block_on(explorer.picture(&mut |_| {})).unwrap()
}

pub(crate) fn picture(explorer: &mut Explorer) -> lumivox_render::Picture {
    shown(explorer).expect("something to show")
}

/// The picture of a new renderer with the same scene, camera and settings.
pub(crate) fn fresh(explorer: &Explorer) -> lumivox_render::Picture {
    let (scene, camera) = (explorer.scene().unwrap(), explorer.camera());
    let settings = explorer.settings().clone();
    let ignore = &mut |_| {};
    let renderer = Renderer::new(explorer.gpu(), scene, Some(camera), settings, ignore);
    block_on(block_on(renderer).unwrap().render(ignore)).unwrap()
}

#[test]
fn without_a_scene_there_is_no_picture() {
    let mut explorer = Explorer::new(gpu(), small(), PresetChoice::Cones(Preset::default()));
    assert!(!block_on(explorer.frame(&mut |_| {})).unwrap());
    assert!(shown(&mut explorer).is_none());
    explorer.open(opened("cornell"));
    for object in 0..explorer.object_names().len() {
        explorer.set_hidden(object, true);
    }
    assert!(shown(&mut explorer).is_none(), "all is hidden");
    explorer.set_hidden(0, false);
    assert!(shown(&mut explorer).is_some());
}

#[test]
fn edits_render_like_a_scene_built_that_way() {
    let mut explorer = explorer("cornell");
    let first = picture(&mut explorer);
    let last = explorer.object_names().len() - 1;
    let was = explorer.placement(last).unwrap();
    explorer.transform(last, Mat4::from_translation(Vec3::new(0.1, 0.0, 0.2)));
    explorer.edit_lights(|scene| scene.lights.truncate(1));
    assert!(explorer.edit_material(0, |material| material.emissive = Vec3::splat(3.0)));
    let seen = picture(&mut explorer);
    assert!(seen == fresh(&explorer) && seen != first);
    explorer.set_local_edit(last, explorer.local_edit_for(last, was).unwrap());
    assert!(explorer.edit_material(0, |material| material.emissive = Vec3::ZERO));
    assert!(picture(&mut explorer) == fresh(&explorer));
    assert!(!explorer.edit_material(99, |_| {}));
}

#[test]
fn settings_refused_by_the_renderer_are_reverted() {
    let mut explorer = explorer("cornell");
    let first = picture(&mut explorer);
    let accepted = explorer.settings().clone();
    let asked = RenderSettings { bounces: 99, ..small() };
    assert!(explorer.set_settings(asked).is_err(), "out of range: refused at once");
    explorer.set_settings(explorer.settings_of(PresetChoice::Cones(Preset::High))).unwrap();
    explorer.note_preset(PresetChoice::Cones(Preset::High));
    let volume = lumivox::VolumeKind::Octree;
    let asked = RenderSettings { volume, volume_memory: Some(1), ..explorer.settings().clone() };
    explorer.set_settings(asked).unwrap();
    assert!(
        block_on(explorer.update(&mut |_| {})).is_err(),
        "only the volume itself knows what it takes"
    );
    assert_eq!(*explorer.settings(), accepted);
    assert_eq!(explorer.preset(), PresetChoice::Cones(Preset::Balanced));
    assert!(picture(&mut explorer) == first);
}

/// If light of earlier frames is kept, voxels are updated within frames, even if late: the scene is
/// never voxelized as a whole, and one frame completes a picture once its voxels are up to date.
#[test]
#[ignore = "slow: over three seconds"]
fn realtime_motion_updates_voxels_within_each_frame() {
    let trace = lumivox::TraceSettings::preset(Preset::Realtime);
    let settings = RenderSettings { bounces: 8, frames: 1, trace, ..small() };
    let mut explorer = Explorer::new(gpu(), settings, PresetChoice::Cones(Preset::Realtime));
    explorer.open(opened("cornell"));
    assert!(block_on(explorer.frame(&mut |_| {})).unwrap());
    let last = explorer.object_names().len() - 1;
    let mut stages = Vec::new();
    for _ in 0..12 {
        explorer.transform(last, Mat4::from_translation(Vec3::X * 0.01));
        let mut tell = |step: RenderProgress| stages.push(step.stage);
        assert!(block_on(explorer.frame(&mut tell)).unwrap());
        assert!(!explorer.renderer().unwrap().has_stale_voxels());
    }
    let rest = (0..32).take_while(|_| block_on(explorer.frame(&mut |_| {})).unwrap()).count();
    assert!(rest < 8, "{rest} frames more than one");
    assert!(stages.iter().all(|stage| !["voxelize", "light"].contains(stage)), "{stages:?}");
}

/// A triangle on the ground; the only animation slides a lamp above it, with a camera on it.
fn sliding_lamp() -> Scene {
    const GLTF: &str = r#"{
        "asset": { "version": "2.0" },
        "nodes": [
            { "mesh": 0 },
            { "translation": [0, 1, 0], "children": [2], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "name": "eye", "translation": [0, 0, 2], "camera": 0 }
        ],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.01 } }],
        "scenes": [{ "nodes": [0, 1] }],
        "materials": [{ "doubleSided": true }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "animations": [{
            "samplers": [{ "input": 1, "output": 2 }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }]
        }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, 0, -1], "max": [1, 0, 1] },
            { "bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1] },
            { "bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 8 },
            { "buffer": 0, "byteOffset": 44, "byteLength": 24 }
        ],
        "buffers": [{ "byteLength": 68, "uri": "lamp.bin" }],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 50 }] } }
    }"#;
    let corners = [-1.0_f32, 0.0, -1.0, 0.0, 0.0, 1.0, 1.0, 0.0, -1.0];
    let times = [0.0_f32, 1.0];
    let places = [0.0_f32, 1.0, 0.0, 0.5, 1.0, 0.0];
    let numbers = corners.iter().chain(&times).chain(&places);
    let files = HashMap::from([
        ("lamp.gltf".to_owned(), GLTF.as_bytes().to_vec()),
        ("lamp.bin".to_owned(), numbers.flat_map(|number| number.to_le_bytes()).collect()),
    ]);
    let mut options = LoadOptions { files: Some(&files), ..LoadOptions::default() };
    Scene::load_with("lamp.gltf", &mut options).unwrap()
}

#[test]
fn a_moving_lamp_updates_the_light() {
    let mut explorer = Explorer::new(gpu(), small(), PresetChoice::Cones(Preset::default()));
    let sight = SightOptions::default();
    explorer.open(PreparedScene::new(sliding_lamp(), &sight, &mut |_| {}).unwrap());
    explorer.set_camera(Camera { name: "hand".to_owned(), ..explorer.camera().clone() });
    let first = picture(&mut explorer);
    explorer.seek(1.0).unwrap();
    let moved = picture(&mut explorer);
    assert!(moved != first && moved == fresh(&explorer));
}

#[test]
fn a_scene_camera_follows_its_animation() {
    let mut explorer = Explorer::new(gpu(), small(), PresetChoice::Cones(Preset::default()));
    let scene = sliding_lamp();
    let sight = SightOptions { camera: Some(scene.cameras[0].clone()), ..SightOptions::default() };
    explorer.open(PreparedScene::new(scene, &sight, &mut |_| {}).unwrap());
    explorer.seek(0.5).unwrap();
    assert!(explorer.follows_camera());
    assert_eq!(explorer.camera().position, Vec3::new(0.25, 1.0, 2.0));
    // The user moves the camera away.
    let by_hand = Camera { position: Vec3::new(0.0, 3.0, 3.0), ..explorer.camera().clone() };
    explorer.set_camera(by_hand.clone());
    explorer.seek(1.0).unwrap();
    assert!(!explorer.follows_camera());
    assert_eq!(*explorer.camera(), by_hand);
}

#[test]
#[ignore = "slow: over three seconds"]
fn revoxelize_policies_decide_when_voxels_follow() {
    let mut explorer = explorer("cornell");
    picture(&mut explorer);
    explorer.revoxelize = Revoxelize::WhenAsked;
    let last = explorer.object_names().len() - 1;
    explorer.transform(last, Mat4::from_translation(Vec3::X * 0.1));
    let stale = picture(&mut explorer);
    assert!(explorer.renderer().unwrap().has_stale_voxels());
    explorer.ask_for_voxels();
    let followed = picture(&mut explorer);
    assert!(followed == fresh(&explorer) && followed != stale);
    for policy in [Revoxelize::EveryFrame, Revoxelize::Every(0.0), Revoxelize::WhenMoved] {
        explorer.revoxelize = policy;
        explorer.transform(last, Mat4::from_translation(Vec3::Z * 0.05));
        explorer.tick(0.1).unwrap();
        let seen = picture(&mut explorer);
        assert!(!explorer.renderer().unwrap().has_stale_voxels());
        assert!(seen == fresh(&explorer), "{policy:?}");
    }
}

/// The grid widens for objects that leave it, and does not shrink again.
#[test]
fn the_grid_widens_for_objects_that_leave_it() {
    let mut explorer = explorer("cornell");
    picture(&mut explorer);
    let last = explorer.object_names().len() - 1;
    explorer.transform(last, Mat4::from_translation(Vec3::X * 3.0));
    picture(&mut explorer);
    let wide = *explorer.renderer().unwrap().gi().grid();
    assert!(wide.max_in_world().cmpge(explorer.bounds().max).all(), "{wide:?}");
    explorer.transform(last, Mat4::from_translation(Vec3::X * -3.0));
    picture(&mut explorer);
    assert_eq!(*explorer.renderer().unwrap().gi().grid(), wide);
    // Out at the other side, then back.
    explorer.transform(last, Mat4::from_translation(Vec3::X * -3.0));
    picture(&mut explorer);
    let wider = *explorer.renderer().unwrap().gi().grid();
    assert!(wider.origin_in_world.x < wide.origin_in_world.x - 1.0, "{wider:?}");
    assert!(wider.max_in_world().x > wide.max_in_world().x - 0.5, "{wider:?}");
}

#[test]
fn object_names_are_made_unique() {
    let mut explorer = explorer("cornell");
    let names = explorer.object_names();
    let first = names[0].clone();
    let opened = explorer.opened.as_mut().unwrap();
    opened.scene.instances[1].name.clone_from(&first);
    opened.scene.instances[2].name.clear();
    opened.scene.instances[3].name = "two\nlines".to_owned();
    opened.names = names::names_of_objects(&opened.scene);
    let names = explorer.object_names();
    assert_eq!(names[1], format!("{first} (2)"));
    assert_eq!(names[2], "object 3");
    assert_eq!(names[3], "two lines");
    assert_eq!(explorer.object(&names[1]), Ok(1));
    let wrong = explorer.object(&first[..first.len() - 1]).unwrap_err().to_string();
    assert!(wrong.contains("did you mean"), "{wrong}");
    let wrong = explorer.object("zzz").unwrap_err().to_string();
    assert!(wrong.contains("`objects` lists"), "{wrong}");
}

/// Naming, finding and hiding many objects of one name takes linear time.
#[test]
fn thousands_of_equal_names_are_made_unique() {
    let mut explorer = explorer("cornell");
    let opened = explorer.opened.as_mut().unwrap();
    let like =
        lumivox_scene::Instance { name: "a".to_owned(), ..opened.scene.instances[0].clone() };
    opened.scene.instances = vec![like; 3000];
    opened.scene.instances[1].name = "a (3)".to_owned();
    opened.posed = vec![Mat4::IDENTITY; 3000];
    opened.marks = opened.scene.instances.iter().map(objects::Marks::of).collect();
    opened.names = names::names_of_objects(&opened.scene);
    let names = explorer.object_names();
    assert_eq!(names[..5], ["a", "a (3)", "a (2)", "a (4)", "a (5)"]);
    assert_eq!(names.iter().collect::<std::collections::HashSet<_>>().len(), 3000);
    for object in 0..3000 {
        explorer.set_hidden(object, true);
    }
    assert_eq!(explorer.scene().unwrap().shown().count(), 0);
}

#[test]
fn closing_a_scene_resets_its_state() {
    let mut explorer = explorer("cornell");
    explorer.store_position(0);
    picture(&mut explorer);
    explorer.close();
    assert_eq!(explorer.position(0), None);
    assert_eq!(explorer.settings().grid_bounds, None);
    assert_eq!(explorer.times.count(), 0);
}

#[test]
fn cameras_are_stored_under_names() {
    let mut explorer = explorer("cornell");
    let own = explorer.scene().unwrap().cameras[0].name.clone();
    let first = explorer.camera().clone();
    explorer.store_camera("window seat").unwrap();
    explorer.set_camera(Camera::look_at(Vec3::ONE, Vec3::ZERO, 1.0));
    explorer.store_camera("above").unwrap();
    let names: Vec<&str> = explorer.stored_cameras().map(|(name, _)| name).collect();
    assert_eq!(names, ["above", "window seat"]);
    let seat = explorer.stored_cameras().nth(1).unwrap().1.clone();
    assert_eq!(seat, Camera { name: "window seat".to_owned(), ..first });
    for name in ["", "  ", own.as_str()] {
        let error = explorer.store_camera(name).unwrap_err().to_string();
        assert!(error.contains(&format!("as \"{name}\"")), "{error}");
    }
    // Storing under this name again replaces the camera.
    explorer.store_camera("window seat").unwrap();
    let stored: Vec<Camera> = explorer.stored_cameras().map(|(_, camera)| camera.clone()).collect();
    assert_eq!(stored[1].position, Vec3::ONE);
    explorer.reopen(opened("cornell"));
    assert_eq!(explorer.stored_cameras().count(), 2);
    explorer.open(opened("cornell"));
    assert_eq!(explorer.stored_cameras().count(), 0);
}

/// A dark scene is lit unless that is disabled, and a note names the light; an emissive scene is
/// unchanged.
#[test]
fn dark_scenes_get_default_light_and_a_note() {
    let mut dark = lumivox_scene::builtin::scene("cornell").unwrap();
    let shining = PreparedScene::new(dark.clone(), &SightOptions::default(), &mut |_| {}).unwrap();
    assert_eq!(shining.scene(), &dark);
    assert!(shining.notes()[0].text.starts_with("its own"), "{:?}", shining.notes());
    dark.lights.clear();
    for material in &mut dark.materials {
        material.emissive = Vec3::ZERO;
    }
    let left = SightOptions { staging: Staging::None, ..SightOptions::default() };
    let left = PreparedScene::new(dark.clone(), &left, &mut |_| {}).unwrap();
    assert!(left.notes().is_empty() && !left.scene().shines());
    let mut stages = Vec::new();
    let mut tell = |step: RenderProgress| stages.push(step.stage);
    let lit = PreparedScene::new(dark, &SightOptions::default(), &mut tell).unwrap();
    assert!(lit.scene().shines() && lit.notes()[0].text.contains("none of its own"));
    assert_eq!(stages, ["looking at the scene"]);
}

#[test]
fn a_requested_camera_wins_over_scene_and_default_cameras() {
    let mut scene = lumivox_scene::builtin::scene("cornell").unwrap();
    let own = scene.cameras[0].clone();
    let wanted = Camera::look_at(Vec3::ONE, Vec3::ZERO, 1.0);
    let camera = |scene: &Scene, options: &SightOptions| {
        PreparedScene::new(scene.clone(), options, &mut |_| {}).unwrap().camera().clone()
    };
    assert_eq!(camera(&scene, &SightOptions::default()), own);
    let options = SightOptions { camera: Some(wanted.clone()), ..SightOptions::default() };
    assert_eq!(camera(&scene, &options), wanted);
    scene.cameras.clear();
    let found = camera(&scene, &SightOptions { aspect: 1.0, ..SightOptions::default() });
    assert_eq!(found, scene.default_camera(1.0));
}

/// Messages of lower crates are passed on to the letter, and errors keep their types.
#[test]
fn errors_keep_the_messages_of_lower_crates() {
    let mut explorer = explorer("cornell");
    let asked = RenderSettings { bounces: 99, ..small() };
    let limits = explorer.gpu().device.limits();
    let below = asked.validate(&limits).unwrap_err().to_string();
    let error = explorer.set_settings(asked).unwrap_err();
    assert!(matches!(error, ExplorerError::Render(_)) && error.to_string() == below, "{error}");
    let unknown = explorer.object("zzz").unwrap_err();
    assert_eq!(ExplorerError::from(unknown.clone()).to_string(), unknown.to_string());
}

/// If one setting is refused, all requested together are left unchanged; accepted settings take
/// effect at once.
#[test]
fn tried_settings_apply_all_or_not_at_all() {
    let mut explorer = explorer("cornell");
    let first = picture(&mut explorer);
    let report = parameters::find_preset("report").unwrap();
    let settings = RenderSettings { volume_memory: Some(1), ..explorer.settings_of(report) };
    assert!(block_on(explorer.try_settings(settings, report, &mut |_| {})).is_err());
    assert_eq!(explorer.preset(), PresetChoice::Cones(Preset::Balanced));
    assert!(picture(&mut explorer) == first);
    let settings = explorer.settings_of(report);
    block_on(explorer.try_settings(settings.clone(), report, &mut |_| {})).unwrap();
    assert_eq!((explorer.preset(), explorer.settings()), (report, &settings));
    assert_eq!(explorer.renderer().unwrap().settings(), &settings);
    assert!(picture(&mut explorer) == fresh(&explorer));
}

#[test]
fn the_explorer_overwrites_a_camera_set_on_the_renderer() {
    let mut explorer = explorer("cornell");
    block_on(explorer.frame(&mut |_| {})).unwrap();
    explorer.renderer_mut().unwrap().set_camera(Camera::default());
    block_on(explorer.update(&mut |_| {})).unwrap();
    assert_eq!(explorer.renderer().unwrap().camera(), explorer.camera());
}
