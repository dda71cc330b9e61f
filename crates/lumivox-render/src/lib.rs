//! A deferred renderer around the global illumination of `lumivox`: from a scene to a picture.
//!
//! ```no_run
//! # async fn render() -> Result<(), Box<dyn std::error::Error>> {
//! use lumivox_render::{Gpu, GpuOptions, RenderSettings, Renderer};
//!
//! let scene = lumivox_scene::builtin::scene("cornell")?;
//! let gpu = Gpu::new(&GpuOptions::default()).await?;
//! let settings = RenderSettings { frames: 32, ..RenderSettings::default() };
//! let mut renderer = Renderer::new(&gpu, &scene, None, settings, &mut |_| {}).await?;
//! let picture = renderer.render(&mut |_| {}).await?;
//! picture.write("cornell.png".as_ref())?;
//! # Ok(())
//! # }
//! ```
//!
//! A frame is a row of passes, each in its own module with its shader beside it: the G-buffer
//! ([`gbuffer_pass`]), direct light ([`direct`]) with shadow maps ([`shadow_maps`]), the cones of
//! `lumivox`, and the [`composite`], which [`accumulate`] averages over frames and [`tone_map`] brings
//! to a screen. The truth that all this is measured by is a path tracer ([`mod@reference`]), and [`compare`] tells how
//! far a picture is from it.

// Tests compare floats that must be equal to the bit.
#![cfg_attr(test, allow(clippy::float_cmp))]

pub mod accumulate;
pub mod classics;
pub mod compare;
pub mod composite;
mod develop;
pub mod direct;
mod error;
mod estimate;
mod faults;
pub mod gbuffer_pass;
mod gpu;
mod image;
mod memory;
mod overlay;
pub mod parameters;
mod preset;
mod raster;
mod readback;
pub mod reference;
mod renderer;
mod settings;
pub mod shaders;
pub mod shadow_maps;
mod srgb;
mod targets;
mod textures;
mod times;
pub mod tone_map;
mod upload;
mod voxel_sets;
pub mod voxel_view;
mod vxct;

// What tests inside share with those from outside names the crate as these do.
#[cfg(test)]
extern crate self as lumivox_render;
#[cfg(test)]
mod layouts;
#[cfg(test)]
mod testing;

pub use error::RenderError;
pub use estimate::MemoryEstimate;
pub use gpu::{Gpu, GpuOptions, describe};
pub use image::{ImageFormat, Picture};
pub use memory::MemoryUse;
pub use overlay::{Overlay, OverlayLine, Wireframe, Wires};
pub use preset::{Companions, PresetChoice};
pub use renderer::{Photometry, Progress, Renderer, global_illumination};
pub use settings::{COST_SCALE_SAMPLES, Exposure, RenderSettings, ShadowMethod, ToneMap, View};
pub use srgb::srgb_encode;
pub use tone_map::{EV100_RANGE, ExposureWarning, Histogram, Metering};
pub use upload::{GpuScene, Lighting, radiance_unit};
pub use voxel_sets::{
    EXTRA_COLOR, MISSING_COLOR, SetDifference, Voxel, VoxelSet, voxel_set_picture,
};
pub use vxct::{ConeShape, Look, VxctDisplay, VxctSettings, has_display_values, vxct_display};
