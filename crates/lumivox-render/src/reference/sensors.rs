//! Light at points instead of pixels: lux meters and luminance meters for the path tracer.
//!
//! Sensors are the pixels of a separate film. In every sample one path starts at each sensor; sums,
//! batches and noise estimates work as for pictures.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use glam::{DVec3, UVec2, Vec3};
use lumivox_scene::Scene;

use super::{PathTracer, ReferenceProgress, ReferenceSettings};
use crate::{Gpu, RenderError};

/// The kinds of sensors in `sensors.wgsl`.
pub(super) const SENSOR_NONE: u32 = 0;
const SENSOR_WHITE: u32 = 1;
pub(super) const SENSOR_RAY: u32 = 2;

/// The most sensors of a meter: their sums take 416 bytes each.
const MOST_SENSORS: usize = 1 << 20;

/// A sensor that measures light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sensor {
    /// A lux meter: the irradiance at a point in the world, m. A point on a surface may be off by
    /// the path tracer's rounding, 2e-6 of the scene's diagonal.
    Irradiance {
        /// The point.
        at: Vec3,
        /// The direction that it faces, of any length except zero.
        normal: Vec3,
    },
    /// A luminance meter: the radiance that arrives at a point in the world, m.
    Radiance {
        /// The point.
        at: Vec3,
        /// The direction that it looks in, of any length except zero.
        direction: Vec3,
    },
}

impl Sensor {
    fn parts(self) -> (Vec3, Vec3, u32) {
        match self {
            Self::Irradiance { at, normal } => (at, normal, SENSOR_WHITE),
            Self::Radiance { at, direction } => (at, direction, SENSOR_RAY),
        }
    }
}

/// Settings of a [`LightMeter`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeterSettings {
    /// Samples of each sensor, 1 to 16 777 216. Noise falls with their square root. Default 1024.
    pub samples: u32,
    /// Seed of the random numbers. Default 0.
    pub seed: u32,
    /// The most bounces, as in [`ReferenceSettings::bounces`].
    pub bounces: Option<u32>,
}

impl Default for MeterSettings {
    fn default() -> Self {
        Self { samples: 1024, seed: 0, bounces: None }
    }
}

/// The light at a sensor: irradiance in lux, or radiance in cd/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// All light, linear RGB.
    pub total: [f32; 3],
    /// The share of `total` that comes directly from lamps and suns; for a radiance, also the
    /// emission of the surface that the ray hits.
    pub direct: [f32; 3],
    /// The illuminance in lux, or the luminance in cd/m²: the luminance of `total`.
    pub value: f32,
    /// The standard error of `value`; infinite with fewer than 17 samples, that is, fewer than two
    /// batches.
    pub standard_error: f32,
    /// The open share of the hemisphere, weighted by the cosine, 0 to 1. Meaningless for a
    /// radiance.
    pub openness: f32,
}

/// Measures light by path tracing, without bias.
#[derive(Debug)]
pub struct LightMeter {
    tracer: PathTracer,
    sensors: Vec<Sensor>,
}

impl LightMeter {
    /// Prepares a valid scene, like [`PathTracer::new`].
    ///
    /// # Errors
    /// As [`PathTracer::new`]; and [`RenderError::Setting`] if a sensor is not finite or has no
    /// direction, or if there are no sensors or more than 1 048 576.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        sensors: &[Sensor],
        settings: MeterSettings,
    ) -> Result<Self, RenderError> {
        check(sensors)?;
        let MeterSettings { samples, seed, bounces } = settings;
        // A sensor's random numbers depend on its pixel, so the shape of the film affects the
        // result.
        let width = (sensors.len() as f64).sqrt().ceil() as u32;
        let width = if width > 64 { width.next_multiple_of(8) } else { width };
        let size = UVec2::new(width, (sensors.len() as u32).div_ceil(width));
        let settings =
            ReferenceSettings { size, samples, seed, bounces, ..ReferenceSettings::default() };
        let tracer =
            PathTracer::with_features(gpu, scene, None, settings, sensors, |features| features);
        Ok(Self { tracer: tracer.await?, sensors: sensors.to_vec() })
    }

    /// Traces the missing samples, like [`PathTracer::render`].
    ///
    /// # Errors
    /// When the device fails.
    pub async fn measure(
        &mut self,
        progress: &mut dyn FnMut(ReferenceProgress) -> ControlFlow<()>,
    ) -> Result<(), RenderError> {
        self.tracer.render(progress).await
    }

    /// Samples of each sensor so far.
    pub fn samples(&self) -> u32 {
        self.tracer.samples()
    }

    /// The light at the sensors, in their order, from the samples so far.
    pub fn readings(&self) -> Vec<Reading> {
        let (film, unit) = (&self.tracer.film, f64::from(self.tracer.uploaded.radiance_unit));
        let total = film.mean(unit, |sums| sums.full);
        let direct = film.mean(unit, |sums| sums.direct);
        let value = film.mean(unit, |sums| sums.one_bounce);
        let variance = film.variance(unit, |sums| (sums.one_bounce, sums.one_bounce_square));
        let openness = film.mean(1.0, |sums| [sums.openness; 3]);
        let reading = |(index, sensor): (usize, &Sensor)| {
            let factor = match sensor {
                Sensor::Irradiance { .. } => PI as f32,
                Sensor::Radiance { .. } => 1.0,
            };
            Reading {
                total: total[index].map(|channel| channel * factor),
                direct: direct[index].map(|channel| channel * factor),
                value: value[index][0] * factor,
                standard_error: variance[index].sqrt() * factor,
                openness: openness[index][0],
            }
        };
        self.sensors.iter().enumerate().map(reading).collect()
    }
}

fn check(sensors: &[Sensor]) -> Result<(), RenderError> {
    let fail = |name, value: String, expected: &str| {
        Err(RenderError::Setting { name, value, expected: expected.to_owned() })
    };
    if sensors.is_empty() || sensors.len() > MOST_SENSORS {
        return fail("the number of sensors", sensors.len().to_string(), "1 to 1048576 at once");
    }
    for (index, sensor) in sensors.iter().enumerate() {
        let (at, direction, _) = sensor.parts();
        if !at.is_finite() {
            return fail("a sensor's place", format!("{at} (number {index})"), "finite");
        }
        if direction.try_normalize().is_none() {
            let value = format!("{direction} (number {index})");
            return fail("a sensor's direction", value, "of a length above 0");
        }
    }
    Ok(())
}

/// The texels of `sensors.wgsl` for a film of a size, relative to the scene's centre; one empty
/// texel without sensors.
pub(super) fn texels(sensors: &[Sensor], size: UVec2, origin: DVec3) -> ([u32; 2], Vec<[f32; 4]>) {
    if sensors.is_empty() {
        return ([1, 1], vec![[0.0; 4]]);
    }
    let mut texels = vec![[0.0; 4]; 2 * size.x as usize * size.y as usize];
    for (sensor, pair) in sensors.iter().zip(texels.chunks_exact_mut(2)) {
        let (at, direction, kind) = sensor.parts();
        let place = (at.as_dvec3() - origin).as_vec3();
        pair[0] = place.extend(kind as f32).to_array();
        pair[1] = direction.normalize_or_zero().extend(0.0).to_array();
    }
    ([2 * size.x, size.y], texels)
}
