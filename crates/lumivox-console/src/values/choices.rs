//! Choices among a few names, each explained in the help.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use lumivox_scene::{Staging, UpAxis};

/// A parser of names that returns their `values`, with a line of help for each.
pub fn among<T: Copy + Send + Sync + 'static>(
    values: &'static [T],
    name_and_help: fn(T) -> (&'static str, &'static str),
) -> impl TypedValueParser<Value = T> {
    let names = values.iter().map(|value| {
        let (name, help) = name_and_help(*value);
        PossibleValue::new(name).help(help)
    });
    PossibleValuesParser::new(names).try_map(move |chosen| {
        let found = values.iter().find(|value| name_and_help(**value).0 == chosen);
        found.copied().ok_or("not one of the choices")
    })
}

/// The names of the surroundings that `--surroundings` chooses from.
pub fn staging() -> impl TypedValueParser<Value = Staging> {
    among(&Staging::ALL, |staging| {
        let help = match staging {
            Staging::Auto => "what suits the scene, if its own light is not enough",
            Staging::Studio => "a studio: soft boxes, a grey wall, a ground",
            Staging::Sky => "the sun and the sky of a clear day, and a ground below things",
            Staging::None => "nothing, even if the scene is dark",
        };
        (staging.name(), help)
    })
}

/// The axis of a file that points up.
pub fn up() -> impl TypedValueParser<Value = UpAxis> {
    among(&[UpAxis::Y, UpAxis::Z], |axis| match axis {
        UpAxis::Y => ("y", "as in glTF"),
        UpAxis::Z => ("z", "as in CAD and scans; the file's y then points to -z"),
    })
}
