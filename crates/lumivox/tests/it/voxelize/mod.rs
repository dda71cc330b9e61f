//! The voxelizer against brute force in f64, and its guarantees: nothing is lost or counted twice,
//! and any order gives the same bits.

mod layers;
mod layouts;
mod materials;
mod overlap;
mod panels;
mod parts;
mod promises;
mod read;
mod scenes;
mod sums;
mod textures;
mod twin;
