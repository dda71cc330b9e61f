#![doc = include_str!("../README.md")]
//!
//! # How it works
//!
//! Triangles are voxelized on the GPU into a compact list of occupied voxels ([`voxels`]), each
//! with a face for every side that has surface. Light is computed on that list: direct light,
//! emission, bounces ([`Light`]). A volume stores and filters it into a pyramid, which is sampled
//! by cones ([`TraceSettings`]) that gather irradiance, occlusion and glossy reflections at the
//! pixels of the caller's G-buffer.
//!
//! A cone returns radiance, irradiance is the cosine-weighted sum over cones, and outgoing radiance
//! is albedo / pi times irradiance, without a scale to tune. All concurrent writes are integer sums
//! or bit sets, so two runs give the same bits.

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
#[doc(hidden)]
pub mod internal;
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
mod version;
mod volume;
mod voxelize;
pub mod voxels;

// Test code shared with integration tests refers to this crate by name.
#[cfg(test)]
extern crate self as lumivox;

pub use cascades::{CascadeOptions, Cascades, MAX_CASCADES};
pub use cones::{Preset, TraceResolution, TraceSettings};
pub use environment::{
    CubeUse, EnvironmentCube, EnvironmentLight, EnvironmentMap, Panorama, PanoramaWithPeaks, Peak,
};
pub use error::GiError;
pub use geometry::{
    Draw, Geometry, GeometryBatch, GeometryParts, Indices, SurfaceMaterial, SurfaceTexture,
    VertexAttributes, VertexPositions,
};
pub use gi::{Frame, FrameStatus, Gi, GiConfig, Voxelized};
pub use gloss::Gloss;
pub use grid::{Grid, MAX_RESOLUTION, MIN_RESOLUTION};
pub use light::{Light, LightSource, Lights, Shadow, ShadowLayer, ShadowMaps, ShadowSource};
pub use points::{GatherPoints, GatherSettings, GatheredPoint, Irradiance, PROBE_SIDES};
pub use trace::{AS_THE_CAMERA, CameraView, GBuffer, GBufferViews, GiView};
pub use volume::{Directionality, OctreeStats, VolumeKind, dense_volume_bytes};
// Re-exported, since the caller must use this version of wgpu.
pub use wgpu;

pub use voxelize::VoxelizeStats;
