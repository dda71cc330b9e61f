//! The look among other settings: switching it leaves nothing behind.

use std::sync::Arc;

use glam::{UVec2, Vec3};
use lumivox_render::look::Look;
use lumivox_render::{Exposure, RenderSettings, View};
use lumivox_vxct::{VxctSettings, vxct_display};

use crate::common::{builtin, gpu, picture, renderer};

fn vxct(change: impl FnOnce(&mut VxctSettings)) -> Arc<dyn Look> {
    let mut vxct = VxctSettings::for_resolution(32);
    change(&mut vxct);
    Arc::new(vxct)
}

/// After any settings, picture and memory equal those of a new renderer.
#[test]
#[ignore = "slow: over three seconds"]
fn switching_the_look_matches_a_fresh_renderer() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let mut asked = RenderSettings {
        size: UVec2::new(48, 32),
        resolution: 32,
        frames: 2,
        bounces: 2,
        shadow_resolution: 128,
        ..RenderSettings::default()
    };
    let mut changing = renderer(&gpu, &scene, asked.clone());
    let mut before = picture(&mut changing);
    let changes: [fn(&mut RenderSettings); 9] = [
        |s| s.look = Some(vxct(|_| {})),
        |s| s.look = Some(vxct(|vxct| vxct.diffuse = false)),
        |s| s.size = UVec2::new(40, 24),
        |s| s.resolution = 48,
        |s| s.view = View::Voxels,
        |s| s.voxel_level = 2,
        |s| s.look = None,
        // A new volume, without the cells that the old one keeps.
        |s| (s.view, s.voxel_level, s.resolution) = (View::Final, 0, 40),
        |s| (s.look, s.bounces) = (Some(vxct(|_| {})), 0),
    ];
    for (step, change) in changes.into_iter().enumerate() {
        change(&mut asked);
        pollster::block_on(changing.set_settings(asked.clone(), &mut |_| {})).expect("in range");
        let seen = picture(&mut changing);
        let mut fresh = renderer(&gpu, &scene, asked.clone());
        assert!(seen == picture(&mut fresh), "step {step}: something of before is left");
        assert_eq!(changing.memory(), fresh.memory(), "step {step}");
        assert!(seen != before, "step {step} changed nothing");
        before = seen;
    }
    // Other lights, other places, other materials.
    let mut other = scene.clone();
    other.lights[0].color = Vec3::new(1.0, 0.5, 0.2);
    pollster::block_on(changing.set_lights(&other, &mut |_| {})).expect("lights");
    assert!(picture(&mut changing) == picture(&mut renderer(&gpu, &other, asked.clone())));
    let instance = other.instances.last_mut().expect("an instance");
    instance.world_from_local *= glam::Mat4::from_scale(Vec3::splat(0.8));
    pollster::block_on(changing.set_scene(&other, &mut |_| {})).expect("places");
    assert!(picture(&mut changing) == picture(&mut renderer(&gpu, &other, asked.clone())));
    other.materials[0].emissive = Vec3::splat(2.0);
    pollster::block_on(changing.set_materials(&other, &mut |_| {})).expect("materials");
    assert!(picture(&mut changing) == picture(&mut renderer(&gpu, &other, asked.clone())));

    asked.look = None;
    pollster::block_on(changing.set_settings(asked.clone(), &mut |_| {})).expect("valid");
    assert!(picture(&mut changing) == picture(&mut renderer(&gpu, &other, asked.clone())));
    asked.look = Some(vxct(|vxct| vxct.shadow_strength = 99.0));
    assert!(pollster::block_on(changing.set_settings(asked, &mut |_| {})).is_err());
}

#[test]
fn explicit_exposure_survives_a_scene_change() {
    let [first, second] =
        ["spheres", "cornell"].map(|name| lumivox_scene::builtin::scene(name).unwrap());
    assert_ne!(vxct_display(&first), vxct_display(&second), "or else nothing is tested");
    let mut settings = RenderSettings::default();
    settings.show_other(None, &second);
    assert_eq!(settings, RenderSettings::default(), "the physical look knows no white of a scene");

    let asked = Exposure::Stops(-3.25);
    settings = settings.with_preset(lumivox_vxct::PRESET, Some(&first));
    let shown = vxct_display(&second);
    settings.show_other(Some(&first), &second);
    assert_eq!((settings.exposure, settings.tone_map), (shown.exposure, shown.tone_map));
    settings.exposure = asked;
    settings.show_other(Some(&second), &first);
    assert_eq!(settings.exposure, asked);
}
