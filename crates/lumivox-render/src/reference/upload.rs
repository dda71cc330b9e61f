//! A scene on the GPU for path tracing: group 0 of `path.wgsl`, and the kernel compiled for it.

use bytemuck::{Pod, Zeroable as _};
use glam::{DVec3, UVec2, Vec3};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, ShaderLibrary, Texture,
    TextureView, storage_buffer, uniform_buffer, upload,
};
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, Light, VolumeKind};
use lumivox_scene::{Camera, Scene};

use super::ReferenceSettings;
use super::checkpoint::fingerprint_of;
use super::geometry::{MOST_TRIANGLES, TriangleRecord, Triangles};
use super::materials::Materials;
use super::records::{MOST_PEAKS, PeakRecord, PixelRecord, WorldRecord};
use super::sensors::{self, Sensor};
use super::surroundings::Surroundings;
use crate::scene::{Lighting, SHEEN_EDGE, radiance_unit, sheen_table};
use crate::{Gpu, RenderError};

/// The most pixels traced in one dispatch, so that the GPU stays responsive.
const MOST_PIXELS: u64 = 1 << 20;
/// With up to this many emitters one point is sampled; with more, the best of many.
const FEW_EMITTERS: usize = 1024;
const MANY_CANDIDATES: u32 = 64;
/// The offset of rays from their surface, as a share of half the scene's diagonal: sixteen times
/// the resolution of f32 there.
const OFFSET: f32 = 1.0 / (1 << 18) as f32;

/// Two steps of f32, relative to the distance from the origin.
const COARSENESS: f64 = 1.0 / (1 << 22) as f64;

/// The resources of a path tracer on the GPU.
#[derive(Debug)]
pub(super) struct Uploaded {
    pub(super) kernel: Kernel,
    pub(super) group: BindGroup,
    /// Sums of the pixels of a band.
    pub(super) film: Buffer,
    /// The number of rows traced in one dispatch.
    pub(super) band_rows: u32,
    /// The capacity of the kernel's stack, in links.
    #[cfg(test)]
    pub(super) stack: u32,
    /// The unit of radiance, in cd/m².
    pub(super) radiance_unit: f32,
    /// The fingerprint of the traced scene, independent of the seed.
    pub(super) fingerprint: u64,
    world: WorldRecord,
    world_buffer: Buffer,
}

impl Uploaded {
    /// Uploads a scene; `adjust` can change the constants that the kernel is compiled with.
    pub(super) async fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: &Camera,
        settings: &ReferenceSettings,
        sensors: &[Sensor],
        adjust: impl FnOnce(Features) -> Features,
    ) -> Result<Self, RenderError> {
        let lighting = Lighting::of(scene);
        let unit = radiance_unit(scene, &lighting);
        // Check before anything is built: building would take minutes and many times the scene's
        // memory.
        let count = scene.triangle_count();
        let bytes = count as u64 * size_of::<TriangleRecord>() as u64;
        let most = gpu.device.limits().max_storage_buffer_binding_size;
        if count > MOST_TRIANGLES || bytes > 2 * most {
            return Err(too_large(gpu, "the triangles", bytes));
        }
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let mut materials = Materials::new(gpu, scene, &lighting, unit)?;
        let triangles = Triangles::new(scene, &materials.sides);
        let emitters = materials.emitters(scene, &triangles);
        let surroundings = match &lighting.environment.map {
            Some(map) => Surroundings::of_map(map)?,
            None => Surroundings::even(),
        };
        let lights = lights_around(&lighting, unit, triangles.origin);
        check_sizes(gpu, &triangles)?;

        let world = world(scene, camera, settings, &triangles, unit, &surroundings);
        let world = WorldRecord {
            light_count: lights.len() as u32,
            emitter_count: emitters.len() as u32,
            ..world
        };
        let textures = scene.textures.iter().map(|texture| texture.rgba8.as_slice());
        // The fingerprint must not depend on the seed.
        let seen = WorldRecord { seed: 0, ..world };
        let parts = [
            bytemuck::bytes_of(&seen),
            bytemuck::cast_slice(&triangles.triangles),
            bytemuck::cast_slice(&triangles.vertices),
            bytemuck::cast_slice(&materials.records),
            bytemuck::cast_slice(&surroundings.texels),
        ];
        let light_words = format!("{lights:?}");
        let fingerprint =
            fingerprint_of(parts.into_iter().chain(textures).chain([light_words.as_bytes()]));

        let device = &gpu.device;
        let band_rows = band_rows(gpu, settings.size);
        let pixels = u64::from(band_rows) * u64::from(settings.size.x);
        let film = storage_buffer(device, "film", pixels * size_of::<PixelRecord>() as u64);
        let world_buffer = uniform_buffer(device, "world", &world);
        let split = (gpu.device.limits().max_storage_buffer_binding_size as usize
            / size_of::<TriangleRecord>())
        .min(triangles.triangles.len());
        let (triangle_records, more_triangles) = triangles.triangles.split_at(split);
        let more_triangles = upload(device, "more triangles", &or_one(more_triangles));
        let buffers = [
            upload(device, "boxes", &triangles.nodes),
            upload(device, "triangles", triangle_records),
            upload(device, "vertices", &triangles.vertices),
            upload(device, "materials", &or_one(&materials.records)),
            Light::buffer(device, &lights),
            upload(device, "emitters", &or_one(&emitters)),
        ];
        let rgba = wgpu::TextureFormat::Rgba32Float;
        let panorama = float_texture(gpu, surroundings.size, rgba, &surroundings.texels);
        let row_format = wgpu::TextureFormat::R32Float;
        let rows = float_texture(gpu, [1, surroundings.size[1]], row_format, &surroundings.rows);
        let sheen: Vec<f32> = if materials.has_sheen {
            sheen_table().into_iter().map(|byte| f32::from(byte) / 255.0).collect()
        } else {
            vec![0.0; (SHEEN_EDGE * SHEEN_EDGE) as usize]
        };
        let sheen = float_texture(gpu, [SHEEN_EDGE; 2], row_format, &sheen);
        let (sensor_size, texels) = sensors::texels(sensors, settings.size, triangles.origin);
        let sensor_texels = float_texture(gpu, sensor_size, rgba, &texels);

        let layout = layout(&gpu.pipelines);
        let builder = BindGroupBuilder::new(&layout).buffer(&world_buffer);
        let group = buffers
            .iter()
            .fold(builder, BindGroupBuilder::buffer)
            .buffer(&film)
            .view(&materials.atlas.view)
            .view(&panorama)
            .view(&rows)
            .view(&sheen)
            .buffer(&more_triangles)
            .view(&sensor_texels)
            .build(device, "world");
        let features = adjust(Features {
            stack: triangles.stack,
            split: split as u32,
            candidates: if emitters.len() > FEW_EMITTERS { MANY_CANDIDATES } else { 1 },
            has_textures: materials.has_textures,
            has_layers: materials.has_layers,
            is_see_through: materials.sides.iter().any(|sides| sides.is_see_through),
            has_lights: !lights.is_empty(),
            has_discs: lights.iter().any(|light| light.source.radius() > 0.0),
            has_emitters: !emitters.is_empty(),
            has_panorama: lighting.environment.map.is_some(),
            has_peaks: !surroundings.peaks.is_empty(),
            has_sensors: !sensors.is_empty(),
        });
        let volume = library_with_volume(VolumeKind::default(), Directionality::default());
        let mut shaders = crate::shaders::library(&volume);
        features.set(&mut shaders);
        let kernel =
            Kernel::new(&gpu.pipelines, &shaders, "render::reference::path", "main", &[&layout])?;
        if scope.pop().await.is_some() {
            let bytes = size_of_val(triangles.triangles.as_slice())
                + size_of_val(triangles.vertices.as_slice())
                + size_of_val(triangles.nodes.as_slice())
                + scene.textures.iter().map(|texture| texture.rgba8.len()).sum::<usize>();
            let what = "the path tracer's copy of the scene";
            let remedy = "load the scene with smaller textures (--texture-memory)";
            return Err(gpu.out_of_memory(what, Some(bytes as u64), remedy));
        }
        gpu.check("uploading the scene for the path tracer")?;
        Ok(Self {
            kernel,
            group,
            film,
            band_rows,
            #[cfg(test)]
            stack: triangles.stack,
            radiance_unit: unit,
            fingerprint,
            world,
            world_buffer,
        })
    }

    /// Clears the sums.
    pub(super) fn clear_film(&self, gpu: &Gpu) {
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.clear_buffer(&self.film, 0, None);
        gpu.queue.submit([encoder.finish()]);
    }

    /// Sets the samples that the next dispatch traces.
    pub(super) fn set_sample(&self, gpu: &Gpu, first_row: u32, row_count: u32, sample: u32) {
        let world = WorldRecord {
            first_row,
            row_count,
            first_sample: sample,
            sample_count: 1,
            ..self.world
        };
        gpu.queue.write_buffer(&self.world_buffer, 0, bytemuck::bytes_of(&world));
    }
}

/// The features that the kernel is compiled with. Unused ones are left out: software GPUs execute
/// both sides of every branch.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::struct_excessive_bools, reason = "each is a constant of the shader")]
pub(crate) struct Features {
    pub(crate) stack: u32,
    /// The number of triangles in the first of the two buffers.
    pub(crate) split: u32,
    /// Sampled points on emitters, of which the best is traced.
    pub(crate) candidates: u32,
    pub(crate) has_textures: bool,
    pub(crate) has_layers: bool,
    pub(crate) is_see_through: bool,
    pub(crate) has_lights: bool,
    pub(crate) has_discs: bool,
    pub(crate) has_emitters: bool,
    pub(crate) has_panorama: bool,
    pub(crate) has_peaks: bool,
    pub(crate) has_sensors: bool,
}

impl Features {
    /// All features.
    pub(crate) const ALL: Self = Self {
        stack: 64,
        split: u32::MAX,
        candidates: 1,
        has_textures: true,
        has_layers: true,
        is_see_through: true,
        has_lights: true,
        has_discs: true,
        has_emitters: true,
        has_panorama: true,
        has_peaks: true,
        has_sensors: true,
    };

    pub(crate) fn set(self, shaders: &mut ShaderLibrary) {
        shaders
            .constant_u32("REFERENCE_STACK", self.stack)
            .constant_u32("REFERENCE_SPLIT", self.split)
            .constant_u32("REFERENCE_CANDIDATES", self.candidates)
            .constant_u32("REFERENCE_HAS_TEXTURES", self.has_textures.into())
            .constant_u32("REFERENCE_HAS_LAYERS", self.has_layers.into())
            .constant_u32("REFERENCE_SEE_THROUGH", self.is_see_through.into())
            .constant_u32("REFERENCE_HAS_LIGHTS", self.has_lights.into())
            .constant_u32("REFERENCE_HAS_DISCS", self.has_discs.into())
            .constant_u32("REFERENCE_HAS_EMITTERS", self.has_emitters.into())
            .constant_u32("REFERENCE_HAS_PANORAMA", self.has_panorama.into())
            .constant_u32("REFERENCE_HAS_PEAKS", self.has_peaks.into())
            .constant_u32("REFERENCE_HAS_SENSORS", self.has_sensors.into());
    }
}

/// The layout of group 0: the eight storage buffers that WebGPU allows, and textures.
pub(super) fn layout(device: &Pipelines) -> wgpu::BindGroupLayout {
    let texels = wgpu::TextureSampleType::Float { filterable: false };
    (0..6)
        .fold(LayoutBuilder::compute().uniform(), |layout, _| layout.storage())
        .storage_mut()
        .texture(wgpu::TextureViewDimension::D2Array, texels)
        .texture_2d_unfilterable()
        .texture_2d_unfilterable()
        .texture_2d_unfilterable()
        .storage()
        .texture_2d_unfilterable()
        .build(device, "path tracer")
}

fn world(
    scene: &Scene,
    camera: &Camera,
    settings: &ReferenceSettings,
    triangles: &Triangles,
    radiance_unit: f32,
    surroundings: &Surroundings,
) -> WorldRecord {
    let size = settings.size.as_vec2();
    let half_height = (0.5 * camera.vertical_fov_rad).tan();
    let world_from_camera = camera.world_from_camera();
    let axis = |column: usize| world_from_camera.col(column).truncate();
    let position = (camera.position.as_dvec3() - triangles.origin).as_vec3();
    let environment = &scene.environment;
    let mut peaks = [PeakRecord::zeroed(); MOST_PEAKS];
    peaks[..surroundings.peaks.len()].copy_from_slice(&surroundings.peaks);
    // Positions far from the origin are already rounded in the scene.
    let coarseness_m = (triangles.origin.abs().max_element() * COARSENESS) as f32;
    WorldRecord {
        camera: position.to_array(),
        near_m: camera.near_m,
        forward: (-axis(2)).to_array(),
        right: (axis(0) * half_height * size.x / size.y).to_array(),
        up: (axis(1) * half_height).to_array(),
        seed: settings.seed,
        size: settings.size.to_array(),
        environment: (environment.radiance / radiance_unit).to_array(),
        most_bounces: settings.bounces.unwrap_or(u32::MAX),
        environment_turn: [environment.rotation_rad.cos(), environment.rotation_rad.sin()],
        peak_count: surroundings.peaks.len() as u32,
        occlusion_distance_m: settings.occlusion_distance_m,
        root: triangles.root,
        offset_m: (triangles.radius_m * OFFSET + coarseness_m).max(f32::MIN_POSITIVE),
        peaks,
        ..WorldRecord::zeroed()
    }
}

/// The lights, with positions relative to the scene's centre.
fn lights_around(lighting: &Lighting, radiance_unit: f32, origin: DVec3) -> Vec<Light> {
    let moved = |position: &mut Vec3| *position = (position.as_dvec3() - origin).as_vec3();
    let mut lights = lighting.to_gpu(radiance_unit);
    for light in &mut lights {
        if let Some(position) = light.source.position_mut() {
            moved(position);
        }
    }
    lights
}

fn band_rows(gpu: &Gpu, size: UVec2) -> u32 {
    let binding = gpu.device.limits().max_storage_buffer_binding_size;
    let pixels = (binding / size_of::<PixelRecord>() as u64).min(MOST_PIXELS);
    ((pixels / u64::from(size.x)) as u32).clamp(1, size.y)
}

fn check_sizes(gpu: &Gpu, triangles: &Triangles) -> Result<(), RenderError> {
    let most = gpu.device.limits().max_storage_buffer_binding_size;
    for (what, bytes) in [
        ("the vertices", size_of_val(triangles.vertices.as_slice())),
        ("the hierarchy of boxes", size_of_val(triangles.nodes.as_slice())),
    ] {
        if bytes as u64 > most {
            return Err(too_large(gpu, what, bytes as u64));
        }
    }
    Ok(())
}

fn too_large(gpu: &Gpu, what: &str, bytes: u64) -> RenderError {
    RenderError::Limit {
        what: format!("{what} of the scene, with all instances, for the path tracer"),
        needed: bytes,
        unit: "bytes",
        limit: "max_storage_buffer_binding_size",
        available: gpu.device.limits().max_storage_buffer_binding_size,
        remedy: "trace a simpler scene or a part of it, or choose another adapter".to_owned(),
    }
}

fn or_one<T: Pod>(records: &[T]) -> Vec<T> {
    if records.is_empty() { vec![T::zeroed()] } else { records.to_vec() }
}

fn float_texture<T: Pod>(
    gpu: &Gpu,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    texels: &[T],
) -> TextureView {
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = Texture::new(
        &gpu.device,
        &wgpu::TextureDescriptor {
            label: Some("numbers for the path tracer"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
    );
    gpu.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * size_of::<T>() as u32),
            rows_per_image: None,
        },
        size,
    );
    texture.view()
}
