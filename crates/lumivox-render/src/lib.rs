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
//! | room | holds |
//! | --- | --- |
//! | `settings/` | everything that can be set, in one table |
//! | `look.rs` | the hook for another way to the picture |
//! | `scene/` | a scene on the GPU |
//! | `passes/` | the passes of a frame, each with its shader beside it |
//! | `picture/` | radiance on its way to a screen and to files |
//! | `renderer/` | joins the passes, and redoes what a change makes necessary |
//! | `measure.rs` | the grid of a workplane, and the figures of many readings of light |
//! | `reference/` | the truth that all this is measured by: a path tracer |
//! | `compare/` | how far a picture is from it |

// Tests compare floats that must be equal to the bit.
#![cfg_attr(test, allow(clippy::float_cmp))]

pub mod compare;
mod error;
mod gpu;
pub mod irradiance_volume;
pub mod look;
pub mod measure;
mod passes;
mod picture;
pub mod reference;
mod renderer;
mod scene;
mod settings;
pub mod shaders;

// Tests inside the crate and in `tests/` share code that names the crate like this.
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
