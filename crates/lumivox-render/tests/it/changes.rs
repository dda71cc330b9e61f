//! Tests that after changes a renderer's picture is bit-identical to a new renderer's.

#![allow(clippy::float_cmp)] // Equal to the bit is the claim.

use std::sync::Arc;

use glam::{Mat4, UVec2, Vec3};
use lumivox::gpu::Timing;
use lumivox::{Directionality, Preset, TraceSettings, VolumeKind};
use lumivox_render::{Exposure, RenderSettings, Renderer, ShadowMethod, ToneMap, View};
use lumivox_scene::{LightKind, Scene, Shading};

use crate::common::{StillCones, builtin, gpu, picture, renderer};

fn settings() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(40, 24),
        resolution: 32,
        frames: 2,
        bounces: 2,
        shadow_resolution: 128,
        ..RenderSettings::default()
    }
}

fn set(renderer: &mut Renderer, settings: &RenderSettings) {
    pollster::block_on(renderer.set_settings(settings.clone(), &mut |_| {})).expect("in range");
}

#[test]
#[ignore = "slow: over three seconds"]
fn settings_may_change_in_any_order() {
    let gpu = gpu();
    let mut scene = builtin("cornell");
    // A sun whose shadows by cones need the voxels' opacities before any light.
    scene.lights.push(lumivox_scene::Light {
        kind: LightKind::Directional,
        intensity: 100.0,
        angular_radius_rad: 0.1,
        direction: Vec3::new(-0.3, -1.0, -0.6).normalize(),
        ..lumivox_scene::Light::default()
    });
    let mut changing = renderer(&gpu, &scene, settings());
    let mut before = picture(&mut changing);
    let octree = VolumeKind::Octree;
    let changes: [fn(&mut RenderSettings, VolumeKind); 16] = [
        |s, _| s.shadow_resolution = 48,
        |s, _| s.resolution = 48,
        |s, _| s.size = UVec2::new(33, 21),
        // Marching cones read the cells, unlike rays.
        |s, _| s.cone_model = Some(Arc::new(StillCones { share: 1.0 })),
        |s, octree| s.volume = octree,
        |s, _| s.directionality = Directionality::Isotropic,
        |s, _| s.cone_model = Some(Arc::new(StillCones { share: 0.5 })),
        |s, _| s.trace = TraceSettings::preset(Preset::Fast),
        |s, _| s.bounces = 1,
        |s, _| s.shadows = ShadowMethod::Cone,
        |s, _| s.view = View::Nodes,
        |s, _| (s.view, s.voxel_level) = (View::Lit, 1),
        |s, _| s.voxel_level = 2,
        |s, _| s.grid_offset = Vec3::splat(0.5),
        |s, _| *s = RenderSettings { frames: 3, ..settings() },
        |s, _| s.bounces = 0,
    ];
    let mut asked = settings();
    for (step, change) in changes.into_iter().enumerate() {
        change(&mut asked, octree);
        set(&mut changing, &asked);
        assert_eq!(*changing.settings(), asked);
        let seen = picture(&mut changing);
        let mut fresh = renderer(&gpu, &scene, asked.clone());
        assert!(seen == picture(&mut fresh), "step {step}: something of before is left");
        assert_eq!(changing.memory(), fresh.memory(), "step {step}");
        assert!(seen != before, "step {step} changed nothing");
        before = seen;
    }
}

/// Changes that do not affect frames keep them; other changes restart the mean.
#[test]
fn frames_restart_only_if_a_change_affects_them() {
    let gpu = gpu();
    let mut renderer = renderer(&gpu, &builtin("cornell"), settings());
    let auto = picture(&mut renderer);
    let shown =
        RenderSettings { exposure: Exposure::Stops(-6.0), tone_map: ToneMap::Aces, ..settings() };
    set(&mut renderer, &shown);
    assert_eq!(renderer.frame_count(), 2);
    let darker = picture(&mut renderer);
    assert_eq!(darker.hdr, auto.hdr);
    assert_ne!(darker.ldr, auto.ldr);
    set(&mut renderer, &RenderSettings { bounces: 3, ..shown });
    assert_eq!(renderer.frame_count(), 0);
}

/// Frames of a moving camera have fewer samples; a picture at rest must not include them.
#[test]
fn a_picture_after_motion_matches_a_fresh_renderer() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let mut moving = renderer(&gpu, &scene, settings());
    let first_frame = |renderer: &mut Renderer| {
        pollster::block_on(renderer.render_frame()).expect("a frame");
        pollster::block_on(renderer.finish()).expect("a picture").hdr
    };
    let mut frames = Vec::new();
    for _ in 0..3 {
        let mut camera = moving.camera().clone();
        camera.position.x += 0.1;
        moving.set_camera(camera);
        frames.push(first_frame(&mut moving));
    }
    let mut at_rest = renderer(&gpu, &scene, settings());
    at_rest.set_camera(moving.camera().clone());
    assert!(frames[2] != first_frame(&mut at_rest), "it has as many samples as at rest");
    assert!(picture(&mut moving).hdr == picture(&mut at_rest).hdr);
}

#[test]
fn refused_settings_change_nothing() {
    let gpu = gpu();
    let mut renderer = renderer(&gpu, &builtin("cornell"), settings());
    let before = picture(&mut renderer);
    let refused = [
        RenderSettings { bounces: 99, ..settings() },
        RenderSettings { resolution: 33, ..settings() },
        RenderSettings { voxel_level: 9, ..settings() },
        RenderSettings { view: View::Bricks, ..settings() },
        RenderSettings { view: View::Lod, volume_memory: Some(1), ..settings() },
    ];
    for settings_refused in refused {
        let refused =
            pollster::block_on(renderer.set_settings(settings_refused.clone(), &mut |_| {}));
        refused.expect_err("refused");
        assert_eq!(*renderer.settings(), settings());
        assert!(picture(&mut renderer) == before);
    }
    renderer.set_camera(renderer.camera().clone());
    assert!(picture(&mut renderer) == before, "it still renders the same");
}

/// Cornell with a lamp of another colour and position, and one more lamp.
fn other_light(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.lights.truncate(1);
    scene.environment.radiance = Vec3::new(0.5, 1.0, 3.0);
    let mut lamp = lumivox_scene::Light {
        intensity: 30.0,
        color: Vec3::new(1.0, 0.5, 0.25),
        position: Vec3::new(0.1, 0.3, 0.2),
        ..lumivox_scene::Light::default()
    };
    scene.lights.push(lamp.clone());
    lamp.position.x = -0.3;
    scene.lights.push(lamp);
    scene
}

#[test]
#[ignore = "slow: over three seconds"]
fn changed_lights_and_materials_match_a_fresh_renderer() {
    let gpu = gpu();
    let rest = builtin("cornell");
    let lit = other_light(&rest);
    let mut painted = rest.clone();
    for (number, material) in painted.materials.iter_mut().enumerate() {
        if let Shading::MetallicRoughness(shading) = &mut material.shading {
            shading.base_color.x = 0.2 * number as f32;
            shading.roughness = 0.4;
            shading.specular = 1.0;
        }
    }
    painted.materials[0].double_sided ^= true;
    let mut bright = rest.clone();
    for material in &mut bright.materials {
        // Bright enough for another unit of radiance.
        material.emissive *= 1e4;
    }
    for light in &mut bright.lights {
        light.color *= 1e4;
    }
    let mut changing = renderer(&gpu, &rest, settings());
    let first = picture(&mut changing);
    for (scene, is_light) in [(&lit, true), (&rest, true), (&painted, false), (&bright, false)] {
        if is_light {
            pollster::block_on(changing.set_lights(scene, &mut |_| {})).expect("lights");
        } else {
            pollster::block_on(changing.set_materials(scene, &mut |_| {})).expect("materials");
        }
        let seen = picture(&mut changing);
        assert!(seen == picture(&mut renderer(&gpu, scene, settings())), "something is left");
        assert_eq!(seen == first, *scene == rest);
    }
}

/// Objects may move before their voxels, until `revoxelize`.
#[test]
#[ignore = "slow: over three seconds"]
fn objects_can_move_before_their_voxels() {
    let gpu = gpu();
    let rest = builtin("cornell");
    let mut moved = rest.clone();
    let last = moved.instances.len() - 1;
    let aside = Mat4::from_translation(Vec3::new(-0.1, 0.0, 0.05));
    moved.instances[last].world_from_local = aside * moved.instances[last].world_from_local;
    let see = |view| RenderSettings { view, ..settings() };

    let mut ahead = renderer(&gpu, &rest, see(View::Voxels));
    let old_voxels = picture(&mut ahead);
    pollster::block_on(ahead.place(&moved)).expect("the same scene");
    assert!(picture(&mut ahead) == old_voxels, "the voxels stay");
    set(&mut ahead, &see(View::Direct));
    let direct = picture(&mut ahead);
    assert!(direct == picture(&mut renderer(&gpu, &moved, see(View::Direct))), "surfaces move");

    assert!(ahead.has_stale_voxels());
    pollster::block_on(ahead.revoxelize(&mut |_| {})).expect("voxels");
    assert!(!ahead.has_stale_voxels());
    assert_eq!(ahead.frame_count(), 0, "what has changed is seen");
    set(&mut ahead, &see(View::Voxels));
    assert!(picture(&mut ahead) == picture(&mut renderer(&gpu, &moved, see(View::Voxels))));
    pollster::block_on(ahead.revoxelize(&mut |_| {})).expect("voxels");
    assert_eq!(ahead.frame_count(), 2, "what stays keeps its frames");
}

/// Without bounces, no cones are traced; the results of another view's cones must not be shown.
#[test]
#[ignore = "slow: over three seconds"]
fn traces_of_another_view_do_not_show() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let timing = Timing::SubmitAndWait;
    let see = |view| RenderSettings { view, bounces: 0, timing, ..settings() };
    let traces = |renderer: &Renderer| renderer.times().iter().any(|time| time.stage == "trace");
    let mut seen = renderer(&gpu, &scene, see(View::Occlusion));
    picture(&mut seen);
    assert!(traces(&seen));
    seen.set_view(View::Final, 0).expect("a view");
    let mut fresh = renderer(&gpu, &scene, see(View::Final));
    assert!(picture(&mut seen) == picture(&mut fresh));
    assert!(!traces(&fresh));
}

/// A scene that defines its grid may be empty, or outside the grid.
#[test]
fn a_scene_outside_its_own_grid_still_renders() {
    let gpu = gpu();
    let mut scene = builtin("cornell");
    scene.grid_bounds = Some(scene.bounds());
    let inside = picture(&mut renderer(&gpu, &scene, settings()));
    let far = Mat4::from_translation(Vec3::Z * 50.0);
    for instance in &mut scene.instances {
        instance.world_from_local = far * instance.world_from_local;
    }
    let mut camera = scene.cameras[0].clone();
    camera.position.z += 50.0;
    let octree = VolumeKind::Octree;
    for volume in [VolumeKind::Dense, octree] {
        let settings = RenderSettings { volume, ..settings() };
        let mut outside = renderer(&gpu, &scene, settings.clone());
        assert_eq!(outside.voxel_stats().voxels, 0);
        outside.set_camera(camera.clone());
        let seen = picture(&mut outside);
        assert!(seen.hdr.iter().any(|pixel| pixel[3] > 0.0), "surfaces are drawn");
        assert_ne!(seen, inside, "without indirect light");
        let mut empty = scene.clone();
        empty.instances.clear();
        let nothing = picture(&mut renderer(&gpu, &empty, settings));
        assert!(nothing.hdr.iter().all(|pixel| pixel[3] == 0.0));
    }
    scene.grid_bounds = None;
    scene.instances.clear();
    let ignore = &mut |_| {};
    let refused = Renderer::new(&gpu, &scene, None, settings(), ignore);
    assert!(pollster::block_on(refused).is_err(), "nothing says where the grid is");
}

/// Views beside the picture equal those of separate renderers, also after a change, and do not
/// affect the picture.
#[test]
#[ignore = "slow: over three seconds"]
fn side_views_match_those_of_separate_renderers() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let views = [View::Diffuse, View::Cost];
    let mut alone = renderer(&gpu, &scene, settings());
    let with = RenderSettings { beside: views.to_vec(), ..settings() };
    let mut together = renderer(&gpu, &scene, with.clone());
    let mut single =
        views.map(|view| renderer(&gpu, &scene, RenderSettings { view, ..settings() }));
    let beside = |together: &Renderer, view| {
        pollster::block_on(together.read_beside(view)).expect("a device")
    };
    assert_eq!(beside(&together, View::Diffuse), None, "there is no frame yet");
    for x in [0.0, 0.3] {
        let camera = lumivox_scene::Camera {
            position: scene.cameras[0].position + Vec3::X * x,
            ..scene.cameras[0].clone()
        };
        alone.set_camera(camera.clone());
        together.set_camera(camera.clone());
        assert_eq!(picture(&mut alone).hdr, picture(&mut together).hdr);
        for (view, single) in views.iter().zip(&mut single) {
            single.set_camera(camera.clone());
            assert_eq!(beside(&together, *view).as_ref(), Some(&picture(single).hdr), "{view:?}");
        }
    }
    assert_eq!(beside(&together, View::Normal), None, "it was not asked for");
    // Another size: textures are created again.
    set(&mut together, &RenderSettings { size: UVec2::new(16, 16), ..with });
    let _ = picture(&mut together);
    assert_eq!(beside(&together, View::Diffuse).map(|pixels| pixels.len()), Some(256));
    set(&mut together, &settings());
    assert_eq!(together.memory(), alone.memory());
}
