//! Renders the layers of a scene and compares them with its reference.

use std::time::Instant;

use glam::Vec3;
use lumivox_scene::{Camera, Scene};
use serde::{Deserialize, Serialize};

use super::{CompareError, ErrorFigures, LinearPicture};
use crate::reference::ReferenceLayers;
use crate::{Gpu, RenderError, RenderProgress, RenderSettings, Renderer, View};

/// The number of frames over which cone samples are counted.
const COST_FRAMES: u32 = 4;

/// The layers of a rendering, for comparison with a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedLayers {
    /// Irradiance in lux on the visible surface after one gather.
    pub one_bounce: LinearPicture,
    /// Irradiance in lux on the visible surface after as many bounces as the settings ask for.
    pub full: LinearPicture,
    /// The picture, in cd/m².
    pub picture: LinearPicture,
    /// The picture after its first frame, in cd/m².
    pub first_frame: LinearPicture,
    /// The cost of a frame.
    pub cost: Cost,
}

/// The cost of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Cost {
    /// Wall-clock milliseconds: the mean over the picture's frames, without one-time work.
    pub frame_ms: f64,
    /// Volume samples that a pixel's cones take.
    pub samples_per_pixel: f64,
}

/// The errors of all layers.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct LayerFigures {
    /// Irradiance after one gather; `None` if the reference is black.
    pub one_bounce: Option<ErrorFigures>,
    /// Irradiance after all bounces.
    pub full: Option<ErrorFigures>,
    /// The picture.
    #[serde(rename = "final")]
    pub picture: Option<ErrorFigures>,
    /// The picture after its first frame.
    #[serde(default)]
    pub first_frame: Option<ErrorFigures>,
}

/// Renders the layers of a scene. The view of the settings does not matter; `progress` is called
/// with the stages of [`Renderer`].
///
/// # Errors
/// As [`Renderer::new`] and [`Renderer::render`].
pub async fn render_layers(
    gpu: &Gpu,
    scene: &Scene,
    camera: &Camera,
    settings: &RenderSettings,
    progress: &mut dyn FnMut(RenderProgress),
) -> Result<RenderedLayers, RenderError> {
    let one_bounce = RenderSettings { bounces: 1, view: View::Diffuse, ..settings.clone() };
    let mut renderer = Renderer::new(gpu, scene, Some(camera), one_bounce, progress).await?;
    let one_bounce = irradiance(&renderer.render(progress).await?.into());
    let every_bounce = RenderSettings { view: View::Diffuse, ..settings.clone() };
    renderer.set_settings(every_bounce, progress).await?;
    let full = irradiance(&renderer.render(progress).await?.into());
    renderer.set_view(View::Final, 0)?;
    let start = Instant::now();
    renderer.render_frame().await?;
    let first_frame = LinearPicture::from(&renderer.finish().await?);
    let picture = LinearPicture::from(&renderer.render(progress).await?);
    let frame_ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(settings.frames);
    renderer.set_view(View::Cost, 0)?;
    for _ in 0..COST_FRAMES {
        renderer.render_frame().await?;
    }
    let samples = renderer.finish().await?.hdr;
    let sum: f64 = samples.iter().map(|pixel| f64::from(pixel[0])).sum();
    let cost = Cost { frame_ms, samples_per_pixel: sum / samples.len() as f64 };
    Ok(RenderedLayers { one_bounce, full, picture, first_frame, cost })
}

/// Converts the diffuse view, irradiance / pi.
fn irradiance(diffuse: &LinearPicture) -> LinearPicture {
    let rgb = diffuse.rgb.iter().map(|rgb| (Vec3::from(*rgb) * std::f32::consts::PI).to_array());
    LinearPicture { size: diffuse.size, rgb: rgb.collect() }
}

impl From<crate::Picture> for LinearPicture {
    fn from(picture: crate::Picture) -> Self {
        Self::from(&picture)
    }
}

impl ReferenceLayers {
    /// One of the layers.
    pub fn layer(&self, rgb: &[[f32; 3]]) -> LinearPicture {
        LinearPicture { size: self.size, rgb: rgb.to_vec() }
    }
}

impl LayerFigures {
    /// Compares a rendering with its reference.
    ///
    /// # Errors
    /// [`CompareError`] when the sizes differ or a value is not finite.
    pub fn new(reference: &ReferenceLayers, ours: &RenderedLayers) -> Result<Self, CompareError> {
        let figures = |rgb: &[[f32; 3]], variance: &[f32], ours: &LinearPicture| {
            let variance = Some(variance).filter(|values| values.iter().all(|v| v.is_finite()));
            match ErrorFigures::new(&reference.layer(rgb), variance, ours) {
                Ok(figures) => Ok(Some(figures)),
                Err(CompareError::Black { .. }) => Ok(None),
                Err(error) => Err(error),
            }
        };
        Ok(Self {
            one_bounce: figures(
                &reference.one_bounce,
                &reference.one_bounce_variance,
                &ours.one_bounce,
            )?,
            full: figures(&reference.full, &reference.full_variance, &ours.full)?,
            picture: figures(&reference.radiance, &reference.radiance_variance, &ours.picture)?,
            first_frame: figures(
                &reference.radiance,
                &reference.radiance_variance,
                &ours.first_frame,
            )?,
        })
    }

    /// The mean of figures from several grid positions.
    pub fn mean(figures: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> Option<ErrorFigures>| {
            let figures: Option<Vec<ErrorFigures>> = figures.iter().map(of).collect();
            figures.and_then(|figures| ErrorFigures::mean(&figures))
        };
        Self {
            one_bounce: mean(|figures| figures.one_bounce),
            full: mean(|figures| figures.full),
            picture: mean(|figures| figures.picture),
            first_frame: mean(|figures| figures.first_frame),
        }
    }
}
