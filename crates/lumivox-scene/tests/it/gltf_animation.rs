//! Animations: everything follows the key frames, at any time and in any order of times.

use glam::{Mat4, Vec3};
use lumivox_scene::{AnimationChoice, Scene, SceneError};
use serde_json::json;

use crate::common::{File, world_triangles, write};

const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// The pose at a time of the first animation.
fn posed(file: &File, time_s: f32) -> Scene {
    let mut scene = file.load().unwrap();
    scene.pose(AnimationChoice::One(0), time_s).unwrap();
    scene
}

fn origin(scene: &Scene) -> Vec3 {
    scene.instances[0].world_from_local.transform_point3(Vec3::ZERO)
}

#[test]
fn translations_rotations_and_scales_move_nodes() {
    let mut file = File::triangle();
    file.json["nodes"][0]["translation"] = json!([0, 0, 50]);
    let parent = file.node(json!({ "children": [0], "name": "arm" }), false);
    file.json["scenes"][0]["nodes"] = json!([parent]);
    let moves = file.vectors(&[[1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    let turns = file.vectors(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]]);
    let grows = file.vectors(&[[1.0, 1.0, 1.0], [3.0, 3.0, 3.0]]);
    file.animation(
        "wave",
        &[0.5, 2.5],
        &[
            (parent, "translation", "LINEAR", moves),
            (0, "rotation", "LINEAR", turns),
            (0, "scale", "STEP", grows),
        ],
    );
    let scene = file.load().unwrap();
    // The transform of the file, before any pose.
    assert_eq!(origin(&scene), Vec3::new(0.0, 0.0, 50.0));
    let animations = scene.animations();
    assert_eq!(animations.len(), 1);
    assert_eq!((animations[0].name.as_str(), animations[0].duration_s), ("wave", 2.5));

    // Half-way: 90 degrees about z, and the scale is still 1.
    let middle = posed(&file, 1.5);
    assert_eq!(origin(&middle), Vec3::new(2.0, 0.0, 50.0));
    let x = middle.instances[0].world_from_local.transform_vector3(Vec3::X);
    assert!((x - Vec3::Y).length() < 1e-6, "{x}");
    // Times outside the animation show its start or end.
    for (time_s, x) in [(-1.0, 1.0), (0.2, 1.0), (2.5, 3.0), (99.0, 3.0), (f32::INFINITY, 3.0)] {
        assert_eq!(origin(&posed(&file, time_s)).x, x, "at {time_s} s");
    }
    let end = posed(&file, 2.5).instances[0].world_from_local.transform_vector3(Vec3::X);
    assert!((end - Vec3::NEG_X * 3.0).length() < 1e-5, "{end}");
}

#[test]
fn spline_and_normalized_integer_tracks_are_read() {
    let mut file = File::triangle();
    // x = t³ on keys at 0 and 2.
    let spline =
        file.vectors(&[[0.0; 3], [0.0; 3], [0.0; 3], [12.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0; 3]]);
    let bytes: Vec<u8> = [[0, 0, 0, 127_i8], [0, 0, 90, 90]]
        .as_flattened()
        .iter()
        .map(|b| b.cast_unsigned())
        .collect();
    let view = file.view(&bytes);
    let turns = file.accessor(view, 5120, 2, "VEC4");
    file.json["accessors"][turns]["normalized"] = json!(true);
    file.animation(
        "a",
        &[0.0, 2.0],
        &[(0, "translation", "CUBICSPLINE", spline), (0, "rotation", "LINEAR", turns)],
    );
    for t in [0.0, 0.5, 1.0, 1.7, 2.0_f32] {
        assert!((origin(&posed(&file, t)).x - t * t * t).abs() < 1e-5, "at {t} s");
    }
    let x = posed(&file, 2.0).instances[0].world_from_local.transform_vector3(Vec3::X);
    assert!((x - Vec3::Y).length() < 1e-6, "{x}");
}

#[test]
fn poses_do_not_depend_on_earlier_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = write(folder.path(), "scene.glb", &tumbling().glb());
    let mut scene = Scene::load(&path).unwrap();
    for time_s in [0.3, 1.0, 0.0, 2.0, 0.7, 1.3, 0.3] {
        scene.pose(AnimationChoice::All, time_s).unwrap();
        let mut fresh = Scene::load(&path).unwrap();
        fresh.pose(AnimationChoice::All, time_s).unwrap();
        assert_eq!(scene, fresh, "at {time_s} s");
        let mut valid = scene.clone();
        valid.validate().unwrap();
        assert_eq!(valid, scene, "at {time_s} s");
    }
}

/// Two triangles; the first is mirrored from 0 to 2 s, and flat at 1 s.
fn tumbling() -> File {
    let mut file = File::triangle();
    let scales = file.vectors(&[[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]]);
    file.node(json!({ "mesh": 0, "translation": [0, 0, 9], "name": "still" }), true);
    file.animation("flip", &[0.0, 2.0], &[(0, "scale", "LINEAR", scales)]);
    file
}

#[test]
fn instances_flattened_to_lines_are_hidden() {
    let mut file = tumbling();
    let scales = file.vectors(&[[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]]);
    file.json["animations"] = json!([]);
    file.animation("shrink", &[0.0, 2.0], &[(0, "scale", "LINEAR", scales)]);
    let mut scene = file.load().unwrap();
    let own = lumivox_scene::Instance { name: "own".to_owned(), ..scene.instances[1].clone() };
    scene.instances.push(own);
    let names = |scene: &Scene| -> Vec<String> {
        scene.instances.iter().map(|instance| instance.name.clone()).collect()
    };
    for (time_s, visible) in [(0.5, true), (1.0, false), (1.5, true), (1.0, false), (0.0, true)] {
        scene.pose(AnimationChoice::One(0), time_s).unwrap();
        // Appended instances stay.
        let expected: &[&str] =
            if visible { &["stand", "still", "own"] } else { &["still", "own"] };
        assert_eq!(names(&scene), expected, "at {time_s} s");
    }
}

/// A triangle across z that is scaled along z to zero and then mirrored shows the same side at all
/// times.
#[test]
fn momentarily_flat_instances_stay_visible() {
    for first in [1.0, -1.0] {
        let mut file = File::triangle();
        let scales = file.vectors(&[[1.0, first, 1.0], [1.0, first, 0.0], [1.0, first, -1.0]]);
        file.animation("press", &[0.0, 1.0, 2.0], &[(0, "scale", "LINEAR", scales)]);
        let mut scene = file.load().unwrap();
        for time_s in [0.0, 0.5, 1.0, 1.5] {
            scene.pose(AnimationChoice::All, time_s).unwrap();
            let ([a, b, c], normal) = world_triangles(&scene)[0];
            let face = (b - a).cross(c - a).normalize();
            assert!(face.dot(normal) > 0.999, "{first} at {time_s} s: {face} {normal}");
            let mut valid = scene.clone();
            valid.validate().unwrap();
            assert_eq!(valid, scene);
        }
    }
}

#[test]
fn mirrored_nodes_keep_front_faces_in_motion() {
    let mut scene = tumbling().load().unwrap();
    for (time_s, x) in [(0.5, 0.5), (1.5, -0.5), (2.0, -1.0)] {
        scene.pose(AnimationChoice::All, time_s).unwrap();
        let triangles = world_triangles(&scene);
        let far = triangles[0].0.iter().map(|p| p.x).find(|&x| x != 0.0);
        assert_eq!(far, Some(x));
        for ([a, b, c], normal) in triangles {
            assert!((b - a).cross(c - a).normalize().dot(normal) > 0.999, "at {time_s} s");
            assert!(normal.z > 0.999);
        }
    }
}

#[test]
fn posing_an_empty_moment_is_a_recoverable_error() {
    let mut file = File::triangle();
    let scales = file.vectors(&[[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [2.0, 2.0, 2.0]]);
    file.animation("blink", &[0.0, 1.0, 2.0], &[(0, "scale", "LINEAR", scales)]);
    let mut scene = file.load().unwrap();
    let error = scene.pose(AnimationChoice::All, 1.0).unwrap_err();
    assert!(matches!(error, SceneError::NothingAtTime { time_s: 1.0, .. }));
    assert!(error.to_string().contains("nothing is visible at 1 s"), "{error}");
    scene.pose(AnimationChoice::All, 2.0).unwrap();
    assert_eq!(scene.bounds().max.x, 2.0);
}

#[test]
fn lights_and_cameras_follow_animated_nodes() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    file.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "directional" }] } });
    file.push(
        "cameras",
        json!({ "type": "perspective", "perspective": { "yfov": 0.9, "znear": 0.2 } }),
    );
    let lamp = json!({ "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } });
    let lamp = file.node(lamp, true);
    let moves = file.vectors(&[[0.0, 0.0, 0.0], [4.0, 2.0, 0.0]]);
    // A rotation by 90 degrees about x turns -z to +y.
    let turns = file.vectors(&[[0.0, 0.0, 0.0, 1.0], [HALF, 0.0, 0.0, HALF]]);
    let channels = [(lamp, "translation", "LINEAR", moves), (lamp, "rotation", "LINEAR", turns)];
    file.animation("pan", &[0.0, 1.0], &channels);
    let mut scene = file.load().unwrap();
    assert_eq!(scene.cameras[0].forward, Vec3::NEG_Z);
    let own = lumivox_scene::Light { name: "own".to_owned(), ..Default::default() };
    scene.lights.push(own.clone());
    scene.pose(AnimationChoice::All, 1.0).unwrap();
    let (light, camera) = (&scene.lights[0], &scene.cameras[0]);
    assert_eq!((light.position, camera.position), (Vec3::new(4.0, 2.0, 0.0), light.position));
    assert!((light.direction - Vec3::Y).length() < 1e-6, "{}", light.direction);
    assert!((camera.forward - Vec3::Y).length() < 1e-6 && (camera.up - Vec3::Z).length() < 1e-6);
    assert_eq!(scene.lights[1], own);

    // The file's lights move, even if changed, as long as they come first; other lights stay.
    let mut brighter = scene.lights.clone();
    brighter[0].radius_m = 0.5;
    scene.replace_lights(brighter);
    scene.replace_cameras(vec![own_camera()]);
    scene.pose(AnimationChoice::All, 0.0).unwrap();
    assert_eq!((scene.lights[0].position, scene.lights[0].radius_m), (Vec3::ZERO, 0.5));
    assert_eq!(scene.cameras, [own_camera()]);
    scene.replace_lights(vec![own.clone()]);
    scene.pose(AnimationChoice::All, 1.0).unwrap();
    assert_eq!(scene.lights, [own]);
}

fn own_camera() -> lumivox_scene::Camera {
    let camera = lumivox_scene::Camera::look_at(Vec3::ONE, Vec3::ZERO, 0.7);
    lumivox_scene::Camera { name: "own".to_owned(), ..camera }
}

#[test]
fn a_rigid_scene_transform_survives_posing() {
    let mut file = File::triangle();
    let moves = file.vectors(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
    file.animation("go", &[0.0, 1.0], &[(0, "translation", "LINEAR", moves)]);
    let mut scene = file.load().unwrap();
    let turn = Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2);
    scene.transform(Mat4::from_translation(Vec3::Y * 3.0) * turn);
    scene.pose(AnimationChoice::All, 1.0).unwrap();
    assert!((origin(&scene) - Vec3::new(0.0, 3.0, -4.0)).length() < 1e-5, "{}", origin(&scene));
}

#[test]
fn animations_play_alone_or_together() {
    let mut file = File::triangle();
    let x = file.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let y = file.vectors(&[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let scales = file.vectors(&[[2.0; 3]; 2]);
    file.animation("x", &[0.0, 1.0], &[(0, "translation", "LINEAR", x)]);
    let second = [(0, "translation", "LINEAR", y), (0, "scale", "STEP", scales)];
    file.animation("y", &[0.0, 2.0], &second);
    let mut scene = file.load().unwrap();
    scene.pose(AnimationChoice::One(1), 2.0).unwrap();
    assert_eq!((origin(&scene), scene.bounds().size().x), (Vec3::Y, 2.0));
    // The first animation does not move what the second moved: it is as in the file.
    scene.pose(AnimationChoice::One(0), 2.0).unwrap();
    assert_eq!((origin(&scene), scene.bounds().size().x), (Vec3::X, 1.0));
    scene.pose(AnimationChoice::All, 1.0).unwrap();
    assert_eq!((origin(&scene), scene.bounds().size().x), (Vec3::Y * 0.5, 2.0));

    let error = scene.pose(AnimationChoice::One(2), 0.0).unwrap_err();
    assert!(matches!(&error, SceneError::UnknownAnimation { index: 2, .. }));
    assert!(error.to_string().contains("there are: x, y"), "{error}");
    let error = scene.pose(AnimationChoice::All, f32::NAN).unwrap_err().to_string();
    assert!(error.contains("the time is NaN"), "{error}");
}

#[test]
fn scenes_without_animations_do_not_move() {
    let mut scene = File::triangle().load().unwrap();
    let before = scene.clone();
    scene.pose(AnimationChoice::All, 1.0).unwrap();
    assert_eq!(scene, before);
    let error = scene.pose(AnimationChoice::One(0), 1.0).unwrap_err();
    assert!(error.to_string().contains("there are: none"), "{error}");
}

#[test]
fn unsupported_targets_and_other_scenes_are_left_out() {
    let mut file = File::triangle();
    let other = file.node(json!({ "mesh": 0 }), false);
    let moves = file.vectors(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    file.animation(
        "mixed",
        &[0.0, 1.0],
        &[(other, "translation", "LINEAR", moves), (0, "translation", "LINEAR", moves)],
    );
    file.json["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    let pointer = json!({ "sampler": 0, "target": { "path": "pointer", "extensions": {
        "KHR_animation_pointer": { "pointer": "/materials/0/emissiveFactor" } } } });
    file.json["animations"][0]["channels"].as_array_mut().unwrap().push(pointer);
    // The extension of a light must survive the repair of the JSON.
    file.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "point", "extensions": { "EXT_x": { "y": 1 } } }] } });
    let scene = file.load().unwrap();
    let warnings = scene.notes.warnings.join("\n");
    assert!(warnings.contains("1 channels of animations move no nodes"), "{warnings}");
    assert_eq!(origin(&posed(&file, 1.0)), Vec3::X);
}

#[test]
fn animated_matrices_are_decomposed() {
    let mut file = File::triangle();
    let matrix = Mat4::from_scale_rotation_translation(
        Vec3::new(-1.0, 2.0, 3.0),
        glam::Quat::from_rotation_y(0.4),
        Vec3::new(5.0, 6.0, 7.0),
    );
    file.json["nodes"][0]["matrix"] = json!(matrix.to_cols_array());
    let moves = file.vectors(&[[0.0, 0.0, 0.0]; 2]);
    file.animation("go", &[0.0, 1.0], &[(0, "translation", "LINEAR", moves)]);
    let scene = file.load().unwrap();
    assert!(scene.instances[0].world_from_local.abs_diff_eq(matrix, 1e-5));
    assert!(scene.notes.warnings.iter().any(|w| w.contains("split")), "{:?}", scene.notes);
    assert_eq!(origin(&posed(&file, 0.5)), Vec3::ZERO);
}

/// Animated things are dynamic, others static; a mark can make only the latter dynamic.
#[test]
fn animated_instances_are_dynamic() {
    let mut file = File::triangle();
    let marked = |mark: bool| json!({ "mesh": 0, "extras": { "lumivox": { "static": mark } } });
    let child = file.node(json!({ "mesh": 0, "name": "hand" }), false);
    let arm = file.node(json!({ "children": [child], "name": "arm" }), true);
    file.node(marked(false), true);
    file.node(marked(true), true);
    let mut stubborn = marked(true);
    stubborn["name"] = json!("stubborn");
    let stubborn = file.node(stubborn, true);
    let still: Vec<bool> = file.load().unwrap().instances.iter().map(|i| i.is_static).collect();
    assert_eq!(still, [true, true, false, true, true], "nothing moves yet");

    let moves = file.vectors(&[[1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]);
    let channels =
        [(arm, "translation", "LINEAR", moves), (stubborn, "translation", "LINEAR", moves)];
    file.animation("wave", &[0.0, 1.0], &channels);
    let scene = posed(&file, 0.5);
    let marks: Vec<bool> = scene.instances.iter().map(|i| i.is_static).collect();
    assert_eq!(marks, [true, false, false, true, false]);
    let mut warnings = scene.notes.warnings.iter().filter(|text| text.contains("static"));
    assert!(warnings.next().is_some_and(|text| text.contains("stubborn")), "{:?}", scene.notes);
    assert_eq!(warnings.next(), None);
}
