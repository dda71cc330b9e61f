//! Hooks: traits by which a caller puts a way of its own in the place of one of Lumivox's.
//!
//! A hook is named in [`GiConfig`](crate::GiConfig), is a description that costs nothing, and makes
//! what works on a device, or gives the WGSL of it. What it makes reads and writes what Lumivox's
//! own way does, so everything before and after it stays the same. Without hooks nothing of them is
//! compiled for the GPU. `lumivox-classics` stands on them.

pub use crate::cones::ConeModel;
pub use crate::light::{FaceLight, Injection, InjectionParts, Injector, MappedLight};
pub use crate::mounted::{Mounted, Resource};
pub use crate::volume::{OctreeBuilder, OctreeBuilding, OctreeParts, TreeToBuild};
pub use crate::voxelize::{
    Detail, Voxelization, VoxelizationShares, Walk, WalkRun, WalkStep, Walker,
};
