//! Cones: their start, their distribution over a hemisphere, their rays, and their settings. With a
//! caller's own [`ConeModel`], cones march through cells instead.
//!
//! The bounces in the voxels (`light/bounce.wgsl`), shadow cones and the cones from the screen
//! (`trace/`) use these modules.

mod hook;
mod settings;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};

use crate::gpu::ShaderLibrary;

pub use hook::ConeModel;
pub use settings::{Preset, TraceResolution, TraceSettings};

/// Maximum surplus of opacity of an oblique wall that counts as scatter; a larger surplus is a
/// second surface. If this is smaller, more light leaks; if larger, surfaces right behind others
/// count and darken farther ones.
const SURPLUS: f32 = 0.1;

/// Minimum surplus that is paid back.
const LEAST_SURPLUS: f32 = 0.03;

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library.constant_f32("SURPLUS", SURPLUS).constant_f32("LEAST_SURPLUS", LEAST_SURPLUS);
}

/// Adds the methods for a march or for exact hits: of cones as `package::cones::trace_method`, of
/// faces as `package::light::gather_method`, of pixels as `package::trace::gather_method`, and of
/// surfaces in mirrors as `package::trace::hit_method`.
pub(crate) fn mount(shaders: &mut ShaderLibrary, marches: bool) {
    let methods = if marches {
        ["cones::march", "light::gather_cones", "trace::by_cones", "trace::marched_hit"]
    } else {
        ["cones::exact", "light::gather_rays", "trace::near_and_far", "trace::lit_hit"]
    };
    for method in methods {
        shaders.fill(crate::gpu::implementation(method));
    }
}

/// `ConeSettings` of `cone.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ConeSettings {
    pub(crate) voxel_per_diameter: f32,
    pub(crate) clearance: f32,
    pub(crate) normal_offset: f32,
    pub(crate) step_per_voxel: f32,
    pub(crate) min_transmittance: f32,
    pub(crate) occlusion_distance: f32,
    pub(crate) padding: [u32; 2],
    pub(crate) model_values: [f32; 4],
}

impl TraceSettings {
    /// The settings of one cone, for voxels of the given size, with the values of the cone model.
    pub(crate) fn cones(&self, voxel_size_m: f32, model_values: [f32; 4]) -> ConeSettings {
        ConeSettings {
            voxel_per_diameter: self.voxel_per_diameter,
            clearance: self.clearance,
            normal_offset: self.normal_offset_voxels,
            step_per_voxel: self.step_per_voxel,
            min_transmittance: self.min_transmittance,
            occlusion_distance: (self.occlusion_distance_m / voxel_size_m).min(3e38),
            model_values,
            ..ConeSettings::zeroed()
        }
    }
}
