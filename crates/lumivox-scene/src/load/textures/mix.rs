//! Combines two images, for formats that spread channels over several images where a
//! [`Material`](crate::Material) has one.

use crate::load::color::{linear_from_srgb, srgb_from_linear};
use crate::load::image::Pixels;

/// The way to combine the texels of one or two images. Factors are compared by their bits, so that
/// equal recipes can be found.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(in crate::load) enum Mix {
    /// Red, green, blue and alpha, each from a channel of one of the images; `None` is 1.
    Channels([Option<(usize, usize)>; 4]),
    /// The diffuse albedo of the specular-glossiness model. The last image holds the specular
    /// colour, with the factor `specular`; the first of two is the diffuse colour. Energy that is
    /// reflected specularly is not reflected diffusely (glTF extension
    /// `KHR_materials_pbrSpecularGlossiness`): albedo = diffuse * (1 - max(specular)).
    SpecularDiffuse {
        /// The specular factor.
        specular: [Bits; 3],
    },
    /// Green is 1 - glossiness: the roughness. Glossiness is the image's alpha times a factor.
    GlossToRoughness {
        /// The glossiness factor.
        glossiness: Bits,
    },
}

/// A number that is compared by its bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::load) struct Bits(u32);

impl From<f32> for Bits {
    fn from(value: f32) -> Self {
        Self(value.to_bits())
    }
}

impl From<Bits> for f32 {
    fn from(bits: Bits) -> Self {
        Self::from_bits(bits.0)
    }
}

impl Mix {
    /// Mixes images to one of the given size; smaller images are enlarged.
    pub(super) fn mix(&self, images: &[Pixels], width: u32, height: u32) -> Pixels {
        let mut rgba8 = Vec::with_capacity(width as usize * height as usize * 4);
        let mut texels = Vec::with_capacity(images.len());
        for y in 0..height {
            for x in 0..width {
                texels.clear();
                texels.extend(images.iter().map(|image| sample(image, x, y, width, height)));
                rgba8.extend(self.texel(&texels));
            }
        }
        Pixels { width, height, rgba8 }
    }

    fn texel(&self, texels: &[[u8; 4]]) -> [u8; 4] {
        match self {
            Self::Channels(channels) => channels.map(|channel| match channel {
                Some((image, channel)) => texels[image][channel],
                None => 255,
            }),
            Self::SpecularDiffuse { specular } => {
                let [.., gloss] = texels else { return [255; 4] };
                let diffuse = if texels.len() > 1 { texels[0] } else { [255; 4] };
                let light = |byte: u8| linear_from_srgb(f32::from(byte) / 255.0);
                let most = (0..3)
                    .map(|c| f32::from(specular[c]) * light(gloss[c]))
                    .fold(0.0_f32, f32::max);
                let rest = (1.0 - most).clamp(0.0, 1.0);
                let [r, g, b, a] = diffuse;
                let albedo = |byte| to_byte(srgb_from_linear(light(byte) * rest));
                [albedo(r), albedo(g), albedo(b), a]
            }
            Self::GlossToRoughness { glossiness } => {
                let gloss = f32::from(*glossiness) * f32::from(texels[0][3]) / 255.0;
                [255, to_byte(1.0 - gloss), 255, 255]
            }
        }
    }
}

fn to_byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Samples `image` at the centre of texel (x, y) of an image of the given size, bilinearly.
fn sample(image: &Pixels, x: u32, y: u32, width: u32, height: u32) -> [u8; 4] {
    let texel = |x: u32, y: u32| {
        let at = (y as usize * image.width as usize + x as usize) * 4;
        [image.rgba8[at], image.rgba8[at + 1], image.rgba8[at + 2], image.rgba8[at + 3]]
    };
    if (image.width, image.height) == (width, height) {
        return texel(x, y);
    }
    let ((x0, x1, fx), (y0, y1, fy)) =
        (between(x, width, image.width), between(y, height, image.height));
    let corners = [texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1)];
    std::array::from_fn(|c| {
        let [a, b, d, e] = corners.map(|corner| f32::from(corner[c]));
        let (top, bottom) = (a + (b - a) * fx, d + (e - d) * fx);
        (top + (bottom - top) * fy).round() as u8
    })
}

/// The two texels of an edge of `to` texels around the centre of texel `i` of an edge of `from`
/// texels, and the weight of the second.
fn between(i: u32, from: u32, to: u32) -> (u32, u32, f32) {
    let at = (f64::from(i) + 0.5) * f64::from(to) / f64::from(from) - 0.5;
    let at = at.clamp(0.0, f64::from(to - 1));
    let first = at.floor() as u32;
    (first, (first + 1).min(to - 1), (at - at.floor()) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(edge: u32, texel: [u8; 4]) -> Pixels {
        Pixels { width: edge, height: edge, rgba8: texel.repeat((edge * edge) as usize) }
    }

    #[test]
    fn channels_are_taken_from_the_requested_images() {
        let mix = Mix::Channels([Some((0, 0)), Some((1, 1)), None, Some((1, 3))]);
        // The smaller image is enlarged.
        let mixed = mix.mix(&[flat(2, [10, 20, 30, 40]), flat(4, [50, 60, 70, 80])], 4, 4);
        assert_eq!(mixed, flat(4, [10, 60, 255, 80]));
    }

    #[test]
    fn enlarging_interpolates() {
        let mix = Mix::Channels([Some((0, 0)); 4]);
        let ramp = Pixels { width: 2, height: 1, rgba8: vec![0, 0, 0, 0, 200, 0, 0, 0] };
        let reds: Vec<u8> = mix.mix(&[ramp], 4, 1).rgba8.iter().copied().step_by(4).collect();
        assert_eq!(reds, [0, 50, 150, 200]);
    }

    #[test]
    fn specular_reflection_is_subtracted_from_diffuse() {
        // sRGB 188 is a linear 0.5029; half of it by the factor leaves 0.7486 of the diffuse white,
        // which is sRGB 224.
        let specular = [0.0.into(), 0.5.into(), 0.0.into()];
        let mix = Mix::SpecularDiffuse { specular };
        let mixed = mix.mix(&[flat(1, [255, 255, 0, 9]), flat(1, [255, 188, 255, 0])], 1, 1);
        assert_eq!(mixed, flat(1, [224, 224, 0, 9]));
        let mixed = mix.mix(&[flat(1, [255, 188, 255, 0])], 1, 1);
        assert_eq!(mixed, flat(1, [224, 224, 224, 255]));
        let mix = Mix::GlossToRoughness { glossiness: 0.5.into() };
        assert_eq!(mix.mix(&[flat(1, [0, 0, 0, 204])], 1, 1), flat(1, [255, 153, 255, 255]));
    }
}
