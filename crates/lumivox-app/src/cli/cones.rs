//! A preset, and changes to its cones.

use clap::Args;
use lumivox_render::PresetChoice;

use crate::args::choices;
use crate::args::settings::{ConeGroups, SettingArgs};

/// The cones.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Cones")]
pub struct ConeArgs {
    /// How much is spent on the cones [default: balanced]
    ///
    /// All but report and vxct obey the same physics; they differ in noise, sharpness and cost. The options
    /// below change single values of the preset. vxct has cones of its own for the resolution, as VXCT had
    /// (docs/vxct-look.md): of the options below only those of the voxels' bounces change anything there.
    #[arg(long, value_name = "NAME", value_parser = choices::preset_or_look())]
    pub preset: Option<PresetChoice>,

    /// Changes to it.
    #[command(flatten)]
    pub settings: SettingArgs<ConeGroups>,
}

impl ConeArgs {
    /// The preset that the settings start from.
    pub fn preset(&self) -> PresetChoice {
        self.preset.unwrap_or_default()
    }
}
