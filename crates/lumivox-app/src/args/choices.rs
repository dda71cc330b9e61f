//! Choices among a few names, each explained in the help.

use clap::builder::TypedValueParser;
use lumivox::Preset;
use lumivox_console::values::choices::among;
use lumivox_explorer::parameters::PRESETS;
use lumivox_render::PresetChoice;

/// The presets whose pictures are measured in physical units.
const PHYSICAL: [PresetChoice; 4] = [
    PresetChoice::Cones(Preset::Fast),
    PresetChoice::Cones(Preset::Balanced),
    PresetChoice::Cones(Preset::High),
    PresetChoice::Report,
];

/// A preset whose pictures are measured in physical units.
pub fn physical_preset() -> impl TypedValueParser<Value = PresetChoice> {
    among(&PHYSICAL, |choice| (choice.name(), choice.summary()))
}

/// A preset of the cones, or a look.
pub fn preset_or_look() -> impl TypedValueParser<Value = PresetChoice> {
    among(PRESETS, |choice| (choice.name(), choice.summary()))
}
