//! OpenEXR pictures: the first layer with red, green and blue, CIE XYZ, or only luminance.

use std::io::Cursor;

use exr::meta::MetaData;
use exr::meta::attribute::{Chromaticities, EnvironmentMap as Projection};
use exr::meta::header::Header;
use exr::prelude::*;

use super::load::{Fault, check_size};
use crate::EnvironmentMap as Map;
use crate::load::color::rgb_from_xyz;

/// The chromaticities of BT.709, which OpenEXR assumes if a file has none: red, green, blue, white.
const BT_709: [f32; 8] = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];

/// The most layers that a warning lists.
const MOST_LISTED: usize = 8;

pub(super) fn decode(bytes: &[u8]) -> std::result::Result<Map, Fault> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(Fault::broken)?;
    let found = meta.headers.iter().find_map(|header| {
        if header.deep { None } else { Channels::of(header).map(|channels| (header, channels)) }
    });
    let Some((header, channels)) = found else {
        return Err(Fault::new(
            format!("it has no flat layer with red, green and blue, but {}", names(&meta)),
            "save it as a plain RGB picture",
        ));
    };
    if header.own_attributes.environment_map == Some(Projection::Cube) {
        return Err(Fault::new("it is a cube map", "convert it to an equirectangular one"));
    }
    // A picture may store only a part of the display window.
    let window = header.shared_attributes.display_window;
    let (width, height) = (window.size.width(), window.size.height());
    check_size(width as u64, height as u64, bytes.len())?;
    check_size(header.layer_size.width() as u64, header.layer_size.height() as u64, bytes.len())?;
    let position = header.own_attributes.layer_position;
    let place = Placement {
        width,
        height,
        left: i64::from(position.x()) - i64::from(window.position.x()),
        top: i64::from(position.y()) - i64::from(window.position.y()),
    };
    let mut warnings = warnings(header, &place);
    match &channels {
        Channels::Xyz(_) => warnings.push(
            "the environment map's channels X, Y, Z count as colours in CIE XYZ; save it as R, G, \
             B if they are something else"
                .to_owned(),
        ),
        Channels::Colors(_) => warnings.extend(tell_layers(&meta)),
        Channels::Luminance(_) => {}
    }
    let is_xyz = matches!(channels, Channels::Xyz(_));
    // The luminance of (1, 1, 1) in cd/m²; values that are not positive or not normal are ignored.
    let unit = header.own_attributes.white_luminance.filter(|l| l.is_normal() && *l > 0.0);

    let mut rgb = channels.read(bytes, place).map_err(Fault::broken)?;
    if is_xyz {
        for texel in &mut rgb {
            *texel = rgb_from_xyz((*texel).into()).into();
        }
    }
    if let Some(unit) = unit {
        rgb.iter_mut().flatten().for_each(|channel| *channel *= unit);
    }
    let (width, height) = (width as u32, height as u32);
    Ok(Map { width, height, rgb, warnings, ..Map::default() })
}

/// The position of a layer in the picture.
#[derive(Clone, Copy)]
struct Placement {
    width: usize,
    height: usize,
    left: i64,
    top: i64,
}

impl Placement {
    fn index(&self, at: Vec2<usize>) -> Option<usize> {
        let x = usize::try_from(at.x() as i64 + self.left).ok()?;
        let y = usize::try_from(at.y() as i64 + self.top).ok()?;
        (x < self.width && y < self.height).then_some(y * self.width + x)
    }
}

/// The names of the channels that hold the colours.
enum Channels {
    Colors([Text; 3]),
    /// CIE XYZ.
    Xyz([Text; 3]),
    Luminance(Text),
}

impl Channels {
    fn of(header: &Header) -> Option<Self> {
        let named = |name: &str| {
            header.channels.list.iter().find(|c| c.name.eq(name)).map(|c| c.name.clone())
        };
        let all = |prefix: &str, names: [&str; 3]| {
            let [a, b, c] = names.map(|name| named(&format!("{prefix}{name}")));
            Some([a?, b?, c?])
        };
        if let Some(prefix) = prefixes(header).first() {
            return all(prefix, ["R", "G", "B"]).map(Self::Colors);
        }
        all("", ["X", "Y", "Z"]).map(Self::Xyz).or_else(|| named("Y").map(Self::Luminance))
    }

    fn read(self, bytes: &[u8], place: Placement) -> Result<Vec<[f32; 3]>> {
        let black = move |_: Vec2<usize>| vec![[0.0; 3]; place.width * place.height];
        let set = move |texels: &mut Vec<[f32; 3]>, at, texel| {
            if let Some(index) = place.index(at) {
                texels[index] = texel;
            }
        };
        let read = read().no_deep_data().largest_resolution_level();
        let bytes = Cursor::new(bytes);
        match self {
            Self::Colors([red, green, blue]) | Self::Xyz([red, green, blue]) => Ok(read
                .specific_channels()
                .required(red)
                .required(green)
                .required(blue)
                .collect_pixels(
                    move |size, _| black(size),
                    move |texels, at, (r, g, b): (f32, f32, f32)| set(texels, at, [r, g, b]),
                )
                .first_valid_layer()
                .all_attributes()
                .from_buffered(bytes)?
                .layer_data
                .channel_data
                .pixels),
            Self::Luminance(name) => Ok(read
                .specific_channels()
                .required(name)
                .collect_pixels(
                    move |size, _| black(size),
                    move |texels, at, (y,): (f32,)| set(texels, at, [y; 3]),
                )
                .first_valid_layer()
                .all_attributes()
                .from_buffered(bytes)?
                .layer_data
                .channel_data
                .pixels),
        }
    }
}

/// Channel prefixes of the layers with colours in a part of the file, such as Blender's `View
/// Layer.Combined.`; the picture itself comes before its render passes.
fn prefixes(header: &Header) -> Vec<String> {
    let names: Vec<String> = header.channels.list.iter().map(|c| c.name.to_string()).collect();
    let has = |name: String| names.contains(&name);
    let reds = names.iter().filter_map(|name| name.strip_suffix('R'));
    let mut prefixes: Vec<String> = reds
        .filter(|prefix| prefix.is_empty() || prefix.ends_with('.'))
        .filter(|prefix| has(format!("{prefix}G")) && has(format!("{prefix}B")))
        .map(str::to_owned)
        .collect();
    prefixes.sort_by_key(|prefix| (!prefix.is_empty(), !prefix.ends_with("Combined.")));
    prefixes
}

/// A warning that says which layer is shown, if several have colours.
fn tell_layers(meta: &MetaData) -> Option<String> {
    let layers = meta.headers.iter().filter(|header| !header.deep).flat_map(|header| {
        let part = header.own_attributes.layer_name.as_ref().map(Text::to_string);
        prefixes(header).into_iter().map(move |prefix| {
            let prefix = Some(prefix.trim_end_matches('.').to_owned());
            let words: Vec<String> =
                part.iter().cloned().chain(prefix).filter(|word| !word.is_empty()).collect();
            let name = if words.is_empty() { "R, G, B".to_owned() } else { words.join(", ") };
            format!("\"{}\"", name.chars().take(40).collect::<String>())
        })
    });
    let layers: Vec<String> = layers.collect();
    let [shown, others @ ..] = layers.as_slice() else { return None };
    let listed = others.iter().take(MOST_LISTED).cloned().collect::<Vec<_>>().join(", ");
    (!others.is_empty()).then(|| {
        format!(
            "the environment map has {} layers with colours: {shown} is shown, and not {listed}; \
             save another one alone to see it",
            layers.len()
        )
    })
}

fn names(meta: &MetaData) -> String {
    let channels = meta.headers.iter().flat_map(|header| &header.channels.list);
    let mut names: Vec<String> =
        channels.take(8).map(|c| c.name.to_string().chars().take(40).collect()).collect();
    if names.is_empty() {
        names.push("no channels".to_owned());
    }
    names.join(", ")
}

fn warnings(header: &Header, place: &Placement) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(Chromaticities { red, green, blue, white }) =
        header.shared_attributes.chromaticities
    {
        let given = [red.0, red.1, green.0, green.1, blue.0, blue.1, white.0, white.1];
        // Files round chromaticities to a thousandth.
        if given.iter().zip(BT_709).any(|(given, own)| (given - own).abs() > 2e-3) {
            let told = "the environment map's colours count as linear sRGB, though the file names \
                        other primaries";
            warnings.push(told.to_owned());
        }
    }
    let covers = place.left <= 0
        && place.top <= 0
        && place.left + header.layer_size.width() as i64 >= place.width as i64
        && place.top + header.layer_size.height() as i64 >= place.height as i64;
    if !covers {
        warnings.push(format!(
            "the environment map stores {} x {} of its {} x {} texels; the rest is black",
            header.layer_size.width(),
            header.layer_size.height(),
            place.width,
            place.height
        ));
    }
    warnings
}
