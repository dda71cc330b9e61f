//! Hooks: traits by which a caller replaces one of Lumivox's methods.
//!
//! A hook is set in [`GiConfig`](crate::GiConfig). It is a cheap description: it creates the object
//! that does the work on a device, or provides its WGSL. The replacement reads and writes the same
//! data as Lumivox's own method, so everything before and after it stays the same. A hook that is
//! not set compiles no GPU code. `lumivox-classics` consists of hooks.

pub use crate::cones::ConeModel;
pub use crate::light::{FaceLight, Injection, InjectionParts, Injector, MappedLight};
pub use crate::mounted::{Mounted, Resource};
pub use crate::volume::{OctreeBuilder, OctreeBuilding, OctreeParts, TreeToBuild};
pub use crate::voxelize::{
    Detail, Voxelization, VoxelizationShares, Walk, WalkRun, WalkStep, Walker,
};
