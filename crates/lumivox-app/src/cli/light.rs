//! Options for light, and for how it is found.

use clap::Args;
use lumivox_console::SourceArgs;

use crate::args::settings::{LightGroups, SettingArgs};

/// Options for light, and for how it is found.
#[derive(Args, Debug)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// Light added to the scene.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// How light is found.
    #[command(flatten)]
    pub settings: SettingArgs<LightGroups>,
}
