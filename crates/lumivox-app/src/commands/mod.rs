//! The commands of the program, one module each.

pub mod bake;
pub mod bench;
pub mod compare;
pub mod convert;
pub mod info;
mod kept;
pub mod measure;
pub mod merge;
pub mod motion;
pub mod quality;
pub mod reference;
pub mod render;
pub mod rooms;
pub mod run;
pub mod scenes;
mod staged;
#[cfg(feature = "window")]
pub mod view;
#[cfg(not(feature = "window"))]
#[path = "no_view.rs"]
pub mod view;
pub mod volumes;
pub mod voxels;
