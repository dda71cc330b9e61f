//! The light at one pixel of the frames so far.

use glam::UVec2;

use super::Renderer;
use crate::gpu::readback::read_texel;
use crate::picture::tone_map::luminance;
use crate::{RenderError, View};

/// The light of a pixel, as light meters measure it: the mean over the frames so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photometry {
    /// The luminance that a camera sees, cd/m².
    pub luminance_cd_m2: f32,
    /// The illuminance of the surface, direct and indirect, lux. `None` over the background, and in
    /// views that do not show all light.
    pub illuminance_lux: Option<f32>,
}

impl Renderer {
    /// The light at a pixel, counted from the top left; reads two texels back. `None` outside the
    /// picture, before the first frame, and for views that show no light.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn photometry(&self, pixel: UVec2) -> Result<Option<Photometry>, RenderError> {
        let Self { gpu, settings, targets, .. } = self;
        let is_inside = pixel.cmplt(settings.size).all();
        if !is_inside || self.frame_count() == 0 || !settings.view.is_light() {
            return Ok(None);
        }
        let unit = self.scene.radiance_unit;
        let [r, g, b, _]: [f32; 4] = read_texel(gpu, targets.accumulate.mean(), pixel).await?;
        let luminance_cd_m2 = luminance([r, g, b]) as f32 * unit;
        let is_known = settings.view == View::Final && settings.look.is_none();
        let illuminance_lux = if is_known {
            let texel: f32 = read_texel(gpu, &targets.composite.illuminance, pixel).await?;
            (texel >= 0.0).then_some(texel * unit)
        } else {
            None
        };
        gpu.check("reading the light at a pixel")?;
        Ok(Some(Photometry { luminance_cd_m2, illuminance_lux }))
    }
}
