//! The commands, one module each.

pub mod compare;
pub mod convert;
pub mod info;
pub mod light;
pub mod quality;
pub mod reference;
pub mod render;
pub mod run;
pub mod scenes;
pub mod settings;
mod staged;
pub mod view;
pub mod volumes;
pub mod voxels;

use lumivox_render::{Gpu, GpuOptions, RenderError};

use crate::cli::GpuArgs;

/// Opens the GPU that the command line asks for.
///
/// # Errors
/// As [`Gpu::new`].
fn open_gpu(args: &GpuArgs) -> Result<Gpu, RenderError> {
    let options = GpuOptions { adapter: args.adapter.clone(), portable: args.portable };
    let gpu = pollster::block_on(Gpu::new(&options))?;
    tracing::info!("running on {}", lumivox_render::describe(&gpu.adapter_info));
    Ok(gpu)
}
