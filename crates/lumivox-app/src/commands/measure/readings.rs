//! The light at places, by cones or by the path tracer.

use std::ops::ControlFlow;

use glam::{UVec2, Vec3};
use lumivox_console::Failure;
use lumivox_render::measure::photometric;
use lumivox_render::reference::{
    LightMeter, MeterSettings, PathTracer, ReferenceProgress, ReferenceSettings, Sensor,
};
use lumivox_render::{Gpu, RenderProgress, RenderSettings, Renderer};
use lumivox_scene::{Camera, Scene};

use super::places::{Places, middle};
use crate::cli::MeasureArgs;
use crate::progress::{ProgressDisplay, words};

/// Points that are gathered between two reports of progress.
const AT_ONCE: usize = 1 << 14;
/// Sensors of one light meter: the most that it takes.
const SENSORS: usize = 1 << 20;

/// The light at a place, in lux or cd/m².
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// The total.
    pub value: f32,
    /// The standard error, if it is known.
    pub standard_error: Option<f32>,
    /// The direct light of lamps and suns; `None` for luminance.
    pub direct: Option<f32>,
    /// The unoccluded share of the hemisphere; `None` for luminance.
    pub openness: Option<f32>,
}

/// A scene to measure.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The scene.
    pub scene: &'a Scene,
    /// The camera of a picture.
    pub camera: &'a Camera,
    /// The progress display.
    pub progress: &'a ProgressDisplay,
}

impl Task<'_> {
    /// Measures by cones.
    ///
    /// # Errors
    /// When the device fails, or the user stops it.
    pub fn by_cones(
        self,
        places: &Places,
        settings: RenderSettings,
        frames: u32,
    ) -> anyhow::Result<Vec<Reading>> {
        if !places.at.is_empty() {
            let reading = |light: lumivox::Irradiance| Reading {
                value: photometric(light.total().to_array()),
                standard_error: None,
                direct: Some(photometric(light.direct.to_array())),
                openness: Some(light.openness),
            };
            let gathered = self.gathered(&places.at, settings, gathers(frames))?;
            return Ok(gathered.into_iter().map(reading).collect());
        }
        let size = places.size.unwrap_or_default();
        let mut renderer = self.renderer(RenderSettings { size, frames, ..settings })?;
        while !renderer.is_complete() {
            pollster::block_on(renderer.render_frame())?;
            self.gpu.wait("rendering a frame")?;
            self.progress.set("frame", renderer.frame_count(), frames);
            self.check()?;
        }
        let mean = pollster::block_on(renderer.read_mean())?;
        let reading = |&[r, g, b, _]: &[f32; 4]| Reading::of_luminance([r, g, b], None);
        Ok(mean.iter().map(reading).collect())
    }

    /// Gathers the light at each place in its direction by cones.
    ///
    /// # Errors
    /// When the device fails, or the user stops it.
    pub fn gathered(
        self,
        places: &[(Vec3, Vec3)],
        settings: RenderSettings,
        frames: u32,
    ) -> anyhow::Result<Vec<lumivox::Irradiance>> {
        // Points need no picture, only a camera in their middle, where cascades are centred.
        let size = UVec2::splat(16);
        let camera = Camera { position: middle(places), ..self.camera.clone() };
        let task = Task { camera: &camera, ..self };
        let renderer = task.renderer(RenderSettings { size, frames, ..settings })?;
        let mut gathered = Vec::with_capacity(places.len());
        for some in places.chunks(AT_ONCE) {
            self.progress.set("gathering", gathered.len() as u32, places.len() as u32);
            self.check()?;
            let (points, normals): (Vec<_>, Vec<_>) = some.iter().copied().unzip();
            gathered.extend(pollster::block_on(renderer.irradiance(&points, &normals, frames))?);
        }
        Ok(gathered)
    }

    fn renderer(self, settings: RenderSettings) -> anyhow::Result<Renderer> {
        settings.validate(&self.gpu.device.limits())?;
        let mut tell = |step: RenderProgress| {
            self.progress.set(words(step.stage), step.done, step.total);
        };
        let renderer = Renderer::new(self.gpu, self.scene, Some(self.camera), settings, &mut tell);
        let renderer = pollster::block_on(renderer)?;
        self.check()?;
        Ok(renderer)
    }

    /// Measures by the path tracer.
    ///
    /// # Errors
    /// When the device fails, or the user stops it.
    pub fn by_paths(
        self,
        places: &Places,
        args: &MeasureArgs,
        bounces: Option<u32>,
    ) -> anyhow::Result<Vec<Reading>> {
        let (samples, seed) = (args.samples, args.seed);
        let known = |error: f32| Some(error).filter(|error| error.is_finite());
        if places.at.is_empty() {
            let size = places.size.unwrap_or_default();
            let settings = ReferenceSettings { size, samples, seed, bounces, ..Default::default() };
            let tracer = PathTracer::new(self.gpu, self.scene, Some(self.camera), settings);
            let mut tracer = pollster::block_on(tracer)?;
            pollster::block_on(tracer.render(&mut |step| self.tell_sample(&step)))?;
            self.check()?;
            let layers = tracer.layers();
            let pixels = layers.radiance.iter().zip(&layers.radiance_variance);
            return Ok(pixels
                .map(|(rgb, variance)| Reading::of_luminance(*rgb, known(variance.sqrt())))
                .collect());
        }
        let is_ray = places.is_luminance();
        let reading = |light: lumivox_render::reference::Reading| Reading {
            value: light.value,
            standard_error: known(light.standard_error),
            direct: (!is_ray).then(|| photometric(light.direct)),
            openness: (!is_ray).then_some(light.openness),
        };
        let read = self.traced(&places.sensors(), MeterSettings { samples, seed, bounces })?;
        Ok(read.into_iter().map(reading).collect())
    }

    /// Traces the light at sensors.
    ///
    /// # Errors
    /// When the device fails, or the user stops it.
    pub fn traced(
        self,
        sensors: &[Sensor],
        settings: MeterSettings,
    ) -> anyhow::Result<Vec<lumivox_render::reference::Reading>> {
        let mut readings = Vec::with_capacity(sensors.len());
        for some in sensors.chunks(SENSORS) {
            let meter = LightMeter::new(self.gpu, self.scene, some, settings);
            let mut meter = pollster::block_on(meter)?;
            pollster::block_on(meter.measure(&mut |step| self.tell_sample(&step)))?;
            self.check()?;
            readings.extend(meter.readings());
        }
        Ok(readings)
    }

    fn tell_sample(self, step: &ReferenceProgress) -> ControlFlow<()> {
        let share = step.samples.fract();
        self.progress.set_within("sample", step.samples as u32, step.total, share);
        self.progress.goes_on()
    }

    fn check(self) -> Result<(), Failure> {
        if self.progress.is_stopped() {
            return Err(Failure::stopped("stopped; nothing was written"));
        }
        Ok(())
    }
}

/// The gathers of a sensor: six per frame, since sensors are few and noisy; at most 65536.
pub fn gathers(frames: u32) -> u32 {
    frames.saturating_mul(6).min(65_536)
}

impl Reading {
    fn of_luminance(rgb: [f32; 3], standard_error: Option<f32>) -> Self {
        Self { value: photometric(rgb), standard_error, direct: None, openness: None }
    }
}
