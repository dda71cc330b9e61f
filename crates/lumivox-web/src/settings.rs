//! A page's settings by name: the table of settings in JavaScript's values.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::Vec3;
use lumivox_explorer::parameters::{Kind, PARAMETERS, Parameter, Value, find_parameter};
use lumivox_explorer::suggest;
use lumivox_render::RenderSettings;
use serde::{Deserialize, Serialize};

use crate::error::WebError;

/// A setting's value in JavaScript.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SettingValue {
    /// A switch.
    Switch(bool),
    /// A number, whole or not.
    Number(f64),
    /// A choice, or a word in place of a number.
    Text(String),
    /// Three numbers.
    Vector([f64; 3]),
}

/// Settings by name.
pub type Settings = BTreeMap<String, SettingValue>;

impl From<Value> for SettingValue {
    fn from(value: Value) -> Self {
        match value {
            Value::Switch(on) => Self::Switch(on),
            Value::Whole(number) => Self::Number(number.into()),
            Value::Number(number) => Self::Number(shortest(number)),
            Value::Word(text) | Value::Choice(text) => Self::Text(text.to_owned()),
            Value::Vector(v) => Self::Vector(v.to_array().map(shortest)),
        }
    }
}

/// The f64 with the same decimals as the f32: 0.1 and not 0.10000000149.
fn shortest(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

impl SettingValue {
    /// The value for a setting of this kind; `None` if it does not fit.
    fn of_kind(&self, kind: Kind) -> Option<Value> {
        match (self, kind) {
            (Self::Switch(on), Kind::Switch) => Some(Value::Switch(*on)),
            (Self::Number(number), Kind::Whole { .. }) => {
                let is_whole =
                    number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(number);
                is_whole.then_some(Value::Whole(*number as u32))
            }
            (Self::Number(number), Kind::Number { .. }) => {
                number.is_finite().then_some(Value::Number(*number as f32))
            }
            (Self::Vector(v), Kind::Vector { .. }) => {
                Some(Value::Vector(Vec3::from_array(v.map(|number| number as f32))))
            }
            _ => None,
        }
    }

    fn in_words(&self) -> String {
        match self {
            Self::Switch(on) => on.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Text(text) => text.clone(),
            Self::Vector(v) => format!("{},{},{}", v[0], v[1], v[2]),
        }
    }
}

/// All settings by name.
pub fn all(settings: &RenderSettings) -> Settings {
    let of = |parameter: &Parameter| {
        (parameter.name.to_owned(), SettingValue::from(parameter.get(settings)))
    };
    PARAMETERS.iter().map(of).collect()
}

/// Changes settings in the order of the table, whatever their order in an object: a setting that
/// requires an octree comes before the octree's options.
///
/// # Errors
/// When there is no such setting, or a value is not allowed. The caller must then discard the
/// changes so far.
pub fn change(settings: &mut RenderSettings, changes: &Settings) -> Result<(), WebError> {
    for name in changes.keys() {
        find(name)?;
    }
    for parameter in PARAMETERS.iter() {
        let Some(value) = parameter.names().find_map(|name| changes.get(name)) else { continue };
        let value = match value.of_kind(parameter.kind) {
            Some(value) => value,
            // Texts are read as on a command line, so that input fields and links need no types.
            None => parameter.parse(&value.in_words())?,
        };
        // Skip unchanged values: setting an option of an octree would switch to an octree.
        if parameter.get(settings) != value {
            parameter.set(settings, value)?;
        }
    }
    Ok(())
}

/// The setting of this name.
fn find(name: &str) -> Result<&'static Parameter, WebError> {
    find_parameter(name).ok_or_else(|| {
        let known = PARAMETERS.iter().flat_map(Parameter::names);
        let remedy = suggest::remedy(name, known, "parameters()");
        WebError::value(format!("there is no setting \"{name}\"{remedy}"))
    })
}

/// The TypeScript declarations of all settings and of lights.
pub fn declarations() -> String {
    let mut text = String::from(
        "/** All settings by name. Ranges and defaults are in `parameters()`; settings that are left out keep their values. */\n\
         export interface Settings {\n",
    );
    let defaults = RenderSettings::default();
    for parameter in PARAMETERS.iter() {
        let unit = match parameter.unit {
            "" => String::new(),
            unit => format!(", {unit}"),
        };
        let default = SettingValue::from(parameter.get(&defaults)).in_words();
        let (what, values) = (parameter.summary, parameter.kind.in_words());
        let (name, values_type) = (parameter.name, type_of(parameter.kind));
        let _ = write!(
            text,
            "  /** {what}: {values}{unit}. Default: {default}. */\n  {name}?: {values_type};\n"
        );
    }
    text + "}\n" + &crate::types::light_declarations()
}

fn type_of(kind: Kind) -> String {
    match kind {
        Kind::Switch => "boolean".to_owned(),
        Kind::Whole { .. } => "number".to_owned(),
        Kind::Number { words, .. } => {
            words.iter().fold("number".to_owned(), |text, word| format!("{text} | \"{word}\""))
        }
        Kind::Vector { .. } => "[number, number, number]".to_owned(),
        Kind::Choice(_) => {
            let quoted: Vec<String> =
                kind.words().iter().map(|name| format!("\"{name}\"")).collect();
            quoted.join(" | ")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(changes: &[(&str, SettingValue)]) -> Result<RenderSettings, WebError> {
        let mut settings = RenderSettings::default();
        let changes = changes.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
        change(&mut settings, &changes.collect()).map(|()| settings)
    }

    fn text(text: &str) -> SettingValue {
        SettingValue::Text(text.to_owned())
    }

    #[test]
    fn all_settings_round_trip_through_javascript() {
        let settings = changed(&[
            ("resolution", SettingValue::Number(64.0)),
            ("view", text("indirect")),
            ("volume", text("octree")),
            ("specular", SettingValue::Switch(false)),
            ("exposure", SettingValue::Number(-1.5)),
        ])
        .unwrap();
        assert_eq!((settings.resolution, settings.view.name()), (64, "indirect"));
        let mut again = RenderSettings::default();
        change(&mut again, &all(&settings)).unwrap();
        assert_eq!(all(&again), all(&settings));
        assert_ne!(all(&again), all(&RenderSettings::default()));
    }

    #[test]
    fn setting_texts_parse_like_command_line_values() {
        let settings = changed(&[("resolution", text("96")), ("specular", text("off"))]).unwrap();
        assert_eq!(all(&settings)["resolution"], SettingValue::Number(96.0));
        assert_eq!(all(&settings)["specular"], SettingValue::Switch(false));
        assert_eq!(all(&changed(&[("exposure", text("auto"))]).unwrap())["exposure"], text("auto"));
    }

    #[test]
    fn errors_of_bad_settings_name_valid_values() {
        let message = |name, value| changed(&[(name, value)]).unwrap_err().message;
        assert_eq!(
            message("resolutoin", text("64")),
            "there is no setting \"resolutoin\"; did you mean \"resolution\"?"
        );
        assert!(message("zzz", text("64")).contains("parameters()"));
        assert!(message("view", text("inside")).contains("indirect"));
        assert!(message("frames", SettingValue::Number(64.5)).contains("whole number"));
        assert!(message("resolution", SettingValue::Number(f64::NAN)).contains("multiple of 8"));
        assert!(message("specular", SettingValue::Number(3.0)).contains("on or off"));
    }

    /// `LUMIVOX_BLESS=1` writes the file.
    #[test]
    fn the_declarations_match_the_parameter_table() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/src/settings.d.ts");
        if std::env::var_os("LUMIVOX_BLESS").is_some() {
            std::fs::write(file, declarations()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(file).unwrap_or_default(), declarations());
    }
}
