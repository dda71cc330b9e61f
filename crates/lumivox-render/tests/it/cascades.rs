//! Cascades in pictures: they follow the camera, and what they show is that of a new renderer there.

use glam::{UVec2, Vec3};
use lumivox::{CascadeOptions, TraceSettings, VolumeKind};
use lumivox_render::{Gpu, Picture, RenderSettings, Renderer, View};
use lumivox_scene::{Camera, Scene};

use crate::common::{builtin, gpu, mean_luminance, picture, renderer};

/// Boxes of 1.3 m, 2.6 m and so on in a room of 2 m.
fn settings() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 36),
        frames: 2,
        bounces: 8,
        shadow_resolution: 256,
        volume: VolumeKind::Cascades,
        cascades: CascadeOptions { count: 4, resolution: 32, voxel_size_m: 0.04 },
        view: View::Diffuse,
        ..RenderSettings::default()
    }
}

/// The Cornell box from a place within it.
fn seen_from(scene: &Scene, position: Vec3) -> Camera {
    Camera { position, ..scene.cameras[0].clone() }
}

fn new_picture(gpu: &Gpu, scene: &Scene, camera: &Camera, settings: &RenderSettings) -> Picture {
    let progress = &mut |_| {};
    let new = Renderer::new(gpu, scene, Some(camera), settings.clone(), progress);
    picture(&mut pollster::block_on(new).expect("a renderer"))
}

/// A still picture after the camera has moved is that of a new renderer, to the bit.
#[test]
fn a_moved_camera_sees_what_a_new_renderer_shows() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let settings = settings();
    let mut moved = renderer(&gpu, &scene, settings.clone());
    picture(&mut moved);
    let before = *moved.gi().grid();
    let camera = seen_from(&scene, Vec3::new(0.3, 0.9, 0.9));
    moved.set_camera(camera.clone());
    let shown = picture(&mut moved);
    assert_ne!(before, *moved.gi().grid(), "the boxes have not moved");
    assert!(shown.hdr == new_picture(&gpu, &scene, &camera, &settings).hdr);
}

/// In motion the boxes follow frame by frame, and the light settles at that of a new renderer; on the way it is never far off.
#[test]
fn boxes_follow_a_camera_in_motion() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let trace = TraceSettings { temporal: true, ..TraceSettings::default() };
    let settings = RenderSettings { trace, frames: 1, ..settings() };
    let mut moving = renderer(&gpu, &scene, settings.clone());
    let mut grids = vec![*moving.gi().grid()];
    let to = Vec3::new(0.0, 1.0, 0.8);
    let from = scene.cameras[0].position;
    let mut darkest = f64::MAX;
    let mut brightest = 0.0_f64;
    for step in 1..=40_u8 {
        let share = (f32::from(step) / 20.0).min(1.0);
        moving.set_camera(seen_from(&scene, from.lerp(to, share)));
        let shown = picture(&mut moving);
        if *moving.gi().grid() != grids[grids.len() - 1] {
            grids.push(*moving.gi().grid());
        }
        if step > 20 {
            let luminance = mean_luminance(&shown);
            (darkest, brightest) = (darkest.min(luminance), brightest.max(luminance));
        }
    }
    println!("{} places, {darkest:.4} to {brightest:.4}", grids.len());
    assert!(grids.len() > 4, "the boxes have stayed behind: {}", grids.len());
    let camera = seen_from(&scene, to);
    let still = RenderSettings { frames: 16, ..settings };
    let expected = mean_luminance(&new_picture(&gpu, &scene, &camera, &still));
    println!("of a new one: {expected:.4}");
    assert!(darkest / expected > 0.95 && brightest / expected < 1.05, "not near {expected}");
}
