//! Lightmaps against closed forms and the path tracer.

use glam::{UVec2, Vec2, Vec3};
use lumivox_render::lightmap::{LightmapPlan, Resolution};
use lumivox_render::reference::{LightMeter, MeterSettings, Sensor};
use lumivox_render::{RenderSettings, Renderer};
use lumivox_scene::Scene;

use crate::common::{builtin, gpu};

/// A built-in scene of rectangles, each with its own chart in one common square.
fn charted(name: &str) -> Scene {
    let mut scene = builtin(name);
    let quads: usize = scene.meshes.iter().map(|mesh| mesh.positions.len() / 4).sum();
    let side = (quads as f32).sqrt().ceil() as usize;
    let mut quad = 0;
    for mesh in &mut scene.meshes {
        for corner in 0..mesh.positions.len() {
            let cell = Vec2::new((quad % side) as f32, (quad / side) as f32);
            mesh.uvs1.push((cell + 0.08 + 0.84 * mesh.uvs[corner]) / side as f32);
            quad += usize::from(corner % 4 == 3);
        }
    }
    scene
}

fn by_cones(scene: &Scene, plan: &LightmapPlan, resolution: u32, frames: u32) -> Vec<Vec3> {
    let settings =
        RenderSettings { size: UVec2::splat(16), resolution, ..RenderSettings::default() };
    let (points, normals): (Vec<_>, Vec<_>) = plan.places().iter().copied().unzip();
    let light = pollster::block_on(async {
        let renderer = Renderer::new(&gpu(), scene, None, settings, &mut |_| {}).await?;
        renderer.irradiance(&points, &normals, frames).await
    });
    light.expect("light").iter().map(|light| light.indirect).collect()
}

/// The indirect light, and the mean square of the standard error of all light, lux.
fn by_paths(scene: &Scene, plan: &LightmapPlan, samples: u32, seed: u32) -> (Vec<Vec3>, f64) {
    let places = plan.places().iter();
    let sensors: Vec<Sensor> =
        places.map(|&(at, normal)| Sensor::Irradiance { at, normal }).collect();
    let settings = MeterSettings { samples, seed, ..MeterSettings::default() };
    let meter = pollster::block_on(LightMeter::new(&gpu(), scene, &sensors, settings));
    let mut meter = meter.expect("a meter");
    pollster::block_on(meter.measure(&mut |_| std::ops::ControlFlow::Continue(()))).expect("light");
    let readings = meter.readings();
    let noise = readings.iter().map(|light| f64::from(light.standard_error).powi(2)).sum::<f64>();
    let indirect = readings.iter().map(|light| Vec3::from(light.total) - Vec3::from(light.direct));
    (indirect.collect(), noise / readings.len() as f64)
}

fn gray(light: Vec3) -> f64 {
    f64::from(light.dot(Vec3::new(0.2126, 0.7152, 0.0722)))
}

/// Bias and RMSE, in per cent of the true mean, without the truth's noise.
fn errors(light: &[Vec3], truth: &[Vec3], noise: f64) -> [f64; 2] {
    let (mut sum, mut bias, mut squares) = (0.0, 0.0, 0.0);
    for (light, truth) in light.iter().zip(truth) {
        let difference = gray(*light) - gray(*truth);
        sum += gray(*truth);
        bias += difference;
        squares += difference * difference;
    }
    let count = truth.len() as f64;
    let rmse = (squares / count - noise).max(0.0).sqrt();
    [100.0 * bias / sum, 100.0 * rmse / (sum / count)]
}

/// In the furnace the radiance is 2 cd/m² everywhere, which is irradiance divided by pi.
#[test]
fn every_texel_of_the_furnace_has_its_light() {
    let scene = charted("furnace");
    let plan = LightmapPlan::new(&scene, 1, Resolution::Texels(16)).expect("charts");
    assert_eq!((plan.buried(), plan.is_packed()), (0, false));
    let map = plan.map(&by_paths(&scene, &plan, 256, 0).0);
    // The gaps between charts are filled, too.
    for (texel, light) in map.light().iter().enumerate() {
        assert!((light / 2.0 - 1.0).abs().max_element() < 0.1, "{light} at {texel}");
    }
}

/// The case of `docs/bake.md`, which includes the truth's noise.
#[test]
#[ignore = "slow: over three seconds"]
fn a_lightmap_of_the_cornell_box_is_close_to_the_path_tracer() {
    let scene = charted("cornell");
    let plan = LightmapPlan::new(&scene, 1, Resolution::Texels(32)).expect("charts");
    let (truth, noise) = by_paths(&scene, &plan, 1024, 1);
    for (name, light, bias, rmse) in [
        ("cones, 64 voxels", by_cones(&scene, &plan, 64, 64), 3.0, 10.0),
        ("paths, 256 samples", by_paths(&scene, &plan, 256, 0).0, 2.0, 10.0),
    ] {
        let [found_bias, found_rmse] = errors(&light, &truth, noise);
        println!("{name}: bias {found_bias:+.1} %, RMSE {found_rmse:.1} %");
        assert!(found_bias.abs() < bias && found_rmse < rmse, "{name}");
    }
}
