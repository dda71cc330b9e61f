//! Choices among a few names, each explained in the help.

use clap::builder::TypedValueParser;
use lumivox::Preset;
use lumivox_console::values::choices::among;
use lumivox_explorer::parameters::PRESETS;
use lumivox_render::PresetChoice;

/// How much is spent on the cones.
pub fn preset() -> impl TypedValueParser<Value = Preset> {
    among(&[Preset::Fast, Preset::Balanced, Preset::High, Preset::Report], |preset| {
        (preset_name(preset), PresetChoice::Cones(preset).summary())
    })
}

/// A preset of the cones, or a look.
pub fn preset_or_look() -> impl TypedValueParser<Value = PresetChoice> {
    among(PRESETS, |choice| (choice.name(), choice.summary()))
}

/// The name of a preset of the cones.
pub const fn preset_name(preset: Preset) -> &'static str {
    PresetChoice::Cones(preset).name()
}
