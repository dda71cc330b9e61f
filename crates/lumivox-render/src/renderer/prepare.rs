//! Preparation for the first frame: the scene and its lights on the GPU.

use lumivox::gpu::{Recorder, Timing};
use lumivox::hooks::Injection;
use lumivox::{
    EnvironmentLight, EnvironmentMap, Geometry, Gi, GiConfig, GiError, Grid, Light, Lights,
    Panorama, Shadow, ShadowLayer, ShadowMaps, VolumeKind, VoxelizeStats, Voxelized,
    dense_volume_bytes,
};
use lumivox_scene::{Bounds, Scene};

use super::RenderProgress;
use crate::passes::near_shadows::NearShadows;
use crate::passes::shadow_maps::ShadowMapPass;
use crate::renderer::estimate::MemoryEstimate;
use crate::scene::{GeometryBudget, GpuScene, Lighting, corners};
use crate::{Gpu, RenderError, RenderSettings};

/// Uploads a scene, unless it is known not to fit.
pub(super) async fn upload(
    gpu: &Gpu,
    scene: &Scene,
    lighting: &Lighting,
    radiance_unit: f32,
    settings: &RenderSettings,
    camera: glam::Vec3,
) -> Result<GpuScene, RenderError> {
    let estimate = MemoryEstimate::new(scene, settings)?;
    estimate.check(gpu)?;
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let budget = settings.geometry_budget.map(|bytes| GeometryBudget { bytes, camera });
    let uploaded = GpuScene::new(gpu, scene, lighting, radiance_unit, budget);
    if scope.pop().await.is_some() {
        return Err(estimate.too_large(gpu));
    }
    gpu.check("uploading the scene")?;
    uploaded
}

/// Compiles all missing pipelines at once, including those for moves if voxels are updated frame by
/// frame.
///
/// # Errors
/// When the device refuses one.
pub(super) async fn compile(
    gpu: &Gpu,
    (gi, geometry): (&Gi, &Geometry),
    settings: &RenderSettings,
    progress: &mut dyn FnMut(RenderProgress),
) -> Result<(), RenderError> {
    let mut report = |done, total| progress(RenderProgress { stage: "compile", done, total });
    let cones = u32::from(settings.view.needs_cones(settings.bounces));
    gi.prepare(
        geometry,
        settings.bounces.max(cones),
        settings.updates_by_frame(),
        &settings.trace,
    )?;
    gpu.pipelines.compile(&mut report).await;
    gpu.save_pipelines();
    gpu.check("compiling pipelines")
}

/// Creates the volume of the voxels and links the library's kernels.
///
/// # Errors
/// [`RenderError::OutOfMemory`] and the library's own errors, when something does not fit.
pub async fn global_illumination(gpu: &Gpu, config: GiConfig) -> Result<Gi, RenderError> {
    // Catches the further errors that commands on a texture raise if it could not be created.
    let followers = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let gi = Gi::with_pipelines(&gpu.pipelines, &gpu.queue, config.clone());
    let is_short = scope.pop().await.is_some();
    let refused = followers.pop().await;
    if is_short {
        let [x, y, z] = config.grid.dimensions.to_array();
        // An octree allocates hardly any memory before it has voxels.
        let (kind, bytes, remedy) = match config.volume {
            VolumeKind::Dense => (
                "a dense volume",
                Some(dense_volume_bytes(&config.grid, config.directionality)),
                "lower the resolution, or store the voxels in an octree (--volume octree)",
            ),
            VolumeKind::Cascades => (
                "cascades",
                Some(dense_volume_bytes(&config.grid, config.directionality)),
                "use fewer or smaller ones (--cascades, --cascade-resolution)",
            ),
            VolumeKind::Octree => {
                ("an octree", None, "free memory for it, or lower the resolution")
            }
        };
        return Err(gpu.out_of_memory(format!("{kind} of {x} x {y} x {z} voxels"), bytes, remedy));
    }
    if let Some(error) = refused {
        let doing = "making the voxels' volume";
        return Err(RenderError::Device { doing, reason: error.to_string() });
    }
    Ok(gi?)
}

/// Voxelizes everything for a new [`Gi`]. If the grid is empty and `may_be_empty`, there are no
/// voxels and no indirect light.
pub(super) async fn voxelize(
    gi: &mut Gi,
    geometry: &Geometry,
    timing: Timing,
    may_be_empty: bool,
) -> Result<Voxelized, GiError> {
    match gi.voxelize(geometry, timing).await {
        Err(GiError::NothingToVoxelize { .. }) if may_be_empty => {
            Ok(Voxelized { stats: VoxelizeStats::default(), times: Vec::new() })
        }
        other => other,
    }
}

/// Uploads the environment's map, if there is one.
pub(super) fn environment_map(
    gpu: &Gpu,
    lighting: &Lighting,
) -> Result<Option<EnvironmentMap>, RenderError> {
    let Some(map) = &lighting.environment.map else { return Ok(None) };
    let panorama = Panorama { width: map.width, height: map.height, rgb: &map.rgb };
    Ok(Some(EnvironmentMap::new(&gpu.device, &gpu.queue, panorama)?))
}

/// Renders shadow maps if there is a pass for them, and binds the lights. Also allocates shadow
/// maps around the camera, and returns the bytes of all maps.
pub(super) fn bind_lights(
    gpu: &Gpu,
    recorder: &mut Recorder,
    shadow_pass: Option<&ShadowMapPass>,
    scene: &GpuScene,
    (lighting, map): (&Lighting, Option<&EnvironmentMap>),
    gi: &Gi,
    settings: &RenderSettings,
) -> (Lights, NearShadows, u64) {
    let shadow_resolution = settings.shadow_resolution;
    let mut lights = lighting.to_gpu(scene.radiance_unit);
    let radiance = lighting.environment.radiance / scene.radiance_unit;
    let rotation_rad = lighting.environment.rotation_rad;
    // The map's brightest parts become lights like lamps, and are the first to get shadow maps.
    let peaks = map.iter().flat_map(|map| map.lights(radiance, rotation_rad));
    lights.splice(0..0, peaks);
    let mut maps: Option<ShadowMaps> = None;
    if let Some(pass) = shadow_pass {
        recorder.stage("shadow maps");
        let sizes = (gi.grid(), shadow_resolution);
        maps = pass.record(gpu, recorder, scene, &mut lights, sizes);
        if let Some(injection) = &settings.injection {
            let texel_m = maps
                .as_ref()
                .map_or(0.0, |maps| largest_texel_m(&lights, &maps.layers, scene.bounds));
            let texel_in_voxels = texel_m / gi.grid().voxel_size_m;
            warn_of_coarse_texels(injection.as_ref(), texel_in_voxels, shadow_resolution);
        }
    }
    let bytes = maps.as_ref().map_or(0, |maps| {
        let size = maps.depth.texture().size();
        4 * u64::from(size.width) * u64::from(size.height) * maps.layers.len() as u64
    });
    let environment = EnvironmentLight { radiance, map, rotation_rad };
    let lights = gi.bind_lights(&lights, environment, maps.as_ref());
    let near = NearShadows::new(gpu, &lights);
    let bytes = bytes + near.bytes();
    (lights, near, bytes)
}

/// The edge of the largest texel of the maps, m: at the far end of the scene, or of a light's
/// range.
fn largest_texel_m(lights: &[Light], layers: &[ShadowLayer], bounds: Bounds) -> f32 {
    let far_end_m = |position: glam::Vec3, range_m: Option<f32>| {
        let distances = corners(bounds).map(|corner| corner.distance(position));
        distances.into_iter().fold(0.0, f32::max).min(range_m.unwrap_or(f32::INFINITY))
    };
    let texel_m = |light: &Light| {
        let Shadow::Map { first_layer } = light.shadow else { return None };
        let texel_size = layers.get(first_layer as usize)?.texel_size;
        Some(light.source.position().map_or(texel_size, |position| {
            texel_size * far_end_m(position, light.source.range_m())
        }))
    };
    lights.iter().filter_map(texel_m).fold(0.0, f32::max)
}

/// Warns if the injection starts from coarse shadow-map texels: with few texels per voxel, its
/// light scatters.
fn warn_of_coarse_texels(injection: &dyn Injection, texel_in_voxels: f32, resolution: u32) {
    let largest = injection.largest_texel_voxels();
    if texel_in_voxels <= largest {
        return;
    }
    let name = injection.name();
    let needed = resolution as f32 * texel_in_voxels / largest;
    tracing::warn!(
        "{name} start from texels of up to {texel_in_voxels:.1} voxels, so that the light of voxels scatters: \
         raise the resolution of the shadow maps (--shadow-resolution) from {resolution} to {}, as far as the \
         GPU allows, or inject directly (--injection direct)",
        (needed.ceil() as u32).checked_next_power_of_two().unwrap_or(u32::MAX)
    );
}

/// Checks the settings, and that the device supports them.
pub(super) fn validate(settings: &RenderSettings, gpu: &Gpu) -> Result<(), RenderError> {
    settings.validate(&gpu.device.limits())?;
    let has_timestamps = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
    if settings.timing == Timing::Timestamps && !has_timestamps {
        return Err(RenderError::Setting {
            name: "timing",
            value: "by timestamps".to_owned(),
            expected: "off or by waiting: this device has no timestamps".to_owned(),
        });
    }
    Ok(())
}

/// Checks that the volume has the selected level.
pub(super) fn validate_level(settings: &RenderSettings, grid: &Grid) -> Result<(), RenderError> {
    let last = settings.last_level(grid);
    if settings.voxel_level <= last {
        return Ok(());
    }
    Err(RenderError::Setting {
        name: "voxel level",
        value: settings.voxel_level.to_string(),
        expected: format!("from 0 to {last}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Mat4, Vec3};
    use lumivox::LightSource;

    #[test]
    fn the_largest_shadow_texel_is_at_the_far_end() {
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(3.0, 0.0, 4.0) };
        let layer = |is_perspective, texel_size| ShadowLayer {
            clip_from_world: Mat4::IDENTITY,
            is_perspective,
            texel_size,
            has_finer: false,
        };
        let layers = [layer(false, 0.1), layer(true, 0.03)];
        let sun = Light {
            source: LightSource::Directional {
                direction: Vec3::NEG_Y,
                irradiance: Vec3::ONE,
                angular_radius_rad: 0.0,
            },
            shadow: Shadow::Map { first_layer: 0 },
        };
        let lamp = |range_m| Light {
            source: LightSource::Point {
                position: Vec3::ZERO,
                intensity: Vec3::ONE,
                radius_m: 0.0,
                range_m,
            },
            shadow: Shadow::Map { first_layer: 1 },
        };
        let largest = |lights: &[Light]| largest_texel_m(lights, &layers, bounds);
        assert!((largest(&[sun]) - 0.1).abs() < 1e-6);
        assert!((largest(&[sun, lamp(None)]) - 0.15).abs() < 1e-6);
        assert!((largest(&[sun, lamp(Some(4.0))]) - 0.12).abs() < 1e-6);
        assert!(largest(&[Light { shadow: Shadow::Cone, ..sun }]) <= 0.0);
    }
}
