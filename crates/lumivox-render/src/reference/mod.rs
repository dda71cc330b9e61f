//! The reference: a path tracer for the same scenes, cameras, materials and lights.
//!
//! It is unbiased: nothing is clamped, and paths end only by Russian roulette (or after 4096
//! surfaces). Next-event estimation samples lamps, emissive triangles and the panorama, and
//! multiple importance sampling (Veach 1997, chapter 9) combines that with directions drawn from
//! the material. All of it is one compute kernel (`path.wgsl`) within WebGPU's default limits, over
//! a bounding volume hierarchy from the `obvhs` crate.
//!
//! | file | contains |
//! | --- | --- |
//! | `world.wgsl` | all buffers and textures that the kernel reads |
//! | `intersect.wgsl` | ray-triangle intersection |
//! | `surface.wgsl`, `texels.wgsl` | materials and their textures at a hit |
//! | `scatter.wgsl` | the BRDF and the sampling of directions |
//! | `sources.wgsl`, `panorama.wgsl` | the sampling of light sources |
//! | `sensors.wgsl` | sensors in place of pixels ([`LightMeter`]) |
//! | `transmittance.wgsl` | visibility and see-through surfaces in between |
//! | `path.wgsl` | the path, and which light counts for which layer |
//!
//! Every sample of every pixel has its own random numbers, which depend only on the seed. So a
//! picture is bit-identical on the same device, in one run or in several, and its noise is known:
//! the variance of each pixel's mean is estimated along with it.

mod atlas;
mod checkpoint;
mod file;
mod film;
mod geometry;
mod layers;
mod materials;
mod part;
mod records;
mod sensors;
mod surroundings;
#[cfg(test)]
mod tests;
mod upload;

use std::ops::ControlFlow;

use glam::UVec2;
use lumivox::gpu::{Recorder, ShaderLibrary, read_buffer};
use lumivox_scene::{Camera, Scene};

use atlas::{TILE_CLAMP, TILE_COLOR, TILE_MIRROR, TILE_NEAREST, TILE_PRESENT};
pub use checkpoint::CheckpointError;
use film::Film;
#[cfg(test)]
pub(crate) use geometry::{NodeRecord, TriangleRecord, VertexRecord};
pub use layers::ReferenceLayers;
pub use part::{PartError, ReferenceMerge, ReferencePart};
use records::PixelRecord;
#[cfg(test)]
pub(crate) use records::{
    EmitterRecord, PeakRecord, PixelRecord as FilmRecord, TileRecord, TracedMaterialRecord,
    WorldRecord,
};
pub use sensors::{LightMeter, MeterSettings, Reading, Sensor};
use sensors::{SENSOR_NONE, SENSOR_RAY};
pub(crate) use upload::Features;
use upload::Uploaded;

use crate::{Gpu, RenderError};

/// The number of samples in a batch: they are evenly spread together, and the GPU sums them in f32
/// before they are added exactly.
pub const BATCH: u32 = 16;
/// The most samples of a pixel for which the sums cannot overflow.
const MOST_SAMPLES: u32 = 1 << 24;
/// The longest edge of a picture, px.
const MOST_EDGE: u32 = 16_384;

/// Defines the path tracer's constants, with all [`Features`].
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("REFERENCE_BATCH", BATCH)
        .constant_u32("REFERENCE_LEAF", geometry::LEAF)
        .constant_u32("TRIANGLE_DOUBLE_SIDED", geometry::DOUBLE_SIDED)
        .constant_u32("TRIANGLE_SEE_THROUGH", geometry::SEE_THROUGH)
        .constant_u32("NO_TRIANGLE", geometry::NO_TRIANGLE)
        .constant_u32("AS_SEEN", geometry::AS_SEEN)
        .constant_u32("BOTH_SIDES", geometry::BOTH_SIDES)
        .constant_u32("BLOCKING", geometry::BLOCKING)
        .constant_u32("SENSOR_NONE", SENSOR_NONE)
        .constant_u32("SENSOR_RAY", SENSOR_RAY)
        .constant_u32("TILE_CLAMP", TILE_CLAMP)
        .constant_u32("TILE_MIRROR", TILE_MIRROR)
        .constant_u32("TILE_NEAREST", TILE_NEAREST)
        .constant_u32("TILE_COLOR", TILE_COLOR)
        .constant_u32("TILE_PRESENT", TILE_PRESENT);
    Features::ALL.set(library);
}

/// The input of a path tracer.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceSettings {
    /// Width and height of the picture in pixels, 1 to 16 384. Default 640 x 360.
    pub size: UVec2,
    /// Samples of each pixel, at least 1. Noise falls with their square root. Default 256.
    pub samples: u32,
    /// Seed of the random numbers: another seed gives other noise. Default 0.
    pub seed: u32,
    /// The number of the first batch of 16 samples, 0 to 1 048 575. Default 0. If several machines
    /// trace parts of a reference, each part has its own batch numbers ([`ReferencePart`]).
    pub first_batch: u32,
    /// The most bounces of a path, counted as
    /// [`RenderSettings::bounces`](crate::RenderSettings::bounces); `None`, the default, sets no
    /// limit.
    pub bounces: Option<u32>,
    /// Reach of ambient occlusion, m. Infinite by default.
    pub occlusion_distance_m: f32,
}

impl Default for ReferenceSettings {
    fn default() -> Self {
        Self {
            size: UVec2::new(640, 360),
            samples: 256,
            seed: 0,
            first_batch: 0,
            bounces: None,
            occlusion_distance_m: f32::INFINITY,
        }
    }
}

/// The progress of a reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceProgress {
    /// Samples of each pixel so far; fractional while a picture is traced in bands.
    pub samples: f64,
    /// Samples of the complete reference.
    pub total: u32,
}

/// Traces paths through one scene.
#[derive(Debug)]
pub struct PathTracer {
    gpu: Gpu,
    settings: ReferenceSettings,
    uploaded: Uploaded,
    film: Film,
}

impl PathTracer {
    /// Prepares a valid scene: flattens its instances, builds the hierarchy, uploads it all and
    /// compiles the kernel.
    ///
    /// The camera is the given one, else the scene's first, else one that frames the whole scene.
    ///
    /// # Errors
    /// [`RenderError::Setting`] for settings out of range, [`RenderError::Limit`] for scenes that
    /// do not fit the device's buffers, and when the device fails.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: Option<&Camera>,
        settings: ReferenceSettings,
    ) -> Result<Self, RenderError> {
        Self::with_features(gpu, scene, camera, settings, &[], |features| features).await
    }

    /// Like [`Self::new`], but measures at sensors if there are any. `adjust` can switch off
    /// techniques, which must not change the mean.
    async fn with_features(
        gpu: &Gpu,
        scene: &Scene,
        camera: Option<&Camera>,
        settings: ReferenceSettings,
        sensors: &[Sensor],
        adjust: impl FnOnce(Features) -> Features,
    ) -> Result<Self, RenderError> {
        validate(&settings)?;
        let camera = camera.or(scene.cameras.first()).cloned();
        let camera = camera.unwrap_or_else(|| {
            scene.default_camera(settings.size.x as f32 / settings.size.y as f32)
        });
        let uploaded = Uploaded::new(gpu, scene, &camera, &settings, sensors, adjust).await?;
        gpu.pipelines.compile(&mut |_, _| {}).await;
        let film = Film::new(settings.size);
        Ok(Self { gpu: gpu.clone(), settings, uploaded, film })
    }

    /// Samples of each pixel in the layers.
    pub fn samples(&self) -> u32 {
        self.film.samples
    }

    /// Traces the samples still missing from the settings' number.
    ///
    /// `progress` is called often; if it breaks, the samples so far are kept, and tracing can
    /// continue later.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render(
        &mut self,
        progress: &mut dyn FnMut(ReferenceProgress) -> ControlFlow<()>,
    ) -> Result<(), RenderError> {
        while self.render_batch(progress).await? {}
        Ok(())
    }

    /// Traces the next missing samples, up to a whole number of batches of 16; returns `false` if
    /// none is left or `progress` broke.
    ///
    /// Between batches, tracing can continue from a checkpoint and gives the same bits as without a
    /// break. If it stops within a batch, the samples that all pixels have are kept, but the result
    /// then differs by rounding.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render_batch(
        &mut self,
        progress: &mut dyn FnMut(ReferenceProgress) -> ControlFlow<()>,
    ) -> Result<bool, RenderError> {
        let (size, first, total) = (self.settings.size, self.film.samples, self.settings.samples);
        let count = (BATCH - first % BATCH).min(total.saturating_sub(first));
        let mut done = count;
        let mut is_broken_off = false;
        let mut bands = Vec::new();
        for first_row in (0..size.y).step_by(self.uploaded.band_rows as usize) {
            let rows = self.uploaded.band_rows.min(size.y - first_row);
            self.uploaded.clear_film(&self.gpu);
            for sample in 0..count {
                let number = self.settings.first_batch * BATCH + first + sample;
                self.uploaded.set_sample(&self.gpu, first_row, rows, number);
                let mut recorder = Recorder::new(&self.gpu.device, &self.gpu.queue);
                self.uploaded.kernel.run(&mut recorder, &[&self.uploaded.group], [size.x, rows, 1]);
                recorder.submit();
                self.gpu.finished("tracing paths").await?;
                let rows_before = f64::from(count) * f64::from(first_row);
                let rows_done = rows_before + f64::from(sample + 1) * f64::from(rows);
                let samples = f64::from(first) + rows_done / f64::from(size.y);
                if progress(ReferenceProgress { samples, total }).is_break() {
                    let is_last = sample + 1 == count && first_row + rows == size.y;
                    if rows < size.y && !is_last {
                        return Ok(false);
                    }
                    (done, is_broken_off) = (sample + 1, true);
                    break;
                }
            }
            let bytes = u64::from(size.x) * u64::from(rows) * size_of::<PixelRecord>() as u64;
            let film = &self.uploaded.film;
            let sums = read_buffer(&self.gpu.device, &self.gpu.queue, film, 0..bytes).await?;
            bands.push((first_row, sums));
        }
        if done > 0 {
            self.film.add(done, &bands);
        }
        Ok(!is_broken_off && self.film.samples < total)
    }

    /// The layers of the samples so far.
    pub fn layers(&self) -> ReferenceLayers {
        ReferenceLayers::new(&self.film, self.uploaded.radiance_unit, self.uploaded.fingerprint)
    }

    /// The state needed to continue later, as bytes for a file.
    pub fn checkpoint(&self) -> Vec<u8> {
        checkpoint::write(&self.film, self.seeded_fingerprint())
    }

    /// The samples so far as a part of a larger reference. The part names everything besides the
    /// input that affects its bits: the version of this crate, the GPU and its driver.
    pub fn part(&self) -> ReferencePart {
        ReferencePart::new(self)
    }

    /// Continues from a checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError`] when the bytes are not a checkpoint, are damaged, or belong to another
    /// scene, camera, size, seed or limit of bounces; the tracer is then unchanged.
    pub fn resume(&mut self, checkpoint: &[u8]) -> Result<(), CheckpointError> {
        self.film = checkpoint::read(checkpoint, self.settings.size, self.seeded_fingerprint())?;
        Ok(())
    }

    /// The fingerprint of scene, camera, size and limit of bounces, independent of the seed. It is
    /// stored with the layers.
    pub fn fingerprint(&self) -> u64 {
        self.uploaded.fingerprint
    }

    fn seeded_fingerprint(&self) -> u64 {
        let ReferenceSettings { seed, first_batch, .. } = self.settings;
        let numbers = u64::from(seed) | u64::from(first_batch) << 32;
        let parts = [self.uploaded.fingerprint.to_le_bytes(), numbers.to_le_bytes()];
        checkpoint::fingerprint_of(parts.iter().map(<[u8; 8]>::as_slice))
    }
}

fn validate(settings: &ReferenceSettings) -> Result<(), RenderError> {
    let fail =
        |name, value: String, expected: String| Err(RenderError::Setting { name, value, expected });
    let size = settings.size;
    if size.min_element() == 0 || size.max_element() > MOST_EDGE {
        let expected = format!("1 to {MOST_EDGE} pixels wide and high");
        return fail("the picture's size", format!("{} x {}", size.x, size.y), expected);
    }
    if settings.samples == 0 {
        return fail("the number of samples", "0".to_owned(), "at least 1".to_owned());
    }
    let batches = u64::from(settings.first_batch) + u64::from(settings.samples.div_ceil(BATCH));
    if batches > u64::from(MOST_SAMPLES / BATCH) && settings.first_batch > 0 {
        let expected = format!("such that at most {} batches are asked for", MOST_SAMPLES / BATCH);
        return fail("the number of the last batch", batches.to_string(), expected);
    }
    let reach = settings.occlusion_distance_m;
    if reach.is_nan() || reach < 0.0 {
        return fail("the occlusion distance", reach.to_string(), "at least 0".to_owned());
    }
    Ok(())
}
