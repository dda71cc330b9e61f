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
//! | module | contains |
//! | --- | --- |
//! | `settings/` | all settings, in one table |
//! | `look.rs` | the hook for other ways to draw the picture |
//! | `scene/` | a scene on the GPU |
//! | `passes/` | the passes of a frame, each with its shader beside it |
//! | `picture/` | conversion of radiance for screens and files |
//! | `renderer/` | connects the passes, and updates whatever a change invalidates |
//! | `measure.rs` | the grid of a workplane, and statistics of light readings |
//! | `reference/` | the path tracer that provides ground truth |
//! | `irradiance_volume/` | light at a grid of probes, as a file for other renderers |
//! | `lightmap/` | light on surfaces, as an image for other renderers |
//! | `compare/` | the error of a picture against the reference |

// Tests compare floats that must be bit-identical.
#![cfg_attr(test, allow(clippy::float_cmp))]

pub mod compare;
mod error;
mod gpu;
mod half_texture;
pub mod irradiance_volume;
pub mod lightmap;
pub mod look;
pub mod measure;
mod passes;
mod picture;
pub mod reference;
mod renderer;
mod scene;
mod settings;
pub mod shaders;

// Tests inside the crate and in `tests/` share code that refers to the crate by this name.
#[cfg(test)]
extern crate self as lumivox_render;
#[cfg(test)]
mod layouts;
#[cfg(test)]
mod testing;

pub use compare::voxel_sets::{
    EXTRA_COLOR, MISSING_COLOR, SetDifference, Voxel, VoxelSet, voxel_set_picture,
};
pub use error::RenderError;
pub use gpu::memory::MemoryUse;
#[cfg(not(target_arch = "wasm32"))]
pub use gpu::pipeline_cache_folder;
pub use gpu::{Gpu, GpuId, GpuOptions, describe};
pub use passes::gbuffer::clip_from_world;
pub use passes::overlay::{Overlay, OverlayLine, Wireframe, Wires};
pub use picture::srgb::srgb_encode;
pub use picture::tone_map::{EV100_RANGE, ExposureWarning, Histogram, Metering};
pub use picture::{ImageFormat, Picture};
pub use renderer::estimate::MemoryEstimate;
pub use renderer::{
    Photometry, RenderProgress, Renderer, TraceFigures, VoxelFace, global_illumination,
};
pub use scene::{GeometryBudget, GpuScene, Lighting, StreamedGeometry, radiance_unit};
pub use settings::parameters;
pub use settings::preset::{AddedPreset, Companions, PresetChoice};
pub use settings::{
    COST_SCALE_SAMPLES, Exposure, HISTORY_SCALE_FRAMES, PHYSICAL, RenderSettings, ShadowMethod,
    ToneMap, View,
};
