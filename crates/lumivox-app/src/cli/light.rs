//! What shines, and how its light is found.

use clap::Args;
use lumivox_console::SourceArgs;
use lumivox_render::ShadowMethod;
use lumivox_render::classics::InjectionChoice;

use crate::args::{choices, number, size};

/// Light, and how it is found.
#[derive(Args, Debug)]
#[command(next_help_heading = "Light")]
pub struct LightArgs {
    /// What shines.
    #[command(flatten)]
    pub sources: SourceArgs,

    /// Reflections of indirect light, 0 to 16 [default: 8; presets report and vxct: 1]
    ///
    /// 0 is direct light alone, 1 is light by way of one other surface. N leave out about the share
    /// a^N of the light in a room of albedo a. Each costs one more gather in the voxels, once.
    #[arg(long, value_name = "BOUNCES", value_parser = number::whole(0..=16))]
    #[arg(allow_negative_numbers = true)]
    pub bounces: Option<u32>,

    /// How shadows of lamps and sun are found
    #[arg(long, value_name = "HOW", value_parser = choices::shadows())]
    #[arg(default_value = "map")]
    pub shadows: ShadowMethod,

    /// Edge of a shadow map in texels, 16 to 32768 (or less, as the GPU allows)
    ///
    /// Higher: sharper shadows that begin nearer to their caster, and photons that scatter less. Four
    /// bytes a texel; a point light has six maps.
    #[arg(long, value_name = "TEXELS", value_parser = number::whole(16..=size::LONGEST_EDGE))]
    #[arg(default_value = "1024", allow_negative_numbers = true)]
    pub shadow_resolution: u32,

    /// How the light of lamps and sun comes into the voxels [default: direct; preset report: photons]
    ///
    /// Both give the same light in the mean. Photons scatter with the texels that a voxel is seen by, and
    /// follow shadows within a voxel. Lights without shadow maps are injected directly.
    #[arg(long, value_name = "HOW", value_parser = choices::injection())]
    pub injection: Option<InjectionChoice>,
}
