//! The commands of the program, one module each.

pub mod bake;
pub mod bench;
pub mod compare;
pub mod convert;
pub mod info;
pub mod kept;
pub mod measure;
pub mod merge;
pub mod reference;
pub mod render;
pub mod run;
pub mod scenes;
pub mod staged;
#[cfg(feature = "window")]
pub mod view;
#[cfg(not(feature = "window"))]
#[path = "no_view.rs"]
pub mod view;
pub mod voxels;
