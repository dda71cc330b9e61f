//! A preset, and changes to its settings.

use clap::Args;
use lumivox_render::PresetChoice;

use crate::args::choices;
use crate::args::settings::{ConeGroups, SettingArgs};

/// The preset and the settings of the cones.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Cones")]
pub struct ConeArgs {
    /// Preset of quality against cost [default: balanced]
    ///
    /// All presets but those of other works (docs/looks.md) obey the same physics; they differ in
    /// noise, sharpness and cost. The options below change single values of the preset.
    #[arg(long, value_name = "NAME", value_parser = choices::preset_or_look())]
    pub preset: Option<PresetChoice>,

    /// Changes to the preset.
    #[command(flatten)]
    pub settings: SettingArgs<ConeGroups>,
}

impl ConeArgs {
    /// The preset that the settings start from.
    pub fn preset(&self) -> PresetChoice {
        self.preset.unwrap_or_default()
    }
}
