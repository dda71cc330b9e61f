//! Undo and redo.

use glam::{UVec2, Vec3};
use lumivox::{Preset, VolumeKind};
use pollster::block_on;

use super::tests::{explorer, fresh, opened, picture, small};
use super::*;

type Change<'a> = Box<dyn Fn(&mut Explorer) + 'a>;

fn undone(explorer: &mut Explorer) -> String {
    explorer.undo().unwrap()
}

/// Each kind of change is undone and redone, and restores the picture to the bit.
#[test]
#[ignore = "slow: over three seconds"]
fn undo_and_redo_cover_every_kind_of_change() {
    let mut explorer = explorer("cornell");
    let last = explorer.object_names().len() - 1;
    let name = explorer.object_names()[last].clone();
    let material = explorer.material_names()[0].clone();
    let high = PresetChoice::Cones(Preset::High);
    let changes: Vec<(String, Change<'_>)> = vec![
        (
            format!("object \"{name}\""),
            Box::new(|e| e.transform(last, glam::Mat4::from_translation(Vec3::X * 0.1))),
        ),
        (format!("object \"{name}\""), Box::new(|e| e.set_hidden(last, true))),
        (
            format!("material \"{material}\""),
            Box::new(|e| {
                assert!(e.edit_material(0, |material| material.emissive = Vec3::splat(3.0)));
            }),
        ),
        (
            "surroundings".to_owned(),
            Box::new(|e| e.edit_lights(|s| s.environment.radiance = Vec3::ONE)),
        ),
        (
            "lights".to_owned(),
            Box::new(|e| e.edit_lights(|s| s.lights.push(lumivox_scene::Light::default()))),
        ),
        (
            "light \"light\"".to_owned(),
            Box::new(|e| e.edit_lights(|s| s.lights.last_mut().unwrap().color = Vec3::X)),
        ),
        (
            "bounces".to_owned(),
            Box::new(|e| {
                let settings = RenderSettings { bounces: 2, ..e.settings().clone() };
                e.choose_settings(settings, e.preset()).unwrap();
            }),
        ),
        (
            "preset high".to_owned(),
            Box::new(move |e| e.choose_settings(e.settings_of(high), high).unwrap()),
        ),
    ];
    let state = |e: &Explorer| {
        let scene = e.scene().unwrap();
        let shown = (scene.instances.clone(), scene.materials.clone(), scene.lights.clone());
        (shown, scene.environment.clone(), e.settings().clone(), e.preset())
    };
    picture(&mut explorer);
    let first = state(&explorer);
    let mut states = Vec::new();
    for (_, change) in &changes {
        change(&mut explorer);
        explorer.end_gesture();
        states.push(state(&explorer));
    }
    for (number, (words, _)) in changes.iter().enumerate().rev() {
        assert_eq!(state(&explorer), states[number]);
        assert_eq!(explorer.undoable(), Some(words.as_str()));
        assert_eq!(undone(&mut explorer), *words);
    }
    assert_eq!(state(&explorer), first);
    assert!(picture(&mut explorer) == fresh(&explorer));
    assert_eq!(explorer.undo().unwrap_err().to_string(), "there is nothing to undo");
    for (number, (words, _)) in changes.iter().enumerate() {
        assert_eq!(explorer.redo().unwrap(), *words);
        assert_eq!(state(&explorer), states[number]);
    }
    assert!(picture(&mut explorer) == fresh(&explorer));
    assert_eq!(explorer.redo().unwrap_err().to_string(), "there is nothing to redo");
    // Changes of the camera or the window's size, and changes to the current value, are not steps.
    explorer.set_camera(Camera::default());
    explorer
        .set_settings(RenderSettings { size: UVec2::new(8, 8), ..explorer.settings().clone() })
        .unwrap();
    explorer.set_hidden(last, true);
    assert_eq!(undone(&mut explorer), "preset high");
    assert_eq!(
        (explorer.camera(), explorer.settings().size),
        (&Camera::default(), UVec2::new(8, 8))
    );
}

/// A drag is one step, the next drag of the same thing another, and a change in between ends it.
#[test]
fn a_gesture_is_one_undo_step() {
    let mut explorer = explorer("cornell");
    let bright = |e: &mut Explorer, value: f32| {
        e.edit_material(0, |material| material.emissive = Vec3::splat(value));
        e.note_change();
    };
    let seen = |e: &Explorer| e.scene().unwrap().materials[0].emissive.x;
    let first = seen(&explorer);
    (1..=5_u8).for_each(|value| bright(&mut explorer, value.into()));
    explorer.end_gesture();
    bright(&mut explorer, 6.0);
    explorer.set_hidden(0, true);
    explorer.note_change();
    bright(&mut explorer, 7.0);
    let mut values = vec![seen(&explorer)];
    while explorer.undo().is_ok() {
        values.push(seen(&explorer));
    }
    assert_eq!(values, [7.0, 6.0, 6.0, 5.0, first]);
    explorer.redo().unwrap();
    assert_eq!(seen(&explorer), 5.0);
    // A new change replaces the steps that could be redone.
    bright(&mut explorer, 8.0);
    assert!(explorer.redo().is_err());
    undone(&mut explorer);
    assert_eq!(seen(&explorer), 5.0);
}

#[test]
fn refused_settings_leave_no_undo_step() {
    let mut explorer = explorer("cornell");
    picture(&mut explorer);
    explorer.set_hidden(0, true);
    explorer.end_gesture();
    let volume = VolumeKind::Octree;
    let ask =
        |e: &Explorer| RenderSettings { volume, volume_memory: Some(1), ..e.settings().clone() };
    let (asked, preset) = (ask(&explorer), explorer.preset());
    assert!(block_on(explorer.try_settings(asked, preset, &mut |_| {})).is_err());
    explorer.end_gesture();
    // The next frame reports the refusal.
    let asked = ask(&explorer);
    explorer.choose_settings(asked, preset).unwrap();
    explorer.end_gesture();
    assert!(block_on(explorer.frame(&mut |_| {})).is_err());
    assert!(explorer.choose_settings(RenderSettings { bounces: 99, ..small() }, preset).is_err());
    assert!(undone(&mut explorer).starts_with("object"));
    assert!(explorer.undo().is_err());
}

#[test]
fn undo_history_is_bounded_and_cleared_with_the_scene() {
    let mut explorer = explorer("cornell");
    for number in 0..150_u8 {
        explorer.edit_material(0, |material| material.emissive = Vec3::splat(number.into()));
        explorer.end_gesture();
    }
    let steps = std::iter::repeat_with(|| explorer.undo()).take_while(Result::is_ok).count();
    assert_eq!(steps, 100);
    explorer.redo().unwrap();
    explorer.open(opened("cornell"));
    assert!(explorer.undo().is_err() && explorer.redo().is_err());
}

/// A grid that widened for an object stays wide when the object returns.
#[test]
fn undo_does_not_shrink_a_widened_grid() {
    let mut explorer = explorer("cornell");
    picture(&mut explorer);
    let last = explorer.object_names().len() - 1;
    explorer.transform(last, glam::Mat4::from_translation(Vec3::X * 3.0));
    let settings = RenderSettings { bounces: 2, ..explorer.settings().clone() };
    explorer.choose_settings(settings, explorer.preset()).unwrap();
    explorer.end_gesture();
    picture(&mut explorer);
    let wide = explorer.settings().grid_bounds;
    undone(&mut explorer);
    picture(&mut explorer);
    assert_eq!((explorer.settings().grid_bounds, explorer.settings().bounces), (wide, 1));
    assert!(explorer.has_fitted_grid() && explorer.undo().is_err());
    // Undo does restore a box that the user set.
    let own = Some(Bounds { min: Vec3::ZERO, max: Vec3::ONE });
    let settings = RenderSettings { grid_bounds: own, ..explorer.settings().clone() };
    explorer.choose_settings(settings, explorer.preset()).unwrap();
    explorer.set_grid_widens(false);
    explorer.end_gesture();
    assert_eq!(undone(&mut explorer), "grid_bounds");
    assert_eq!(explorer.settings().grid_bounds, wide);
    assert!(explorer.has_fitted_grid());
    explorer.redo().unwrap();
    assert_eq!(explorer.settings().grid_bounds, own);
    assert!(!explorer.has_fitted_grid());
}
