//! Bevy's own irradiance volume, baked by Lumivox: light without the plugin.

use bevy::asset::RenderAssetUsages;
use bevy::image::{CompressedImageFormats, ImageSampler, ImageType};
use bevy::light::IrradianceVolume;
use bevy::prelude::*;
use lumivox_render::compare::ErrorFigures;
use lumivox_render::irradiance_volume::{self, DIRECTIONS, ProbeGrid};
use lumivox_render::{Gpu, GpuOptions, RenderSettings, Renderer};
use lumivox_scene::Scene;

use crate::common::scene;
use crate::stage::Stage;
use crate::truth;

/// A scene's baked volume, as a file, and its grid.
fn baked(gpu: &Gpu, given: &Scene) -> (Vec<u8>, ProbeGrid) {
    let bounds = given.bounds();
    let grid = ProbeGrid::over(bounds.min - 1e-3, bounds.max + 1e-3, 0.2);
    let probes = grid.probes();
    let points: Vec<Vec3> = probes.iter().flat_map(|&probe| [probe; 6]).collect();
    let normals = DIRECTIONS.repeat(probes.len());
    let settings =
        RenderSettings { size: UVec2::splat(16), resolution: 64, ..RenderSettings::default() };
    let irradiance = pollster::block_on(async {
        let renderer =
            Renderer::new(gpu, given, None, settings, &mut |_| {}).await.expect("a renderer");
        renderer.irradiance(&points, &normals, 64).await.expect("light")
    });
    let sides: Vec<Vec3> = irradiance.iter().map(|light| light.indirect).collect();
    let buried = irradiance_volume::buried(given, &probes);
    let volume = irradiance_volume::IrradianceVolume::new(grid, sides.as_chunks::<6>().0, &buried);
    (volume.to_ktx2().0, grid)
}

/// The stage has no global illumination.
pub fn a_baked_volume_lights_the_cornell_box_of_bevy(stage: &mut Stage) {
    let given = scene::builtin("cornell");
    let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).expect("a device");
    let (file, grid) = baked(&gpu, &given);
    let direct = truth::antialiased(stage);
    let kind = ImageType::Extension("ktx2");
    let formats = CompressedImageFormats::NONE;
    let usage = RenderAssetUsages::RENDER_WORLD;
    let image = Image::from_buffer(&file, kind, formats, false, ImageSampler::linear(), usage);
    let voxels = stage.add(image.expect("an image"));
    let place = Transform::from_translation(grid.center()).with_scale(grid.size);
    let volume = IrradianceVolume { voxels, intensity: 1.0, ..default() };
    stage.app.world_mut().spawn((volume, place));
    stage.frames(4);
    let lit = truth::antialiased(stage);
    lit.save("target/pictures/cornell-baked.png", 2.0);
    let indirect = truth::difference_of(&lit, &direct);
    let truth::Expected { truth, variance, .. } = truth::Expected::of_cornell();
    let error = ErrorFigures::new(truth, Some(variance), &indirect).expect("comparable");
    println!("cornell, baked: {error:.2?}");
    // Probes 20 cm apart blur the light, and miss contact shadows.
    assert!(error.bias_percent.abs() < 10.0 && error.rmse_percent < 30.0, "{error:?}");
}
