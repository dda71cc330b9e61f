//! Lights as objects of JavaScript, from the table of their fields.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use lumivox_scene::{LIGHT_FIELDS, LightField, LightForm, LightKind, LightValue};
use serde::{Deserialize, Serialize};
use tsify::Tsify;

use crate::error::WebError;
use crate::settings::SettingValue;

/// A light: `name`, `kind`, and the fields of its kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Light(BTreeMap<String, Option<SettingValue>>);

impl From<&lumivox_scene::Light> for Light {
    fn from(light: &lumivox_scene::Light) -> Self {
        let value = |value| match value {
            LightValue::None => None,
            LightValue::Text(text) => Some(SettingValue::Text(text)),
            LightValue::Number(number) => Some(SettingValue::Number(number)),
            LightValue::Vector(vector) => Some(SettingValue::Vector(vector)),
        };
        Self(light.record().map(|(key, of)| (key.to_owned(), value(of))).collect())
    }
}

impl Light {
    /// Converts to the scene's light, checked.
    ///
    /// # Errors
    /// When the kind or a property is unknown, or a value is not allowed.
    pub fn to_scene(&self) -> Result<lumivox_scene::Light, WebError> {
        let value = |value: &Option<SettingValue>| match value {
            None => LightValue::None,
            Some(SettingValue::Switch(on)) => LightValue::Text(on.to_string()),
            Some(SettingValue::Text(text)) => LightValue::Text(text.clone()),
            Some(SettingValue::Number(number)) => LightValue::Number(*number),
            Some(SettingValue::Vector(vector)) => LightValue::Vector(*vector),
        };
        let record: Vec<_> = self.0.iter().map(|(key, of)| (key.as_str(), value(of))).collect();
        lumivox_scene::Light::of_record(&record)
            .map_err(|message| WebError::value(format!("this is not a light: {message}")))
    }
}

/// A kind of light: panels are made from these.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct LightKindInfo {
    /// Its name in lights.
    pub name: String,
    /// Its name for people, and in the console.
    pub word: String,
    /// A sentence on it, without a full stop.
    pub summary: String,
    /// The fields that it has.
    pub fields: Vec<LightFieldInfo>,
}

/// A field of lights.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct LightFieldInfo {
    /// Its name in lights.
    pub key: String,
    /// Its title in panels.
    pub title: String,
    /// Its meaning in a few words.
    pub summary: String,
    /// The unit of its values; empty without one.
    pub unit: String,
    /// `true` if it is a colour.
    pub is_color: bool,
    /// The names of its numbers; empty if it is one number.
    pub parts: Vec<String>,
    /// Whether it may be null.
    pub optional: bool,
}

impl LightKindInfo {
    /// All kinds.
    pub fn all() -> Vec<Self> {
        let field = |field: &LightField, kind| LightFieldInfo {
            key: field.key.to_owned(),
            title: field.title.to_owned(),
            summary: field.summary.to_owned(),
            unit: field.unit(kind).to_owned(),
            is_color: field.form == LightForm::Color,
            parts: field.form.parts().iter().flatten().map(|part| (*part).to_owned()).collect(),
            optional: field.is_optional(),
        };
        let kinds = LightKind::ALL.into_iter().map(|kind| Self {
            name: kind.name().to_owned(),
            word: kind.word().to_owned(),
            summary: kind.summary().to_owned(),
            fields: kind.fields().map(|row| field(row, kind)).collect(),
        });
        kinds.collect()
    }
}

/// The TypeScript declaration of lights.
pub fn declarations() -> String {
    let default = lumivox_scene::Light::default();
    let names = LightKind::ALL.map(|kind| format!("\"{}\"", kind.name())).join(" | ");
    let mut text = format!(
        "/** The kinds of light. */\n\
         export type LightKind = {names};\n\
         /** A light. Its source is invisible. Properties that its kind does not have are ignored. */\n\
         export interface Light {{\n  \
           /** The name in lists and messages. Default: \"{}\". */\n  name?: string;\n  \
           /** The kind. Default: \"{}\". */\n  kind?: LightKind;\n",
        default.name,
        default.kind.name()
    );
    for field in LIGHT_FIELDS {
        let typical = lumivox_scene::Light::typical(field.kinds[0]);
        let (title, summary, allowed) = (field.title, field.summary, field.expected(&typical));
        let null = if field.is_optional() { " | null" } else { "" };
        let default = field.value(&typical);
        let is_vector = field.form.parts().is_some();
        let values = if is_vector { "[number, number, number]" } else { "number" };
        let _ = write!(
            text,
            "  /** {title}, {summary}:\n   * {allowed}. Default: {default}. */\n  {}?: {values}{null};\n",
            field.key
        );
    }
    text + "}\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_the_same_after_conversion_to_javascript_and_back() {
        for kind in LightKind::ALL {
            let light = lumivox_scene::Light::typical(kind);
            let object = Light::from(&light);
            assert!(object.0.keys().all(|key| declarations().contains(&format!(" {key}?: "))));
            assert_eq!(object.to_scene(), Ok(light));
        }
    }

    #[test]
    fn errors_name_the_field() {
        let message = |key: &str, value| {
            let light = Light(BTreeMap::from([(key.to_owned(), Some(value))]));
            light.to_scene().unwrap_err().message
        };
        assert!(message("intensity", SettingValue::Number(-1.0)).contains("its intensity is -1"));
        assert!(message("strength", SettingValue::Number(1.0)).contains("no \"strength\""));
        assert!(message("kind", SettingValue::Text("lamp".to_owned())).contains("directional"));
        assert!(message("color", SettingValue::Switch(true)).contains("color"));
    }
}
