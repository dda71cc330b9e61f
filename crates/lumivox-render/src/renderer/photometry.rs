//! Light as numbers: at a pixel of the frames so far, and at arbitrary points.

use glam::{UVec2, Vec3};
use lumivox::{GatherSettings, Irradiance};

use super::Renderer;
use crate::gpu::readback::read_texel;
use crate::picture::tone_map::luminance;
use crate::{RenderError, View};

/// The light of a pixel, as light meters would measure it: the mean over the frames so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photometry {
    /// The luminance at the camera, cd/m².
    pub luminance_cd_m2: f32,
    /// The direct and indirect illuminance of the surface, lux. `None` for the background, and in
    /// views that do not show all light.
    pub illuminance_lux: Option<f32>,
}

impl Renderer {
    /// The light at a pixel, counted from the top left; reads two texels back. `None` outside the
    /// picture, before the first frame, and for views that do not show light.
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

    /// The irradiance in lux at points in the world, m, on surfaces or in the air, with normals of
    /// any length except zero: the reading of a lux meter. Gathered by the settings' cones, with
    /// the picture's bounces, over `frames` frames (1 to 65 536) with different directions.
    ///
    /// # Errors
    /// [`RenderError::Setting`] in a look without physical units; [`RenderError::Gi`] as
    /// [`lumivox::Gi::gather`].
    pub async fn irradiance(
        &self,
        points: &[Vec3],
        normals: &[Vec3],
        frames: u32,
    ) -> Result<Vec<Irradiance>, RenderError> {
        if self.settings.look.is_some() {
            return Err(RenderError::Setting {
                name: "look",
                value: self.settings.look_name().to_owned(),
                expected: "physical, for light in lux".to_owned(),
            });
        }
        let mut settings = GatherSettings::default();
        (settings.cones, settings.frames) = (self.settings.trace, frames);
        let mut gathered = self.gi.gather(points, normals, &self.lights, &settings).await?;
        let unit = self.scene.radiance_unit;
        for point in &mut gathered {
            point.direct *= unit;
            // Without bounces, only lamps and suns light surfaces.
            point.indirect *= if self.settings.bounces == 0 { 0.0 } else { unit };
        }
        self.gpu.check("gathering light at points")?;
        Ok(gathered)
    }
}
