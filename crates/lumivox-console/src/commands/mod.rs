//! The code of the commands: a file for each group, with its part of the table.

pub mod animation;
pub mod camera;
pub mod files;
pub mod frames;
pub mod lights;
pub mod look;
pub mod materials;
pub mod objects;
pub mod parameters;
pub mod pictures;
pub mod program;
pub mod ray;
mod script;
pub mod surroundings;
pub mod view;
pub mod voxels;
