//! The right side of a split: another view, or the path-traced reference as it improves.

use std::ops::ControlFlow;
use std::time::Duration;

use glam::UVec2;
use lumivox::gpu::Texture;
use lumivox_explorer::{Side, SplitSchedule};
use lumivox_render::reference::{PathTracer, ReferenceSettings};
use lumivox_render::{Exposure, Gpu, Picture, View};
use web_time::Instant;

use crate::error::WebError;
use crate::session::{Session, no_scene};
use crate::types::Split;

/// Time of path tracing between reports to the page.
const TRACE_FOR: Duration = Duration::from_millis(150);
/// Maximum samples of a reference, far more than needed.
const MOST_SAMPLES: u32 = 1 << 20;

/// The content of the right side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Right {
    /// Another view.
    View(View),
    /// The path-traced reference with this many samples of each pixel.
    Reference(u32),
}

impl Right {
    /// Reads a page's request.
    ///
    /// # Errors
    /// When there is no such view, or a number is out of range.
    pub fn named(split: &Split) -> Result<Self, WebError> {
        if !(0.0..=1.0).contains(&split.at) {
            return Err(WebError::value(format!(
                "the split is at {}, but must be from 0 to 1",
                split.at
            )));
        }
        if !(1..=MOST_SAMPLES).contains(&split.samples) {
            return Err(WebError::value(format!(
                "the reference has {} samples, but must have 1 to {MOST_SAMPLES}",
                split.samples
            )));
        }
        if split.right == "reference" {
            return Ok(Self::Reference(split.samples));
        }
        let view =
            View::ALL.into_iter().find(|view| view.name() == split.right).ok_or_else(|| {
                let names: Vec<&str> = View::ALL.iter().map(|view| view.name()).collect();
                WebError::value(format!(
                    "there is no view \"{}\"; there are reference, {}",
                    split.right,
                    names.join(", ")
                ))
            })?;
        Ok(Self::View(view))
    }
}

/// A finished picture that is shown.
#[derive(Debug)]
struct Still {
    pixels: Vec<[u8; 4]>,
    texture: Texture,
}

impl Still {
    fn new(gpu: &Gpu, size: UVec2, pixels: Vec<[u8; 4]>) -> Self {
        let extent = wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 };
        let texture = Texture::new(
            &gpu.device,
            &wgpu::TextureDescriptor {
                label: Some("still"),
                size: extent,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            },
        );
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * size.x),
            rows_per_image: None,
        };
        gpu.queue.write_texture(texture.as_image_copy(), pixels.as_flattened(), layout, extent);
        Self { pixels, texture }
    }
}

/// The right side of a split.
#[derive(Debug)]
pub struct Beside {
    /// Its content.
    pub right: Right,
    /// Its left edge, from 0 to 1.
    pub at: f32,
    schedule: SplitSchedule,
    left_still: Option<Still>,
    right_still: Option<Still>,
    tracer: Option<Box<PathTracer>>,
}

impl Beside {
    /// A right side without a picture yet.
    pub fn new(right: Right, at: f32) -> Self {
        let schedule = SplitSchedule::default();
        Self { right, at, schedule, left_still: None, right_still: None, tracer: None }
    }

    /// Starts again because the picture has changed.
    pub fn start_again(&mut self) {
        self.schedule.start_again();
    }

    /// Starts again because the scene has changed by itself.
    pub fn scene_changed(&mut self) {
        self.schedule.scene_changed();
    }

    /// Forgets the reference: the scene or the camera has changed.
    pub fn forget(&mut self) {
        self.tracer = None;
        if matches!(self.right, Right::Reference(_)) {
            self.right_still = None;
        }
    }

    /// The texture on the left; `None` while the explorer's own picture is the left one.
    pub fn left(&self) -> Option<&Texture> {
        self.left_still.as_ref().map(|still| &still.texture)
    }

    /// The pixels on the left.
    pub fn left_pixels(&self) -> Option<&[[u8; 4]]> {
        self.left_still.as_ref().map(|still| still.pixels.as_slice())
    }

    /// The texture on the right; `None` before the first frame.
    pub fn texture(&self) -> Option<&Texture> {
        self.right_still.as_ref().map(|still| &still.texture)
    }

    /// The pixels on the right, and their left edge.
    pub fn right_pixels(&self) -> Option<(&[[u8; 4]], f32)> {
        self.right_still.as_ref().map(|still| (still.pixels.as_slice(), self.at))
    }

    /// Samples of the reference so far.
    pub fn samples(&self) -> Option<u32> {
        match self.right {
            Right::View(_) => None,
            Right::Reference(_) => Some(self.tracer.as_ref().map_or(0, |tracer| tracer.samples())),
        }
    }

    /// Does the next piece of work; returns `true` once none is left. Changing pictures are not
    /// completed.
    ///
    /// # Errors
    /// When a view is refused, or the device fails.
    pub async fn advance(
        &mut self,
        session: &mut Session,
        is_changing: bool,
    ) -> Result<bool, WebError> {
        match self.right {
            Right::View(view) => self.advance_view(session, view, is_changing).await,
            Right::Reference(samples) => self.advance_reference(session, samples).await,
        }
    }

    async fn advance_view(
        &mut self,
        session: &mut Session,
        view: View,
        is_changing: bool,
    ) -> Result<bool, WebError> {
        let has_rendered = match self.schedule.next() {
            Some(Side::Left) => {
                self.left_still = None;
                session.render_view(session.view()).await?
            }
            Some(Side::Right) => self.render_right(session, view).await?,
            None => return Ok(true),
        };
        self.schedule.advance(has_rendered, is_changing);
        Ok(self.schedule.next().is_none())
    }

    /// Renders one frame of the right side; stores the left picture first.
    async fn render_right(&mut self, session: &mut Session, view: View) -> Result<bool, WebError> {
        let size = session.console.explorer.settings().size;
        if self.left_still.is_none() {
            let pixels = session.screen().await?;
            self.left_still = Some(Still::new(session.gpu(), size, pixels));
        }
        let has_rendered = session.render_view(view).await?;
        let pixels = session.screen().await?;
        self.right_still = Some(Still::new(session.gpu(), size, pixels));
        Ok(has_rendered)
    }

    /// Completes the left side first: it takes less time than the reference.
    async fn advance_reference(
        &mut self,
        session: &mut Session,
        samples: u32,
    ) -> Result<bool, WebError> {
        self.left_still = None;
        if session.render_view(session.view()).await? {
            return Ok(false);
        }
        let (gpu, size) = (session.gpu().clone(), session.console.explorer.settings().size);
        let tracer = match &mut self.tracer {
            Some(tracer) => tracer,
            None => {
                let scene = session.console.explorer.scene().ok_or_else(no_scene)?;
                let camera = Some(session.console.explorer.camera());
                let settings = ReferenceSettings { size, samples, ..ReferenceSettings::default() };
                let tracer = PathTracer::new(&gpu, scene, camera, settings).await?;
                self.tracer.insert(Box::new(tracer))
            }
        };
        let before = tracer.samples();
        let start = Instant::now();
        let mut has_time = |_| match start.elapsed() < TRACE_FOR {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        };
        if before < samples {
            tracer.render_batch(&mut has_time).await?;
        }
        let is_over = tracer.samples() >= samples;
        if tracer.samples() > before || self.right_still.is_none() {
            let settings = session.console.explorer.settings();
            let exposure = match session.view().is_light() {
                true => Exposure::Stops(session.stops()),
                false => settings.exposure,
            };
            let hdr = tracer.layers().picture();
            let picture = Picture::develop(&gpu, size, hdr, exposure, settings.tone_map).await?;
            self.right_still = Some(Still::new(&gpu, size, picture.ldr));
        }
        Ok(is_over)
    }
}
