//! The library from outside, in one program: the shaders that its tests share are linked and
//! compiled once.

mod common;
mod lost;
mod scan;
mod voxelize;
