//! Shared by the tests that render built-in scenes: the device, a rendering, and means over pixels.

mod device;
pub mod kept;
mod still;
pub mod zoo;

pub use device::{gpu, own_gpu};
use lumivox_render::{Gpu, Picture, RenderSettings, Renderer};
use lumivox_scene::{Camera, Material, MetallicRoughness, Scene, Shading};
pub use still::StillCones;

/// A built-in scene.
///
/// # Panics
/// When there is none of that name.
pub fn builtin(name: &str) -> Scene {
    lumivox_scene::builtin::scene(name).expect("a built-in scene")
}

/// A white metal.
pub fn metal(roughness: f32) -> Material {
    let shading = MetallicRoughness {
        base_color: glam::Vec4::ONE,
        metallic: 1.0,
        roughness,
        ..MetallicRoughness::default()
    };
    Material {
        shading: Shading::MetallicRoughness(shading),
        ..Material::diffuse("metal", glam::Vec3::ONE)
    }
}

/// A built-in scene, turned so that no wall is aligned with the voxels.
pub fn turned(name: &str) -> Scene {
    let mut scene = builtin(name);
    scene.rotate(glam::Vec3::new(0.5, 0.35, 0.4));
    scene
}

/// A renderer of a scene from its first camera.
///
/// # Panics
/// When the device refuses.
pub fn renderer(gpu: &Gpu, scene: &Scene, settings: RenderSettings) -> Renderer {
    pollster::block_on(Renderer::new(gpu, scene, None, settings, &mut |_| {})).expect("a renderer")
}

/// The picture with all frames.
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

/// Mean luminance (Rec. 709) of the pixels filled by surfaces, in the picture's unit.
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
