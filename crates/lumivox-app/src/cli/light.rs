//! What shines, and how its light is found.

use clap::Args;
use lumivox_console::SourceArgs;

use crate::args::settings::{LightGroups, SettingArgs};

/// Light, and how it is found.
#[derive(Args, Debug)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// What shines.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// How its light is found.
    #[command(flatten)]
    pub settings: SettingArgs<LightGroups>,
}
