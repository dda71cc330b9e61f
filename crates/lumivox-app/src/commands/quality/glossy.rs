//! Reflections by roughness: each sphere of the scene `spheres` is compared with its reference.

use glam::{UVec2, Vec3};
use lumivox::Preset;
use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::reference::{
    PathTracer, ReferenceLayers, ReferenceProgress, ReferenceSettings,
};
use lumivox_render::{Companions, Gpu, PresetChoice, RenderSettings, Renderer, View};
use lumivox_scene::{Camera, Scene, builtin};

use super::cases::middle;
use crate::cli::QualityArgs;
use crate::progress::ProgressDisplay;
use crate::quality::check_wish;

/// The scene with spheres of different roughness.
pub const SCENE: &str = "spheres";
/// The factor by which the pictures' edges are longer than those of other measurements.
const ENLARGED: u32 = 2;
/// The factor by which their references have fewer samples.
const FEWER: u32 = 8;
/// The preset without goals for the spheres.
const FAST: PresetChoice = PresetChoice::Cones(Preset::Fast);

/// The errors of one sphere with one preset.
#[derive(Clone, Debug)]
pub struct Sphere {
    /// The material's name: its kind and roughness.
    pub name: String,
    pub preset: &'static str,
    pub figures: ErrorFigures,
    pub pixels: usize,
}

/// Measures the indirect light on each sphere, reflections included: the picture without direct
/// light.
///
/// # Errors
/// When rendering fails.
pub fn measure(
    args: &QualityArgs,
    gpu: &Gpu,
    progress: &ProgressDisplay,
) -> anyhow::Result<Vec<Sphere>> {
    let scene = builtin::scene(SCENE)?;
    let camera = &scene.cameras[0];
    let size = args.size * ENLARGED;
    let samples = (args.samples / FEWER).max(32);
    let settings = ReferenceSettings { size, samples, ..ReferenceSettings::default() };
    let truth = trace(args, gpu, &scene, camera, settings, progress)?;
    let parts = truth.radiance.iter().zip(&truth.direct);
    let indirect: Vec<Vec3> =
        parts.map(|(all, direct)| Vec3::from(*all) - Vec3::from(*direct)).collect();

    let mut spheres = Vec::new();
    for &preset in args.presets.iter().filter(|preset| **preset != FAST) {
        let settings = RenderSettings {
            size,
            frames: args.frames,
            resolution: middle(&args.resolutions),
            trace: preset.trace(),
            cone_model: Companions::of(preset).cone_model,
            view: View::Indirect,
            ..RenderSettings::default()
        };
        let mut tell =
            |step: lumivox_render::RenderProgress| progress.set("spheres", step.done, step.total);
        let renderer = Renderer::new(gpu, &scene, Some(camera), settings, &mut tell);
        let mut renderer = pollster::block_on(renderer)?;
        let ours = pollster::block_on(renderer.render(&mut tell))?;
        for instance in &scene.instances {
            let name = &scene.materials[instance.material].name;
            if !name.contains("roughness") {
                continue;
            }
            let center = instance.world_from_local.transform_point3(Vec3::ZERO);
            let mesh = &scene.meshes[instance.mesh];
            let radius_m = mesh.positions.iter().map(|p| p.length()).fold(0.0, f32::max);
            let pixels: Vec<usize> = (0..truth.radiance.len())
                .filter(|pixel| {
                    let at = position(camera, size, *pixel, truth.depth_m[*pixel]);
                    truth.coverage[*pixel] > 0.999 && at.distance(center) < 1.02 * radius_m
                })
                .collect();
            if pixels.is_empty() {
                continue;
            }
            let row = UVec2::new(pixels.len() as u32, 1);
            let reference = pixels.iter().map(|pixel| indirect[*pixel].to_array()).collect();
            let ours = pixels.iter().map(|pixel| {
                let [r, g, b, _] = ours.hdr[*pixel];
                [r, g, b]
            });
            let variance: Vec<f32> =
                pixels.iter().map(|pixel| truth.radiance_variance[*pixel]).collect();
            let figures = ErrorFigures::new(
                &LinearPicture { size: row, rgb: reference },
                Some(&variance),
                &LinearPicture { size: row, rgb: ours.collect() },
            )?;
            spheres.push(Sphere {
                name: name.clone(),
                preset: preset.name(),
                figures,
                pixels: pixels.len(),
            });
        }
    }
    Ok(spheres)
}

fn trace(
    args: &QualityArgs,
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: ReferenceSettings,
    progress: &ProgressDisplay,
) -> anyhow::Result<ReferenceLayers> {
    let file = args.cache.as_ref().map(|folder| folder.join("spheres-large.exr"));
    if let Some(file) = file.as_ref().filter(|file| file.exists()) {
        return Ok(ReferenceLayers::read_exr(file)?);
    }
    let mut tracer = pollster::block_on(PathTracer::new(gpu, scene, Some(camera), settings))?;
    let mut hear = |step: ReferenceProgress| {
        progress.set("path sample", step.samples as u32, step.total);
        progress.goes_on()
    };
    pollster::block_on(tracer.render(&mut hear))?;
    check_wish(progress)?;
    let layers = tracer.layers();
    if let Some(file) = file {
        layers.write_exr(&file)?;
    }
    Ok(layers)
}

/// The position at a distance on the ray through the middle of a pixel.
fn position(camera: &Camera, size: UVec2, pixel: usize, distance_m: f32) -> Vec3 {
    let (x, y) = (pixel as u32 % size.x, pixel as u32 / size.x);
    let place = (glam::Vec2::new(x as f32, y as f32) + 0.5) / size.as_vec2() * 2.0 - 1.0;
    let half_height = (0.5 * camera.vertical_fov_rad).tan();
    let aspect = size.x as f32 / size.y as f32;
    let local = Vec3::new(place.x * half_height * aspect, -place.y * half_height, -1.0);
    let direction = camera.world_from_camera().transform_vector3(local).normalize();
    camera.position + direction * distance_m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_lie_where_the_camera_sees_them() {
        let camera = Camera::look_at(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 1.0);
        let size = UVec2::new(4, 2);
        let middle = [1, 2, 5, 6].map(|pixel| position(&camera, size, pixel, 5.0));
        let mean = middle.iter().sum::<Vec3>() / 4.0;
        assert!(mean.truncate().length() < 1e-5, "{mean}");
        // Upper left.
        let corner = position(&camera, size, 0, 5.0);
        assert!(corner.x < 0.0 && corner.y > 0.0, "{corner}");
    }
}
