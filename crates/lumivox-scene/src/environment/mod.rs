//! Surroundings: pictures from files, a computed sky, and a studio.
//!
//! A picture is equirectangular (see [`EnvironmentMap`] for the directions of its texels). Few
//! files are in cd/m²: panoramas are stitched from photographs in an arbitrary unit. One unit of a
//! file counts as 1 cd/m², and [`Environment::radiance`](crate::Environment::radiance) multiplies
//! it.

#[cfg(feature = "panoramas")]
mod exr;
#[cfg(feature = "panoramas")]
mod hdr;
#[cfg(feature = "panoramas")]
mod load;
mod measure;
#[cfg(feature = "panoramas")]
mod repair;
pub mod sky;
pub mod studio;

#[cfg(all(test, feature = "panoramas"))]
mod tests;
