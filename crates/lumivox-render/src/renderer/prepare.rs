//! What a renderer does before its first frame: the scene and its lights on the GPU.

use lumivox::gpu::Recorder;
use lumivox::{
    EnvironmentLight, EnvironmentMap, Gi, GiConfig, Lights, Panorama, ShadowMaps,
    dense_volume_bytes,
};
use lumivox_scene::Scene;

use crate::estimate::MemoryEstimate;
use crate::shadow_maps::ShadowMapPass;
use crate::upload::{GpuScene, Lighting};
use crate::{Gpu, RenderError, RenderSettings};

/// Uploads a scene, if it is known to fit.
pub(super) async fn upload(
    gpu: &Gpu,
    scene: &Scene,
    lighting: &Lighting,
    radiance_unit: f32,
    settings: &RenderSettings,
) -> Result<GpuScene, RenderError> {
    let estimate = MemoryEstimate::new(scene, settings)?;
    estimate.check(gpu)?;
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let uploaded = GpuScene::new(gpu, scene, lighting, radiance_unit);
    if scope.pop().await.is_some() {
        return Err(estimate.too_large());
    }
    gpu.check("uploading the scene")?;
    uploaded
}

/// Makes the voxels' volume and compiles the library's kernels.
pub(super) async fn global_illumination(gpu: &Gpu, config: GiConfig) -> Result<Gi, RenderError> {
    // What is done with a texture that could not be made is refused in turn.
    let followers = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let gi = Gi::new(&gpu.device, &gpu.queue, config);
    let is_short = scope.pop().await.is_some();
    let refused = followers.pop().await;
    if is_short {
        let [x, y, z] = config.grid.dimensions.to_array();
        let needed = dense_volume_bytes(&config.grid, config.directionality);
        return Err(RenderError::OutOfMemory {
            what: format!("a dense volume of {x} x {y} x {z} voxels"),
            needed_mib: needed.div_ceil(1 << 20),
            remedy: "lower the resolution, or store the voxels in an octree (--volume octree)"
                .to_owned(),
        });
    }
    if let Some(error) = refused {
        let doing = "making the voxels' volume";
        return Err(RenderError::Device { doing, reason: error.to_string() });
    }
    Ok(gi?)
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

/// Renders shadow maps if there is a pass for them, and binds the lights. Also the bytes of the maps.
pub(super) fn bind_lights(
    gpu: &Gpu,
    recorder: &mut Recorder,
    shadow_pass: Option<&ShadowMapPass>,
    scene: &GpuScene,
    (lighting, map): (&Lighting, Option<&EnvironmentMap>),
    gi: &Gi,
    shadow_resolution: u32,
) -> (Lights, u64) {
    let mut lights = lighting.to_gpu(scene.radiance_unit);
    let radiance = lighting.environment.radiance / scene.radiance_unit;
    let rotation_rad = lighting.environment.rotation_rad;
    // Its brightest parts shine like lamps, and have the first choice of shadow maps.
    let peaks = map.iter().flat_map(|map| map.lights(radiance, rotation_rad));
    lights.splice(0..0, peaks);
    let mut maps: Option<ShadowMaps> = None;
    if let Some(pass) = shadow_pass {
        recorder.stage("shadow maps");
        maps = pass.record(gpu, recorder, scene, &mut lights, shadow_resolution);
    }
    let layer_bytes = 4 * u64::from(shadow_resolution).pow(2);
    let bytes = maps.as_ref().map_or(0, |maps| maps.layers.len() as u64 * layer_bytes);
    let environment = EnvironmentLight { radiance, map, rotation_rad };
    (gi.bind_lights(&lights, environment, maps.as_ref()), bytes)
}
