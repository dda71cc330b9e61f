//! Options with a few named values, each explained in the help.

use clap::builder::TypedValueParser;
use lumivox_console::values::choices::among;
use lumivox_explorer::parameters::{PRESETS, PRESETS_TO_MEASURE};
use lumivox_render::PresetChoice;

/// A preset whose pictures are measured in physical units.
pub fn physical_preset() -> impl TypedValueParser<Value = PresetChoice> {
    among(PRESETS_TO_MEASURE, |choice| (choice.name(), choice.summary()))
}

/// A preset of the cones, or a look.
pub fn preset_or_look() -> impl TypedValueParser<Value = PresetChoice> {
    among(PRESETS, |choice| (choice.name(), choice.summary()))
}
