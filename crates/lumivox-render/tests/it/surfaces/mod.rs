//! Materials in pictures, shadows and voxels, against closed forms: layers, transparency,
//! attributes of vertices, sides.

mod attributes;
mod layers;
mod resolution;
mod sides;
mod stage;
mod transparency;
