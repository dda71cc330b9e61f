//! Tests of the path tracer against closed forms, CPU versions of its parts, and itself.
//!
//! Means are compared within four times the tracer's reported standard error. Seeds are fixed, so
//! results on one device never change; on another, one of 16,000 comparisons fails by chance.

mod bounces;
mod brdf;
mod forms;
mod furnace;
mod guides;
mod rays;
mod robust;
mod same;
mod sampling;
mod sensors;
mod techniques;
mod transparency;

use glam::{Mat4, UVec2, Vec3};
use lumivox_scene::{
    Camera, Filter, Instance, Light, LightKind, Material, Mesh, Sampler, Scene, Texture,
    TextureRef, Wrap,
};

use super::{Features, PathTracer, ReferenceLayers, ReferenceSettings};
use crate::testing::zoo::quad;
use crate::testing::{gpu, zoo};

fn builtin(name: &str) -> Scene {
    lumivox_scene::builtin::scene(name).expect("a built-in scene")
}

fn settings(edge: u32, samples: u32) -> ReferenceSettings {
    ReferenceSettings { size: UVec2::splat(edge), samples, ..ReferenceSettings::default() }
}

/// A tracer of a scene that is first validated, like scenes from files.
fn tracer_with(
    scene: &Scene,
    settings: &ReferenceSettings,
    adjust: impl FnOnce(Features) -> Features,
) -> PathTracer {
    let mut scene = scene.clone();
    scene.validate().expect("a valid scene");
    let gpu = gpu();
    let made = PathTracer::with_features(&gpu, &scene, None, settings.clone(), &[], adjust);
    pollster::block_on(made).expect("a path tracer")
}

fn tracer(scene: &Scene, settings: &ReferenceSettings) -> PathTracer {
    tracer_with(scene, settings, |features| features)
}

fn finish(mut tracer: PathTracer) -> ReferenceLayers {
    let mut go_on = |_| std::ops::ControlFlow::Continue(());
    let done = tracer.render(&mut go_on);
    pollster::block_on(done).expect("a reference");
    let layers = tracer.layers();
    for pixels in [&layers.radiance, &layers.direct, &layers.one_bounce, &layers.full] {
        let is_sound = |pixel: &[f32; 3]| pixel.iter().all(|x| x.is_finite() && *x >= 0.0);
        assert!(pixels.iter().all(is_sound), "a value is negative, infinite or undefined");
    }
    layers
}

fn traced(scene: &Scene, settings: &ReferenceSettings) -> ReferenceLayers {
    finish(tracer(scene, settings))
}

/// A mean over pixels and channels, and an upper bound of its standard error (less if the channels'
/// errors are independent).
#[derive(Clone, Copy, Debug)]
struct Estimate {
    mean: f64,
    error: f64,
}

/// The mean of the channels.
fn mean(color: [f64; 3]) -> f64 {
    color.iter().sum::<f64>() / 3.0
}

/// The relative rounding error of f32 along a path.
const ROUNDING: f64 = 3e-5;

impl Estimate {
    /// The estimate over the pixels with the given indices.
    fn over(
        pixels: impl IntoIterator<Item = usize>,
        values: &[[f32; 3]],
        variances: &[f32],
    ) -> Self {
        let (mut sum, mut variance, mut count) = (0.0, 0.0, 0.0);
        for pixel in pixels {
            sum += mean(values[pixel].map(f64::from));
            variance += f64::from(variances[pixel]);
            count += 1.0;
        }
        assert!(count > 0.0, "no pixel");
        Self { mean: sum / count, error: variance.sqrt() / count }
    }

    fn of(values: &[[f32; 3]], variances: &[f32]) -> Self {
        Self::over(0..values.len(), values, variances)
    }

    fn radiance(layers: &ReferenceLayers) -> Self {
        Self::of(&layers.radiance, &layers.radiance_variance)
    }

    fn full(layers: &ReferenceLayers) -> Self {
        Self::of(&layers.full, &layers.full_variance)
    }

    #[track_caller]
    fn assert_is(self, what: &str, expected: f64) {
        self.assert_near(what, Self { mean: expected, error: 0.0 });
    }

    #[track_caller]
    fn assert_near(self, what: &str, other: Self) {
        let error = self.error.hypot(other.error);
        let tolerance = 4.0 * error + ROUNDING * other.mean.abs();
        let difference = self.mean - other.mean;
        println!(
            "{what}: {:.5}, of {:.5} ({:+.1} sigma of {error:.1e})",
            self.mean,
            other.mean,
            difference / error.max(1e-30)
        );
        assert!(difference.abs() <= tolerance, "{what}: {self:?}, not {other:?}");
    }
}

/// An empty scene, seen from z = 4 with a square field of view of 0.3 radians.
fn stage() -> Scene {
    let mut scene = Scene { name: "stage".to_owned(), ..Scene::default() };
    scene.cameras.push(Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, 0.3));
    scene
}

fn add(scene: &mut Scene, mesh: Mesh, material: Material) {
    scene.meshes.push(mesh);
    scene.materials.push(material);
    scene.instances.push(Instance {
        name: String::new(),
        mesh: scene.meshes.len() - 1,
        material: scene.materials.len() - 1,
        world_from_local: Mat4::IDENTITY,
        ..Instance::default()
    });
}

/// A square that fills the picture of the camera of [`stage`].
fn pane(z: f32) -> Mesh {
    quad(Vec3::Z * z, Vec3::X, Vec3::Y)
}

/// A texture that repeats.
fn texture(scene: &mut Scene, size: UVec2, filter: Filter, rgba8: Vec<u8>) -> TextureRef {
    let sampler =
        Sampler { wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, magnify: filter, minify: filter };
    let (width, height) = (size.x, size.y);
    scene.textures.push(Texture { name: String::new(), width, height, rgba8, sampler });
    TextureRef::new(scene.textures.len() - 1)
}

/// A material that emits `radiance` and reflects nothing.
fn glowing(radiance: Vec3) -> Material {
    Material { emissive: radiance, ..Material::diffuse("glowing", Vec3::ZERO) }
}

fn point_light(position: Vec3, intensity: f32, radius_m: f32) -> Light {
    Light { intensity, position, radius_m, ..Light::default() }
}

fn sun(direction: Vec3, intensity: f32, angular_radius_rad: f32) -> Light {
    Light {
        kind: LightKind::Directional,
        intensity,
        angular_radius_rad,
        direction: direction.normalize(),
        ..Light::default()
    }
}
