//! What the tests that render built-in scenes share: the device, a rendering, and means over pixels.

// Every test program compiles this module and uses its own part of it.
#![allow(dead_code)]

pub mod zoo;

use lumivox_render::{Gpu, GpuOptions, Picture, RenderSettings, Renderer};
use lumivox_scene::{Camera, Scene};

/// A device with WebGPU's default limits, so that what passes here runs in a browser.
///
/// # Panics
/// When there is no adapter.
pub fn gpu() -> Gpu {
    let options = GpuOptions { portable: true, ..GpuOptions::default() };
    pollster::block_on(Gpu::new(&options))
        .expect("a GPU adapter: run the tests through ./test, which installs a software driver")
}

/// A built-in scene.
///
/// # Panics
/// When there is none of that name.
pub fn builtin(name: &str) -> Scene {
    lumivox_scene::builtin::scene(name).expect("a built-in scene")
}

/// A scene, lit and ready to be rendered from its first camera.
///
/// # Panics
/// When the device refuses.
pub fn renderer(gpu: &Gpu, scene: &Scene, settings: RenderSettings) -> Renderer {
    pollster::block_on(Renderer::new(gpu, scene, None, settings, &mut |_| {})).expect("a renderer")
}

/// The picture of all frames.
///
/// # Panics
/// When the device refuses.
pub fn picture(renderer: &mut Renderer) -> Picture {
    pollster::block_on(renderer.render(&mut |_| {})).expect("a picture")
}

/// The camera of that name.
///
/// # Panics
/// When the scene has none.
pub fn camera(scene: &Scene, name: &str) -> Camera {
    scene.cameras.iter().find(|camera| camera.name == name).expect("a camera of that name").clone()
}

/// Mean luminance (Rec. 709) of the pixels that a surface fills, in the picture's unit.
///
/// # Panics
/// When there is no such pixel, or a value is not finite.
pub fn mean_luminance(picture: &Picture) -> f64 {
    let filled = picture.hdr.iter().filter(|[.., surface]| *surface >= 1.0);
    let luminance: Vec<f64> = filled
        .map(|&[r, g, b, _]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b))
        .collect();
    assert!(luminance.iter().all(|value| value.is_finite()), "a value is not finite");
    assert!(!luminance.is_empty(), "no pixel shows a surface");
    luminance.iter().sum::<f64>() / luminance.len() as f64
}
