//! Tests of materials in pictures, shadows and voxels against closed forms: layers, transparency,
//! vertex attributes, sides.

mod attributes;
mod layers;
mod resolution;
mod sides;
mod stage;
mod transparency;
