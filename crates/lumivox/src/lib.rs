//! Voxel cone tracing on the caller's `wgpu::Device`: dynamic global illumination in physical units.
//!
//! Triangles are voxelized on the GPU into a compact list of occupied voxels ([`voxels`]), each with a face
//! for every side that has surface. Light is computed on that list: direct light, emission, bounces
//! ([`Light`]). A volume stores it, filters it into a pyramid and is sampled by cones ([`TraceSettings`]) that
//! gather irradiance, occlusion and glossy reflections at the pixels of the caller's G-buffer.
//!
//! A cone returns radiance, irradiance is the cosine-weighted sum over cones, and outgoing radiance is
//! albedo / pi times irradiance: there is no scale to tune. Whatever many threads write at once is an integer
//! sum or a bit set, so two runs give the same bits.
//!
//! The order of calls is that of [`Gi`]'s methods; `examples/own_engine` shows them with triangles, lights
//! and a G-buffer of its own.

mod cascades;
mod cones;
mod emitters;
mod environment;
mod error;
#[cfg(test)]
mod frames_test;
mod geometry;
mod gi;
mod gloss;
pub mod gpu;
mod grid;
pub mod hooks;
#[cfg(test)]
mod layouts_test;
mod light;
mod mounted;
mod points;
pub mod settings;
pub mod shaders;
mod temporal;
#[cfg(test)]
mod testing;
mod trace;
mod volume;
mod voxelize;
pub mod voxels;

// What tests inside share with those from outside names the crate as these do.
#[cfg(test)]
extern crate self as lumivox;

pub use cascades::{CascadeOptions, Cascades, MAX_CASCADES};
pub use cones::{Preset, TraceResolution, TraceSettings};
pub use environment::{
    CubeUse, EnvironmentCube, EnvironmentLight, EnvironmentMap, Panorama, PanoramaWithPeaks, Peak,
};
pub use error::GiError;
pub use geometry::{
    Draw, Geometry, GeometryBatch, Indices, SurfaceMaterial, SurfaceTexture, VertexAttributes,
    VertexPositions,
};
pub use gi::{Gi, GiConfig, Voxelized};
pub use gloss::Gloss;
pub use grid::{Grid, MAX_RESOLUTION, MIN_RESOLUTION};
pub use light::{Light, LightSource, Lights, Shadow, ShadowLayer, ShadowMaps, ShadowSource};
pub use points::{GatherPoints, GatherSettings, GatheredPoint, Irradiance};
pub use trace::{AS_THE_CAMERA, CameraView, GBuffer, GBufferViews, TraceTargets};
pub use volume::{Directionality, VolumeKind, dense_volume_bytes};
pub use volume::{Duplication, Mipmapping, OctreeOptions, OctreeStats};
// The engine's wgpu must be this one.
pub use wgpu;

pub use voxelize::{FrameVoxels, VoxelizeStats, VoxelizedScene, Voxelizer};
