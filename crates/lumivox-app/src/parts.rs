//! The parts of the program that `lumivox-lab` uses too. They change with the program: nothing else
//! should depend on them.

pub use crate::args::choices::physical_preset;
pub use crate::args::output;
pub use crate::args::scene::check as check_scene;
pub use crate::args::settings::{SettingArgs, VolumeGroups};
pub use crate::cli::{ConeArgs, GpuArgs, LightArgs, SceneArg, ViewArgs, scene_source};
pub use crate::commands::kept::Kept;
pub use crate::commands::measure::gathers;
pub use crate::commands::staged::{look_at, stage};
pub use crate::commands::voxels::{grid, upload};
pub use crate::exit::CODES;
pub use crate::light::check as check_light;
pub use crate::program::{Program, run};
pub use crate::progress::ProgressDisplay;
pub use crate::quality::{
    Align, Canvas, Leak, Measured, Row, Subject, Truth, check_wish, reference, strip, write_strip,
};

/// Settings of a rendering: read from the command line, and reported under their names.
pub mod settings {
    pub use crate::settings::{of, of_voxels, serialize};
}
