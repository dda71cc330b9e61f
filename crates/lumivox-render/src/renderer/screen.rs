//! From the mean over frames to screens and files.

use lumivox::gpu::{Recorder, Texture};

use super::Renderer;
use crate::gpu::readback::read_texture;
use crate::picture::tone_map::Encoding;
use crate::scene::corners;
use crate::{
    COST_SCALE_SAMPLES, HISTORY_SCALE_FRAMES, Metering, Picture, RenderError, ToneMap, View,
};

impl Renderer {
    /// The picture of the frames so far, of which there must be at least one.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn finish(&mut self) -> Result<Picture, RenderError> {
        let hdr = self.read_mean().await?;
        let stops = self.stops_of(&hdr);
        let ldr = self.screen(stops).await?;
        Ok(Picture { size: self.settings.size, hdr, ldr })
    }

    /// Measures the frames so far: the stops that [`Self::finish`] uses, a warning, and the
    /// histogram. Reads the picture back.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn meter(&self) -> Result<Metering, RenderError> {
        if !self.settings.view.is_light() {
            return Ok(Metering { stops: 0.0, warning: None, histogram: None });
        }
        Ok(self.settings.exposure.meter(&self.read_mean().await?))
    }

    /// The screen pixels of the frames so far, row by row from the top, exposed by a number of
    /// stops. For live views, which meter now and then and otherwise read back 8 bits a channel.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn screen(&mut self, stops: f32) -> Result<Vec<[u8; 4]>, RenderError> {
        self.draw_screen(stops).await?;
        let ldr = read_texture(&self.gpu, self.screen_texture()).await?;
        self.gpu.check("reading the picture back")?;
        Ok(ldr)
    }

    /// Like [`Self::screen`], but without a read-back: the result is in [`Self::screen_texture`].
    ///
    /// # Errors
    /// When the device fails.
    pub async fn draw_screen(&mut self, stops: f32) -> Result<(), RenderError> {
        let encoding = self.encoding(stops);
        let mut recorder =
            Recorder::with_timing(&self.gpu.device, &self.gpu.queue, self.settings.timing);
        recorder.stage("picture");
        self.record_screen(&mut recorder, encoding);
        self.times.add(recorder.finish().await?);
        Ok(())
    }

    /// The texture that [`Self::draw_screen`] last drew: `Rgba8Unorm`, encoded for a screen, with
    /// the picture's size.
    pub fn screen_texture(&self) -> &Texture {
        self.targets.tone_map.screen()
    }

    /// The mean over the frames so far, row by row from the top: light in cd/m², other quantities
    /// in the view's unit. [`Self::finish`] also encodes it for a screen.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn read_mean(&self) -> Result<Vec<[f32; 4]>, RenderError> {
        let mean = self.targets.accumulate.mean();
        let mut hdr: Vec<[f32; 4]> = read_texture(&self.gpu, mean).await?;
        if self.settings.view.is_light() {
            let unit = self.scene.radiance_unit;
            for pixel in &mut hdr {
                *pixel = [pixel[0] * unit, pixel[1] * unit, pixel[2] * unit, pixel[3]];
            }
            // A look may have lobes that subtract light.
            debug_assert!(
                self.settings.look.is_some()
                    || hdr.iter().all(|[rgb @ .., _]| rgb.iter().all(|value| *value >= 0.0)),
                "radiance is negative or not a number"
            );
        }
        Ok(hdr)
    }

    /// The stops for pixels in real units.
    fn stops_of(&self, hdr: &[[f32; 4]]) -> f32 {
        if self.settings.view.is_light() { self.settings.exposure.stops(hdr) } else { 0.0 }
    }

    /// The encoding of the current view for the screen. The GPU's texture is in multiples of the
    /// unit of radiance.
    fn encoding(&self, stops: f32) -> Encoding {
        match self.settings.view {
            View::Occlusion | View::Shadow | View::Disocclusion => {
                Encoding::Data { scale: 1.0, offset: 0.0 }
            }
            View::Normal => Encoding::Data { scale: 0.5, offset: 0.5 },
            View::Albedo | View::Lit | View::Nodes => {
                Encoding::Color { scale: 1.0, curve: ToneMap::Linear }
            }
            View::Cost => Encoding::Heat { scale: 1.0 / COST_SCALE_SAMPLES },
            View::History => Encoding::LogHeat { scale: 1.0 / (1.0 + HISTORY_SCALE_FRAMES).log2() },
            View::Depth => {
                let farthest_m = corners(self.scene.bounds)
                    .map(|corner| corner.distance(self.camera.position))
                    .into_iter()
                    .fold(f32::MIN_POSITIVE, f32::max);
                Encoding::Data { scale: -1.0 / farthest_m, offset: 1.0 }
            }
            _ => {
                let scale = stops.exp2() * self.scene.radiance_unit;
                Encoding::Color { scale, curve: self.settings.tone_map }
            }
        }
    }
}
