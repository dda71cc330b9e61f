//! The hook for a caller's own direct light in the voxels.

use std::any::Any;
use std::fmt::Debug;

use crate::gpu::{BindGroup, Buffer, Pipelines, Recorder, ShaderLibrary};
use crate::voxels::VoxelList;
use crate::{GiError, Grid, Lights};

/// How the light of lamps and suns comes into the voxels, instead of asking each light for each face.
///
/// Write one for light that a simulation of your own computes, that was baked, or that is meant to be unphysical.
/// Bounces, and the surroundings that arrive by them, work on it as on Lumivox's own.
pub trait Injection: Debug + Send + Sync {
    /// The name; settings that name the same injection are equal.
    fn name(&self) -> &'static str;

    /// Bytes that it keeps on the GPU for each face of the voxels, for estimates of memory. Default: 0.
    fn bytes_per_face(&self) -> u64 {
        0
    }

    /// The largest texel of a shadow map, in voxels, that its light does not suffer from, for warnings. Default: any.
    fn largest_texel_voxels(&self) -> f32 {
        f32::INFINITY
    }

    /// Makes what computes the light on a device.
    ///
    /// # Errors
    /// As [`crate::Gi::with_pipelines`], which passes them on.
    fn make(&self, parts: &InjectionParts<'_>) -> Result<Box<dyn Injector>, GiError>;
}

/// Injections are compared by their names.
impl PartialEq for dyn Injection {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// What an [`Injection`] can be made of.
#[derive(Clone, Copy, Debug)]
pub struct InjectionParts<'a> {
    /// The device, with its pipelines.
    pub device: &'a Pipelines,
    /// All of Lumivox's modules, `package::volume` among them; add your own to a clone.
    pub shaders: &'a ShaderLibrary,
    /// Where the voxels are.
    pub grid: &'a Grid,
    /// The layout of bind group 0: the grid, the volume and the emitters ([`crate::Gi::globals_layout`]).
    pub globals: &'a wgpu::BindGroupLayout,
    /// The layout of bind group 2: lights and shadow maps ([`crate::Gi::lights_layout`]).
    pub lights: &'a wgpu::BindGroupLayout,
}

/// What an [`Injection`] makes: it lights the faces of a voxel list. [`crate::Gi::injector`] gives it back.
pub trait Injector: Any + Debug + wgpu::WasmNotSendSync {
    /// Takes the list that is lit from now on.
    fn take(&mut self, device: &Pipelines, voxels: &VoxelList);

    /// Records the passes that write the light of every face.
    fn run(&self, recorder: &mut Recorder, light: FaceLight<'_>);

    /// Bytes on the GPU, by what they hold.
    fn memory(&self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }
}

/// Where an [`Injector`] reads lights from and writes faces to.
#[derive(Clone, Copy, Debug)]
pub struct FaceLight<'a> {
    /// Bind group 0: the grid and the volume, which has this list's opacities already if a light has cone shadows.
    pub globals: &'a BindGroup,
    /// The lights, with bind group 2.
    pub lights: &'a Lights,
    /// To be written for each face: the radiance that it sends out before any bounce (`array<vec4f>`, 1 in w).
    pub direct: &'a Buffer,
}
