//! One renderer for all pictures of a sequence.
//!
//! With [`History::Kept`] it works like the window's renderer: objects move from frame to frame,
//! and frames reuse light of earlier ones. With [`History::None`] each picture starts without
//! history.

use lumivox_render::{Exposure, Picture, RenderProgress, RenderSettings, Renderer};
use lumivox_scene::{Camera, Places};

use crate::commands::render::job::RenderJob;
use crate::commands::render::noise;
use crate::progress::{ProgressDisplay, words};
use crate::timeline::History;

/// The renderer for all pictures of a sequence, with the pose that it last showed.
#[derive(Debug, Default)]
pub struct Film {
    shown: Option<(Renderer, Places)>,
}

/// A picture's place in the progress.
pub struct Step<'a> {
    /// The name of the stage.
    pub stage: &'static str,
    pub progress: &'a ProgressDisplay,
    /// Pictures before this one.
    pub done: u32,
    pub total: u32,
}

impl Film {
    /// Shows the job's scene in its current pose, from a camera. Later scenes may differ from the
    /// first only in their pose.
    ///
    /// # Errors
    /// When something does not fit the device, or the device fails.
    pub fn show(
        &mut self,
        step: &Step<'_>,
        job: &RenderJob<'_>,
        camera: &Camera,
        history: History,
    ) -> anyhow::Result<()> {
        let (gpu, scene) = (&job.gpu, &job.scene);
        let tell = &mut |progress| step.prepares(progress);
        let Some((renderer, places)) = &mut self.shown else {
            let settings = film_settings(job, history);
            let renderer = Renderer::new(gpu, scene, Some(camera), settings, tell);
            self.shown = Some((pollster::block_on(renderer)?, Places::of(scene)));
            return Ok(());
        };
        let moved = places.moved(scene);
        if moved.shapes {
            pollster::block_on(renderer.set_scene(scene, tell))?;
        } else if moved.lights || !moved.instances.is_empty() {
            // Also updates the lights. The unit of radiance must not change between pictures.
            pollster::block_on(renderer.move_instances(scene, &moved.instances, tell))?;
        }
        *places = Places::of(scene);
        if renderer.camera() != camera {
            renderer.set_camera(camera.clone());
        }
        if history == History::None {
            pollster::block_on(renderer.cut(tell))?;
        }
        Ok(())
    }

    /// Renders the picture; with [`History::Kept`], all its frames in addition to earlier ones.
    /// Returns `None` if the user stopped it; a later run then renders it again.
    ///
    /// # Errors
    /// When nothing is shown, or the device fails.
    pub fn render(
        &mut self,
        step: &Step<'_>,
        job: &RenderJob<'_>,
        history: History,
    ) -> anyhow::Result<Option<Picture>> {
        let renderer = self.renderer_mut()?;
        let tell = &mut |progress| {
            step.renders(progress);
            step.progress.goes_on()
        };
        Ok(match history {
            History::Kept => pollster::block_on(renderer.render_more(job.settings.frames, tell))?,
            History::None => {
                noise::render(renderer, job.may_stop(), tell)?.map(|(picture, _)| picture)
            }
        })
    }

    /// Renders a single frame.
    ///
    /// # Errors
    /// When nothing is shown, or the device fails.
    pub fn glimpse(&mut self) -> anyhow::Result<Picture> {
        let renderer = self.renderer_mut()?;
        pollster::block_on(renderer.render_frame())?;
        Ok(pollster::block_on(renderer.finish())?)
    }

    /// Changes the exposure of pictures from now on.
    pub fn set_exposure(&mut self, exposure: Exposure) {
        if let Some((renderer, _)) = &mut self.shown {
            renderer.set_exposure(exposure);
        }
    }

    /// The renderer; `None` before anything was shown.
    pub fn renderer(&self) -> Option<&Renderer> {
        self.shown.as_ref().map(|(renderer, _)| renderer)
    }

    fn renderer_mut(&mut self) -> anyhow::Result<&mut Renderer> {
        let shown = self.shown.as_mut().map(|(renderer, _)| renderer);
        shown.ok_or_else(|| anyhow::anyhow!("a picture without a scene"))
    }
}

/// The settings of the renderer. With [`History::Kept`] there are at least two frames: one frame
/// always samples the middles of pixels, so edges would stay jagged.
fn film_settings(job: &RenderJob<'_>, history: History) -> RenderSettings {
    let frames = job.settings.frames;
    let frames = if history == History::Kept { frames.max(2) } else { frames };
    RenderSettings { frames, ..job.settings.clone() }
}

impl Step<'_> {
    /// Reports the progress of preparing a scene; only the first takes long.
    fn prepares(&self, progress: RenderProgress) {
        match self.done {
            0 => self.progress.set(words(progress.stage), progress.done, progress.total),
            _ => self.tell_share(0.0),
        }
    }

    fn renders(&self, progress: RenderProgress) {
        self.tell_share(f64::from(progress.done) / f64::from(progress.total.max(1)));
    }

    fn tell_share(&self, share: f64) {
        self.progress.set_within(self.stage, self.done, self.total, share);
    }
}
