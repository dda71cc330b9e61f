//! `OpenEXR` pictures, which may have several layers: parts of the file, and channels whose names
//! share the text before the last dot.

use std::collections::BTreeSet;
use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{
    AnyChannel, AnyChannels, FlatSamples, Image, Layer, Layers, ReadChannels as _, ReadLayers as _,
    read,
};
use glam::UVec2;

use super::{Fault, PictureFile, check_size};
use crate::compare::LinearPicture;

/// The most samples in all channels of all layers: 2 GiB as floats.
const MOST_SAMPLES: u64 = 1 << 29;

type Part = Layer<AnyChannels<FlatSamples>>;

pub(super) fn decode(bytes: &[u8], layer: Option<&str>) -> Result<PictureFile, Fault> {
    check_sizes(bytes)?;
    let image: Image<Layers<AnyChannels<FlatSamples>>> = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(Fault::broken)?;
    let candidates: Vec<Candidate> = image.layer_data.iter().flat_map(Candidate::of).collect();
    let chosen = choose(&candidates, layer)?;
    let window = image.attributes.display_window;
    let attributes = &chosen.part.attributes;
    if attributes.layer_position != window.position || chosen.part.size != window.size {
        return Err(Fault::new(
            "its pixels do not fill its picture: data window and display window differ",
            "save it uncropped",
        ));
    }
    let size = UVec2::new(window.size.width() as u32, window.size.height() as u32);
    let mut rgb = vec![[0.0; 3]; window.size.area()];
    for (index, channel) in chosen.channels.iter().enumerate() {
        if channel.sample_data.len() != rgb.len() {
            return Err(Fault::new("it stores fewer colours than pixels", "save it as plain RGB"));
        }
        for (pixel, value) in rgb.iter_mut().zip(channel.sample_data.values_as_f32()) {
            pixel[index] = value;
        }
    }
    // The luminance of (1, 1, 1) in cd/m². A value that cannot be a luminance is ignored.
    if let Some(unit) = attributes.white_luminance.filter(|unit| unit.is_normal() && *unit > 0.0) {
        rgb.as_flattened_mut().iter_mut().for_each(|value| *value *= unit);
    }
    let layer = Some(chosen.name.clone()).filter(|name| !name.is_empty());
    Ok(PictureFile { picture: LinearPicture { size, rgb }, layer })
}

/// Checks the sizes that a file claims before memory is allocated.
fn check_sizes(bytes: &[u8]) -> Result<(), Fault> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(Fault::broken)?;
    let mut samples = 0_u64;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.width() as u64, header.layer_size.height() as u64);
        check_size(width, height)?;
        samples += width * height * header.channels.list.len() as u64;
    }
    if samples <= MOST_SAMPLES {
        return Ok(());
    }
    let reason = format!("it has {samples} samples in all its layers, more than {MOST_SAMPLES}");
    Err(Fault::new(reason, "save fewer layers"))
}

/// A layer: channels that form a picture.
struct Candidate<'a> {
    name: String,
    part: &'a Part,
    channels: [&'a AnyChannel<FlatSamples>; 3],
}

impl<'a> Candidate<'a> {
    /// All layers in a part of the file, by name.
    fn of(part: &'a Part) -> Vec<Self> {
        let list = &part.channel_data.list;
        let prefix_of = |name: &str| name.rfind('.').map_or("", |dot| &name[..=dot]).to_owned();
        let names: Vec<String> = list.iter().map(|channel| channel.name.to_string()).collect();
        let prefixes: BTreeSet<String> = names.iter().map(|name| prefix_of(name)).collect();
        let part_name = part.attributes.layer_name.as_ref().map(ToString::to_string);
        let part_name = part_name.unwrap_or_default();
        let candidate = |prefix: String| {
            let find = |last: &str| {
                let index = names.iter().position(|name| *name == format!("{prefix}{last}"))?;
                list.get(index)
            };
            let rgb = || Some([find("R")?, find("G")?, find("B")?]);
            let channels = rgb().or_else(|| find("Y").map(|grey| [grey; 3]))?;
            let own = prefix.trim_end_matches('.');
            // Some programs repeat the name of the part in its channels.
            let repeats = own == part_name || own.starts_with(&format!("{part_name}."));
            let name = match (part_name.as_str(), own) {
                ("", own) => own.to_owned(),
                (part, "") => part.to_owned(),
                (_, own) if repeats => own.to_owned(),
                (part, own) => format!("{part}.{own}"),
            };
            Some(Self { name, part, channels })
        };
        prefixes.into_iter().filter_map(candidate).collect()
    }
}

fn choose<'a, 'b>(
    candidates: &'b [Candidate<'a>],
    layer: Option<&str>,
) -> Result<&'b Candidate<'a>, Fault> {
    let is = |name: &str| candidates.iter().find(|candidate| candidate.name == name);
    let Some(first) = candidates.first() else {
        return Err(Fault::new(
            "it has no flat layer with red, green and blue, nor with luminance",
            "save it as a plain RGB picture",
        ));
    };
    let has_names = candidates.iter().any(|candidate| !candidate.name.is_empty());
    let Some(layer) = layer.filter(|_| has_names) else {
        return Ok(is("").unwrap_or(first));
    };
    is(layer).ok_or_else(|| {
        let name = |candidate: &Candidate| match candidate.name.as_str() {
            "" => "one without a name".to_owned(),
            name => name.to_owned(),
        };
        let known: Vec<String> = candidates.iter().map(name).collect();
        Fault::Layer { layer: layer.to_owned(), known: known.join(", ") }
    })
}
