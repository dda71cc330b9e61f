//! From radiance or data to 8 bits a channel.
//!
//! Colours are multiplied by 2 to the power of the exposure's stops, mapped by a curve, and encoded
//! for a screen (sRGB, IEC 61966-2-1). Data is only scaled, or shown as colours of a heat map.

mod curve;
mod histogram;

use bytemuck::{Pod, Zeroable};
use glam::UVec2;
use lumivox::gpu::{
    BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, uniform_buffer,
};

pub use histogram::Histogram;

use crate::gpu::textures::ScreenTextures;
use crate::{Exposure, ToneMap};

/// Values of `ToneMapSettings::encoding` in the shader.
pub(crate) const ENCODE_COLOR: u32 = 0;
pub(crate) const ENCODE_DATA: u32 = 1;
pub(crate) const ENCODE_HEAT: u32 = 2;
pub(crate) const ENCODE_LOG_HEAT: u32 = 3;

/// The format of the pixels for a screen.
const SCREEN_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The middle grey that automatic exposure aims at (Reinhard et al. 2002, section 3.1).
const MIDDLE_GREY: f64 = 0.18;
/// Automatic exposure maps the luminance that a fifth of the surface exceeds, such as the ground of
/// a studio, to this value: white objects beside it are then nearly white, and no large surface is
/// clipped. A patch of sun may be.
const LIGHT_GREY: f64 = 0.6;
/// The most stops by which [`LIGHT_GREY`] may darken and brighten the result, relative to a
/// middle-grey mean.
const UNDER_AND_OVER: [f32; 2] = [2.0, 1.5];
/// The range that cameras expose for, in EV at ISO 100: from a landscape under stars to snow in
/// full sun (ANSI PH2.7-1986, "Photographic exposure guide", table 1).
pub const EV100_RANGE: std::ops::RangeInclusive<f32> = -6.0..=17.0;
/// The luminance at EV 0 and ISO 100: a reflected-light meter reads `K 2^EV / 100` cd/m², K = 12.5
/// (ISO 2720:1974).
const METER_CD_M2: f64 = 0.125;
/// A picture counts as black if fewer than this share of its pixels reach [`FIRST_CODE`].
const SHOWN: f64 = 1e-3;
/// The linear value of the first code above black (IEC 61966-2-1).
const FIRST_CODE: f64 = 1.0 / (255.0 * 12.92);
/// Pixels darker than this share of the picture's mean luminance are ignored: black has no
/// logarithm, and half of a direct-light view may be black.
const DARKEST: f64 = 1e-3;

/// The encoding of a picture for a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Encoding {
    /// Linear colour: multiplied, mapped by the curve, sRGB-encoded.
    Color {
        /// The factor.
        scale: f32,
        /// The curve.
        curve: ToneMap,
    },
    /// Data: the value, times `scale`, plus `offset` where there is a surface, is the code from 0
    /// to 1.
    Data {
        /// The factor.
        scale: f32,
        /// The added value.
        offset: f32,
    },
    /// The first channel times `scale`, from 0 to 1, as colours from dark violet to yellow.
    Heat {
        /// The factor.
        scale: f32,
    },
    /// The base-2 logarithm of 1 plus the first channel, times `scale`, in the same colours.
    LogHeat {
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
    /// Creates the pipeline and the texture that it writes.
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
        let kernel = Kernel::new(device, shaders, "render::picture::tone_map", "main", &[&layout])?;
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

    /// Like [`Self::record`], with a kernel that blends one more texture over the result.
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

    /// The bindings of `tone_map.wgsl`, to which other shaders can add theirs.
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

    /// The result: `Rgba8Unorm`, already encoded.
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
            Encoding::LogHeat { scale } => {
                Self { encoding: ENCODE_LOG_HEAT, curve: 0, scale, offset: 0.0 }
            }
        }
    }
}

impl Exposure {
    /// The stops; `None` if they depend on the picture.
    pub fn fixed_stops(self) -> Option<f32> {
        match self {
            Self::Auto | Self::AutoEach => None,
            Self::Stops(stops) => Some(stops),
        }
    }

    /// The stops for a picture of radiances in cd/m² (rgb; a is 1 where there is a surface): see
    /// [`Exposure::meter`].
    pub fn stops(self, picture: &[[f32; 4]]) -> f32 {
        match self {
            Self::Stops(stops) => stops,
            Self::Auto | Self::AutoEach => automatic(picture).0,
        }
    }

    /// Measures a picture: the stops, its histogram, and a warning if it cannot be a good picture.
    ///
    /// Automatic exposure maps the geometric mean of the surfaces' luminance to 0.18 (Reinhard et
    /// al. 2002, "Photographic tone reproduction for digital images", equation 1). From there it
    /// moves by up to 1.5 stops up or two down, so that the luminance that only a fifth of the
    /// surfaces exceeds becomes a light grey. It stays within [`EV100_RANGE`]; the stops of a
    /// picture without light or surfaces are 0.
    pub fn meter(self, picture: &[[f32; 4]]) -> Metering {
        let (automatic, wanted) = automatic(picture);
        let stops = self.fixed_stops().unwrap_or(automatic);
        let scale = f64::from(stops.exp2());
        let is_shown = |&&[r, g, b, _]: &&[f32; 4]| luminance([r, g, b]) * scale >= FIRST_CODE;
        let shown = picture.iter().filter(is_shown).count();
        let warning = if (shown as f64) < SHOWN * picture.len() as f64 {
            Some(ExposureWarning::Black)
        } else if self.fixed_stops().is_none() && (wanted - automatic).abs() > 0.01 {
            let ev100 = ev100(wanted);
            Some(if wanted > automatic {
                ExposureWarning::TooDark { ev100 }
            } else {
                ExposureWarning::TooBright { ev100 }
            })
        } else {
            None
        };
        let histogram =
            Some(Histogram::of(picture.iter().map(|&[r, g, b, _]| luminance([r, g, b]))));
        Metering { stops, warning, histogram }
    }
}

/// The light measurements of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metering {
    /// The exposure of the picture, in stops.
    pub stops: f32,
    /// The problem with the picture's light, if there is one.
    pub warning: Option<ExposureWarning>,
    /// The histogram of its pixels; `None` if it shows no light.
    pub histogram: Option<Histogram>,
}

/// The reason why a camera would not expose the picture well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExposureWarning {
    /// All but a thousandth of the picture is black.
    Black,
    /// The scene has less light than cameras expose for; the picture is darker than requested.
    TooDark {
        /// The light in EV at ISO 100.
        ev100: f32,
    },
    /// The scene has more light than cameras expose for; the picture is brighter.
    TooBright {
        /// The light in EV at ISO 100.
        ev100: f32,
    },
}

impl std::fmt::Display for ExposureWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (least, most) = (EV100_RANGE.start(), EV100_RANGE.end());
        match self {
            Self::Black => write!(f, "the picture is black"),
            Self::TooDark { ev100 } => {
                write!(
                    f,
                    "the scene is darker than any that cameras expose for (EV100 {ev100:.1}, below {least})"
                )
            }
            Self::TooBright { ev100 } => {
                write!(
                    f,
                    "the scene is brighter than any that cameras expose for (EV100 {ev100:.1}, above {most})"
                )
            }
        }
    }
}

/// The exposure in stops at which the mean luminance of a meter becomes middle grey.
fn stops_of(ev100: f32) -> f32 {
    (MIDDLE_GREY / METER_CD_M2).log2() as f32 - ev100
}

fn ev100(stops: f32) -> f32 {
    stops_of(stops)
}

/// The stops of automatic exposure, with and without the limits of [`EV100_RANGE`].
fn automatic(picture: &[[f32; 4]]) -> (f32, f32) {
    let Some(grey) = middle_grey_stops(picture) else { return (0.0, 0.0) };
    let mut lit: Vec<f64> = surfaces(picture).collect();
    let fifth = lit.len() - 1 - lit.len() / 5;
    let (_, bright, _) = lit.select_nth_unstable_by(fifth, f64::total_cmp);
    let light_grey = (LIGHT_GREY / *bright).log2() as f32;
    let [under, over] = UNDER_AND_OVER;
    let wanted = light_grey.clamp(grey - under, grey + over);
    (wanted.clamp(stops_of(*EV100_RANGE.end()), stops_of(*EV100_RANGE.start())), wanted)
}

/// The stops at which the geometric mean of the surfaces' luminance becomes middle grey; `None`
/// without light.
pub(crate) fn middle_grey_stops(picture: &[[f32; 4]]) -> Option<f32> {
    geometric_mean(picture).map(|mean| (MIDDLE_GREY / mean).log2() as f32)
}

/// ITU-R BT.709-6, section 3.2.
pub(crate) fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// Luminance of the pixels that show a surface.
fn surfaces(picture: &[[f32; 4]]) -> impl Iterator<Item = f64> + '_ {
    let shown = picture.iter().filter(|pixel| pixel[3] >= 0.5);
    shown.map(|&[r, g, b, _]| luminance([r, g, b]))
}

/// The geometric mean of luminance over the pixels that show a surface.
fn geometric_mean(picture: &[[f32; 4]]) -> Option<f64> {
    let count = surfaces(picture).count();
    let mean = surfaces(picture).sum::<f64>() / count as f64;
    if count == 0 || !mean.is_finite() || mean <= 0.0 {
        return None;
    }
    let lit = || surfaces(picture).filter(|luminance| *luminance >= DARKEST * mean);
    // Not empty: the brightest pixel is at least as bright as the mean.
    Some((lit().map(f64::ln).sum::<f64>() / lit().count() as f64).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SKY: [f32; 4] = [1e6, 1e6, 1e6, 0.0];
    const BLACK: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

    fn grey(luminance: f32) -> [f32; 4] {
        [luminance, luminance, luminance, 1.0]
    }

    #[test]
    fn middle_grey_is_the_geometric_mean_of_surfaces() {
        // The pixel before black is below a thousandth of the mean, so it is ignored.
        let stops = middle_grey_stops(&[grey(4.0), grey(1.0), SKY, grey(1e-3), BLACK]).unwrap();
        assert!((stops - (0.18_f32 / 2.0).log2()).abs() < 1e-5, "{stops}");
        for dark in [&[SKY][..], &[[0.0; 4]], &[BLACK], &[]] {
            assert_eq!(middle_grey_stops(dark), None);
            assert_eq!(Exposure::Auto.stops(dark), 0.0);
        }
        assert_eq!(Exposure::Stops(-3.0).stops(&[grey(4.0)]), -3.0);
    }

    /// On a grey ground a white object is nearly white, a black one black, and the ground stays
    /// grey.
    #[test]
    fn auto_exposure_shows_a_white_object_nearly_white() {
        let shown = |thing: f32, covered: usize| {
            let picture: Vec<[f32; 4]> =
                (0..100).map(|i| grey(if i < covered { thing } else { 0.5 } * 300.0)).collect();
            let scale = Exposure::Auto.stops(&picture).exp2() * 300.0;
            (thing * scale, 0.5 * scale)
        };
        for covered in [10, 30, 70] {
            let (white, ground) = shown(0.8, covered);
            assert!(
                (0.55..1.0).contains(&white) && (0.35..0.65).contains(&ground),
                "{covered} %: {white} {ground}"
            );
            let (black, ground) = shown(0.02, covered);
            assert!(black < 0.06 && ground <= 0.65, "{covered} %: {black} {ground}");
        }
        // A lit window in a dark room may be clipped.
        let mut room = vec![grey(10.0); 90];
        room.extend([grey(3000.0); 10]);
        assert!(Exposure::Auto.stops(&room).exp2() * 10.0 > 0.08);
    }

    #[test]
    fn extreme_exposures_give_a_warning() {
        let meter = |luminance: f32| Exposure::Auto.meter(&[grey(luminance); 50]);
        // The brightest fifth equals the mean, so exposure is the most above middle grey: 1.5
        // stops.
        let lit = meter(100.0);
        assert!((lit.stops - (0.18_f32 / 100.0).log2() - 1.5).abs() < 1e-5, "{lit:?}");
        assert_eq!(lit.warning, None);
        let dark = meter(1e-6);
        assert!((dark.stops - 6.53).abs() < 0.01, "{dark:?}");
        assert!(matches!(dark.warning, Some(ExposureWarning::Black)), "{dark:?}");
        let dim = meter(5e-4);
        assert!(
            matches!(dim.warning, Some(ExposureWarning::TooDark { ev100 }) if ev100 < -7.0),
            "{dim:?}"
        );
        let told = dim.warning.unwrap().to_string();
        assert!(told.contains("EV100 -9.5, below -6"), "{told}");
        let bright = meter(1e6);
        assert!((bright.stops + 16.47).abs() < 0.01, "{bright:?}");
        assert!(matches!(bright.warning, Some(ExposureWarning::TooBright { .. })));
        assert_eq!(Exposure::Auto.meter(&[BLACK; 9]).warning, Some(ExposureWarning::Black));
        // A fixed exposure gives no warning, unless the picture is black.
        assert_eq!(Exposure::Stops(3.0).meter(&[grey(1e-3); 9]).warning, None);
        assert_eq!(
            Exposure::Stops(-30.0).meter(&[grey(1.0); 9]).warning,
            Some(ExposureWarning::Black)
        );
    }
}
