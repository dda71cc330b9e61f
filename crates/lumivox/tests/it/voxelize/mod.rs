//! The voxelizer against a brute force in f64, and its promises: nothing lost, nothing counted
//! twice, the same bits whatever the order.

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
