//! The properties of each setting.

use lumivox_explorer::parameters::{Kind, PARAMETERS, Parameter};
use lumivox_render::RenderSettings;
use serde::Serialize;
use tsify::Tsify;

use crate::settings::SettingValue;

/// A setting: panels are made from these.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct ParameterInfo {
    /// Its name in [`Settings`](crate::settings::Settings).
    pub name: String,
    /// `picture`, `view`, `overlay`, `volume`, `light`, `cones` or `vxct`.
    pub group: String,
    /// The unit of its numbers; empty without one.
    pub unit: String,
    /// A sentence on it, without a full stop.
    pub summary: String,
    /// The kind of its values.
    #[tsify(type = "\"switch\" | \"whole\" | \"number\" | \"vector\" | \"choice\"")]
    pub kind: String,
    /// The least value.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The greatest value.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// The number of which its values are multiples.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiple: Option<f64>,
    /// The names of a choice.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// Words for values without a number: `auto`, `unlimited`.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<String>,
    /// The default value.
    #[tsify(type = "boolean | number | string | [number, number, number]")]
    pub default: SettingValue,
}

impl ParameterInfo {
    /// All settings, in the order of the table.
    pub fn all() -> Vec<Self> {
        let defaults = RenderSettings::default();
        PARAMETERS.iter().map(|parameter| Self::of(parameter, &defaults)).collect()
    }

    fn of(parameter: &Parameter, defaults: &RenderSettings) -> Self {
        let default = SettingValue::from(parameter.get(defaults));
        let kind = match parameter.kind {
            Kind::Switch => "switch",
            Kind::Whole { .. } => "whole",
            Kind::Number { .. } => "number",
            Kind::Vector { .. } => "vector",
            Kind::Choice(_) => "choice",
        };
        let mut info = Self {
            name: parameter.name.to_owned(),
            group: parameter.group.name().to_owned(),
            unit: parameter.unit.to_owned(),
            summary: parameter.summary.to_owned(),
            kind: kind.to_owned(),
            min: None,
            max: None,
            multiple: None,
            choices: Vec::new(),
            words: Vec::new(),
            default,
        };
        match parameter.kind {
            Kind::Switch => {}
            Kind::Whole { low, high, multiple } => {
                (info.min, info.max) = (Some(low.into()), Some(high.into()));
                info.multiple = Some(multiple.into());
            }
            Kind::Number { low, high, words, .. } => {
                (info.min, info.max) = (Some(low.into()), Some(high.into()));
                info.words = words.iter().map(|word| (*word).to_owned()).collect();
            }
            Kind::Vector { low, below } => {
                (info.min, info.max) = (Some(low.into()), Some(below.into()));
            }
            Kind::Choice(choices) => {
                info.choices = choices.iter().map(|choice| choice.name.to_owned()).collect();
            }
        }
        info
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameter_info_has_ranges_and_choices() {
        let all = ParameterInfo::all();
        let of = |name: &str| all.iter().find(|info| info.name == name).unwrap();
        assert_eq!((of("frames").min, of("frames").max), (Some(1.0), Some(65_536.0)));
        assert_eq!(of("exposure").words, ["auto", "auto-each"]);
        assert!(of("view").choices.iter().any(|view| view == "indirect"));
        assert_eq!(all.len(), PARAMETERS.len());
    }
}
