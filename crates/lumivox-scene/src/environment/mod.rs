//! Surroundings: pictures of them from files, a computed sky, and a studio.
//!
//! A picture is equirectangular (see [`EnvironmentMap`] for the directions of its texels). Files
//! seldom hold cd/m²: panoramas are stitched from photographs in a unit of their own. One unit of a
//! file counts as 1 cd/m², and [`Environment::radiance`](crate::Environment::radiance) multiplies
//! it.

mod exr;
mod hdr;
mod load;
mod measure;
mod repair;
pub mod sky;
pub mod studio;

#[cfg(test)]
mod tests;
