//! Reference files: `OpenEXR` with all layers in one file.
//!
//! 32-bit floats: the radiance is `R`, `G` and `B`, the coverage `A`; the others are `direct.R`,
//! `one_bounce.R`, `full.R`, `occlusion.Y`, `albedo.R`, `normal.X`, `depth.Z` and so on, and the
//! variances `variance.radiance`, `variance.direct`, `variance.one_bounce`, `variance.full` and
//! `variance.occlusion`. An attribute contains the number of samples and the scene's fingerprint.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, ReadChannels as _,
    ReadLayers as _, Text, WritableImage as _, read,
};
use glam::UVec2;
use lumivox_scene::{check_regular, write_atomically};

use super::ReferenceLayers;
use crate::{Exposure, Gpu, ImageFormat, Picture, RenderError, ToneMap};

/// A single attribute: several would be written in an order that differs between runs.
const ATTRIBUTE: &str = "lumivox.reference";

/// Layers of three channels, with the channels' names.
const COLORS: [(&str, [&str; 3]); 6] = [
    ("", ["R", "G", "B"]),
    ("direct.", ["R", "G", "B"]),
    ("one_bounce.", ["R", "G", "B"]),
    ("full.", ["R", "G", "B"]),
    ("albedo.", ["R", "G", "B"]),
    ("normal.", ["X", "Y", "Z"]),
];
const NUMBERS: [&str; 8] = [
    "A",
    "occlusion.Y",
    "depth.Z",
    "variance.radiance",
    "variance.direct",
    "variance.one_bounce",
    "variance.full",
    "variance.occlusion",
];

impl ReferenceLayers {
    fn colors(&mut self) -> [&mut Vec<[f32; 3]>; 6] {
        [
            &mut self.radiance,
            &mut self.direct,
            &mut self.one_bounce,
            &mut self.full,
            &mut self.albedo,
            &mut self.normal,
        ]
    }

    fn numbers(&mut self) -> [&mut Vec<f32>; 8] {
        [
            &mut self.coverage,
            &mut self.occlusion,
            &mut self.depth_m,
            &mut self.radiance_variance,
            &mut self.direct_variance,
            &mut self.one_bounce_variance,
            &mut self.full_variance,
            &mut self.occlusion_variance,
        ]
    }

    /// Writes all layers into one `OpenEXR` file, atomically.
    ///
    /// # Errors
    /// [`RenderError::Write`] when the file cannot be written; then no temporary file is left
    /// behind.
    pub fn write_exr(&self, path: &Path) -> Result<(), RenderError> {
        let written = write_atomically(path, |out| self.write_exr_to(out));
        written.map_err(|error| RenderError::Write {
            file: path.to_owned(),
            reason: error.to_string(),
        })
    }

    /// The bytes of a file: all layers as `OpenEXR`, or the picture as PNG with automatic exposure.
    ///
    /// # Errors
    /// When the device fails, or the picture is larger than the format allows.
    pub async fn encode(&self, gpu: &Gpu, format: ImageFormat) -> Result<Vec<u8>, RenderError> {
        let encoded = match format {
            ImageFormat::Exr => {
                let mut bytes = io::Cursor::new(Vec::new());
                self.write_exr_to(&mut bytes).map(|()| bytes.into_inner())
            }
            ImageFormat::Png => {
                let (exposure, curve) = (Exposure::Auto, ToneMap::default());
                let picture =
                    Picture::develop(gpu, self.size, self.picture(), exposure, curve).await?;
                picture.encode(format)
            }
        };
        encoded.map_err(|error| RenderError::Write {
            file: "picture".into(),
            reason: error.to_string(),
        })
    }

    fn write_exr_to(&self, out: &mut (impl io::Write + io::Seek)) -> io::Result<()> {
        let mut layers = self.clone();
        let mut channels: Vec<AnyChannel<FlatSamples>> = Vec::new();
        let mut add = |name: String, samples: Vec<f32>| {
            channels.push(AnyChannel::new(Text::new_or_panic(&name), FlatSamples::F32(samples)));
        };
        for ((layer, names), pixels) in COLORS.into_iter().zip(layers.colors()) {
            for (index, name) in names.into_iter().enumerate() {
                add(format!("{layer}{name}"), pixels.iter().map(|pixel| pixel[index]).collect());
            }
        }
        for (name, values) in NUMBERS.into_iter().zip(layers.numbers()) {
            add(name.to_owned(), std::mem::take(values));
        }
        let mut attributes = LayerAttributes::default();
        let word = format!("{} samples, fingerprint {}", self.samples, self.fingerprint);
        let value = AttributeValue::Text(Text::new_or_panic(&word));
        attributes.other.insert(Text::new_or_panic(ATTRIBUTE), value);
        let size = (self.size.x as usize, self.size.y as usize);
        let channels = AnyChannels::sort(channels.into());
        let layer = Layer::new(size, attributes, Encoding::FAST_LOSSLESS, channels);
        let image = exr::image::Image::from_layer(layer);
        // Single-threaded, so that the bytes are the same in every run.
        image.write().non_parallel().to_buffered(out).map_err(io::Error::other)
    }

    /// Reads a file written by [`ReferenceLayers::write_exr`].
    ///
    /// # Errors
    /// [`RenderError::Reference`] when the file cannot be read or lacks a layer.
    pub fn read_exr(path: &Path) -> Result<Self, RenderError> {
        let fail = |reason: String| RenderError::Reference { file: path.to_owned(), reason };
        check_regular(path).map_err(|error| fail(error.to_string()))?;
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(path)
            .map_err(|error| fail(error.to_string()))?;
        let layer = image.layer_data;
        let told = match layer.attributes.other.get(&Text::new_or_panic(ATTRIBUTE)) {
            Some(AttributeValue::Text(text)) => numbers(&text.to_string()),
            _ => None,
        };
        let not_ours = || fail("it is not a reference: `lumivox reference` writes one".to_owned());
        let (samples, fingerprint) = told.ok_or_else(not_ours)?;
        let mut found: BTreeMap<String, Vec<f32>> = BTreeMap::new();
        for channel in layer.channel_data.list {
            found.insert(channel.name.to_string(), channel.sample_data.values_as_f32().collect());
        }
        let mut take = |name: &str| {
            found.remove(name).ok_or_else(|| fail(format!("the channel {name} is missing")))
        };
        let size = UVec2::new(layer.size.x() as u32, layer.size.y() as u32);
        let mut layers = Self { size, samples, fingerprint, ..Self::empty() };
        for ((layer, names), pixels) in COLORS.into_iter().zip(layers.colors()) {
            let [r, g, b] = names.map(|name| take(&format!("{layer}{name}")));
            let both = r?.into_iter().zip(g?).zip(b?);
            *pixels = both.map(|((r, g), b)| [r, g, b]).collect();
        }
        for (name, values) in NUMBERS.into_iter().zip(layers.numbers()) {
            *values = take(name)?;
        }
        Ok(layers)
    }

    fn empty() -> Self {
        Self {
            size: UVec2::ZERO,
            samples: 0,
            fingerprint: 0,
            radiance: Vec::new(),
            direct: Vec::new(),
            one_bounce: Vec::new(),
            full: Vec::new(),
            occlusion: Vec::new(),
            albedo: Vec::new(),
            normal: Vec::new(),
            depth_m: Vec::new(),
            coverage: Vec::new(),
            radiance_variance: Vec::new(),
            direct_variance: Vec::new(),
            one_bounce_variance: Vec::new(),
            full_variance: Vec::new(),
            occlusion_variance: Vec::new(),
        }
    }
}

/// Parses the number of samples and the fingerprint from the attribute's text.
fn numbers(words: &str) -> Option<(u32, u64)> {
    let (samples, fingerprint) = words.split_once(" samples, fingerprint ")?;
    samples.parse().ok().zip(fingerprint.parse().ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers() -> ReferenceLayers {
        let mut layers = ReferenceLayers {
            size: UVec2::new(3, 2),
            samples: 20,
            fingerprint: u64::MAX - 5,
            ..ReferenceLayers::empty()
        };
        for (index, pixels) in layers.colors().into_iter().enumerate() {
            *pixels = (0..6).map(|i| [i as f32, index as f32, -0.5]).collect();
        }
        for (index, values) in layers.numbers().into_iter().enumerate() {
            *values = (0..6).map(|i| 1e-3 + (i * index) as f32).collect();
        }
        layers
    }

    #[test]
    fn reference_layers_round_trip_through_exr() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("reference.exr");
        layers().write_exr(&file).expect("written");
        assert_eq!(ReferenceLayers::read_exr(&file).expect("read"), layers());
    }

    #[test]
    fn other_files_are_refused_by_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("picture.exr");
        let picture = Picture { size: UVec2::ONE, hdr: vec![[1.0; 4]], ldr: vec![[255; 4]] };
        picture.write(&file).expect("written");
        let error = ReferenceLayers::read_exr(&file).expect_err("a picture, no reference");
        assert!(error.to_string().contains("picture.exr"), "{error}");
        assert!(error.to_string().contains("lumivox reference"), "{error}");
        assert!(ReferenceLayers::read_exr(&folder.path().join("none.exr")).is_err());
    }
}
