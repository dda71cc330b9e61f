//! One room: its sensors and a picture by cones and by paths.

use std::time::Instant;

use glam::Vec3;
use lumivox_app::parts::{ProgressDisplay, gathers};
use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::measure::photometric;
use lumivox_render::reference::{
    LightMeter, MeterSettings, PathTracer, ReferenceProgress, ReferenceSettings, Sensor,
};
use lumivox_render::{Gpu, RenderProgress, RenderSettings, Renderer, View};

use super::RoomFigures;
use super::random::Room;

/// The most bounces of paths.
const BOUNCES: u32 = 16;
/// The samples of a sensor divided by those of a pixel.
const FEWER: u32 = 64;
/// The fewest samples of a pixel: two batches, so that their noise is known.
const FEWEST: u32 = 32;

/// Measures rooms with the same settings.
pub struct Meter<'a> {
    gpu: &'a Gpu,
    progress: &'a ProgressDisplay,
    settings: RenderSettings,
    samples: u32,
}

impl<'a> Meter<'a> {
    /// Measures by cones with these settings and `frames`, and by paths with `samples`.
    pub fn new(
        gpu: &'a Gpu,
        progress: &'a ProgressDisplay,
        settings: &RenderSettings,
        frames: u32,
        samples: u32,
    ) -> Self {
        let settings = RenderSettings { frames, view: View::Diffuse, ..settings.clone() };
        Self { gpu, progress, settings, samples }
    }

    /// Measures a room at each resolution; `index` is its number among `count` rooms. Returns early
    /// if the user stops it.
    ///
    /// # Errors
    /// When the device fails.
    pub fn measure(
        &self,
        room: &Room,
        resolutions: &[u32],
        (index, count): (u32, u32),
    ) -> anyhow::Result<Vec<RoomFigures>> {
        // For progress, sensors, picture, and each resolution count the same.
        let parts = 2.0 + resolutions.len() as f64;
        let show = |part: f64| self.progress.set_within("room", index, count, part / parts);
        let hear = |first: f64| {
            move |step: ReferenceProgress| {
                show(first + step.samples / f64::from(step.total));
                self.progress.goes_on()
            }
        };
        let start = Instant::now();
        let at = |&(at, normal): &(Vec3, Vec3)| Sensor::Irradiance { at, normal };
        let sensors: Vec<Sensor> = room.sensors.iter().map(at).collect();
        let bounces = Some(BOUNCES);
        let settings = MeterSettings { samples: self.samples, bounces, ..MeterSettings::default() };
        let meter = LightMeter::new(self.gpu, &room.scene, &sensors, settings);
        let mut meter = pollster::block_on(meter)?;
        pollster::block_on(meter.measure(&mut hear(0.0)))?;
        let paths = meter.readings();
        let settings = ReferenceSettings {
            size: self.settings.size,
            samples: (self.samples / FEWER).max(FEWEST),
            bounces,
            ..ReferenceSettings::default()
        };
        let tracer = PathTracer::new(self.gpu, &room.scene, None, settings);
        let mut tracer = pollster::block_on(tracer)?;
        pollster::block_on(tracer.render(&mut hear(1.0)))?;
        let truth = tracer.layers();
        let path_seconds = start.elapsed().as_secs_f64();

        let mut all = Vec::new();
        for (part, &resolution) in resolutions.iter().enumerate() {
            show(2.0 + part as f64);
            if self.progress.is_stopped() {
                break;
            }
            let start = Instant::now();
            let settings = RenderSettings { resolution, ..self.settings.clone() };
            let mut tell = |_: RenderProgress| {};
            let renderer = Renderer::new(self.gpu, &room.scene, None, settings, &mut tell);
            let mut renderer = pollster::block_on(renderer)?;
            let (points, normals): (Vec<_>, Vec<_>) = room.sensors.iter().copied().unzip();
            let light = renderer.irradiance(&points, &normals, gathers(self.settings.frames));
            let cones: Vec<f32> = pollster::block_on(light)?
                .iter()
                .map(|light| photometric(light.total().to_array()))
                .collect();
            let mut figures = RoomFigures::of_sensors(room, resolution, &cones, &paths);
            let mut picture = LinearPicture::from(&pollster::block_on(renderer.render(&mut tell))?);
            let is_faulty =
                |pixel: &&[f32; 3]| !pixel.iter().all(|part| *part >= 0.0 && part.is_finite());
            figures.faulty_pixels = picture.rgb.iter().filter(is_faulty).count();
            // The view shows irradiance / pi.
            picture
                .rgb
                .as_flattened_mut()
                .iter_mut()
                .for_each(|part| *part *= std::f32::consts::PI);
            let full = truth.layer(&truth.full);
            // Dark rooms have only noise; pictures that are not finite have no figures.
            let compared = ErrorFigures::new(&full, Some(&truth.full_variance), &picture).ok();
            let compared = compared.filter(|_| !figures.is_dark());
            figures.bias_percent = compared.map(|compared| compared.bias_percent);
            figures.rmse_percent = compared.map(|compared| compared.rmse_percent);
            figures.cone_seconds = start.elapsed().as_secs_f64();
            figures.path_seconds = path_seconds;
            all.push(figures);
        }
        Ok(all)
    }
}
