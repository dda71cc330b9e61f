//! The choice of the GPU.

use std::path::PathBuf;

use clap::Args;
use lumivox_render::GpuOptions;

/// The choice of the GPU.
#[derive(Args, Debug)]
#[command(next_help_heading = "GPU")]
pub struct GpuArgs {
    /// Part of the GPU's name, in upper or lower case [default: the fastest kind of GPU]
    ///
    /// `lumivox info` lists them.
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,

    /// Use no more than WebGPU's default limits, as in a browser [default: off]
    #[arg(long)]
    pub portable: bool,

    /// Folder for the file of compiled pipelines, or `off` [default: the user's cache folder]
    ///
    /// A driver that keeps none itself starts faster the next time (Vulkan only). The variable
    /// `LUMIVOX_PIPELINE_CACHE` sets the default.
    #[arg(long, value_name = "FOLDER")]
    pub pipeline_cache: Option<PathBuf>,
}

impl GpuArgs {
    /// Options for opening the device.
    pub fn options(&self) -> GpuOptions {
        GpuOptions {
            adapter: self.adapter.clone(),
            portable: self.portable,
            pipeline_cache: match &self.pipeline_cache {
                Some(folder) if folder.as_os_str() == "off" => None,
                Some(folder) => Some(folder.clone()),
                None => lumivox_render::pipeline_cache_folder(),
            },
        }
    }
}
