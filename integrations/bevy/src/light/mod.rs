//! The app's own light for the voxels, with its shadows and surroundings, and the light of the
//! voxels for forward and transparent objects, by probes.

pub(crate) mod irradiance;
pub(crate) mod lights;
pub(crate) mod probes;
pub(crate) mod shadows;
pub(crate) mod surroundings;
