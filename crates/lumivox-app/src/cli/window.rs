//! The arguments of `view`, the window.

use clap::{Args, ValueEnum};
use lumivox_console::SceneSource;

use super::ExploreArgs;
use super::load::scene_source;

/// Examples for the help.
pub const EXAMPLES: &str = "\
Examples:
  lumivox view
  lumivox view builtin:atrium
  lumivox view hall.glb --resolution 256 --preset high
  lumivox view hall.glb --fresh < commands.txt

In the window F1 shows all keys. Lines on stdin are commands, as in the window's console.";

/// The arguments of `view`.
#[derive(Args, Debug)]
#[command(mut_arg("scene", |arg| arg.hide(true)), mut_arg("size", |arg| arg.hide(true)))]
pub struct WindowArgs {
    /// The scene to open: a file, or builtin:NAME [default: none; the window offers some]
    ///
    /// `lumivox scenes` lists the built-in ones. Files can be dropped onto the window, too.
    #[arg(value_name = "SCENE", value_parser = scene_source(), help_heading = "Scene")]
    pub file: Option<SceneSource>,

    /// Picture, voxels, light and cones.
    #[command(flatten)]
    pub explore: ExploreArgs,

    /// Start with the defaults instead of the settings kept from the last time [default: off]
    ///
    /// Options of the command line override kept settings in any case. Changes are kept again.
    #[arg(long, help_heading = "Window")]
    pub fresh: bool,

    /// The GPU device that the window is drawn with [default: auto]
    ///
    /// With the device that renders, pictures stay on the GPU and panels wait for frames. With another one, panels wait for
    /// nothing and pictures cross through main memory.
    #[arg(
        long,
        value_enum,
        value_name = "DEVICE",
        default_value_t,
        hide_default_value = true,
        help_heading = "Window"
    )]
    pub window_device: WindowDevice,
}

/// The GPU device that a window is drawn with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum WindowDevice {
    /// The one that renders, unless it is a software driver.
    #[default]
    Auto,
    /// The one that renders, if it can draw into windows.
    Shared,
    /// Its own.
    Own,
}

impl WindowArgs {
    /// The scene to open.
    pub fn scene(&self) -> Option<&SceneSource> {
        self.file.as_ref().or(self.explore.scene.as_ref())
    }
}
