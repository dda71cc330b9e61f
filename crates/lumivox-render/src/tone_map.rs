//! From radiance or data to 8 bits a channel.
//!
//! Colours are multiplied by 2 to the power of the exposure's stops, bent by a curve, and encoded for
//! a screen (sRGB, IEC 61966-2-1). Data is scaled alone, or shown as colours of a heat map.

mod curve;

use bytemuck::{Pod, Zeroable};
use glam::UVec2;
use lumivox::gpu::{
    BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, uniform_buffer,
};

use crate::textures::ScreenTextures;
use crate::{Exposure, ToneMap};

/// Values of `ToneMapSettings::encoding` in the shader.
pub(crate) const ENCODE_COLOR: u32 = 0;
pub(crate) const ENCODE_DATA: u32 = 1;
pub(crate) const ENCODE_HEAT: u32 = 2;

/// Of what a screen shows.
const SCREEN_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The middle grey that automatic exposure aims at (Reinhard et al. 2002, section 3.1).
const MIDDLE_GREY: f64 = 0.18;
/// Pixels darker than this share of the picture's mean luminance do not count: black has no logarithm,
/// and where direct light alone is shown, half of a picture may be black.
const DARKEST: f64 = 1e-3;

/// How a picture is brought to the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// Linear colour: multiplied, bent by the curve, sRGB-encoded.
    Color {
        /// The factor.
        scale: f32,
        /// The curve.
        curve: ToneMap,
    },
    /// Numbers: the code from 0 to 1 is `scale` times the number, plus `offset` where there is a
    /// surface.
    Data {
        /// The factor.
        scale: f32,
        /// What is added.
        offset: f32,
    },
    /// The first channel times `scale`, from 0 to 1, as colours from dark violet to yellow.
    Heat {
        /// The factor.
        scale: f32,
    },
}

/// `ToneMapSettings` of `tone_map.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ToneMapSettings {
    pub(crate) encoding: u32,
    pub(crate) curve: u32,
    pub(crate) scale: f32,
    pub(crate) offset: f32,
}

/// Tone maps a picture.
#[derive(Debug)]
pub struct ToneMapPass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    settings: Buffer,
    screen: Texture,
    size: UVec2,
}

impl ToneMapPass {
    /// Makes the pipeline and the texture that it writes.
    ///
    /// # Errors
    /// When the shader does not link.
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        textures: &mut ScreenTextures<'_>,
        size: UVec2,
    ) -> Result<Self, ShaderError> {
        let layout = Self::layout().build(device, "tone map");
        let kernel = Kernel::new(device, shaders, "render::tone_map", "main", &[&layout])?;
        let settings = uniform_buffer(device, "tone map", &ToneMapSettings::zeroed());
        let screen = textures.create("screen", SCREEN_FORMAT, wgpu::TextureUsages::STORAGE_BINDING);
        Ok(Self { kernel, layout, settings, screen, size })
    }

    /// Tone maps `picture`; once per submission.
    pub fn record(&self, recorder: &mut Recorder, picture: &Texture, encoding: Encoding) {
        self.set(recorder, encoding);
        let (picture, screen) = (picture.view(), self.screen.view());
        let group = self.bind(&self.layout, &picture, &screen).build(recorder.device(), "tone map");
        self.kernel.run(recorder, &[&group], [self.size.x, self.size.y, 1]);
    }

    /// The same by a kernel with one texture more, which comes on top.
    pub(crate) fn record_below(
        &self,
        recorder: &mut Recorder,
        picture: &Texture,
        encoding: Encoding,
        (kernel, layout): (&Kernel, &wgpu::BindGroupLayout),
        over: &TextureView,
    ) {
        self.set(recorder, encoding);
        let (picture, screen) = (picture.view(), self.screen.view());
        let group = self.bind(layout, &picture, &screen).view(over);
        let group = group.build(recorder.device(), "tone map and overlay");
        kernel.run(recorder, &[&group], [self.size.x, self.size.y, 1]);
    }

    /// The bindings of `tone_map.wgsl`, to which others may add theirs.
    pub(crate) fn layout() -> LayoutBuilder {
        LayoutBuilder::compute()
            .uniform()
            .texture_2d_unfilterable()
            .storage_texture(wgpu::TextureViewDimension::D2, SCREEN_FORMAT)
    }

    fn bind<'a>(
        &'a self,
        layout: &'a wgpu::BindGroupLayout,
        picture: &'a TextureView,
        screen: &'a TextureView,
    ) -> BindGroupBuilder<'a> {
        BindGroupBuilder::new(layout).buffer(&self.settings).view(picture).view(screen)
    }

    fn set(&self, recorder: &Recorder, encoding: Encoding) {
        let settings = ToneMapSettings::from(encoding);
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
    }

    /// What was written: `Rgba8Unorm`, already encoded.
    pub fn screen(&self) -> &Texture {
        &self.screen
    }
}

impl From<Encoding> for ToneMapSettings {
    fn from(encoding: Encoding) -> Self {
        match encoding {
            Encoding::Color { scale, curve } => {
                Self { encoding: ENCODE_COLOR, curve: curve as u32, scale, offset: 0.0 }
            }
            Encoding::Data { scale, offset } => {
                Self { encoding: ENCODE_DATA, curve: 0, scale, offset }
            }
            Encoding::Heat { scale } => {
                Self { encoding: ENCODE_HEAT, curve: 0, scale, offset: 0.0 }
            }
        }
    }
}

impl Exposure {
    /// The stops, where they do not depend on a picture.
    pub fn fixed_stops(self) -> Option<f32> {
        match self {
            Self::Auto => None,
            Self::Stops(stops) => Some(stops),
        }
    }

    /// The stops for a picture of radiances (rgb, and in a whether there is a surface) in cd/m².
    ///
    /// Automatic exposure maps the geometric mean of luminance to 0.18 (Reinhard et al. 2002,
    /// "Photographic tone reproduction for digital images", equation 1); a picture without light or
    /// surfaces is left as it is.
    pub fn stops(self, picture: &[[f32; 4]]) -> f32 {
        match self {
            Self::Stops(stops) => stops,
            Self::Auto => {
                geometric_mean(picture).map_or(0.0, |mean| (MIDDLE_GREY / mean).log2() as f32)
            }
        }
    }
}

/// ITU-R BT.709-6, section 3.2.
pub(crate) fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// The geometric mean of luminance over the pixels that show a surface.
fn geometric_mean(picture: &[[f32; 4]]) -> Option<f64> {
    let surfaces = || {
        let shown = picture.iter().filter(|pixel| pixel[3] >= 0.5);
        shown.map(|&[r, g, b, _]| luminance([r, g, b]))
    };
    let count = surfaces().count();
    let mean = surfaces().sum::<f64>() / count as f64;
    if count == 0 || !mean.is_finite() || mean <= 0.0 {
        return None;
    }
    let lit = || surfaces().filter(|luminance| *luminance >= DARKEST * mean);
    // The brightest pixel is at least as bright as the mean, so there is one.
    Some((lit().map(f64::ln).sum::<f64>() / lit().count() as f64).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn automatic_exposure_makes_the_geometric_mean_grey() {
        let bright = [4.0, 4.0, 4.0, 1.0];
        let dark = [1.0, 1.0, 1.0, 1.0];
        let sky = [1e6, 1e6, 1e6, 0.0];
        let stops = Exposure::Auto.stops(&[bright, dark, sky, [0.0, 0.0, 0.0, 1.0]]);
        assert!((stops - (0.18_f32 / 2.0).log2()).abs() < 1e-5, "{stops}");
        assert_eq!(Exposure::Auto.stops(&[sky]), 0.0);
        assert_eq!(Exposure::Auto.stops(&[[0.0; 4]]), 0.0);
        assert_eq!(Exposure::Stops(-3.0).stops(&[bright]), -3.0);
    }
}
