//! The hook for a caller's own direct light in the voxels.

use std::any::Any;
use std::fmt::Debug;

use crate::gpu::{BindGroup, Buffer, Pipelines, Recorder, ShaderLibrary};
use crate::voxels::VoxelList;
use crate::{GiError, Grid, Lights};

/// How the light of lamps and suns gets into the voxels, instead of evaluating each light for each
/// face.
///
/// Implement it for light from your own simulation, for baked light, or for light that is meant to
/// be unphysical. Bounces, and the surroundings whose light arrives by them, work as with Lumivox's
/// own direct light.
pub trait Injection: Debug + Send + Sync {
    /// The name; settings that name the same injection are equal.
    fn name(&self) -> &'static str;

    /// Bytes on the GPU for each face of the voxels, for estimates of memory. Default: 0.
    fn bytes_per_face(&self) -> u64 {
        0
    }

    /// The largest texel of a shadow map, in voxels, that does not degrade the injected light, for
    /// warnings. Default: infinity.
    fn largest_texel_voxels(&self) -> f32 {
        f32::INFINITY
    }

    /// Creates the [`Injector`] on a device.
    ///
    /// # Errors
    /// Returned by [`crate::Gi::with_pipelines`].
    fn make(&self, parts: &InjectionParts<'_>) -> Result<Box<dyn Injector>, GiError>;
}

/// Injections are compared by their names.
impl PartialEq for dyn Injection {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// Parts that an [`Injection`] can use to create its [`Injector`].
#[derive(Clone, Copy, Debug)]
pub struct InjectionParts<'a> {
    /// The device, with its pipelines.
    pub device: &'a Pipelines,
    /// All of Lumivox's modules, `package::volume` among them; add your own to a clone.
    pub shaders: &'a ShaderLibrary,
    /// The grid of the voxels.
    pub grid: &'a Grid,
    /// The layout of bind group 0: the grid, the volume and the emitters
    /// ([`crate::Gi::globals_layout`]).
    pub globals: &'a wgpu::BindGroupLayout,
    /// The layout of bind group 2: lights and shadow maps ([`crate::Gi::lights_layout`]).
    pub lights: &'a wgpu::BindGroupLayout,
}

/// Created by an [`Injection`]: it lights the faces of a voxel list. [`crate::Gi::injector`]
/// returns it.
pub trait Injector: Any + Debug + wgpu::WasmNotSendSync {
    /// Sets the list that later runs light.
    fn take(&mut self, device: &Pipelines, voxels: &VoxelList);

    /// Records the passes that write the light of every face.
    fn run(&self, recorder: &mut Recorder, light: FaceLight<'_>);

    /// Bytes on the GPU, by purpose.
    fn memory(&self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }
}

/// The lights that an [`Injector`] reads, and the faces that it writes.
#[derive(Clone, Copy, Debug)]
pub struct FaceLight<'a> {
    /// Bind group 0: the grid and the volume, which already has this list's opacities if a light
    /// has cone shadows.
    pub globals: &'a BindGroup,
    /// The lights, with bind group 2.
    pub lights: &'a Lights,
    /// Output: the radiance that each face sends out before any bounce (`array<vec4f>`, 1 in w).
    pub direct: &'a Buffer,
}
